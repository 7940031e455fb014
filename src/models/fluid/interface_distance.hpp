// How far a fluid's particles are from the interface with another fluid, from the share of the neighbourhood that their
// own fluid fills (laws/interface_side.hpp).
//
// Of a fluid below a plane, at the distance d, the share follows from the kernels; the rows of a lattice, half a
// spacing, one and a half... from the interface, have a share that is a little another, and there the distance is
// theirs. Measured on such rows strained by a fifth: 0.01 spacings; disturbed by a fifth of a spacing: 0.06 in the
// first row.
#pragma once

#include <span>
#include <vector>

#include "engine/pair_entry.hpp"
#include "engine/records.hpp"
#include "laws/interface_side.hpp"

namespace barchan {

class InterfaceDistance {
 public:
  InterfaceDistance() = default;
  /// Of a fluid of this spacing (m) with itself and with the other one of its own spacing.
  struct Side {
    KernelKind kernel;
    double radius, spacing;  // m
  };
  InterfaceDistance(const Side& own, const Side& other, int dimensions);

  /// Distance (m) of particles with this share, at least `nearest`.
  double operator()(double share) const;

  /// A particle nearer than this, in spacings, counts as at this distance: 1/theta has no bound.
  static constexpr double nearest = 0.25;

 private:
  double step_ = 0.0;           // of the share
  std::vector<double> values_;  // m, from a share of 0 to 1
};

BARCHAN_PER_INSTRUCTION_SET(find_interface,
                            /// Writes the distance (m) of each of the n particles. own: their motion records; entries:
                            /// of the fluid with itself and with others.
                            void find_interface(std::size_t n, int dimensions, const RecordArray& own,
                                                std::span<const PairEntry<InterfaceSide>> entries,
                                                const InterfaceDistance& distance, AlignedVector<double>& out);)

}  // namespace barchan
