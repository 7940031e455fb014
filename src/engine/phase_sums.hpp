// Sums over all particles of a phase, wherever they are: a model does not ask which process holds them. Their bits do
// not depend on the order of the particles (engine/reproducible_sum.hpp). All ranks ask at the same place.
#pragma once

#include <cstddef>
#include <utility>

#include "engine/exchange.hpp"

namespace barchan {

/// How many particles it has.
inline std::size_t count_of(const PhaseParticles& p) { return Exchange(p).total(p.size()); }

/// Of f(k) for k < count, particles or parts of the phase that this process holds.
template <class F>
double sum_of(const PhaseParticles& p, std::size_t count, F&& f) {
  return Exchange(p).sum(count, std::forward<F>(f));
}

/// Of f(k) for all its particles k.
template <class F>
double sum_of(const PhaseParticles& p, F&& f) {
  return sum_of(p, p.size(), std::forward<F>(f));
}

}  // namespace barchan
