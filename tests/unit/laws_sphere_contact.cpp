// One contact of two spheres in steps of a twelfth of its duration, for all phases of the first touch: what the law
// asks for must come out of the steps.
#include "laws/sphere_catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace barchan {
namespace {

constexpr int phases = 8;
using V = simd::Vec<double, phases>;
template <std::size_t row>
using Law = std::variant_alternative_t<row, AnySphereContact>;  // of the catalogue
using Linear = Law<0>;
using Hertz = Law<1>;

Linear linear(double e, double friction = 0.0, double rolling = 0.0) {
  return {{500.0}, NormalDashpot::of_restitution<LinearSpring>(e), {{}, friction}, {rolling}};
}
Hertz hertzian(double e, double friction = 0.0, double rolling = 0.0) {
  return {HertzSpring::of_material(1e8, 0.3),
          NormalDashpot::of_restitution<HertzSpring>(e),
          {MindlinSlipStiffness::of_poisson(0.3), friction},
          {rolling}};
}
/// Calls f with both laws, without rolling resistance.
template <class F>
void both(double e, double friction, F&& f) {
  f(linear(e, friction).without_rolling());
  f(hertzian(e, friction).without_rolling());
}

/// What the spheres do after the contact, of each phase.
struct After {
  double speed[phases], across[phases], spin[phases], lost[phases], deepest[phases];
};

/// Two spheres of the masses (kg) and radii 1 mm meet with `speed` (m/s) along x and slip with `slip` along y.
template <class L>
After meet(const L& law, double mass_a, double mass_b, double speed, double slip, double steps) {
  const double radius = 1e-3, reduced = mass_a * mass_b / (mass_a + mass_b);
  const double dt = law.normal.duration({reduced, 0.5 * radius, speed}) / steps;
  const typename L::template Constants<V> constants(law, dt);
  V x = V(2.0 * radius + 2.0 * speed * dt) + V(speed * dt / phases) * V::iota(), y(0.0);
  V u(-speed), v(slip), spin_a(0.0), spin_b(0.0), lost(0.0), deepest(0.0);
  std::array<V, L::template numbers<2>> memory;
  memory.fill(V(0.0));
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
    auto f = L::touch(constants, s, memory);
    for (V& m : memory) m = mask_zero(near, m);
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

const char* name_of(const LinearSpring&) { return "linear "; }
const char* name_of(const HertzSpring&) { return "Hertz "; }

TEST(SphereContactSteps, KeepTheWrittenRestitution) {
  for (const double e : {0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0})
    for (const auto& [a, b] : {std::pair{1e-5, 1e-5}, {1e-5, 3e-5}, {1e-5, 1e300}})
      for (const double speed : {1.0, 0.1})
        both(e, 0.0, [&, m_a = a, m_b = b](const auto& law) {
          // Of Hertz a slow contact lasts longer; of the linear law as long.
          const After after = meet(law, m_a, m_b, speed, 0.0, NormalDashpot::steps(e));
          const auto [least, most] = std::minmax_element(after.speed, after.speed + phases);
          const double bound = 3e-3 * e;
          EXPECT_NEAR(*least / speed, e, bound) << name_of(law.normal) << e << ' ' << m_b;
          EXPECT_NEAR(*most / speed, e, bound) << name_of(law.normal) << e << ' ' << m_b;
          const double reduced = m_a * m_b / (m_a + m_b), energy = 0.5 * reduced * speed * speed;
          for (const double lost : after.lost)
            EXPECT_NEAR(lost / energy, 1.0 - e * e, 1.1e-2) << name_of(law.normal) << e;
        });
}

TEST(SphereContactSteps, KeepTheEnergyOfElasticSpheres) {
  both(1.0, 0.0, [](const auto& law) {
    const After after = meet(law, 1e-5, 1e-5, 1.0, 0.0, 24.0);
    double mean = 0.0;
    for (const double u : after.speed) {
      EXPECT_NEAR(u * u, 1.0, 1e-3) << name_of(law.normal);
      mean += (u * u - 1.0) / phases;
    }
    EXPECT_NEAR(mean, 0.0, 3e-6) << name_of(law.normal)
                                 << ": no phase of the touch is likelier: gains and losses cancel";
  });
}

TEST(SphereContactSteps, ReachTheOverlapOfTheTheory) {
  both(1.0, 0.0, [](const auto& law) {
    const After after = meet(law, 1e-5, 1e-5, 1.0, 0.0, 48.0);  // 48: some step is near the turning point
    const double overlap = law.normal.largest_overlap({5e-6, 5e-4, 1.0});
    EXPECT_NEAR(*std::max_element(after.deepest, after.deepest + phases), overlap, 5e-3 * overlap);
  });
}

// Where a contact slides throughout, Coulomb's law gives dv_t = mu (1 + e) v_n, and a spin of 5/2 that by the radius
// and by the share of the mass (Walton 1993).
TEST(SphereContactSteps, SlideAsCoulombsLaw) {
  for (const double e : {0.3, 0.7, 0.9})
    for (const double speed : {1.0, 0.3})
      both(e, 0.3, [&](const auto& law) {
        const After after = meet(law, 1e-5, 1e-5, speed, 5.0 * speed, 12.0);
        const double push = 0.3 * (1.0 + e) * speed;
        for (int k = 0; k < phases; ++k) {
          EXPECT_NEAR(5.0 * speed - after.across[k], push, 5e-3 * push) << name_of(law.normal) << e;
          EXPECT_NEAR(std::abs(after.spin[k]) * 1e-3, 1.25 * push, 5e-3 * 1.25 * push);
          EXPECT_NEAR(after.speed[k], e * speed, 5e-3 * e * speed);
        }
      });
}

/// A sphere (1e-5 kg, radius 1 mm) that a weight (N) presses on a plane, from an overlap of nothing, after so many
/// steps of a twelfth of a contact; from half of them on they are a third longer.
struct Pressed {
  double overlap, stored, lost, lost_before, push;
};
template <class L>
Pressed press(const L& law, double weight, int steps) {
  using One = simd::Vec<double, 1>;
  constexpr double mass = 1e-5, radius = 1e-3;
  const double dt = law.normal.duration({mass, radius, 0.1}) / 16.0;
  double x = 0.0, u = 0.0, lost = 0.0, before = 0.0, last = dt;
  std::array<One, L::template numbers<2>> memory;
  memory.fill(One(0.0));
  Pressed p{};
  for (int k = 0; k < steps; ++k) {
    const double now = k < steps / 2 ? dt : 4.0 / 3.0 * dt;
    if (k == 3 * steps / 4) before = lost;
    TouchingSpheres<One, 2> s;
    s.normal = {One(0.0), One(1.0)};
    s.velocity = {One(0.0), One(-u)};
    s.spin_a[0] = s.spin_b[0] = One(0.0);
    s.overlap = One(x);
    s.lever_a = One(radius - x);
    s.lever_b = One(0.0);
    s.reduced_mass = One(mass);
    s.inverse_mass = One(1.0 / mass);
    s.reduced_radius = One(radius);
    const typename L::template Constants<One> constants(law, StepOfContacts::after(last, now));
    const auto f = L::touch(constants, s, memory);
    const double next = k + 1 < steps / 2 ? dt : 4.0 / 3.0 * dt;
    lost += f.lost.v;
    p = {x, f.stored.v, lost, before, f.force[1].v};
    u += 0.5 * (now + next) / mass * (weight - f.force[1].v);
    x += next * u;
    last = now;
  }
  return p;
}

// At rest the dashpot has no speed to act on: the overlap is the weight over the stiffness, and nothing is lost any
// more. With the speed that has the contact's own force alone the overlap was 1.1 (e = 0.3) to 1.25 times that.
TEST(SphereContactSteps, CarryAWeightAtTheirStiffness) {
  constexpr double weight = 1e-4;
  for (const double e : {0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99})
    both(e, 0.3, [&](const auto& law) {
      const Pressed p = press(law, weight, e > 0.95 ? 200000 : 8000);
      const std::string name = name_of(law.normal) + std::to_string(e);
      const double power = std::string(name_of(law.normal)) == "Hertz " ? 1.5 : 1.0,
                   overlap = power == 1.0 ? weight / law.normal.stiffness_at(1e-3, 0.0)
                                          : std::pow(weight / law.normal.stiffness_at(1e-3, 1.0), 2.0 / 3.0),
                   stored = weight * overlap / (power + 1.0);
      EXPECT_NEAR(p.overlap, overlap, 1e-4 * overlap) << name;
      EXPECT_NEAR(p.push, weight, 1e-6 * weight) << name;
      EXPECT_NEAR(p.stored, stored, 1e-3 * stored) << name;
      EXPECT_NEAR(p.lost, p.lost_before, 1e-9 * stored) << name;
      EXPECT_NEAR(p.lost + p.stored, weight * overlap, (e < 0.1 ? 8e-2 : 6e-2) * weight * overlap)
          << name << ": the work of the weight; what it does is observed some steps late";
    });
}

/// Two free spheres of one radius (m) and mass (kg) in `Dim` dimensions, of all phases of the first touch; a moves
/// towards b along a slanted line.
template <std::size_t Dim>
struct Pair {
  static constexpr std::size_t spins = Dim == 2 ? 1 : 3;
  static constexpr double radius = 1e-3, mass = 1e-5, inertia = 0.4 * mass * radius * radius;
  std::array<V, Dim> place[2], velocity[2];
  std::array<V, spins> spin[2];
  V lost{0.0};

  V energy() const {
    V sum(0.0);
    for (int k = 0; k < 2; ++k) {
      for (const V& u : velocity[k]) sum += V(0.5 * mass) * u * u;
      for (const V& w : spin[k]) sum += V(0.5 * inertia) * w * w;
    }
    return sum;
  }
  /// About the origin; in 2D its last component only.
  std::array<V, spins> angular_momentum() const {
    std::array<V, spins> sum;
    for (std::size_t d = 0; d < spins; ++d) {
      const std::size_t e = Dim == 2 ? 0 : (d + 1) % 3, f = Dim == 2 ? 1 : (d + 2) % 3;
      sum[d] = V(0.0);
      for (int k = 0; k < 2; ++k)
        sum[d] += V(inertia) * spin[k][d] + V(mass) * (place[k][e] * velocity[k][f] - place[k][f] * velocity[k][e]);
    }
    return sum;
  }
  /// What the law sees, and the forces of a step.
  template <class L>
  ContactForces<V, Dim> step(const typename L::template Constants<V>& c, double dt,
                             std::array<V, L::template numbers<Dim>>& memory) {
    TouchingSpheres<V, Dim> s;
    V apart2(0.0);
    for (std::size_t d = 0; d < Dim; ++d) {
      s.normal[d] = place[0][d] - place[1][d];
      s.velocity[d] = velocity[0][d] - velocity[1][d];
      apart2 += s.normal[d] * s.normal[d];
    }
    const V apart = simd::sqrt(apart2);
    for (V& n : s.normal) n = n / apart;
    s.spin_a = spin[0];
    s.spin_b = spin[1];
    s.overlap = V(2.0 * radius) - apart;
    s.lever_a = s.lever_b = V(0.5) * apart;
    s.reduced_mass = V(0.5 * mass);
    s.inverse_mass = V(2.0 / mass);
    s.reduced_radius = V(0.5 * radius);
    V fast(0.0);
    for (const V& u : s.velocity) fast += simd::max(u, -u);
    const auto near = s.overlap > V(-dt) * fast;
    auto f = L::touch(c, s, memory);
    for (V& m : memory) m = mask_zero(near, m);
    for (std::size_t d = 0; d < Dim; ++d) {
      const V push = V(dt / mass) * mask_zero(near, f.force[d]);
      velocity[0][d] += push;
      velocity[1][d] -= push;
    }
    for (std::size_t d = 0; d < spins; ++d) {
      spin[0][d] += V(dt / inertia) * mask_zero(near, f.torque_a[d]);
      spin[1][d] += V(dt / inertia) * mask_zero(near, f.torque_b[d]);
    }
    lost += mask_zero(near, f.lost);
    return f;
  }
  void drift(double dt) {
    for (int k = 0; k < 2; ++k)
      for (std::size_t d = 0; d < Dim; ++d) place[k][d] += V(dt) * velocity[k][d];
  }
};

template <std::size_t Dim>
Pair<Dim> slanted(double speed, double slip, double dt) {
  Pair<Dim> p;
  const V gap = V(2.0 * speed * dt) + V(speed * dt / phases) * V::iota();
  const std::array<double, 3> along = Dim == 2 ? std::array{0.6, 0.8, 0.0} : std::array{0.48, 0.64, 0.6};
  const std::array<double, 3> across{-0.8, 0.6, 0.0};
  for (std::size_t d = 0; d < Dim; ++d) {
    p.place[1][d] = V(3e-3);
    p.place[0][d] = p.place[1][d] + V(along[d]) * (V(2e-3) + gap);
    p.velocity[0][d] = V(-speed * along[d] + slip * across[d]);
    p.velocity[1][d] = V(0.0);
  }
  for (std::size_t d = 0; d < Pair<Dim>::spins; ++d) {
    p.spin[0][d] = V(150.0 + 40.0 * static_cast<double>(d));
    p.spin[1][d] = V(-60.0 * static_cast<double>(d + 1));
  }
  return p;
}

template <std::size_t Dim, class L>
void expect_closed_books(const L& law) {
  const double dt = law.normal.duration({0.5 * Pair<Dim>::mass, 5e-4, 1.0}) / 12.0;
  const typename L::template Constants<V> constants(law, dt);
  Pair<Dim> p = slanted<Dim>(1.0, 0.4, dt);
  std::array<V, L::template numbers<Dim>> memory;
  memory.fill(V(0.0));
  const V before = p.energy();
  const auto turning = p.angular_momentum();
  for (int k = 0; k < 200; ++k) {
    p.template step<L>(constants, dt, memory);
    p.drift(dt);
  }
  const V after = p.energy();
  const auto turned = p.angular_momentum();
  const double scale = Pair<Dim>::mass * 1e-3;
  for (int lane = 0; lane < phases; ++lane) {
    EXPECT_NEAR((before[lane] - after[lane]) / before[lane], p.lost[lane] / before[lane], 1.5e-3)
        << Dim << "D, friction " << law.friction.friction << ", rolling " << L::rolls;
    EXPECT_GE(p.lost[lane], -4e-3 * before[lane]);
    for (std::size_t d = 0; d < Pair<Dim>::spins; ++d)
      EXPECT_NEAR(turned[d][lane] / scale, turning[d][lane] / scale, 1e-9) << "angular momentum, " << Dim << "D";
  }
}

// Forces at one place, equal and opposite: the angular momentum of both spheres stays to rounding. What friction and
// rolling resistance take is what the motion loses: with another mass of the tangential motion than 2/7 the books gape.
TEST(SphereContactSteps, CloseTheBooksOfFrictionAndRolling) {
  for (const double friction : {0.1, 0.5, 10.0}) {
    expect_closed_books<2>(linear(1.0, friction).without_rolling());
    expect_closed_books<3>(linear(1.0, friction).without_rolling());
    expect_closed_books<2>(linear(1.0, friction, 0.2));
    expect_closed_books<3>(linear(1.0, friction, 0.2));
  }
}

// Two spheres that roll on each other without slip: no friction, and a torque against the rolling, mu_r N R* where it
// has given way, equal and opposite on the two.
template <std::size_t Dim>
void expect_rolling_torque() {
  const Linear law = linear(1.0, 0.5, 0.1);
  const double dt = law.normal.duration({0.5 * Pair<Dim>::mass, 5e-4, 1.0}) / 40.0;
  const Linear::Constants<V> constants(law, dt);
  TouchingSpheres<V, Dim> s;
  for (std::size_t d = 0; d < Dim; ++d) {
    s.normal[d] = V(d == 0 ? 1.0 : 0.0);
    s.velocity[d] = V(0.0);
  }
  for (std::size_t d = 0; d < Pair<Dim>::spins; ++d) s.spin_a[d] = s.spin_b[d] = V(0.0);
  constexpr std::size_t axis = Pair<Dim>::spins - 1;  // about z
  s.spin_a[axis] = V(1000.0);
  s.spin_b[axis] = V(-1000.0);
  s.overlap = V(2e-5);
  s.lever_a = s.lever_b = V(1e-3);
  s.reduced_mass = V(5e-6);
  s.inverse_mass = V(2e5);
  s.reduced_radius = V(5e-4);
  std::array<V, Linear::numbers<Dim>> memory;
  memory.fill(V(0.0));
  ContactForces<V, Dim> f;
  for (int k = 0; k < 50; ++k) f = Linear::touch(constants, s, memory);
  const double most = 0.1 * f.force[0][0] * 5e-4;
  EXPECT_GT(most, 0.0);
  EXPECT_NEAR(f.torque_a[axis][0], -most, 1e-9 * most) << "against the spin of a";
  EXPECT_NEAR(f.torque_b[axis][0], most, 1e-9 * most) << "against the spin of b";
  EXPECT_NEAR(f.force[1][0], 0.0, 1e-12 * f.force[0][0]) << "it does not slip";
}

TEST(SphereContactSteps, RollingTorqueIsAgainstTheRollingOfBoth) {
  expect_rolling_torque<2>();
  expect_rolling_torque<3>();
}

}  // namespace
}  // namespace barchan
