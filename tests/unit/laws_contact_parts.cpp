// The parts of which the contact laws of spheres are composed, each alone on two spheres against its formula.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "laws/sphere_catalogue.hpp"

namespace barchan {
namespace {

using One = simd::Vec<double, 1>;

constexpr double mass = 4e-6, radius = 5e-4;  // kg, m: reduced ones of all pairs here

NormalMotion<One> motion(double overlap, double approach) {
  return {One(overlap), One(approach), One(mass), One(1.0 / mass), One(radius)};
}
template <class Spring>
double push(const Spring& spring, const NormalDashpot& dashpot, double overlap, double approach, double dt) {
  const typename Spring::template Constants<One> c(spring);
  return Spring::force(c, NormalDashpot::Constants<One>(dashpot), motion(overlap, approach), ContactStep<One>(dt))
      .force.v;
}

TEST(NormalSprings, HaveTheWrittenForceWithoutDamping) {
  const LinearSpring linear{700.0};
  const HertzSpring hertz = HertzSpring::of_material(2e8, 0.25);
  const double modulus = 4.0 / 3.0 * 2e8 / (2.0 * (1.0 - 0.25 * 0.25));  // Pa, 4/3 E*
  for (const double overlap : {1e-8, 1e-6, 3e-5}) {
    EXPECT_NEAR(push(linear, {}, overlap, 0.0, 1e-9), 700.0 * overlap, 1e-9 * 700.0 * overlap);
    EXPECT_NEAR(push(hertz, {}, overlap, 0.0, 1e-9), modulus * std::sqrt(radius) * std::pow(overlap, 1.5),
                1e-9 * modulus * std::sqrt(radius) * std::pow(overlap, 1.5));
  }
  EXPECT_EQ(push(linear, {}, -1e-6, 0.0, 1e-9), 0.0) << "apart";
  EXPECT_NEAR(push(hertz, {}, -1e-6, 0.0, 1e-9), 0.0, 1e-20) << "apart";
}

template <class Spring>
void expect_energy_and_impact(const Spring& spring, double power) {
  // The stored energy is the integral of the force: F delta/(power + 1).
  const typename Spring::template Constants<One> c(spring);
  const auto at = [&](double overlap) {
    return Spring::force(c, NormalDashpot::Constants<One>(NormalDashpot{}), motion(overlap, 0.0),
                         ContactStep<One>(1e-9));
  };
  const double deep = 2e-5;
  double integral = 0.0;
  constexpr int n = 2000;
  for (int k = 0; k < n; ++k) integral += at((k + 0.5) * deep / n).force.v * deep / n;
  EXPECT_NEAR(at(deep).stored.v, integral, 1e-4 * integral);
  EXPECT_NEAR(at(deep).force.v * deep / (power + 1.0), integral, 1e-4 * integral);
  // All of an impact's energy is stored at its largest overlap, and a spring made of that overlap is the same one.
  const SphereImpact impact{mass, radius, 0.7};
  const double overlap = spring.largest_overlap(impact), energy = 0.5 * mass * 0.7 * 0.7;
  EXPECT_NEAR(at(overlap).stored.v, energy, 1e-6 * energy);
  const Spring same = Spring::of_overlap({}, impact, overlap);
  EXPECT_NEAR(same.stiffness_at(radius, overlap), spring.stiffness_at(radius, overlap),
              1e-12 * spring.stiffness_at(radius, overlap));
  // Speed goes with overlap to the power that is said.
  const double twice = spring.largest_overlap({mass, radius, 1.4});
  EXPECT_NEAR(std::pow(twice / overlap, Spring::speed_power), 2.0, 1e-12);
}

TEST(NormalSprings, StoreTheEnergyOfAnImpact) {
  expect_energy_and_impact(LinearSpring{700.0}, 1.0);
  expect_energy_and_impact(HertzSpring::of_material(2e8, 0.25), 1.5);
}

/// A head-on impact in fine steps: its duration (s) and its restitution.
template <class Spring>
std::array<double, 2> impact(const Spring& spring, double e, double speed) {
  const NormalDashpot dashpot = NormalDashpot::of_restitution<Spring>(e);
  const double dt = spring.duration({mass, radius, speed}) / 4000.0;
  double x = -1e-12, u = speed, time = 0.0;  // overlap, approach
  while (x > -1e-9 && time < 1.0) {
    u -= dt / mass * push(spring, dashpot, x, u, dt);
    x += dt * u;
    time += dt;
  }
  return {time, -u / speed};
}

TEST(NormalSprings, LastAsLongAsTheTheorySays) {
  const SphereImpact at{mass, radius, 0.7};
  const LinearSpring linear{700.0};
  const double half_period = std::numbers::pi * std::sqrt(mass / 700.0);
  EXPECT_NEAR(impact(linear, 1.0, 0.7)[0], half_period, 2e-3 * half_period);
  EXPECT_NEAR(linear.duration(at), half_period, 1e-12 * half_period);
  const HertzSpring hertz = HertzSpring::of_material(2e8, 0.25);
  const double k = hertz.modulus * std::sqrt(radius),
               overlap = std::pow(1.25 * mass * 0.49 / k, 0.4),  // F = k delta^1.5
      duration = 2.943275 * overlap / 0.7;
  EXPECT_NEAR(impact(hertz, 1.0, 0.7)[0], duration, 3e-3 * duration);
  EXPECT_NEAR(hertz.duration(at), duration, 1e-9 * duration);
}

TEST(NormalDashpots, KeepTheirRestitutionBesideEachSpring) {
  for (const double e : {0.2, 0.5, 0.9, 1.0}) {
    const double zeta = NormalDashpot::damping_ratio(e);
    EXPECT_NEAR(zeta > 0.0 ? NormalDashpot::restitution(zeta) : 1.0, e, 1e-12);
    EXPECT_NEAR(impact(LinearSpring{700.0}, e, 0.3)[1], e, 2e-3);
    EXPECT_NEAR(impact(HertzSpring::of_material(2e8, 0.25), e, 0.3)[1], e, 2e-3);
  }
}

TEST(NormalDashpots, ActAtTheTimeOfThePlaces) {
  const NormalDashpot::Constants<One> d(NormalDashpot{0.4});
  const double k = 900.0, c = d.coefficient(One(mass * k)).v, half_dt = 3e-6, spring = 0.02, approach = 0.3;
  EXPECT_DOUBLE_EQ(c, 0.4 * std::sqrt(mass * k));
  const double force = d.beside(One(spring), One(c), One(approach), One(1.0 + c / mass * half_dt)).v;
  EXPECT_NEAR(force, spring + c * (approach - force / mass * half_dt), 1e-15);
}

TEST(NormalDashpots, NeverPull) {
  for (const double speed : {-0.01, -0.3, -5.0}) {
    EXPECT_GE(push(LinearSpring{700.0}, {1.0}, 1e-7, speed, 1e-8), 0.0);
    EXPECT_GE(push(HertzSpring::of_material(2e8, 0.25), {1.0}, 1e-7, speed, 1e-8), 0.0);
  }
}

/// A normal force that nothing changes.
NormalForce<One> held(double load, double stiffness) {
  NormalForce<One> n;
  n.force = n.elastic = n.load = One(load);
  n.stored = n.dashpot = One(0.0);
  n.depth = One(1e-5);
  n.inverse_depth = One(1e5);
  n.stiffness = One(stiffness);
  n.share = One(1.0);
  return n;
}
/// Two spheres at a slanted contact that do not move.
template <std::size_t Dim>
TouchingSpheres<One, Dim> slanted() {
  TouchingSpheres<One, Dim> s;
  const double n[3] = {Dim == 2 ? 0.6 : 0.48, Dim == 2 ? 0.8 : 0.64, 0.6};
  for (std::size_t d = 0; d < Dim; ++d) {
    s.normal[d] = One(n[d]);
    s.velocity[d] = One(0.0);
  }
  for (auto& w : s.spin_a) w = One(0.0);
  for (auto& w : s.spin_b) w = One(0.0);
  s.overlap = One(1e-5);
  s.lever_a = One(9e-4);
  s.lever_b = One(1.1e-3);
  s.reduced_mass = One(mass);
  s.inverse_mass = One(1.0 / mass);
  s.reduced_radius = One(radius);
  return s;
}
template <std::size_t Dim>
ContactForces<One, Dim> none() {
  ContactForces<One, Dim> f;
  for (auto& x : f.force) x = One(0.0);
  for (auto& x : f.torque_a) x = One(0.0);
  for (auto& x : f.torque_b) x = One(0.0);
  f.lost = f.stored = One(0.0);
  return f;
}
template <std::size_t Dim>
double size_of(const std::array<One, Dim>& x) {
  double square = 0.0;
  for (const One& y : x) square += y.v * y.v;
  return std::sqrt(square);
}

using Coulomb = CoulombFriction<ConstantSlipStiffness>;

/// Friction alone, for a step.
template <std::size_t Dim, std::size_t N>
ContactForces<One, Dim> rub(const Coulomb& friction, const TouchingSpheres<One, Dim>& s, const NormalForce<One>& n,
                            double dt, std::array<One, N>& memory) {
  const Coulomb::Constants<One> c(friction);
  const ContactStep<One> step(dt);
  auto out = none<Dim>();
  std::array<One, N> others;  // nothing else acts
  others.fill(One(0.0));
  Coulomb::add(c, s, n, Coulomb::stiffness_of(c, n, One(0.0), step), One(0.0), step, memory.data(), others.data(), out);
  return out;
}

template <std::size_t Dim>
void expect_coulomb() {
  constexpr double k = 700.0, load = 2e-3, mu = 0.4, dt = 1e-9, speed = 0.5;
  TouchingSpheres<One, Dim> s = slanted<Dim>();
  const double across[3] = {-0.8, 0.6, 0.0};  // perpendicular to both normals
  for (std::size_t d = 0; d < Dim; ++d) s.velocity[d] = One(speed * across[d]);
  std::array<One, Dim == 2 ? 1 : 3> slip;
  slip.fill(One(0.0));
  const auto f = rub({{}, mu}, s, held(load, k), dt, slip);
  for (std::size_t d = 0; d < Dim; ++d)  // k_t xi against the slip
    EXPECT_NEAR(f.force[d].v, -2.0 / 7.0 * k * speed * dt * across[d], 1e-6 * 200.0 * speed * dt) << Dim << "D";
  EXPECT_NEAR(f.stored.v, 0.5 * 2.0 / 7.0 * k * std::pow(speed * dt, 2), 1e-9 * k * std::pow(speed * dt, 2));
  // Beyond the limit the force is mu times the load and the slip is what it needs.
  for (auto& x : slip) x = x * One(1e6);
  const auto most = rub({{}, mu}, s, held(load, k), dt, slip);
  EXPECT_NEAR(size_of(most.force), mu * load, 1e-12);
  EXPECT_NEAR(size_of(slip), mu * load / (2.0 / 7.0 * k), 1e-12);
  EXPECT_GT(most.lost.v, 0.0);
  double along = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) along += most.force[d].v * s.normal[d].v;
  EXPECT_NEAR(along, 0.0, 1e-15) << "across the normal";
  EXPECT_EQ(size_of(rub({{}, 0.0}, s, held(load, k), dt, slip).force), 0.0) << "no friction, no force";
}

TEST(CoulombFrictions, HaveASpringAndALimit) {
  expect_coulomb<2>();
  expect_coulomb<3>();
}

// Opposite forces at one place: the torques on both spheres and the moment of the two forces add up to nothing.
template <std::size_t Dim>
void expect_no_moment() {
  TouchingSpheres<One, Dim> s = slanted<Dim>();
  for (std::size_t d = 0; d < Dim; ++d) s.velocity[d] = One(0.3 + 0.1 * static_cast<double>(d));
  for (std::size_t d = 0; d < s.spin_a.size(); ++d) {
    s.spin_a[d] = One(100.0 - 30.0 * static_cast<double>(d));
    s.spin_b[d] = One(-70.0);
  }
  std::array<One, Dim == 2 ? 1 : 3> slip;
  slip.fill(One(1e-7));
  const auto f = rub({{}, 0.4}, s, held(2e-3, 700.0), 1e-6, slip);
  const double distance = s.lever_a.v + s.lever_b.v;
  for (std::size_t d = 0; d < f.torque_a.size(); ++d) {
    const std::size_t e = Dim == 2 ? 0 : (d + 1) % 3, g = Dim == 2 ? 1 : (d + 2) % 3;
    const double moment = distance * (s.normal[e].v * f.force[g].v - s.normal[g].v * f.force[e].v);
    EXPECT_NEAR(f.torque_a[d].v + f.torque_b[d].v + moment, 0.0, 1e-18) << Dim << "D";
  }
  EXPECT_GT(size_of(f.torque_a), 1e-9) << "there is a torque";
}

TEST(CoulombFrictions, TurnBothSpheresWithoutAMoment) {
  expect_no_moment<2>();
  expect_no_moment<3>();
}

/// Energy that a slip to A, to -A and back to A takes, in steps of A/n.
double cycle(double mu, double amplitude, int n) {
  constexpr double k = 700.0, load = 2e-3, dt = 1e-9;
  TouchingSpheres<One, 2> s = slanted<2>();
  s.inverse_mass = One(0.0);  // the motion is given
  std::array<One, 1> slip{One(0.0)};
  double lost = 0.0;
  const auto go = [&](double sign, int steps) {
    for (int q = 0; q < steps; ++q) {
      s.velocity[0] = One(-0.8 * sign * amplitude / n / dt);
      s.velocity[1] = One(0.6 * sign * amplitude / n / dt);
      lost += rub({{}, mu}, s, held(load, k), dt, slip).lost.v;
    }
  };
  go(1.0, n);
  const double before = lost;
  go(-1.0, 2 * n);
  go(1.0, 2 * n);
  return lost - before;
}

TEST(CoulombFrictions, TakeFromACycleWhatSlides) {
  constexpr double k_t = 200.0, load = 2e-3, mu = 0.4, amplitude = 1e-5;  // slides beyond 4e-6 m
  const double slides = 4.0 * mu * load * (amplitude - mu * load / k_t);
  EXPECT_NEAR(cycle(mu, amplitude, 4000), slides, 2e-3 * slides);
  // One that sticks gives back all; what is left is the step's own error, which falls with the step.
  const double stored = 0.5 * k_t * amplitude * amplitude;
  EXPECT_LT(std::abs(cycle(1e3, amplitude, 1000)), 2e-2 * stored);
  EXPECT_LT(std::abs(cycle(1e3, amplitude, 4000)), 5e-3 * stored);
}

// Loaded and unloaded with a slip in between, in whatever order: nothing is gained (Thornton et al. 2013).
TEST(MindlinSlipStiffnesses, GainNothingInACycleOfLoads) {
  EXPECT_NEAR(MindlinSlipStiffness::of_poisson(0.3).ratio, 3.0 * 0.7 / 1.7, 1e-15);
  const auto of = [](double v_n) {
    return MindlinSlipStiffness::of(One(0.8), held(1.0, 700.0), One(v_n), ContactStep<One>(1e-6));
  };
  EXPECT_DOUBLE_EQ(of(0.0).now.v, 0.8 * 700.0);
  EXPECT_DOUBLE_EQ(of(0.0).before.v, of(0.0).now.v);
  EXPECT_LT(of(-1.0).before.v, of(-1.0).now.v) << "loaded: it was softer";
  EXPECT_LT(of(-1.0).shrink.v, 1.0) << "loaded: new surface carries no slip";
  EXPECT_GT(of(1.0).before.v, of(1.0).now.v) << "unloaded: it was stiffer";
  EXPECT_EQ(of(1.0).shrink.v, 1.0) << "unloaded: the slip stays";
  // sqrt(depth before/depth now), depth 1e-5 m, 1e-6 m deeper or less deep in the step.
  EXPECT_NEAR(of(-1.0).before.v / of(-1.0).now.v, std::sqrt(0.9), 1e-12);

  using Friction = CoulombFriction<MindlinSlipStiffness>;
  const HertzSpring spring = HertzSpring::of_material(2e8, 0.25);
  const Friction::Constants<One> c(Friction{MindlinSlipStiffness::of_poisson(0.25), 1e3});
  constexpr double dt = 1e-8;
  for (const bool slip_first : {false, true}) {
    TouchingSpheres<One, 2> s = slanted<2>();
    s.inverse_mass = One(0.0);
    std::array<One, 1> slip{One(0.0)};
    double overlap = 5e-6, lost = 0.0, most = 0.0;
    const auto go = [&](double deeper, double across, int steps) {
      for (int q = 0; q < steps; ++q) {
        overlap += deeper / steps;
        const double v_n = -deeper / steps / dt;
        s.velocity = {One(v_n * 0.6 - 0.8 * across / steps / dt), One(v_n * 0.8 + 0.6 * across / steps / dt)};
        const auto n =
            HertzSpring::force(HertzSpring::Constants<One>(spring), NormalDashpot::Constants<One>(NormalDashpot{}),
                               motion(overlap, 0.0), ContactStep<One>(dt));
        auto f = none<2>();
        One others(0.0);
        const ContactStep<One> step(dt);
        Friction::add(c, s, n, Friction::stiffness_of(c, n, One(v_n), step), One(v_n), step, slip.data(), &others, f);
        lost += f.lost.v;
        most = std::max(most, f.stored.v);
      }
    };
    go(slip_first ? 0.0 : 1e-5, 1e-6, 2000);
    go(slip_first ? 1e-5 : -1e-5, 0.0, 2000);
    go(slip_first ? -1e-5 : 0.0, -1e-6, 2000);
    EXPECT_GT(lost, -1e-3 * most) << slip_first;
  }
}

template <std::size_t Dim>
void expect_rolling() {
  constexpr std::size_t spins = Dim == 2 ? 1 : 3;
  constexpr double k = 700.0, load = 2e-3, mu = 0.2, dt = 1e-9;
  const RollingResistance::Constants<One> c(RollingResistance{mu});
  const ContactStep<One> step(dt);
  const SlipStiffness<One> k_t{One(200.0), One(200.0), One(1.0)};
  TouchingSpheres<One, Dim> s = slanted<Dim>();
  std::array<One, spins> slip;
  slip.fill(One(0.0));
  const auto roll = [&] {
    auto f = none<Dim>();
    std::array<One, spins> others;
    others.fill(One(0.0));
    RollingResistance::add(c, s, held(load, k), k_t, step, slip.data(), others.data(), f);
    EXPECT_EQ(size_of(f.force), 0.0) << "no force";
    for (std::size_t d = 0; d < spins; ++d) EXPECT_DOUBLE_EQ(f.torque_a[d].v, -f.torque_b[d].v) << "opposite torques";
    return f;
  };
  // Both turn alike: nobody rolls.
  s.spin_a[0] = s.spin_b[0] = One(40.0);
  EXPECT_EQ(size_of(roll().torque_a), 0.0);
  if constexpr (Dim == 3) {  // a twist about the normal is no rolling
    for (std::size_t d = 0; d < 3; ++d) s.spin_a[d] = s.spin_b[d] + One(60.0) * s.normal[d];
    EXPECT_NEAR(size_of(roll().torque_a), 0.0, 1e-18);
    slip.fill(One(0.0));
  }
  // Across the normal: k_t R*^2 times the angle, against the turn; then at most mu_r R* times the load.
  const double axis[3] = {Dim == 2 ? 1.0 : -0.8, 0.6, 0.0};
  for (std::size_t d = 0; d < spins; ++d) {
    s.spin_a[d] = One(50.0 * axis[d]);
    s.spin_b[d] = One(-50.0 * axis[d]);
  }
  const auto f = roll();
  for (std::size_t d = 0; d < spins; ++d)
    EXPECT_NEAR(f.torque_a[d].v, -200.0 * radius * radius * 100.0 * dt * axis[d],
                1e-6 * 200.0 * radius * radius * 100.0 * dt);
  for (auto& x : slip) x = x * One(1e7);
  EXPECT_NEAR(size_of(roll().torque_a), mu * load * radius, 1e-15);
}

TEST(RollingResistances, HaveASpringALimitAndNoForce) {
  expect_rolling<2>();
  expect_rolling<3>();
}

// Newton's third law: who is called the first does not matter. All parts together.
template <std::size_t Dim, class Law>
void expect_third_law(const Law& law, double dt) {
  constexpr std::size_t spins = Dim == 2 ? 1 : 3;
  const typename Law::template Constants<One> c(law, dt);
  TouchingSpheres<One, Dim> s = slanted<Dim>(), t = s;
  for (std::size_t d = 0; d < Dim; ++d) {
    s.velocity[d] = One(-0.2 + 0.15 * static_cast<double>(d));
    t.velocity[d] = -s.velocity[d];
    t.normal[d] = -s.normal[d];
  }
  for (std::size_t d = 0; d < spins; ++d) {
    s.spin_a[d] = t.spin_b[d] = One(150.0 - 40.0 * static_cast<double>(d));
    s.spin_b[d] = t.spin_a[d] = One(-60.0);
  }
  std::swap(t.lever_a, t.lever_b);
  std::array<One, Law::template numbers<Dim>> memory, other;
  memory.fill(One(0.0));
  other.fill(One(0.0));
  for (int step = 0; step < 4; ++step) {
    const auto f = Law::touch(c, s, memory), g = Law::touch(c, t, other);
    const double force = size_of(f.force), torque = size_of(f.torque_a) + size_of(f.torque_b);
    EXPECT_GT(force, 0.0);
    EXPECT_GT(torque, 0.0);
    for (std::size_t d = 0; d < Dim; ++d) EXPECT_NEAR(f.force[d].v, -g.force[d].v, 1e-13 * force);
    for (std::size_t d = 0; d < spins; ++d) {
      EXPECT_NEAR(f.torque_a[d].v, g.torque_b[d].v, 1e-13 * torque);
      EXPECT_NEAR(f.torque_b[d].v, g.torque_a[d].v, 1e-13 * torque);
    }
    EXPECT_NEAR(f.lost.v, g.lost.v, 1e-12 * f.stored.v);
  }
}

SphereMaterial material(double restitution, double friction, double rolling, double stiffness, double young,
                        double poisson) {
  SphereMaterial m;
  m.restitution = restitution;
  m.friction = friction;
  m.rolling_friction = rolling;
  m.stiffness = stiffness;
  m.young = young;
  m.poisson = poisson;
  return m;
}

TEST(ComposedContacts, DoNotKnowWhoIsTheFirst) {
  const SphereMaterial grains = material(0.6, 0.4, 0.1, 700.0, 2e8, 0.25);
  const SphereMaterial* const pair[] = {&grains, &grains};
  each_sphere_law([&](auto row) {
    using Law = typename decltype(row)::Law;
    const typename Law::Normal springs[] = {*Law::Normal::of(grains), *Law::Normal::of(grains)};
    const Law law = Law::between(springs, pair);
    const double dt = law.normal.duration({mass, radius, 0.3}) / 12.0;
    expect_third_law<2>(law, dt);
    expect_third_law<3>(law, dt);
    expect_third_law<2>(law.without_rolling(), dt);
    expect_third_law<3>(law.without_rolling(), dt);
  });
}

/// A spring that remembers the largest overlap of a contact and is half as stiff below it.
struct WornSpring : LinearSpring {
  template <std::size_t>
  static constexpr std::size_t remembers = 1;
  using LinearSpring::Constants;
  template <class V, class Dashpot>
  static NormalForce<V> force(const Constants<V>& c, const Dashpot& d, const NormalMotion<V>& m,
                              const ContactStep<V>& dt, V* memory) {
    NormalForce<V> n = LinearSpring::force(c, d, m, dt);
    n.force = select(m.overlap < memory[0], V(0.5) * n.force, n.force);
    memory[0] = simd::max(memory[0], m.overlap);
    return n;
  }
};

template <std::size_t Dim>
void expect_worn() {
  using Law = SphereContact<WornSpring, NormalDashpot, CoulombFriction<ConstantSlipStiffness>, RollingResistance>;
  using Known = SphereContact<LinearSpring, NormalDashpot, CoulombFriction<ConstantSlipStiffness>, RollingResistance>;
  constexpr std::size_t last = Law::template springs<Dim>;
  static_assert(Law::template numbers<Dim> == Known::template numbers<Dim> + 1);
  static_assert(last == Known::template observed<Dim>, "the springs are the first numbers");
  Known known;
  known.normal.stiffness = 500.0;
  known.friction.friction = 0.5;
  known.rolling.friction = 0.1;
  Law worn{{known.normal}, known.damping, known.friction, known.rolling};
  const typename Known::template Constants<One> c(known, 1e-6);
  const typename Law::template Constants<One> w(worn, 1e-6);
  std::array<One, Known::template numbers<Dim>> memory;
  std::array<One, Law::template numbers<Dim>> more;
  memory.fill(One(0.0));
  more.fill(One(0.0));
  TouchingSpheres<One, Dim> s = slanted<Dim>();
  for (std::size_t d = 0; d < Dim; ++d) s.velocity[d] = One(0.05);
  for (const double share : {1.0, 1.5, 1.2}) {
    s.overlap = One(share * 1e-6);
    const auto f = Known::touch(c, s, memory), g = Law::touch(w, s, more);
    if (share > 1.3 || share == 1.0) EXPECT_EQ(g.force[0].v, f.force[0].v);
    else EXPECT_LT(std::abs(g.force[0].v), std::abs(f.force[0].v));
  }
  EXPECT_DOUBLE_EQ(more[last].v, 1.5e-6) << "the largest overlap";
}

// A part remembers what it says, behind the slips, and no other file knows of it.
TEST(ComposedContacts, GiveASpringTheNumbersThatItRemembers) {
  expect_worn<2>();
  expect_worn<3>();
}

// Springs in series, the smaller friction and restitution; a wall takes those of what touches it.
TEST(ComposedContacts, TakeTheirConstantsFromBothPhases) {
  const SphereMaterial hard = material(0.9, 0.6, 0.3, 3000.0, 3e8, 0.2),
                       soft = material(0.5, 0.2, 0.4, 1000.0, 1e8, 0.4);
  const SphereMaterial* const both[] = {&hard, &soft};
  each_sphere_law([&](auto row) {
    using Law = typename decltype(row)::Law;
    using Normal = typename Law::Normal;
    const Normal springs[] = {*Normal::of(hard), *Normal::of(soft)};
    const Law law = Law::between(springs, both), at_wall = Law::between({springs, 1}, {both, 1});
    const double k = law.normal.stiffness_at(radius, 1e-6), k_hard = springs[0].stiffness_at(radius, 1e-6),
                 k_soft = springs[1].stiffness_at(radius, 1e-6);
    EXPECT_NEAR(2.0 / k, 1.0 / k_hard + 1.0 / k_soft, 1e-12 / k);
    EXPECT_NEAR(at_wall.normal.stiffness_at(radius, 1e-6), k_hard, 1e-12 * k_hard);
    EXPECT_EQ(law.friction.friction, 0.2);
    EXPECT_EQ(at_wall.friction.friction, 0.6);
    EXPECT_EQ(law.rolling.friction, 0.3);
    EXPECT_NEAR(law.damping.ratio, Normal::dashpot_share() * NormalDashpot::damping_ratio(0.5), 1e-12);
  });
  SphereMaterial unsaid = hard;
  unsaid.stiffness.reset();
  unsaid.young = 0.0;
  EXPECT_FALSE(LinearSpring::of(unsaid)) << "left to largest-overlap";
  EXPECT_FALSE(HertzSpring::of(unsaid)) << "left to largest-overlap";
}

// Each law of spheres that a document can name has its row, and says which keys it reads.
TEST(SphereCatalogues, HaveARowForEachWord) {
  std::size_t rows = 0;
  each_sphere_law([&](auto row) {
    EXPECT_TRUE(of_spheres(decltype(row)::word));
    EXPECT_FALSE(sphere_keys_of(decltype(row)::word)->stiffness.empty());
    ++rows;
  });
  EXPECT_EQ(rows + 1, words_of<ContactLaw>.size()) << "and the kernel's contact";
  EXPECT_FALSE(of_spheres(ContactLaw::kernel));
  EXPECT_TRUE(sphere_keys_of(ContactLaw::hertz)->reads("poisson"));
  EXPECT_FALSE(sphere_keys_of(ContactLaw::linear)->reads("poisson"));
}

}  // namespace
}  // namespace barchan
