// Places whose outermost layer follows a border, and whose volumes are even. Internal to src/start.
#pragma once

#include <vector>

#include "scene/scene.hpp"
#include "start/region.hpp"

namespace barchan {

/// Packing "relaxed" of the k-th fill. As many places as the region holds spacings^d, to the nearest whole number:
/// those of the square lattice that lie deepest. They move down the gradient of the kernel sum (as particle shifting
/// does: Lind et al. 2012), in which the space outside counts as filled, until it is flat; the outermost layer is held
/// half a spacing inside the border. Places deeper than 8 spacings stay on the lattice. At most 400 rounds; the same
/// bits for any number of threads. misfit_of_region(scene, k) must be empty.
std::vector<Vec3> relaxed_places(const Scene& scene, std::size_t k);

/// How even places are: the least distance of two, in spacings, and the sums of V W over places and the space outside,
/// which are 1 where the places are even. For tests.
struct Evenness {
  double least_distance = 0.0;
  double least_sum = 0.0, mean_sum = 0.0, largest_sum = 0.0;
  double content = 0.0;  // m2 or m3, of the region
};
Evenness evenness_of(const Scene& scene, std::size_t k, const std::vector<Vec3>& places);

}  // namespace barchan
