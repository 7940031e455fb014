// Normal force of two spheres: a linear spring (Cundall and Strack 1979, eq. (9)).
//
//   F = K delta, delta: the overlap; an impact without damping lasts pi sqrt(m*/K)
//
// A step takes the mean of the force while the contact sets in (laws/contact_onset.hpp), and the spring and the dashpot
// for which the discrete oscillator has the decay and the frequency of the continuous one: with T^2 = K dt^2/m*,
// D = c/sqrt(m* K): K (1 - T^2 (1 + D^2)/12), c (1 - T^2 D^2/12), to order T^4. That takes the mean of the force for
// an acceleration -F/m*; under a force B of others it is (B - F)/m*, and the spring has T^2 (1 + D^2)/12 B more: at
// rest F = B = K delta. The same ramp rounds the end of the clipped force. Without a dashpot the force follows
// from x_n alone, so that the steps stay those of a mechanical system: where many touch at once, a force that knows
// velocities gains energy (1 % in 10^4 steps of a dense gas).
#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "laws/contact_onset.hpp"
#include "laws/touching_spheres.hpp"
#include "scene/contact_words.hpp"

namespace barchan {

struct LinearSpring {
  static double dashpot_share() { return 2.0; }       // D/zeta
  static constexpr double speed_power = 1.0;          // the speed of an impact goes with this power of its overlap
  static constexpr double stored_share = 0.5;         // of force times overlap
  static constexpr double steps_without_loss = 48.0;  // of a contact, for the energy of a dense gas within 1e-3

  double stiffness = 0.0;  // N/m, K

  /// What the keys of grains say; nothing where they leave it to largest-overlap.
  static std::optional<LinearSpring> of(const SphereMaterial& keys) {
    if (!keys.stiffness) return std::nullopt;
    return LinearSpring{*keys.stiffness};
  }
  /// The spring with which an impact has that overlap (m).
  static LinearSpring of_overlap(const SphereMaterial&, const SphereImpact& impact, double overlap) {
    return {impact.mass * impact.speed * impact.speed / (overlap * overlap)};
  }
  static LinearSpring between(std::span<const LinearSpring> grains) {
    std::vector<double> k;
    for (const auto& g : grains) k.push_back(g.stiffness);
    return {in_series(k)};
  }
  /// dF/d delta over the power of the overlap (N/m); reduced radius and overlap in m.
  double stiffness_at(double, double) const { return stiffness; }
  /// The overlap (m) and the duration (s) of a head-on impact without damping.
  double largest_overlap(const SphereImpact& impact) const { return impact.speed * std::sqrt(impact.mass / stiffness); }
  double duration(const SphereImpact& impact) const { return std::numbers::pi * std::sqrt(impact.mass / stiffness); }

  template <class V>
  struct Constants {
    V stiffness;
    explicit Constants(const LinearSpring& s) : stiffness(s.stiffness) {}
  };

  /// Spring and dashpot in a step.
  template <class V, class Dashpot>
  static BARCHAN_SIMD_INLINE NormalForce<V> force(const Constants<V>& c, const Dashpot& d, const NormalMotion<V>& m,
                                                  const ContactStep<V>& dt) {
    using namespace contact_onset;
    using simd::fma;
    using simd::fnma;
    const V x = m.overlap, damping2 = d.ratio * d.ratio, of_dashpot = damping2 * V(1.0 / 12.0),
            of_both = of_dashpot + V(1.0 / 12.0);
    const V turn2 = c.stiffness * (dt.whole * dt.whole) * m.inverse_mass, mean = turn2 * of_both;
    const V held = mean * simd::max(m.others, V(0.0)), k = fnma(c.stiffness, mean, c.stiffness);
    const V dashpot = d.coefficient(m.mass * c.stiffness) * fnma(turn2, of_dashpot, V(1.0));
    const V drag = dashpot * m.inverse_mass * dt.half;
    // Far from an onset every ramp is the overlap itself: what only an onset needs is found there.
    const V deep = simd::max(x, V(0.0)), before = way(m.approach, dt.whole);
    V first = deep;
    if (to_bits(x < before) != 0) first = ramp(x, before);
    const V centred = fnma(fma(k, first, held) * m.inverse_mass, dt.half, m.approach);
    const V a = way(centred, dt.whole);
    NormalForce<V> n;
    n.share = V(1.0);
    V sprung = deep, worked = deep, more = held;
    if (to_bits(x < a) != 0) {
      n.share = begin(x, a);
      sprung = ramp(x, a);
      worked = ramp_of_work(x, a);
      more = held * n.share;
    }
    n.elastic = fma(k, worked, more);
    n.depth = deep;
    n.stiffness = c.stiffness;
    n.dashpot = dashpot;
    if (!d.loses) {
      n.force = n.load = n.elastic = k * deep;
      n.stored = V(stored_share) * n.elastic * deep;
      return n;
    }
    // One quotient: of contacts that close the force, of those that part its depth, k the stiffness.
    const auto closes = m.approach > V(0.0);
    const V pushed = d.beside(fma(k, select(closes, sprung, x), more), dashpot * select(closes, n.share, V(1.0)),
                              m.approach, select(closes, fma(drag, n.share, V(1.0)), fma(drag, k, k)));
    V parting = simd::max(pushed, V(0.0));
    if (to_bits(pushed < a) != 0) parting = ramp(pushed, a);
    n.force = n.load = select(closes, pushed, k * parting);
    n.stored = V(stored_share) * n.elastic * deep;
    return n;
  }
};

}  // namespace barchan
