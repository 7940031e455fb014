// A body in its reference configuration: who is whose neighbour, and the constants of the total Lagrangian sums. It is
// made once, of the particles' first places, and never changes; a run that is continued makes the same one again.
//
// Particles stand in the order of their ids, which fills make row by row. The sums of `width` particles run side by
// side, lane l for particle first + l. On a lattice their neighbours at one offset stand side by side as well, and
// the weights are the same in all lanes: a slot of 20 bytes serves `width` pairs, and the list of a body of any size
// stays in the cache. At the ends of rows some lanes have no such neighbour: a slot with weights by lane. Places
// without order (a random packing) take slots with an index by lane.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/aligned.hpp"
#include "base/vec3.hpp"
#include "engine/cell_grid.hpp"
#include "kernels/kernel_kind.hpp"

namespace barchan {

/// w = V0 (-dW/dr)/r of a pair, and w X_ab with X_ab = X_a - X_b.
template <class T>
struct PairWeights {
  T w;
  std::array<T, 3> wx;
};

template <class T>
class ReferenceBody {
 public:
  /// Neighbours at first + lane + delta, with the same weights in all lanes.
  struct Whole {
    std::int32_t delta;
    PairWeights<T> weights;
  };
  /// Slots of a group, in the order in which they are summed.
  struct Group {
    std::uint32_t whole = 0, part = 0, scattered = 0;  // ends; a group begins where the one before ends
  };

  std::size_t size = 0, width = 0;
  int dimensions = 2;
  double volume = 0.0;                       // m^dimensions, of a particle
  std::array<std::vector<double>, 3> place;  // m, X
  std::vector<Group> groups;                 // of `width` particles; the last may have fewer
  std::vector<Whole> wholes;
  std::vector<std::int32_t> part_delta;  // one a slot
  AlignedVector<T> part_weights;         // a slot: width times w, then wX by axis
  AlignedVector<std::uint32_t> index;    // a slot: width indices
  AlignedVector<T> scattered_weights;
  std::array<AlignedVector<T>, 6> inverse;  // M^-1, M = sum w X (x) X: 2D xx xy yy, 3D xx xy xz yy yz zz
  std::array<AlignedVector<T>, 3> sum;      // sum w X
  std::int64_t flat = -1;                   // first particle whose neighbours lie in one line or plane
  std::uint64_t pairs = 0;                  // directed

  /// Connected parts of the body: each is an interval of ids or several.
  struct Piece {
    std::size_t begin, end, anchor;  // ids from the phase's first; anchor: the first particle of the part
  };
  std::vector<Piece> pieces;
  double diameter = 0.0;  // m, the longest of the parts
};

/// `places` (m) of a phase with this spacing; `width`: lanes of T.
template <class T>
ReferenceBody<T> make_reference_body(const std::vector<Vec3>& places, const Bounds& bounds, double spacing,
                                     KernelKind kernel, double radius, std::size_t width);

}  // namespace barchan
