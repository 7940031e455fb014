// Pair laws on two particles: what a does to b, b does to a, to the last bits; a contact is zero beyond the rest
// distance, derives from its potential, and gives the restitution it promises at any speed.
#include <gtest/gtest.h>

#include "kernels/kernel.hpp"
#include "laws/elastic.hpp"
#include "laws/kernel_contact.hpp"
#include "laws/plain_fluid.hpp"
#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

using One = simd::Vec<double, 1>;
constexpr double ulp = std::numeric_limits<double>::epsilon();

template <std::size_t Dim>
std::array<One, Dim> broadcast(const Vec3& x, double sign = 1.0) {
  std::array<One, Dim> v;
  for (std::size_t d = 0; d < Dim; ++d) v[d] = One(sign * x[d]);
  return v;
}

Vec3 random_vector(int dimensions, double size, sets::Uniform& random) {
  Vec3 x{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) x[d] = random(-size, size);
  return x;
}

template <int Dim>
class PlainPair {
 public:
  explicit PlainPair(sets::Uniform& random)
      : r(random_vector(Dim, 1.0, random)),
        v_a(random_vector(Dim, 3.0, random)),
        v_b(random_vector(Dim, 3.0, random)),
        p_a(random(-5, 90)),
        p_b(random(-5, 90)),
        rho_a(random(0.9, 1.1)),
        rho_b(2000.0 * random(0.9, 1.1)) {}

  /// m dv/dt of the first particle: the formula of the law's head with one neighbour.
  std::array<double, Dim> force(bool of_a, double f, double mu) const {
    using Law = PlainFluid<Dim>;
    typename Law::template Own<One> own{};
    own.v = broadcast<Dim>(of_a ? v_a : v_b);
    own.p = One(of_a ? p_a : p_b);
    const auto neighbour = broadcast<Dim>(of_a ? v_b : v_a);
    const double rho = of_a ? rho_a : rho_b, volume = volume_of(of_a), other = volume_of(!of_a);
    typename Law::template Sums<One> pair{}, s{};
    Law::add(own, broadcast<Dim>(r, of_a ? 1.0 : -1.0), One(dot(r, r)), One(f / 3.0), neighbour.data(),
             One(of_a ? p_b : p_a), One(other), pair);
    s.take(pair, 3.0, mu, 1.0, {0, -9.81, 0});  // 3: the kernel's constant factor
    std::array<double, Dim> m_dv;
    for (std::size_t d = 0; d < Dim; ++d) m_dv[d] = (rho * volume) * ((2.0 * s.viscous[d][0] - s.pressure[d][0]) / rho);
    return m_dv;
  }
  double volume_of(bool a) const { return a ? 1.3 / rho_a : 2500.0 / rho_b; }

  Vec3 r, v_a, v_b;
  double p_a, p_b, rho_a, rho_b;
};

template <int Dim>
void expect_plain_fluid_acts_back(double mu) {
  sets::Uniform random(1);
  for (int k = 0; k < 500; ++k) {
    const PlainPair<Dim> pair(random);
    const double f = random(-2.0, -0.1);
    const auto on_a = pair.force(true, f, mu), on_b = pair.force(false, f, mu);
    // Either force is a product of volumes, F and a vector, multiplied in another order: a few roundings of its terms.
    for (std::size_t d = 0; d < Dim; ++d) {
      const double volumes = pair.volume_of(true) * pair.volume_of(false) * std::abs(f);
      const double terms = volumes * ((std::abs(pair.p_a) + std::abs(pair.p_b)) * std::abs(pair.r[d]) +
                                      2.0 * mu * (std::abs(pair.v_a[d]) + std::abs(pair.v_b[d])));
      EXPECT_NEAR(on_a[d], -on_b[d], 6.0 * ulp * terms);
      EXPECT_GT(std::abs(on_a[d]), 0.0);
    }
  }
}

TEST(PlainFluidLaw, ActsBackAtADensityRatioOf2000) {
  for (const double mu : {0.0, 1.7}) {
    expect_plain_fluid_acts_back<2>(mu);
    expect_plain_fluid_acts_back<3>(mu);
  }
}

TEST(PlainFluidLaw, PressurePushesApartAndViscosityDrags) {
  sets::Uniform random(2);
  PlainPair<2> pair(random);
  pair.r = {0.4, 0.3, 0};
  pair.p_a = pair.p_b = 10.0;
  pair.v_a = pair.v_b;
  const auto push = pair.force(true, -1.0, 1.0);
  EXPECT_GT(push[0] * 0.4 + push[1] * 0.3, 0.0);
  EXPECT_NEAR(push[0] * 0.3 - push[1] * 0.4, 0.0, 1e-14 * std::abs(push[0])) << "along the line of centres";
  pair.p_a = pair.p_b = 0.0;
  pair.v_a[0] += 2.0;
  const auto drag = pair.force(true, -1.0, 1.0);
  EXPECT_LT(drag[0], 0.0);
  EXPECT_NEAR(drag[1], 0.0, 1e-15);
}

/// m_a a_a and m_b a_b of two elastic particles with masses m_a, m_b.
template <int Dim, bool Viscous>
void expect_elastic_acts_back(double m_a, double m_b, double roundings) {
  using Law = ElasticForce<Dim>;
  sets::Uniform random(3);
  int felt = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 r = random_vector(Dim, 1.0, random), v_a = random_vector(Dim, 3.0, random),
               v_b = random_vector(Dim, 3.0, random);
    std::array<One, Law::stresses> s_a, s_b;
    for (auto* s : {&s_a, &s_b})
      for (auto& c : *s) c = One(random(-4, 4));
    const double f = random(-2.0, -0.1);
    const auto force = [&](bool of_a) {
      typename Law::template Own<One> own{};
      own.v = broadcast<Dim>(of_a ? v_a : v_b);
      own.s = of_a ? s_a : s_b;
      own.mass_b = One(of_a ? m_b : m_a);
      own.alpha = One(-1.5);
      own.beta = One(0.8);
      own.soft = One(0.01);
      const auto neighbour = broadcast<Dim>(of_a ? v_b : v_a);
      std::array<One, Dim> a{};
      One power(0.0);
      Law::template add<Viscous, true>(own, broadcast<Dim>(r, of_a ? 1.0 : -1.0), One(dot(r, r)), One(f),
                                       neighbour.data(), (of_a ? s_b : s_a).data(), One(1.0), a, power);
      std::array<double, Dim + 1> m_dv;
      for (std::size_t d = 0; d < Dim; ++d) m_dv[d] = (of_a ? m_a : m_b) * a[d][0];
      m_dv[Dim] = (of_a ? m_a : m_b) * power[0];
      return m_dv;
    };
    const auto on_a = force(true), on_b = force(false);
    for (std::size_t d = 0; d < Dim; ++d) {
      EXPECT_NEAR(on_a[d], -on_b[d], roundings * ulp * std::abs(on_a[d]));
      felt += on_a[d] != 0.0;
    }
    double power = 0.0, size = 0.0;  // of the force in the frame of b: both particles find the same
    for (std::size_t d = 0; d < Dim; ++d) {
      power += on_a[d] * (v_a[d] - v_b[d]);
      size += std::abs(on_a[d] * (v_a[d] - v_b[d]));
    }
    EXPECT_NEAR(on_a[Dim], power, 8.0 * ulp * size);
    EXPECT_NEAR(on_b[Dim], power, 8.0 * ulp * size);
  }
  EXPECT_EQ(felt, 500 * Dim);
}

TEST(ElasticLaw, ActsBack) {
  expect_elastic_acts_back<2, false>(0.7, 0.7, 0.0);  // equal masses: to the last bit
  expect_elastic_acts_back<3, false>(0.7, 0.7, 0.0);
  expect_elastic_acts_back<2, true>(0.7, 0.7, 0.0);
  expect_elastic_acts_back<3, true>(0.7, 0.7, 0.0);
  expect_elastic_acts_back<2, true>(0.7, 1234.5, 2.0);  // the masses are multiplied in another order
  expect_elastic_acts_back<3, false>(0.7, 1234.5, 2.0);
}

/// A contact of two grains of mass m a spacing d apart at rest, kernel radius 1.1 d, stiffness such that c = 1.
struct Grains {
  double d = 1.0, mass = 2.0;
  CubicSpline<double> kernel{1.1, 2};
  KernelContact law{};
  explicit Grains(double restitution) {
    law.stiffness = mass;
    law.damping = 2.0 * KernelContact::damping_ratio(restitution) * std::sqrt(law.stiffness * 0.5 * mass);
    law.rest_value = kernel.value(d);
    law.inverse_slope = 1.0 / std::abs(kernel.derivative(d));
  }
  std::array<double, 2> force(const Vec3& r, const Vec3& v) const {
    One w, f;
    kernel.value_and_gradient(One(dot(r, r)), w, f);
    std::array<One, 2> force{One(0.0), One(0.0)};
    KernelContact::add(KernelContact::Constants<One>(law), broadcast<2>(r), One(dot(r, r)), broadcast<2>(v), w, f,
                       force);
    return {force[0][0], force[1][0]};
  }
  double potential(double r) const {
    const double g = std::max(kernel.value(r) - law.rest_value, 0.0) * law.inverse_slope;
    return 0.5 * law.stiffness * g * g;
  }
};

TEST(KernelContactLaw, ActsBackToTheLastBit) {
  const Grains grains(0.6);
  sets::Uniform random(4);
  for (int k = 0; k < 500; ++k) {
    const Vec3 r = random_vector(2, 0.65, random), v = random_vector(2, 1.0, random);
    const auto on_a = grains.force(r, v), on_b = grains.force(-1.0 * r, -1.0 * v);
    EXPECT_EQ(on_a[0], -on_b[0]);
    EXPECT_EQ(on_a[1], -on_b[1]);
    EXPECT_NE(on_a[0], 0.0);
  }
}

TEST(KernelContactLaw, IsZeroBeyondTheRestDistance) {
  const Grains grains(0.6);
  for (const double r : {1.0 + 1e-9, 1.02, 1.0999, 1.1, 1.5, 1e12}) {
    const auto f = grains.force({0, r, 0}, {0.3, -2.0, 0});
    EXPECT_EQ(f[0], 0.0) << r;
    EXPECT_EQ(f[1], 0.0) << r;
  }
  EXPECT_GT(grains.force({0, 0.999, 0}, {0, -0.001, 0})[1], 0.0) << "touching grains repel";
}

TEST(KernelContactLaw, DerivesFromItsPotential) {
  const Grains grains(1.0);
  for (double r = 0.5; r < 0.9995; r += 0.01) {
    const double step = 1e-6;
    const double slope = (grains.potential(r + step) - grains.potential(r - step)) / (2.0 * step);
    const auto f = grains.force({0.6 * r, 0.8 * r, 0}, {1.0, 2.0, 0});
    EXPECT_NEAR(0.6 * f[0] + 0.8 * f[1], -slope, 1e-6 * std::abs(slope)) << r;
    EXPECT_NEAR(0.8 * f[0] - 0.6 * f[1], 0.0, 1e-13 * std::abs(slope)) << "along the line of centres";
  }
  EXPECT_NEAR(grains.potential(0.999), 0.5 * grains.law.stiffness * 1e-6, 0.05 * 1e-6) << "1/2 K (d - r)^2 near rest";
}

/// Speed after over speed before a head-on collision, by the leapfrog with small steps.
double restitution(const Grains& grains, double speed) {
  const double dt = 2e-4, reduced = 0.5 * grains.mass;
  double r = 1.0 + 0.5 * dt * speed, v = -speed;  // v: rate of change of r
  const auto acceleration = [&](double at, double rate) { return grains.force({at, 0, 0}, {rate, 0, 0})[0] / reduced; };
  for (int step = 0; step < 1'000'000 && (r < 1.0 || v < 0.0); ++step) {
    const double half = v + 0.5 * dt * acceleration(r, v);
    r += dt * half;
    const double predicted = half + 0.5 * dt * acceleration(r, half);
    v = half + 0.5 * dt * acceleration(r, predicted);
  }
  return v / speed;
}

TEST(KernelContactLaw, GivesTheRestitutionItPromisesAtAnySpeed) {
  for (const double e : {0.3, 0.7, 0.9, 1.0}) {
    const Grains grains(e);
    for (const double speed : {0.003, 0.03, 0.1})  // of the contact speed: overlaps up to a tenth
      EXPECT_NEAR(restitution(grains, speed), e, 0.02 * e) << "speed " << speed;
  }
}

TEST(KernelContactLaw, DampingRatioIsThatOfALinearContact) {
  // zeta = -ln e / sqrt(pi^2 + ln^2 e), inverse of e = exp(-pi zeta / sqrt(1 - zeta^2)); five decimals.
  for (const auto& [e, zeta] : std::initializer_list<std::pair<double, double>>{
           {0.5, 0.21545}, {0.6, 0.16049}, {0.7, 0.11281}, {0.8, 0.07085}, {0.9, 0.03352}, {0.95, 0.01632}, {1.0, 0.0}})
    EXPECT_NEAR(KernelContact::damping_ratio(e), zeta, 5.1e-6) << e;
}

}  // namespace
}  // namespace barchan
