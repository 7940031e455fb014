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
#include "laws/interface_plane.hpp"
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

/// Where the interface is near each particle of a fluid, of the fits of laws/interface_plane.hpp.
struct InterfacePlanes {
  AlignedVector<double> normal;  // into the other fluid, x y (z) of each particle; zero: no plane was found
  AlignedVector<double> spread;  // m, of the distances about the plane (root of their mean square)
};

BARCHAN_PER_INSTRUCTION_SET(
    fit_interface,
    /// Fits the plane of each of the n particles. own: their motion records; entries: of the fluid with itself and with
    /// others, which bring the distances (m) of their particles; raw: the distances of the fluid's own particles; out:
    /// the distances (m) from the planes, below zero beyond.
    void fit_interface(std::size_t n, int dimensions, const RecordArray& own,
                       std::span<const PairEntry<InterfacePlane>> entries, const AlignedVector<double>& raw,
                       AlignedVector<double>& out, InterfacePlanes& planes);)

BARCHAN_PER_INSTRUCTION_SET(find_interface,
                            /// Writes the distance (m) of each of the n particles. own: their motion records; entries:
                            /// of the fluid with itself and with others.
                            void find_interface(std::size_t n, int dimensions, const RecordArray& own,
                                                std::span<const PairEntry<InterfaceSide>> entries,
                                                const InterfaceDistance& distance, AlignedVector<double>& out);)

}  // namespace barchan
