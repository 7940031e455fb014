// The parts of a fluid's rates, for the books of its energy (energy_books.hpp): what finishes the sums of a particle
// (fluid_finish.hpp) hands them over where a pass asks for them. A pass that does not ask hands NoParts over, and
// nothing of this is computed.
#pragma once

#include <array>
#include <vector>

#include "engine/fours.hpp"
#include "models/fluid/fluid_rates.hpp"

namespace barchan {

struct NoParts {
  static constexpr bool asked = false;
};
inline constexpr NoParts no_parts{};

/// Of one particle, or of several side by side (V).
template <int Dim, class V>
struct RateParts {
  static constexpr bool asked = true;
  double centring;                                 // s, the time by which the velocities are behind the density's step
  std::array<V, Dim> pressure, friction, carried;  // m/s2; carried: by the shifting
  std::array<V, Dim> stress, turning;              // m/s2, of a free surface; turning: by the friction of the method
  V viscosity;                                     // Pa s, of the friction
  V squeezed;                                      // kg/m3/s: -rho div v, of velocities that are not behind
  V diffused, moved, renewed;                      // kg/m3/s; moved: by the shifting; renewed: loose or clamped
};

/// The same of all particles of a fluid, a column each: scratch of a step.
struct PartColumns {
  static constexpr bool asked = true;
  double centring = 0.0;
  std::array<std::vector<double>, 3> pressure, friction, stress, turning, carried;
  std::vector<double> viscosity, squeezed, diffused, moved, renewed;

  /// Makes room for n particles.
  void fit(std::size_t n, int dimensions) {
    for (auto* vectors : {&pressure, &friction, &stress, &turning, &carried})
      for (int d = 0; d < dimensions; ++d) (*vectors)[static_cast<std::size_t>(d)].resize(n);
    for (auto* column : {&viscosity, &squeezed, &diffused, &moved, &renewed}) column->resize(n);
  }

  /// For four particles, still without numbers.
  template <int Dim>
  RateParts<Dim, Four> of() const {
    RateParts<Dim, Four> parts;
    parts.centring = centring;
    return parts;
  }
  /// Takes four particles from k on, of which `count` exist.
  template <int Dim>
  BARCHAN_SIMD_INLINE void store(const RateParts<Dim, Four>& r, std::size_t k, std::size_t count) {
    for (std::size_t d = 0; d < Dim; ++d) {
      store_four(r.pressure[d], pressure[d].data(), k, count);
      store_four(r.friction[d], friction[d].data(), k, count);
      store_four(r.stress[d], stress[d].data(), k, count);
      store_four(r.turning[d], turning[d].data(), k, count);
      store_four(r.carried[d], carried[d].data(), k, count);
    }
    store_four(r.viscosity, viscosity.data(), k, count);
    store_four(r.squeezed, squeezed.data(), k, count);
    store_four(r.diffused, diffused.data(), k, count);
    store_four(r.moved, moved.data(), k, count);
    store_four(r.renewed, renewed.data(), k, count);
  }
};

BARCHAN_PER_INSTRUCTION_SET(
    fluid_rate_parts,
    /// Writes the parts of the rates of fluid_rates, and nothing else; to be called before it, which renews what both
    /// read. Of a fluid that touches no other.
    void fluid_rate_parts(PhaseParticles& fluid, const RecordArray& own, std::span<const FluidNeighbour> neighbours,
                          const FluidParameters& parameters, FluidScheme scheme, PartColumns& parts);
    void fluid_rate_parts(PhaseParticles& fluid, const CompactRecords& own, std::span<const FluidNeighbour> neighbours,
                          const FluidParameters& parameters, FluidScheme scheme, PartColumns& parts);)

}  // namespace barchan
