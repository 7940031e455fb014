// Normal force of two spheres: Hertz (1882; Johnson 1985, eq. (4.23)).
//
//   F = 4/3 E* sqrt(R* delta) delta, delta: the overlap; of two spheres of one material E* = E/(2 (1 - nu^2))
//   an impact without damping: delta = (15 m* v^2/(16 E* sqrt R*))^(2/5), t = 2.943275 delta/v
//
// A step takes the mean of delta^(3/2) while the contact sets in, as laws/contact_onset.hpp does of delta, and far from
// the onset what the same weights make of it, delta^(3/2) + a^2/(16 sqrt(delta)); spring and dashpot are those for
// which the discrete oscillator has the decay and the frequency of the continuous one (laws/linear_spring.hpp), with
// the tangent stiffness 3/2 F/delta and a force of others as there. Without a dashpot the force follows from
// x_n.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "laws/contact_onset.hpp"
#include "laws/touching_spheres.hpp"
#include "scene/contact_words.hpp"

namespace barchan {

namespace contact_onset {

/// Of x^(3/2) and x^(1/4), for a = 1: ((x + 1)^q - 2 x^q + (x - 1)^q)/(q (q - 1)), q = 7/2 and 9/4, bases at least 0.
template <class V>
struct HertzOnset {
  V force, root;
  explicit BARCHAN_SIMD_INLINE HertzOnset(V x) {
    const V weights[3] = {V(1.0), V(-2.0), V(1.0)}, at[3] = {x + V(1.0), x, x - V(1.0)};
    force = root = V(0.0);
    for (int k = 0; k < 3; ++k) {
      const V y = simd::max(at[k], V(0.0)), r = simd::sqrt(y), y2 = y * y;
      force = simd::fma(weights[k], y2 * (y * r), force);
      root = simd::fma(weights[k], y2 * simd::sqrt(r), root);
    }
    force = force * V(1.0 / 8.75);
    root = root * V(1.0 / 2.8125);
  }
};

}  // namespace contact_onset

struct HertzSpring {
  static double dashpot_share() { return std::sqrt(5.0); }  // D/zeta
  static constexpr double speed_power = 1.25;         // the speed of an impact goes with this power of its overlap
  static constexpr double stored_share = 0.4;         // of force times overlap
  static constexpr double steps_without_loss = 24.0;  // of a contact, for the energy of a dense gas within 1e-3

  double modulus = 0.0;  // Pa, 4/3 E*

  static HertzSpring of_material(double young, double poisson) {
    return {4.0 / 3.0 * (0.5 * young / (1.0 - poisson * poisson))};
  }
  /// What the keys of grains say; nothing where they leave it to largest-overlap.
  static std::optional<HertzSpring> of(const SphereMaterial& keys) {
    if (!(keys.young > 0.0)) return std::nullopt;
    return of_material(keys.young, keys.poisson);
  }
  /// The spring with which an impact has that overlap (m).
  static HertzSpring of_overlap(const SphereMaterial&, const SphereImpact& impact, double overlap) {
    return {1.25 * impact.mass * impact.speed * impact.speed / (std::sqrt(impact.radius) * std::pow(overlap, 2.5))};
  }
  static HertzSpring between(std::span<const HertzSpring> grains) {
    std::vector<double> k;
    for (const auto& g : grains) k.push_back(g.modulus);
    return {in_series(k)};
  }
  /// F/delta (N/m); reduced radius and overlap in m.
  double stiffness_at(double radius, double overlap) const { return modulus * std::sqrt(radius * overlap); }
  /// The overlap (m) and the duration (s) of a head-on impact without damping.
  double largest_overlap(const SphereImpact& impact) const {
    return std::pow(1.25 * impact.mass * impact.speed * impact.speed / (modulus * std::sqrt(impact.radius)), 0.4);
  }
  double duration(const SphereImpact& impact) const { return 2.943275 * largest_overlap(impact) / impact.speed; }

  template <class V>
  struct Constants {
    V modulus;
    explicit Constants(const HertzSpring& s) : modulus(s.modulus) {}
  };

  /// Spring and dashpot in a step. Each root and quotient stands here once; what only an onset needs is found there.
  template <class V, class Dashpot>
  static BARCHAN_SIMD_INLINE NormalForce<V> force(const Constants<V>& c, const Dashpot& d, const NormalMotion<V>& m,
                                                  const ContactStep<V>& dt) {
    using namespace contact_onset;
    using simd::fma;
    using simd::fnma;
    const V x = m.overlap, radius = m.radius, inverse_mass = m.inverse_mass, approach = m.approach;
    const V least(1e-30), overlap = simd::max(x, least), near(4.0);
    NormalForce<V> n;
    const V here = c.modulus * simd::sqrt(radius * overlap), inverse = V(1.0) / overlap;
    const V turn2 = V(1.5) * here * (dt.whole * dt.whole) * inverse_mass, mean = turn2 * V(1.0 / 12.0),
            slower = fnma(turn2, V(1.0 / 12.0), V(1.0));
    const V before = way(approach, dt.whole);
    const auto begins = x < near * before;
    n.depth = overlap;
    n.inverse_depth = inverse;
    n.stiffness = here;
    n.elastic = here * overlap * slower;
    n.dashpot = d.coefficient(m.mass * here);
    n.share = V(1.0);
    // Far from the onset x^(3/2) + a^2/(16 sqrt(x)), which is what the weights make of it.
    const V small = V(1.0 / 16.0) * (inverse * inverse);
    const auto far_of = [&](V a) { return here * overlap * fma(a * a, small, slower); };
    const auto near_of = [&](V a, V onset) { return c.modulus * (a * simd::sqrt(radius * a)) * slower * onset; };
    V first = far_of(before), more = mean * simd::max(m.others, V(0.0));
    if (to_bits(begins) != 0) {
      const V ratio = x / before;
      const HertzOnset<V> early(simd::min(ratio, near));
      first = select(begins, near_of(before, early.force), first);
      n.dashpot =
          select(begins, d.coefficient(m.mass * c.modulus * simd::sqrt(radius * before)) * early.root, n.dashpot);
      n.share = begin(x, before);
      more = more * n.share;
      n.depth = simd::max(overlap, V(0.25) * before);
      n.inverse_depth = V(1.0) / n.depth;
      n.stiffness = c.modulus * simd::sqrt(radius * n.depth);
    }
    const V a = way(fnma((first + more) * inverse_mass, dt.half, approach), dt.whole);
    const auto begins_still = x < near * a;
    V elastic = far_of(a);
    if (to_bits(begins_still) != 0)
      elastic = select(begins_still, near_of(a, HertzOnset<V>(simd::min(x / a, near)).force), elastic);
    elastic = elastic + more;
    const V drag = n.dashpot * inverse_mass;
    n.dashpot = n.dashpot * fnma(drag * drag, dt.whole * dt.whole * V(1.0 / 12.0), V(1.0));
    const V push = d.beside(elastic, n.dashpot, approach, fma(n.dashpot * inverse_mass, dt.half, V(1.0)));
    const V ending = select(x > V(0.0), ramp(push, V(1.5) * here * before), V(0.0));
    n.force = n.elastic;
    if (d.loses) {
      n.force = select(approach > V(0.0), push, ending);
      n.elastic = n.elastic + more;
    }
    n.load = n.force;
    n.stored = V(stored_share) * n.elastic * simd::max(x, V(0.0));
    return n;
  }
};

}  // namespace barchan
