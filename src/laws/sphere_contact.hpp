// Contact of two spheres, composed of four parts: a normal spring, its damping, friction, rolling resistance.
//
//   F = F_n n + F_t; torques on both by the levers, and those of the rolling resistance
//
// A part is a type with its constants (numbers), its `between` (the constants that one or two phases of grains give),
// its `Constants<V>` (the same in all lanes) and one pure function of the pair:
//
//   normal     laws/linear_spring.hpp, laws/hertz_spring.hpp
//   damping    laws/normal_dashpot.hpp, or NoDashpot
//   friction   laws/coulomb_friction.hpp with laws/slip_stiffness.hpp, or NoFriction
//   rolling    laws/rolling_resistance.hpp, or NoRolling
//
// A part that remembers something of a contact says how many numbers (`remembers<Dim>`) and gets them, zero where a
// touch begins, to read and to write. A normal spring gets them behind its other arguments. Besides, each direction in
// which a velocity counts remembers what other forces do there (laws/other_forces.hpp).
//
// The laws that a scene can choose are the rows of laws/sphere_catalogue.hpp.
//
// Found for 12 steps a contact, all phases of the first touch (tests/unit/laws_sphere_contact.cpp): e = 0.3 within 0.3
// %, 0.5 to 0.9 within 0.2 %; forces taken at the end of a step missed them by 14 and 2 to 8 %.
#pragma once

#include "laws/coulomb_friction.hpp"
#include "laws/normal_dashpot.hpp"
#include "laws/other_forces.hpp"
#include "laws/rolling_resistance.hpp"
#include "laws/touching_spheres.hpp"

namespace barchan {

/// How many numbers a part remembers of a contact.
template <class Part, std::size_t Dim>
constexpr std::size_t remembered_by() {
  if constexpr (requires { Part::template remembers<Dim>; }) return Part::template remembers<Dim>;
  else return 0;
}

template <class NormalPart, class DampingPart, class FrictionPart = NoFriction, class RollingPart = NoRolling>
struct SphereContact {
  using Normal = NormalPart;
  using Damping = DampingPart;
  using Friction = FrictionPart;
  using Rolling = RollingPart;
  /// The same without rolling resistance, without friction too, and without loss.
  using WithoutRolling = SphereContact<Normal, Damping, Friction>;
  using Smooth = SphereContact<Normal, Damping>;
  using Lossless = SphereContact<Normal, NoDashpot>;
  static constexpr bool damps = Damping::damps, rubs = Friction::rubs, rolls = Rolling::rolls;
  static_assert(rubs || !rolls, "the springs of the rolling resistance are as stiff as those of the friction");
  static_assert(remembered_by<Damping, 2>() == 0, "nobody asks a damping part what it remembers");
  /// Of the numbers that a contact remembers the first are lengths of springs across the normal (m), which hold
  /// left_behind() when it ends.
  template <std::size_t Dim>
  static constexpr std::size_t springs = remembered_by<Friction, Dim>() + remembered_by<Rolling, Dim>();
  /// Behind them are those of the normal spring, and then what other forces do along the normal, across it, and to the
  /// rolling (m/s2).
  template <std::size_t Dim>
  static constexpr std::size_t observed = springs<Dim> + remembered_by<Normal, Dim>();
  template <std::size_t Dim>
  static constexpr std::size_t numbers = observed<Dim> + (damps ? 1 : 0) + springs<Dim>;

  Normal normal;
  Damping damping;
  [[no_unique_address]] Friction friction;
  [[no_unique_address]] Rolling rolling;

  /// Of the springs of one or two phases of grains and what the phases say of their contacts.
  static SphereContact between(std::span<const Normal> springs, std::span<const SphereMaterial* const> grains) {
    return {Normal::between(springs), Damping::template between<Normal>(grains), Friction::between(grains),
            Rolling::between(grains)};
  }
  WithoutRolling without_rolling() const { return {normal, damping, friction, {}}; }
  Smooth smooth() const { return {normal, damping, {}, {}}; }
  Lossless lossless() const { return {normal, {}, {}, {}}; }

  /// k_t (N/m) at an overlap (m) of spheres of a reduced radius (m).
  double slip_stiffness(double radius, double overlap) const {
    return friction.stiffness_ratio() * normal.stiffness_at(radius, overlap);
  }
  /// Energy over slip^2 (N/m) that is left in the springs across the normal where a contact ends.
  double left_behind() const { return 0.5 * friction.stiffness_ratio() * normal.stiffness_at(0.0, 0.0); }

  /// The constants in all lanes, and the step.
  template <class V>
  struct Constants {
    typename Normal::template Constants<V> normal;
    typename Damping::template Constants<V> damping;
    [[no_unique_address]] typename Friction::template Constants<V> friction;
    [[no_unique_address]] typename Rolling::template Constants<V> rolling;
    ContactStep<V> dt;
    Constants(const SphereContact& c, const StepOfContacts& step)
        : normal(c.normal), damping(c.damping), friction(c.friction), rolling(c.rolling), dt(step) {}
    Constants(const SphereContact& c, double step) : Constants(c, StepOfContacts{step}) {}
  };

  /// The forces of a contact in a step. `memory`: what the contact remembers, which is advanced.
  template <class V, std::size_t Dim>
  static BARCHAN_SIMD_INLINE ContactForces<V, Dim> touch(const Constants<V>& c, const TouchingSpheres<V, Dim>& s,
                                                         std::array<V, numbers<Dim>>& memory) {
    constexpr std::size_t spin = TouchingSpheres<V, Dim>::spin;
    ContactForces<V, Dim> out;
    V v_n(0.0);
    for (std::size_t d = 0; d < Dim; ++d) v_n = simd::fma(s.velocity[d], s.normal[d], v_n);
    V added(0.0);
    if constexpr (damps) added = other_forces::in_step(memory[observed<Dim>], -v_n, c.dt);
    const V approach = simd::fma(V(0.5), added, -v_n);
    const NormalMotion<V> motion{s.overlap,      approach,         s.reduced_mass,
                                 s.inverse_mass, s.reduced_radius, s.reduced_mass * added * c.dt.rate};
    NormalForce<V> normal;
    if constexpr (remembered_by<Normal, Dim>() > 0)
      normal = Normal::force(c.normal, c.damping, motion, c.dt, memory.data() + springs<Dim>);
    else normal = Normal::force(c.normal, c.damping, motion, c.dt);
    if constexpr (damps)
      memory[observed<Dim>] = other_forces::remember(added, -v_n, -normal.force * s.inverse_mass, c.dt);
    out.lost =
        (normal.elastic - normal.force) * simd::fma(normal.force * s.inverse_mass, c.dt.half, -approach) * c.dt.whole;
    out.stored = normal.stored;
    for (std::size_t d = 0; d < Dim; ++d) out.force[d] = normal.force * s.normal[d];
    for (std::size_t d = 0; d < spin; ++d) out.torque_a[d] = out.torque_b[d] = V(0.0);
    if constexpr (rubs) {
      V* const others = memory.data() + observed<Dim> + (damps ? 1 : 0);
      const SlipStiffness<V> k = Friction::stiffness_of(c.friction, normal, v_n, c.dt);
      Friction::add(c.friction, s, normal, k, v_n, c.dt, memory.data(), others, out);
      if constexpr (rolls)
        Rolling::add(c.rolling, s, normal, k, c.dt, memory.data() + remembered_by<Friction, Dim>(),
                     others + remembered_by<Friction, Dim>(), out);
    }
    return out;
  }
};

}  // namespace barchan
