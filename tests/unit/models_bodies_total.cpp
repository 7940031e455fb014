// Total Lagrangian bodies against naive twins written from the formulas in their headers: the acceleration, and that it
// is the exact slope of an energy; laws of the material against the slope of theirs.
#include <gtest/gtest.h>

#include "kernels/kernel.hpp"
#include "models/bodies/stress_fields.hpp"
#include "models/bodies/total_lagrangian.hpp"
#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

using namespace sets;
using Tensor = std::array<std::array<double, 3>, 3>;

constexpr double radius = 2.3;

double weight(int dimensions, double r) {
  return with_kernel<double>(KernelKind::wendland_c2, radius, dimensions,
                             [&](const auto& kernel) { return std::abs(kernel.derivative(r)) / r; });
}

/// A body with displacements and what the passes make of it.
template <class T>
struct Stage {
  Bounds bounds;
  std::vector<Vec3> start;
  ReferenceBody<T> reference;
  TotalWork<T> work;
  TotalParameters q;
  PhaseParticles p;

  Stage(int dimensions, const Bounds& b, std::vector<Vec3> places, Elasticity law, double retardation = 0.0,
        double along = 0.0)
      : bounds(b),
        start(std::move(places)),
        reference(make_reference_body<T>(start, b, 1.0, KernelKind::wendland_c2, radius, simd::width_in_use<T>())),
        p(phase(dimensions, start, 1.0, {Field::velocity, Field::acceleration, Field::density})) {
    q.law = law;
    q.moduli = {3.0, 2.0, retardation};
    q.hourglass = 0.7;
    q.along = along;
    q.density = 1.3;
    for (std::size_t d = 0; d < 3; ++d) q.period[d] = b.periodic[d] ? b.high[d] - b.low[d] : 0.0;
    work.resize(start.size(), reference.width, dimensions, q);
    for (std::size_t d = 0; d < 3; ++d)
      if (q.period[d] > 0.0) work.displaced[d].assign(start.size(), 0.0);
    p.keep_places();
    work.at = p.places();
  }
  void shake(double size, Uniform& random) {
    for (int d = 0; d < p.dimensions(); ++d)
      for (std::size_t k = 0; k < p.size(); ++k) {
        p.column(Field::position, d)[k] = start[k][static_cast<std::size_t>(d)] + random(-size, size);
        p.column(Field::velocity, d)[k] = random(-size, size);
      }
  }
  void load() {
    pack_displacements(p, reference, work, q);
    total_stress(p, reference, work, q);
    total_forces(p, reference, work, q);
  }
  Vec3 acceleration(std::size_t k) const {
    Vec3 a{};
    for (int d = 0; d < p.dimensions(); ++d) a[static_cast<std::size_t>(d)] = p.column(Field::acceleration, d)[k];
    return a;
  }
  Vec3 displacement(std::size_t k) const {
    Vec3 u{};
    for (int d = 0; d < p.dimensions(); ++d)
      u[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k] - start[k][static_cast<std::size_t>(d)];
    return u;
  }
  /// Elastic energy and that of the hourglass control.
  double energy() {
    pack_displacements(p, reference, work, q);
    TotalDetail detail;
    const std::size_t padded = reference.groups.size() * reference.width;
    for (auto& c : detail.gradient) c.assign(padded, 0.0);
    detail.hourglass.assign(padded, 0.0);
    total_detail(reference, work, q, detail);
    double sum = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k)
      sum += solid_of(detail.gradient, k, p.dimensions(), q.law, q.moduli).energy + detail.hourglass[k];
    return sum;
  }
};

struct Shape {
  const char* name;
  int dimensions;
  double perturb;
  bool periodic;
};
void PrintTo(const Shape& s, std::ostream* out) { *out << s.name; }

std::vector<Vec3> places_of(const Shape& s, const Bounds& b, Uniform& random) {
  auto places = lattice(b, 1.0, s.perturb, random);
  // A notch, so that rows have different lengths.
  if (!s.periodic)
    std::erase_if(places, [&](const Vec3& x) { return x[0] > 4.0 && (s.dimensions == 3 || x[0] < 6.0) && x[1] > 3.0; });
  return places;
}
Bounds bounds_of(const Shape& s) {
  return s.dimensions == 2 ? box(2, {21, 7, 0}, {s.periodic, false, false})
                           : box(3, {7, 6, 5}, {s.periodic, false, s.periodic});
}

class TotalLagrangian : public ::testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, TotalLagrangian,
                         ::testing::Values(Shape{"Lattice2D", 2, 0.0, false}, Shape{"Disordered2D", 2, 0.2, false},
                                           Shape{"Periodic2D", 2, 0.0, true}, Shape{"Lattice3D", 3, 0.0, false},
                                           Shape{"Disordered3D", 3, 0.2, false}, Shape{"Periodic3D", 3, 0.1, true}));

/// Calls f(b, X_ab, w) for the neighbours of a, all images looked at.
template <class T, class F>
void for_neighbours(const Stage<T>& s, std::size_t a, F&& f) {
  const int around = 1;
  for (std::size_t b = 0; b < s.start.size(); ++b)
    for (int i = -around; i <= around; ++i)
      for (int k = -around; k <= around; ++k) {
        if ((i != 0 && !s.bounds.periodic[0]) || (k != 0 && !s.bounds.periodic[2])) continue;
        Vec3 x = s.start[a] - s.start[b];
        x[0] += i * s.q.period[0];
        x[2] += k * s.q.period[2];
        const double r = norm(x);
        if (r > 0.0 && r < radius) f(b, x, weight(s.p.dimensions(), r));
      }
}

Tensor inverse_of(const Tensor& m, int dimensions) {
  Tensor l{};
  if (dimensions == 2) {
    const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    l[0][0] = m[1][1] / det;
    l[1][1] = m[0][0] / det;
    l[0][1] = l[1][0] = -m[0][1] / det;
    return l;
  }
  double det = 0.0;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t e = 0; e < 3; ++e) {
      const std::size_t p = (d + 1) % 3, q = (d + 2) % 3, r = (e + 1) % 3, s = (e + 2) % 3;
      l[e][d] = m[p][r] * m[q][s] - m[p][s] * m[q][r];
      if (d == 0) det += m[d][e] * l[e][d];
    }
  for (auto& row : l)
    for (double& x : row) x /= det;
  return l;
}

/// H and Q = kappa H - P M^-1 of every particle, from the formulas.
template <class T>
void naive_stress(const Stage<T>& s, std::vector<Tensor>& h, std::vector<Tensor>& q) {
  const auto dim = static_cast<std::size_t>(s.p.dimensions());
  for (std::size_t a = 0; a < s.start.size(); ++a) {
    Tensor m{}, g{};
    for_neighbours(s, a, [&](std::size_t b, const Vec3& x, double w) {
      const Vec3 u = s.displacement(a) - s.displacement(b);
      for (std::size_t d = 0; d < dim; ++d)
        for (std::size_t e = 0; e < dim; ++e) {
          m[d][e] += w * x[d] * x[e];
          g[d][e] += w * u[d] * x[e];
        }
    });
    const Tensor l = inverse_of(m, s.p.dimensions());
    Tensor f{}, stress{}, strain{};
    for (std::size_t d = 0; d < 3; ++d) f[d][d] = 1.0;
    for (std::size_t d = 0; d < dim; ++d)
      for (std::size_t e = 0; e < dim; ++e) {
        double sum = 0.0;
        for (std::size_t c = 0; c < dim; ++c) sum += g[d][c] * l[c][e];
        f[d][e] += sum;
      }
    double trace = 0.0;
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e < 3; ++e) {
        for (std::size_t c = 0; c < 3; ++c) strain[d][e] += 0.5 * f[c][d] * f[c][e];
        if (d == e) strain[d][e] -= 0.5;
        if (d == e) trace += strain[d][e];
      }
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e < 3; ++e)
        for (std::size_t c = 0; c < 3; ++c)
          stress[d][e] += f[d][c] * (2.0 * s.q.moduli.mu * strain[c][e] + (c == e ? s.q.moduli.lambda * trace : 0.0));
    Tensor reach{}, gradient = f;
    for (std::size_t d = 0; d < 3; ++d) gradient[d][d] -= 1.0;
    for (std::size_t d = 0; d < dim; ++d)
      for (std::size_t e = 0; e < dim; ++e) {
        reach[d][e] = s.q.hourglass * gradient[d][e];
        for (std::size_t c = 0; c < dim; ++c) reach[d][e] -= stress[d][c] * l[c][e];
      }
    h.push_back(gradient);
    q.push_back(reach);
  }
}

template <class T>
double largest_error(const Shape& shape) {
  Uniform random(5);
  const Bounds b = bounds_of(shape);
  Stage<T> s(shape.dimensions, b, places_of(shape, b, random), Elasticity::saint_venant_kirchhoff);
  s.shake(0.05, random);
  s.load();
  std::vector<Tensor> h, q;
  naive_stress(s, h, q);
  double worst = 0.0, largest = 0.0;
  for (std::size_t a = 0; a < s.start.size(); ++a) {
    Vec3 sum{};
    for_neighbours(s, a, [&](std::size_t n, const Vec3& x, double w) {
      const Vec3 u = s.displacement(a) - s.displacement(n);
      for (std::size_t d = 0; d < static_cast<std::size_t>(shape.dimensions); ++d) {
        for (std::size_t e = 0; e < static_cast<std::size_t>(shape.dimensions); ++e)
          sum[d] += w * (q[a][d][e] + q[n][d][e]) * x[e];
        sum[d] -= 2.0 * s.q.hourglass * w * u[d];
      }
    });
    const Vec3 exact = (1.0 / s.q.density) * sum;
    worst = std::max(worst, norm(s.acceleration(a) - exact));
    largest = std::max(largest, norm(exact));
  }
  return worst / largest;
}

TEST_P(TotalLagrangian, AccelerationEqualsTheNaiveSums) {
  EXPECT_LT(largest_error<double>(GetParam()), 1e-12);
  EXPECT_LT(largest_error<float>(GetParam()), 3e-6);
}

TEST_P(TotalLagrangian, AForceIsTheSlopeOfTheEnergy) {
  for (const auto& [law, along] : {std::pair{Elasticity::neo_hookean, 0.0},
                                   {Elasticity::neo_hookean, 1.9},
                                   {Elasticity::saint_venant_kirchhoff, 0.0}}) {
    Uniform random(6);
    const Bounds b = bounds_of(GetParam());
    Stage<double> s(GetParam().dimensions, b, places_of(GetParam(), b, random), law, 0.0, along);
    s.shake(0.05, random);
    s.load();
    for (std::size_t k = 0; k < s.p.size(); k += 13)
      for (int d = 0; d < s.p.dimensions(); ++d) {
        constexpr double step = 1e-5;
        double& x = s.p.column(Field::position, d)[k];
        const double place = x;
        x = place + step;
        const double more = s.energy();
        x = place - step;
        const double less = s.energy();
        x = place;
        EXPECT_NEAR(s.p.column(Field::acceleration, d)[k] * s.q.density, -(more - less) / (2.0 * step), 1e-7);
      }
  }
}

TEST_P(TotalLagrangian, AnAffineMotionIsSeenExactlyAndStraysNowhere) {
  if (GetParam().periodic) return;
  Uniform random(7);
  const Bounds b = bounds_of(GetParam());
  Stage<double> s(GetParam().dimensions, b, places_of(GetParam(), b, random), Elasticity::neo_hookean, 0.0, 1.9);
  const auto dim = static_cast<std::size_t>(GetParam().dimensions);
  Tensor h{};
  for (std::size_t d = 0; d < dim; ++d)
    for (std::size_t e = 0; e < dim; ++e) h[d][e] = random(-0.3, 0.3);
  for (std::size_t k = 0; k < s.start.size(); ++k)
    for (std::size_t d = 0; d < dim; ++d)
      for (std::size_t e = 0; e < dim; ++e)
        s.p.column(Field::position, static_cast<int>(d))[k] += h[d][e] * s.start[k][e];
  pack_displacements(s.p, s.reference, s.work, s.q);
  TotalDetail detail;
  const std::size_t padded = s.reference.groups.size() * s.reference.width;
  for (auto& c : detail.gradient) c.assign(padded, 0.0);
  detail.hourglass.assign(padded, 0.0);
  total_detail(s.reference, s.work, s.q, detail);
  for (std::size_t k = 0; k < s.start.size(); ++k) {
    for (std::size_t d = 0; d < dim; ++d)
      for (std::size_t e = 0; e < dim; ++e) EXPECT_NEAR(detail.gradient[d * dim + e][k], h[d][e], 1e-11);
    EXPECT_NEAR(detail.hourglass[k], 0.0, 1e-20);
  }
}

/// The largest difference of two bodies' accelerations, over the largest of the second.
template <class A, class B>
double difference_of(const Stage<A>& a, const Stage<B>& b) {
  double most = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < a.start.size(); ++k) {
    most = std::max(most, norm(a.acceleration(k) - b.acceleration(k)));
    scale = std::max(scale, norm(b.acceleration(k)));
  }
  return most / scale;
}

/// Strains of 1e-4 and a turn of 1.9 rad: without PartTurns single precision tells 1e-3 of the forces.
TEST_P(TotalLagrangian, SinglePrecisionKeepsTheDigitsOfABodyThatTurns) {
  if (GetParam().periodic) return;
  Uniform random(8);
  const Bounds b = bounds_of(GetParam());
  const auto start = places_of(GetParam(), b, random);
  for (const auto& [retardation, along] : {std::pair{0.0, 0.0}, {0.2, 0.0}, {0.0, 1.9}}) {
    Stage<double> exact(GetParam().dimensions, b, start, Elasticity::neo_hookean, retardation, along);
    Stage<float> s(GetParam().dimensions, b, start, Elasticity::neo_hookean, retardation, along);
    exact.q.gravity = s.q.gravity = {1e-5, -2e-5, 0.0};
    exact.shake(1e-4, random);
    const double c = std::cos(1.9), z = std::sin(1.9);
    for (std::size_t k = 0; k < start.size(); ++k) {
      const double x = exact.p.column(Field::position, 0)[k], y = exact.p.column(Field::position, 1)[k];
      exact.p.column(Field::position, 0)[k] = 40.0 + c * x - z * y;
      exact.p.column(Field::position, 1)[k] = z * x + c * y;
    }
    for (int d = 0; d < s.p.dimensions(); ++d)
      for (const Field f : {Field::position, Field::velocity})
        std::copy_n(exact.p.column(f, d), start.size(), s.p.column(f, d));
    s.load();
    exact.load();
    EXPECT_TRUE(s.work.turns.any());
    EXPECT_LT(difference_of(s, exact), 1e-6);
    EXPECT_NEAR(s.energy() / exact.energy(), 1.0, 1e-6);

    // What follows from the places follows after a restart as well.
    Archive saved;
    s.work.turns.archive(saved);
    Archive loaded(saved.bytes());
    Stage<float> again(GetParam().dimensions, b, start, Elasticity::neo_hookean, retardation, along);
    again.q.gravity = s.q.gravity;
    again.work.turns.archive(loaded);
    for (int d = 0; d < s.p.dimensions(); ++d)
      for (const Field f : {Field::position, Field::velocity})
        std::copy_n(exact.p.column(f, d), start.size(), again.p.column(f, d));
    again.load();
    EXPECT_TRUE(again.work.turns.any());
    EXPECT_LT(difference_of(again, exact), 1e-6);
  }
}

/// A bar that is drawn to twice its length, and one that moves: no turn.
TEST_P(TotalLagrangian, OnlyBodiesThatTurnAreTurned) {
  if (GetParam().periodic) return;
  Uniform random(8);
  const Bounds b = bounds_of(GetParam());
  Stage<float> s(GetParam().dimensions, b, places_of(GetParam(), b, random), Elasticity::neo_hookean);
  s.shake(0.1, random);
  for (std::size_t k = 0; k < s.start.size(); ++k)
    s.p.column(Field::position, 0)[k] = 7.0 + 2.0 * s.p.column(Field::position, 0)[k];
  s.load();
  EXPECT_FALSE(s.work.turns.any());
}

TEST_P(TotalLagrangian, ATurnMakesNoForceAndMomentumIsKept) {
  if (GetParam().periodic) return;
  Uniform random(8);
  const Bounds b = bounds_of(GetParam());
  Stage<double> s(GetParam().dimensions, b, places_of(GetParam(), b, random), Elasticity::neo_hookean);
  const double c = std::cos(1.9), z = std::sin(1.9);
  for (std::size_t k = 0; k < s.start.size(); ++k) {
    s.p.column(Field::position, 0)[k] = 40.0 + c * s.start[k][0] - z * s.start[k][1];
    s.p.column(Field::position, 1)[k] = z * s.start[k][0] + c * s.start[k][1];
  }
  s.load();
  for (std::size_t k = 0; k < s.p.size(); ++k) EXPECT_LT(norm(s.acceleration(k)), 1e-12);
  s.shake(0.1, random);
  s.load();
  Vec3 momentum{}, turning{};
  for (std::size_t k = 0; k < s.p.size(); ++k) {
    const Vec3 a = s.acceleration(k), x = s.start[k] + s.displacement(k);
    momentum = momentum + a;
    turning = turning + Vec3{x[1] * a[2] - x[2] * a[1], x[2] * a[0] - x[0] * a[2], x[0] * a[1] - x[1] * a[0]};
  }
  EXPECT_LT(norm(momentum), 1e-11);
  EXPECT_LT(norm(turning), 1e-10);
}

TEST(TotalLagrangianDamping, IsTheRetardationOfTheStress) {
  // With H = 0 and a uniform rate the stress is t_r (lambda tr E' I + 2 mu E'): that of the strain t_r E' without
  // damping.
  Uniform random(9);
  const Bounds b = box(2, {20, 6, 0}, {false, false, false});
  Stage<double> damped(2, b, lattice(b, 1.0, 0.0, random), Elasticity::neo_hookean, 0.25),
      strained(2, b, damped.start, Elasticity::neo_hookean);
  constexpr double rate = 1e-6;
  for (std::size_t k = 0; k < damped.start.size(); ++k) {
    damped.p.column(Field::velocity, 0)[k] = rate * damped.start[k][0] - 3.0 * rate * damped.start[k][1];
    strained.p.column(Field::position, 0)[k] += 0.25 * damped.p.column(Field::velocity, 0)[k];
  }
  damped.load();
  strained.load();
  for (std::size_t k = 0; k < damped.start.size(); ++k)
    EXPECT_LT(norm(damped.acceleration(k) - strained.acceleration(k)), 1e-4 * rate);
}

TEST(Hyperelastic, StressIsTheSlopeOfTheEnergyAndHookesForSmallStrains) {
  Uniform random(10);
  const ElasticModuli m{3.0, 2.0, 0.0};
  for (const Elasticity law : {Elasticity::neo_hookean, Elasticity::saint_venant_kirchhoff})
    for (const int dimensions : {2, 3}) {
      const auto dim = static_cast<std::size_t>(dimensions);
      std::array<AlignedVector<double>, 9> h;
      for (auto& c : h) c.assign(1, 0.0);
      for (std::size_t c = 0; c < dim * dim; ++c) h[c][0] = random(-1e-7, 1e-7);
      const SolidState small = solid_of(h, 0, dimensions, law, m);
      const double trace = small.strain[0] + small.strain[1] + small.strain[2];
      for (std::size_t c = 0; c < 6; ++c)
        EXPECT_NEAR(small.stress[c], 2.0 * m.mu * small.strain[c] + (c < 3 ? m.lambda * trace : 0.0), 1e-12);
      // Cauchy's stress s of a large gradient: J s = (dpsi/dF) F^T.
      for (std::size_t c = 0; c < dim * dim; ++c) h[c][0] = random(-0.3, 0.3);
      const SolidState large = solid_of(h, 0, dimensions, law, m);
      Tensor f{}, p{};
      for (std::size_t d = 0; d < 3; ++d) f[d][d] = 1.0;
      for (std::size_t d = 0; d < dim; ++d)
        for (std::size_t e = 0; e < dim; ++e) {
          const double at = h[d * dim + e][0];
          f[d][e] += at;
          h[d * dim + e][0] = at + 1e-6;
          const double more = solid_of(h, 0, dimensions, law, m).energy;
          h[d * dim + e][0] = at - 1e-6;
          p[d][e] = (more - solid_of(h, 0, dimensions, law, m).energy) / 2e-6;
          h[d * dim + e][0] = at;
        }
      double j = f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) - f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
                 f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
      constexpr std::size_t places[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
      for (std::size_t d = 0; d < dim; ++d)
        for (std::size_t e = 0; e < dim; ++e) {
          double sum = 0.0;
          for (std::size_t c = 0; c < dim; ++c) sum += p[d][c] * f[e][c];
          EXPECT_NEAR(large.stress[places[d][e]], sum / j, 1e-8);
        }
    }
}

TEST(Hyperelastic, TheStressAcrossThePlaneIsThatOfSpace) {
  // Plane strain is a motion in space without H_zz: both laws give the same stress, zz included.
  Uniform random(11);
  const ElasticModuli m{3.0, 2.0, 0.0};
  for (const Elasticity law : {Elasticity::neo_hookean, Elasticity::saint_venant_kirchhoff}) {
    std::array<AlignedVector<double>, 9> flat, solid;
    for (auto* h : {&flat, &solid})
      for (auto& c : *h) c.assign(1, 0.0);
    for (std::size_t d = 0; d < 2; ++d)
      for (std::size_t e = 0; e < 2; ++e) flat[2 * d + e][0] = solid[3 * d + e][0] = random(-0.3, 0.3);
    const SolidState a = solid_of(flat, 0, 2, law, m), b = solid_of(solid, 0, 3, law, m);
    for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(a.stress[c], b.stress[c], 1e-14);
    EXPECT_NEAR(a.energy, b.energy, 1e-14);
  }
}

TEST(StressFields, PrincipalAndVonMises) {
  const Symmetric pull{5, 0, 0, 0, 0, 0}, shear{0, 0, 0, 2, 0, 0}, pressure{-3, -3, -3, 0, 0, 0};
  EXPECT_NEAR(von_mises_stress(pull), 5.0, 1e-14);
  EXPECT_NEAR(von_mises_stress(shear), 2.0 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(von_mises_stress(pressure), 0.0, 1e-14);
  const auto values = principal_stresses(shear);
  EXPECT_NEAR(values[0], 2.0, 1e-14);
  EXPECT_NEAR(values[1], 0.0, 1e-14);
  EXPECT_NEAR(values[2], -2.0, 1e-14);
}

}  // namespace
}  // namespace barchan
