// Records: what a pair loop loads of a neighbour, packed side by side so that whole cache lines are fetched and
// transposed in registers. Particles come first, then periodic images, then one dummy that pads the rows of pair lists.
//
// A motion record holds position, velocity and two scalars:
//   2D  x y u v p V - -      3D  x y z u v w p V
// p is the pressure [Pa] (its meaning is the pass's own), V the volume [m^dimensions]; V = 0 marks the dummy.
// A stress record holds position, velocity, stress/density^2 and volume:
//   2D  x y u v sxx syy sxy V     3D  x y z u v w sxx syy szz sxy syz sxz V - - -
#pragma once

#include <cstddef>

#include "base/aligned.hpp"
#include "neighbours/cell_grid.hpp"

namespace barchan {

template <int Dim>
struct MotionRecord {
  static constexpr int size = 8, position = 0, velocity = Dim, pressure = 2 * Dim, volume = 2 * Dim + 1;
};

template <int Dim>
struct StressRecord {
  static constexpr int size = Dim == 2 ? 8 : 16, position = 0, velocity = Dim, stress = 2 * Dim;
  static constexpr int stresses = Dim == 2 ? 3 : 6, volume = stress + stresses;
};

/// Records of one phase.
class RecordArray {
 public:
  explicit RecordArray(int size) : size_(static_cast<std::size_t>(size)) {}

  /// Room for `particles` + `images` + the dummy. Allocates only to grow.
  void resize(std::size_t particles, std::size_t images) {
    particles_ = particles;
    const std::size_t needed = (particles + images + 1) * size_;
    if (data_.size() < needed) data_.resize(needed + (images / 4 + 64) * size_);
    dummy_ = particles + images;
    double* d = data_.data() + dummy_ * size_;
    for (std::size_t f = 0; f < size_; ++f) d[f] = 0.0;
    d[0] = d[1] = far_away;  // finite, beyond every kernel
  }

  double* operator[](std::size_t k) { return data_.data() + k * size_; }
  const double* operator[](std::size_t k) const { return data_.data() + k * size_; }
  const double* data() const { return data_.data(); }
  std::size_t stride() const { return size_; }
  std::uint32_t dummy() const { return static_cast<std::uint32_t>(dummy_); }
  std::size_t bytes() const { return data_.capacity() * sizeof(double); }

  /// Copies the images from their sources, shifted by their periods. The first `dimensions` fields are the position.
  void fill_images(const CellGrid& grid, int dimensions) {
    const auto& images = grid.image_list();
    const auto n = static_cast<std::int64_t>(images.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t q = 0; q < n; ++q) {
      const Image& image = images[static_cast<std::size_t>(q)];
      const double* from = (*this)[image.source];
      double* to = (*this)[particles_ + static_cast<std::size_t>(q)];
      for (std::size_t f = 0; f < size_; ++f) to[f] = from[f];
      for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) to[d] += image.shift[d] * grid.period()[d];
    }
  }

 private:
  static constexpr double far_away = 1.0e12;
  std::size_t size_, particles_ = 0, dummy_ = 0;
  AlignedVector<double> data_;
};

}  // namespace barchan
