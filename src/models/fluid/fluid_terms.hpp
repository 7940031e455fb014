// The terms that finish the sums of a consistent fluid's particle (fluid_finish.hpp), beside the corrected operators:
// which of them a fluid has is a type of the loop, so that no particle asks for one that its scene lacks.
//
// To add a term: a member here, rows below with it, what terms_of() says of it, and its line in finish_consistent().
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "models/fluid/fluid_rates.hpp"

namespace barchan {

/// What ends a fluid: nothing, or a free surface. `loose`: spray and swollen water lose their
/// pressure; `stressed`: besides, the surface bears no viscous stress; `heavy`: besides, it bears weight.
enum class SurfaceTerms { none, loose, stressed, heavy };

struct FluidTerms {
  bool ends = false;  // a void or a free surface is near some particle, or solids move in the fluid
  SurfaceTerms surface = SurfaceTerms::none;
  bool pores = false;    // particles may be alone among grains
  bool calming = false;  // a density that is far off decays

  constexpr bool has_surface() const { return surface != SurfaceTerms::none; }
  constexpr bool stressed() const { return surface == SurfaceTerms::stressed || heavy(); }
  constexpr bool heavy() const { return surface == SurfaceTerms::heavy; }
  constexpr bool operator==(const FluidTerms&) const = default;
};

/// The combinations in use.
inline constexpr std::array fluid_rows{
    // a fluid that is whole: open, and one that fills its space
    FluidTerms{},
    FluidTerms{.calming = true},
    // with voids or solids that move in it, without a surface; among grains
    FluidTerms{.ends = true},
    FluidTerms{.ends = true, .calming = true},
    FluidTerms{.ends = true, .pores = true},
    FluidTerms{.ends = true, .pores = true, .calming = true},
    // with a free surface: without friction and weight; without weight or turbulent; heavy; among grains
    FluidTerms{.ends = true, .surface = SurfaceTerms::loose},
    FluidTerms{.ends = true, .surface = SurfaceTerms::stressed},
    FluidTerms{.ends = true, .surface = SurfaceTerms::heavy},
    FluidTerms{.ends = true, .surface = SurfaceTerms::loose, .pores = true},
    FluidTerms{.ends = true, .surface = SurfaceTerms::stressed, .pores = true},
    FluidTerms{.ends = true, .surface = SurfaceTerms::heavy, .pores = true},
};

/// The terms whose numbers are not zero; next to an interface with another fluid a fluid always ends.
inline FluidTerms terms_of(const FluidParameters& q, bool joined = false) {
  FluidTerms terms{.ends = q.ends || joined, .calming = q.calming > 0.0};
  if (!terms.ends) return terms;
  terms.pores = q.pores > 0.0;
  if (q.least_viscosity > 0.0 && q.stressed) terms.surface = SurfaceTerms::heavy;
  else if (q.stressed) terms.surface = SurfaceTerms::stressed;
  else if (q.loosening > 0.0) terms.surface = SurfaceTerms::loose;
  return terms;
}

/// The function `Finish::four<terms>` of the row with these terms. Throws std::logic_error where no row has them.
template <class Finish>
auto finish_of(const FluidTerms& terms) {
  static constexpr auto functions = []<std::size_t... row>(std::index_sequence<row...>) {
    return std::array{&Finish::template four<fluid_rows[row]>...};
  }
  (std::make_index_sequence<fluid_rows.size()>{});
  const auto found = std::find(fluid_rows.begin(), fluid_rows.end(), terms);
  if (found == fluid_rows.end()) throw std::logic_error("no row of models/fluid/fluid_terms.hpp has a fluid's terms");
  return functions[static_cast<std::size_t>(found - fluid_rows.begin())];
}

}  // namespace barchan
