// Laws against values that are found by hand, or from another formula than the law's own: a factor or a sign that is
// wrong in a law shows here, on two particles.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/pressure_law.hpp"
#include "laws/body_contact.hpp"
#include "laws/extension.hpp"
#include "laws/kept_drag.hpp"
#include "laws/sphere_catalogue.hpp"
#include "laws/surface_contact.hpp"
#include "laws/turning_friction.hpp"

namespace barchan {
namespace {

using V = simd::Vec<double, 4>;
using Linear = std::variant_alternative_t<0, AnySphereContact>;  // of the catalogue
using Hertz = std::variant_alternative_t<1, AnySphereContact>;

/// 500 N/m with a restitution.
Linear linear(double e, double friction = 0.0, double rolling = 0.0) {
  return {{500.0}, NormalDashpot::of_restitution<LinearSpring>(e), {{}, friction}, {rolling}};
}
/// Of equal spheres without losses, E = 1e8 Pa, nu = 0.3.
Hertz hertzian() {
  return {HertzSpring::of_material(1e8, 0.3),
          NormalDashpot::of_restitution<HertzSpring>(1.0),
          {MindlinSlipStiffness::of_poisson(0.3), 0.0},
          {0.0}};
}

constexpr double sphere_mass = 1e-5, sphere_radius = 1e-3;  // kg, m, of each of two spheres

/// Two equal spheres that overlap by so much (m) and rest but for what the caller gives them.
template <std::size_t Dim>
TouchingSpheres<V, Dim> spheres(double overlap) {
  TouchingSpheres<V, Dim> s;
  for (std::size_t d = 0; d < Dim; ++d) {
    s.normal[d] = V(d == 0 ? 1.0 : 0.0);
    s.velocity[d] = V(0.0);
  }
  for (std::size_t d = 0; d < s.spin; ++d) s.spin_a[d] = s.spin_b[d] = V(0.0);
  s.overlap = V(overlap);
  s.lever_a = s.lever_b = V(sphere_radius - 0.5 * overlap);
  s.reduced_mass = V(0.5 * sphere_mass);
  s.inverse_mass = V(2.0 / sphere_mass);
  s.reduced_radius = V(0.5 * sphere_radius);
  return s;
}

/// N and J: the force along the normal and what is stored, of spheres without losses.
template <class Law>
std::array<double, 2> push_and_store(const Law& law, double overlap) {
  std::array<V, Law::template numbers<2>> memory;
  memory.fill(V(0.0));
  const auto f = Law::touch(typename Law::template Constants<V>(law, 1e-9), spheres<2>(overlap), memory);
  return {f.force[0][0], f.stored[0]};
}

template <class Law>
void expect_force_is_slope_of_store(const Law& law) {
  for (const double overlap : {1e-5, 4e-5}) {
    const double step = 1e-4 * overlap;
    const double slope =
        (push_and_store(law, overlap + step)[1] - push_and_store(law, overlap - step)[1]) / (2.0 * step);
    EXPECT_NEAR(push_and_store(law, overlap)[0], slope, 1e-6 * slope);
  }
}

TEST(LawsByHand, SpheresStoreTheWorkOfTheirForce) {
  expect_force_is_slope_of_store(linear(1.0).smooth());
  expect_force_is_slope_of_store(hertzian().smooth());
}

// Mindlin 1949: k_t = 8 G* a of k_n = 2 E* a, a the radius of the contact, G* = G/(2 (2 - nu)) and
// E* = E/(2 (1 - nu^2)) of equal spheres. The normal force over the overlap is 2/3 of k_n.
TEST(LawsByHand, TangentialStiffnessOfHertzIsMindlins) {
  for (const double nu : {0.0, 0.2, 0.45}) {
    const double young = 1e9, shear = young / (2.0 * (1.0 + nu));
    const double g = shear / (2.0 * (2.0 - nu)), e = young / (2.0 * (1.0 - nu * nu));
    EXPECT_NEAR(MindlinSlipStiffness::of_poisson(nu).ratio, 8.0 * g / (2.0 / 3.0 * 2.0 * e), 1e-12) << nu;
  }
}

// A step so short that the slip is nothing: what is left of the tangential force is the dashpot, half of that along the
// normal, zeta sqrt(m* k) v.
TEST(LawsByHand, TangentialDashpotIsHalfOfTheNormalOne) {
  const auto law = linear(0.5, 1e6).without_rolling();
  const double overlap = 1e-5, speed = 0.1, dt = 1e-9;
  auto s = spheres<2>(overlap);
  s.velocity[1] = V(speed);
  using Law = Linear::WithoutRolling;
  std::array<V, Law::numbers<2>> memory;
  memory.fill(V(0.0));
  const auto f = Law::touch(Law::Constants<V>(law, dt), s, memory);
  const double expected = -NormalDashpot::damping_ratio(0.5) * std::sqrt(0.5 * sphere_mass * 500.0) * speed;
  EXPECT_NEAR(f.force[1][0], expected, 1e-3 * std::abs(expected));
}

// The velocity of the time of the place is that half a step before and half of what the force itself gives to the
// velocity of the contact, F (1/m* + R^2 (1/I + 1/I)) dt/2. Of solid spheres that is 7/2 F/m* dt/2; of rolling, with
// the lever R* = R/2, R*^2 (1/I + 1/I) = 5/8 1/m*.
template <bool Rolls>
void expect_force_knows_its_own_work() {
  const Linear law = linear(0.3, 1e6, 1e6);
  const double overlap = 1e-5, dt = 4e-5, inertia = 0.4 * sphere_mass * sphere_radius * sphere_radius;
  auto s = spheres<2>(overlap);
  s.lever_a = s.lever_b = V(sphere_radius);
  if (Rolls) {
    s.spin_a[0] = V(100.0);
    s.spin_b[0] = V(-100.0);
  } else {
    s.velocity[1] = V(0.1);
  }
  const double speed = Rolls ? 0.5 * sphere_radius * 200.0 : 0.1;
  std::array<V, Linear::numbers<2>> memory;
  memory.fill(V(0.0));
  const auto f = Linear::touch(Linear::Constants<V>(law, dt), s, memory);
  const double force = Rolls ? f.torque_a[0][0] / (0.5 * sphere_radius) : f.force[1][0];
  const double gain = Rolls ? 0.25 * sphere_radius * sphere_radius * 2.0 / inertia
                            : 2.0 / sphere_mass + sphere_radius * sphere_radius * 2.0 / inertia;
  // The dashpot as the exact step has it (head of laws/sphere_contact.hpp).
  const double turn2 = 500.0 * dt * dt * 2.0 / sphere_mass, d = 2.0 * NormalDashpot::damping_ratio(0.3);
  const double dashpot = 0.5 * d * std::sqrt(0.5 * sphere_mass * 500.0) * (1.0 - turn2 * d * d / 12.0);
  const double slip = speed * dt, stiffness = 2.0 / 7.0 * 500.0;
  EXPECT_NEAR(force, -stiffness * slip - dashpot * (speed + 0.5 * dt * gain * force), 1e-9 * std::abs(force));
}

TEST(LawsByHand, FrictionAndRollingKnowTheirOwnWork) {
  expect_force_knows_its_own_work<false>();
  expect_force_knows_its_own_work<true>();
}

/// What two particles of bodies keep of their speed, of eight phases of the first touch, with steps of w dt = 0.1.
template <class Push>
void expect_restitution(double e, double tolerance, const Push& push) {
  const double reduced = 1.0, stiffness = 1.0, dt = 0.1 * std::sqrt(reduced / stiffness);
  for (int phase = 0; phase < 8; ++phase) {
    double gap = 0.05 * dt + dt * phase / 8.0, speed = -0.01;
    gap *= 0.01;
    for (int k = 0; k < 200; ++k) {
      speed += dt / reduced * push(-gap, speed, dt);
      gap += dt * speed;
    }
    EXPECT_NEAR(speed / 0.01, e, tolerance) << "phase " << phase;
  }
}

TEST(LawsByHand, ParticlesOfBodiesKeepTheWrittenShareOfTheirSpeed) {
  using One = simd::Vec<double, 1>;
  for (const double e : {0.3, 0.6, 0.9, 1.0}) {
    const BodyContactLaw law = BodyContactLaw::of(1.0, 1.0, 1.0, e, 0.0);
    expect_restitution(e, 4e-3, [&](double overlap, double speed, double dt) {
      std::array<One, 2> force{One(0.0), One(0.0)};
      const double apart = 1.0 - overlap;
      BodyContactLaw::add<false>(BodyContactLaw::Constants<One>(law, dt), std::array{One(apart), One(0.0)},
                                 One(apart * apart), std::array{One(speed), One(0.0)}, force);
      return force[0].v;
    });
  }
}

TEST(LawsByHand, SurfacesKeepTheWrittenShareOfTheirSpeed) {
  for (const double e : {0.3, 0.6, 0.9, 1.0}) {
    const SurfaceContactLaw law{1.0, e, 0.0};
    expect_restitution(e, 4e-3, [&](double overlap, double speed, double dt) {
      return overlap > 0.0 ? law.push(overlap, speed, 1.0, dt) : 0.0;
    });
  }
}

// One pair: twist = mu V F r x v, moment = mu V F r r.
TEST(LawsByHand, FrictionOnTurningBodiesTwists) {
  const TurningFriction law{{}, 2.0};
  TurningFriction::Own<3, double> b{}, a{};
  b.v = {1.0, -2.0, 0.5};
  a.v = {0.25, 1.0, -1.0};
  a.volume = 3.0;
  Pair<3, double> ba{{0.3, -0.2, 0.7}, 0.62, 0.0, -0.5};
  TurningFriction::Sums<3, double> sums{};
  law.add(b, a, ba, sums);
  const double f = 2.0 * 3.0 * -0.5;
  const Vec3 twist = cross(Vec3{0.3, -0.2, 0.7}, Vec3{0.75, -3.0, 1.5});
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(sums.twist[d], f * twist[d], 1e-14) << d;
  EXPECT_NEAR(sums.moment[1], f * 0.3 * -0.2, 1e-14);

  TurningFriction::Own<2, double> d{}, c{};
  d.v = {1.0, -2.0};
  c.volume = 3.0;
  Pair<2, double> dc{{0.3, -0.2}, 0.13, 0.0, -0.5};
  TurningFriction::Sums<2, double> flat{};
  law.add(d, c, dc, flat);
  EXPECT_NEAR(flat.twist[0], f * (0.3 * -2.0 - -0.2 * 1.0), 1e-14);
}

// On a bowl y = (x^2/R + z^2/S)/2 that is turned by an angle about y, what follows the surface at a speed u along one
// of its own axes is accelerated by u^2/R and u^2/S, along the middle of both by u^2 (1/R + 1/S)/2.
TEST(LawsByHand, CurvedWallsTurnTheFlowAlongAnyDirection) {
  const double r = 0.5, s = -0.25;  // 1/m, of the two axes
  for (const double angle : {0.0, 0.4, 1.1}) {
    const double c = std::cos(angle), w = std::sin(angle);
    const double bend[3] = {r * c * c + s * w * w, (r - s) * c * w, r * w * w + s * c * c};
    for (const double way : {0.0, 0.5, 1.0, 2.5}) {
      const Vec3 u{3.0 * std::cos(angle + way), 0.7, 3.0 * std::sin(angle + way)};
      const double expected = 9.0 * (r * std::cos(way) * std::cos(way) + s * std::sin(way) * std::sin(way));
      EXPECT_NEAR(turn<3>(bend, u), expected, 1e-13) << angle << ' ' << way;
    }
  }
}

// A wall particle of an unknown depth mirrors the fluid about the wall's velocity: the mean of both is that of the
// wall.
TEST(LawsByHand, AWallThatMovesMirrorsTheFluid) {
  ExtendedState<2> state{};
  state.weight = 1.0;
  state.mean = {0.5, -1.0};
  state.wall = {2.0, 3.0};
  const auto v = state.no_slip();
  for (std::size_t d = 0; d < 2; ++d) EXPECT_NEAR(0.5 * (v[d] + state.mean[d]), state.wall[d], 1e-15);
}

// dv/dt = -k v^2 has v = v_0/(1 + k v_0 t): taken in the middle of its time, a kept drag is off by the third power of
// the time; taken at either end by the second.
TEST(LawsByHand, KeptDragIsOfTheMiddleOfItsTime) {
  const double start = 2.0, k = 1.5;
  const auto error = [&](double time) {
    const auto kept = kept_drag<2>(
        {0.0, 0.0}, {start, 0.0}, {0.0, 0.0}, k, 1.0, [](double re) { return re; }, time);
    return std::abs(start + time * kept.drag[0] - start / (1.0 + k * start * time));
  };
  for (const double time : {0.02, 0.01}) EXPECT_GT(error(time) / error(0.5 * time), 6.0);
  EXPECT_LT(error(0.01), 1e-4);
}

// The stiffness of the equation of state at rest is the square of the speed of sound, whatever Tait's exponent.
TEST(LawsByHand, SoundHasTheWrittenSpeed) {
  for (const double exponent : {1.0, 4.0, 7.0}) {
    const PressureLaw law{1000.0, 30.0, exponent, 5.0};
    EXPECT_NEAR((law(1000.001) - law(999.999)) / 0.002, 900.0, 1e-3) << exponent;
    EXPECT_NEAR(law(1000.0), 5.0, 1e-9);
  }
}

}  // namespace
}  // namespace barchan
