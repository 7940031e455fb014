// One contact of two spheres in steps of a twelfth of its duration, for all phases of the first touch: what the law
// asks for must come out of the steps.
#include "laws/sphere_contact.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace barchan {
namespace {

constexpr int phases = 8;
using V = simd::Vec<double, phases>;
using Constants = sphere_contact::Constants<V>;

/// What the spheres do after the contact, of each phase.
struct After {
  double speed[phases], across[phases], spin[phases], lost[phases], deepest[phases];
};

/// Two spheres of the masses (kg) and radii 1 mm meet with `speed` (m/s) along x and slip with `slip` along y.
template <bool Hertz>
After meet(const SphereContact& law, double mass_a, double mass_b, double speed, double slip, double dt) {
  const double radius = 1e-3, reduced = mass_a * mass_b / (mass_a + mass_b);
  const Constants constants(law, dt);
  V x = V(2.0 * radius + 2.0 * speed * dt) + V(speed * dt / phases) * V::iota(), y(0.0);
  V u(-speed), v(slip), spin_a(0.0), spin_b(0.0), lost(0.0), deepest(0.0);
  std::array<V, 1> memory{V(0.0)};
  for (int k = 0; k < 60; ++k) {
    TouchingSpheres<V, 2> s;
    s.normal = {V(1.0), V(0.0)};
    s.velocity = {u, v};
    s.spin_a[0] = spin_a;
    s.spin_b[0] = spin_b;
    s.overlap = V(2.0 * radius) - x;
    s.lever_a = s.lever_b = V(radius);
    s.reduced_mass = V(reduced);
    s.inverse_mass = V(1.0 / reduced);
    s.reduced_radius = V(0.5 * radius);
    const auto near = s.overlap > V(-dt) * simd::max(u, -u);
    auto f = touch<Hertz, true, false>(constants, s, memory);
    memory[0] = mask_zero(near, memory[0]);
    u += V(dt / reduced) * mask_zero(near, f.force[0]);
    v += V(dt / reduced) * mask_zero(near, f.force[1]);
    spin_a += V(2.5 * dt / (mass_a * radius * radius)) * mask_zero(near, f.torque_a[0]);
    spin_b += V(2.5 * dt / (mass_b * radius * radius)) * mask_zero(near, f.torque_b[0]);
    lost += mask_zero(near, f.lost);
    deepest = simd::max(deepest, s.overlap);
    x += V(dt) * u;
  }
  After after;
  u.store(after.speed);
  v.store(after.across);
  spin_a.store(after.spin);
  lost.store(after.lost);
  deepest.store(after.deepest);
  return after;
}

After meet(const SphereContact& law, double mass_a, double mass_b, double speed, double slip, double steps) {
  const double reduced = mass_a * mass_b / (mass_a + mass_b), dt = law.duration(reduced, 5e-4, speed) / steps;
  return law.hertz ? meet<true>(law, mass_a, mass_b, speed, slip, dt)
                   : meet<false>(law, mass_a, mass_b, speed, slip, dt);
}

SphereContact law_of(bool hertz, double e) {
  return hertz ? SphereContact::hertzian(1e8, 0.3, e) : SphereContact::linear(500.0, e);
}

TEST(SphereContactSteps, KeepTheWrittenRestitution) {
  for (const bool hertz : {false, true})
    for (const double e : {0.3, 0.5, 0.7, 0.9, 1.0})
      for (const auto& [a, b] : {std::pair{1e-5, 1e-5}, {1e-5, 3e-5}, {1e-5, 1e300}})
        for (const double speed : {1.0, 0.1}) {
          SphereContact law = law_of(hertz, e);
          // Of Hertz a slow contact lasts longer; of the linear law as long.
          const After after = meet(law, a, b, speed, 0.0, 12.0);
          const auto [least, most] = std::minmax_element(after.speed, after.speed + phases);
          EXPECT_NEAR(*least / speed, e, 5e-3 * e) << hertz << ' ' << e << ' ' << b;
          EXPECT_NEAR(*most / speed, e, 5e-3 * e) << hertz << ' ' << e << ' ' << b;
          const double reduced = a * b / (a + b), energy = 0.5 * reduced * speed * speed;
          for (const double lost : after.lost) EXPECT_NEAR(lost / energy, 1.0 - e * e, 1.1e-2) << hertz << " " << e;
        }
}

TEST(SphereContactSteps, KeepTheEnergyOfElasticSpheres) {
  for (const bool hertz : {false, true}) {
    const After after = meet(law_of(hertz, 1.0), 1e-5, 1e-5, 1.0, 0.0, 24.0);
    double mean = 0.0;
    for (const double u : after.speed) {
      EXPECT_NEAR(u * u, 1.0, 1e-3) << hertz;
      mean += (u * u - 1.0) / phases;
    }
    EXPECT_NEAR(mean, 0.0, 3e-6) << hertz << ": no phase of the touch is likelier: gains and losses cancel";
  }
}

TEST(SphereContactSteps, ReachTheOverlapOfTheTheory) {
  for (const bool hertz : {false, true}) {
    const SphereContact law = law_of(hertz, 1.0);
    const After after = meet(law, 1e-5, 1e-5, 1.0, 0.0, 48.0);  // 48: some step is near the turning point
    EXPECT_NEAR(*std::max_element(after.deepest, after.deepest + phases), law.largest_overlap(5e-6, 5e-4, 1.0),
                5e-3 * law.largest_overlap(5e-6, 5e-4, 1.0));
  }
}

// Where a contact slides throughout, Coulomb's law gives dv_t = mu (1 + e) v_n, and a spin of 5/2 that by the radius
// and by the share of the mass (Walton 1993).
TEST(SphereContactSteps, SlideAsCoulombsLaw) {
  for (const bool hertz : {false, true})
    for (const double e : {0.3, 0.7, 0.9})
      for (const double speed : {1.0, 0.3}) {
        SphereContact law = law_of(hertz, e);
        law.friction = 0.3;
        const After after = meet(law, 1e-5, 1e-5, speed, 5.0 * speed, 12.0);
        const double push = 0.3 * (1.0 + e) * speed;
        for (int k = 0; k < phases; ++k) {
          EXPECT_NEAR(5.0 * speed - after.across[k], push, 5e-3 * push) << hertz << ' ' << e;
          EXPECT_NEAR(std::abs(after.spin[k]) * 1e-3, 1.25 * push, 5e-3 * 1.25 * push);
          EXPECT_NEAR(after.speed[k], e * speed, 5e-3 * e * speed);
        }
      }
}

}  // namespace
}  // namespace barchan
