// Kernels: normalised in one, two and three dimensions, their gradient is their derivative, vectors give what numbers
// give, nothing is left beyond the radius, and lattice sums are those of the published kernels.
#include <gtest/gtest.h>

#include <limits>

#include "kernels/kernel.hpp"
#include "plan/plan.hpp"

namespace barchan {
namespace {

constexpr double pi = std::numbers::pi;

/// Composite Gauss-Legendre quadrature, exact for polynomials up to degree nine in each of `pieces`.
template <class F>
double integral(double low, double high, int pieces, F&& f) {
  constexpr std::array<double, 5> x{0, -0.5384693101056831, 0.5384693101056831, -0.9061798459386640,
                                    0.9061798459386640};
  constexpr std::array<double, 5> w{0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                                    0.2369268850561891};
  const double half = 0.5 * (high - low) / pieces;
  double sum = 0.0;
  for (int k = 0; k < pieces; ++k)
    for (std::size_t q = 0; q < 5; ++q) sum += w[q] * f(low + half * (2 * k + 1 + x[q]));
  return sum * half;
}

template <class Kernel>
class Kernels : public ::testing::Test {};
using Both = ::testing::Types<CubicSpline<double>, WendlandC2<double>>;
TYPED_TEST_SUITE(Kernels, Both);

TYPED_TEST(Kernels, IntegrateToOne) {
  for (const double radius : {0.3, 2.0, 3.7})
    for (int dimensions = 1; dimensions <= 3; ++dimensions) {
      const TypeParam kernel(radius, dimensions);
      const double sum = integral(0.0, radius, 2, [&](double r) {  // two pieces: the spline changes at radius/2
        const double shell = dimensions == 1 ? 2.0 : dimensions == 2 ? 2.0 * pi * r : 4.0 * pi * r * r;
        return shell * kernel.value(r);
      });
      EXPECT_NEAR(sum, 1.0, 1e-13) << dimensions << "D, radius " << radius;
    }
}

TYPED_TEST(Kernels, DerivativeIsThatOfTheValue) {
  for (int dimensions = 1; dimensions <= 3; ++dimensions) {
    const double radius = 2.6, step = 1e-5;
    const TypeParam kernel(radius, dimensions);
    for (double r = 0.01; r < 1.02 * radius; r += 0.013)
      EXPECT_NEAR(kernel.derivative(r), (kernel.value(r + step) - kernel.value(r - step)) / (2 * step),
                  1e-8 * kernel.value(0.0))
          << "r = " << r;
  }
}

TYPED_TEST(Kernels, DecreaseAndVanishAtTheRadius) {
  const double radius = 1.1;
  for (int dimensions = 1; dimensions <= 3; ++dimensions) {
    const TypeParam kernel(radius, dimensions);
    for (double r = 0.0; r < radius - 0.02; r += 0.01) EXPECT_GT(kernel.value(r), kernel.value(r + 0.01));
    for (const double r : {radius, std::nextafter(radius, 2.0), 1.2, 7.0, 1e12}) {
      EXPECT_NEAR(kernel.value(r), 0.0, r > radius ? 0.0 : 1e-40);
      EXPECT_NEAR(kernel.derivative(r), 0.0, r > radius ? 0.0 : 1e-25);
    }
  }
}

/// Distances from near zero to beyond the radius and out to the dummy's place.
std::vector<double> distances(double radius) {
  std::vector<double> r;
  for (int k = 1; k <= 120; ++k) r.push_back(radius * k / 100.0);
  r.insert(r.end(), {1e-3 * radius, 0.5 * radius, radius, 3.0 * radius, 1e12, 1e12, 1e12, 1e12});
  return r;
}

template <class T, int W, template <class> class Kernel>
void expect_vectors_equal_numbers(int dimensions) {
  using V = simd::Vec<T, W>;
  const double radius = 2.4, rounding = 64.0 * std::numeric_limits<T>::epsilon();
  const Kernel<T> kernel(radius, dimensions);
  const Kernel<double> exact(radius, dimensions);
  const auto r = distances(radius);
  ASSERT_EQ(r.size() % W, 0u);
  for (std::size_t k = 0; k < r.size(); k += W) {
    std::array<T, W> squared{};
    for (std::size_t q = 0; q < W; ++q) squared[q] = static_cast<T>(r[k + q] * r[k + q]);
    V w, f;
    kernel.value_and_gradient(V::load(squared.data()), w, f);
    const V alone = kernel.gradient(V::load(squared.data()));
    const V slopes = kernel.slope(V::load(squared.data())) * V(kernel.slope_factor());
    for (int q = 0; q < W; ++q) {
      const double at = r[k + static_cast<std::size_t>(q)], slope = exact.derivative(at) / at;
      const double steep = exact.value(0.0) / radius;  // scale of the derivative
      EXPECT_NEAR(w[q], exact.value(at), rounding * exact.value(0.0)) << "W " << W << ", r " << at;
      EXPECT_NEAR(f[q], slope, rounding * (std::abs(slope) + steep / at)) << "W " << W << ", r " << at;
      EXPECT_NEAR(alone[q], slope, rounding * (std::abs(slope) + steep / at)) << "W " << W << ", r " << at;
      EXPECT_NEAR(slopes[q], slope, rounding * (std::abs(slope) + steep / at)) << "W " << W << ", r " << at;
      if (at > 1.001 * radius) {
        EXPECT_EQ(slopes[q], T(0));
        EXPECT_EQ(w[q], T(0));
        EXPECT_EQ(f[q], T(0));
        EXPECT_EQ(alone[q], T(0));
      }
    }
  }
}

template <template <class> class Kernel>
void expect_all_widths_equal_numbers() {
  for (int dimensions = 1; dimensions <= 3; ++dimensions) {
    expect_vectors_equal_numbers<double, 1, Kernel>(dimensions);
    expect_vectors_equal_numbers<double, 4, Kernel>(dimensions);
    expect_vectors_equal_numbers<double, 8, Kernel>(dimensions);
    expect_vectors_equal_numbers<float, 1, Kernel>(dimensions);
    expect_vectors_equal_numbers<float, 8, Kernel>(dimensions);
  }
}

TEST(KernelVectors, CubicSplineEqualsItsNumbers) { expect_all_widths_equal_numbers<CubicSpline>(); }
TEST(KernelVectors, WendlandEqualsItsNumbers) { expect_all_widths_equal_numbers<WendlandC2>(); }

// Eq. (14) of Halik et al. 2015 as printed: alpha {2/3 - R^2 + R^3/2, (2-R)^3/6, 0}.
TEST(CubicSplineForm, IsThePapersEquation14) {
  for (const double h : {1.0, 0.75, 0.5, 0.25})
    for (int dimensions = 1; dimensions <= 3; ++dimensions) {
      const double alpha = dimensions == 1   ? 1.0 / h
                           : dimensions == 2 ? 15.0 / (7.0 * pi * h * h)
                                             : 3.0 / (2.0 * pi * h * h * h);
      const CubicSpline<double> kernel(2.0 * h, dimensions);
      for (double q = 0.0; q < 2.3; q += 0.01) {
        const double t = 2.0 - q;
        const double printed = q < 1 ? 2.0 / 3.0 - q * q + 0.5 * q * q * q : q < 2 ? t * t * t / 6.0 : 0.0;
        EXPECT_NEAR(kernel.value(q * h), alpha * printed, 1e-14 * alpha);
      }
    }
}

// Sums on square and cubic lattices: sum V W, -sum V x dW/dx and neighbours, each derived from the kernels' formulas by
// plain summation to six decimals; the first column is the radius over the spacing, 2 h/dx.
struct LatticeSum {
  KernelKind kernel;
  int dimensions;
  double radius, volume, gradient;
  int neighbours;
};

TEST(LatticeSums, AreThoseOfTheKernels) {
  using enum KernelKind;
  const std::vector<LatticeSum> table{
      {cubic_spline, 2, 2.4, 0.999757, 0.990793, 20}, {cubic_spline, 2, 2.6, 0.999947, 1.010543, 20},
      {cubic_spline, 2, 3.0, 1.003440, 1.006725, 24}, {wendland_c2, 2, 3.0, 1.005142, 0.997399, 24},
      {wendland_c2, 2, 4.0, 1.001206, 0.999199, 44},  {cubic_spline, 3, 2.4, 1.000810, 0.981689, 56},
      {cubic_spline, 3, 2.6, 0.997262, 0.993484, 80}, {cubic_spline, 3, 3.0, 1.001795, 1.010123, 92},
      {wendland_c2, 3, 3.0, 1.003141, 1.000619, 92},  {wendland_c2, 3, 4.0, 1.000549, 0.999413, 250},
  };
  for (const auto& t : table) {
    const Consistency c = lattice_consistency(t.kernel, t.radius, t.dimensions);
    EXPECT_NEAR(c.volume_sum, t.volume, 1e-6) << t.dimensions << "D, radius " << t.radius;
    EXPECT_NEAR(c.gradient_sum, t.gradient, 1e-6) << t.dimensions << "D, radius " << t.radius;
    EXPECT_EQ(c.neighbours, t.neighbours) << t.dimensions << "D, radius " << t.radius;
    EXPECT_TRUE(c.consistent());
  }
}

// The paper's contact radii are no approximations: at 1.1 spacings a particle sees four neighbours and 14 % of a
// gradient.
TEST(LatticeSums, SayThatContactRadiiAreNotConsistent) {
  const Consistency grains = lattice_consistency(KernelKind::cubic_spline, 1.1, 2);
  EXPECT_EQ(grains.neighbours, 4);
  EXPECT_NEAR(grains.volume_sum, 1.51, 0.005);
  EXPECT_NEAR(grains.gradient_sum, 0.14, 0.005);
  EXPECT_FALSE(grains.consistent());
  const Consistency bodies = lattice_consistency(KernelKind::cubic_spline, 1.0, 2);  // eq. (17b)
  EXPECT_EQ(bodies.neighbours, 0);
  EXPECT_EQ(bodies.gradient_sum, 0.0);
  EXPECT_FALSE(bodies.consistent());
  // One sum right and the other wrong is not enough.
  EXPECT_FALSE((Consistency{20, 1.0, 0.96}).consistent());
  EXPECT_FALSE((Consistency{20, 1.04, 1.0}).consistent());
  EXPECT_TRUE((Consistency{20, 1.02, 0.98}).consistent());
}

}  // namespace
}  // namespace barchan
