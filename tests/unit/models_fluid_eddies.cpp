// Eddies: the pair's viscosity is the logarithmic mean, the distance to the ground that of a search through everything,
// and without eddies the pass gives what the laminar one gives.
#include "models/fluid/turbulence.hpp"

#include <gtest/gtest.h>

#include <random>

#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

TEST(PairViscosity, IsTheLogarithmicMean) {
  EXPECT_DOUBLE_EQ(pair_viscosity(2.0, 2.0), 4.0);
  for (const double ratio : {1.5, 3.0, 5.0}) {
    const double exact = (ratio - 1.0) / std::log(ratio);
    EXPECT_NEAR(pair_viscosity(1.0, std::sqrt(ratio)) / exact, 1.0, ratio > 3.0 ? 3e-3 : 6e-4) << ratio;
  }
}

TEST(EddyViscosity, SolvesItsEquation) {
  // phi = (nu + nu_t)|S|, nu_t = l^2 |S|
  const double nu = 1e-5, length = 2e-3, shear = 300.0, nu_t = length * length * shear;
  EXPECT_NEAR(eddy_viscosity(nu, length, (nu + nu_t) * shear), nu_t, 1e-12);
}

TEST(LogLaw, IsFollowedAboveAQuarterOfASpacing) {
  EXPECT_DOUBLE_EQ(log_law_friction(0.01, 1e-4, 1e-3), std::pow(0.4 / std::log(100.0), 2));
  EXPECT_DOUBLE_EQ(log_law_friction(0.0, 1e-4, 1e-3), log_law_friction(2.5e-4, 1e-4, 1e-3));
}

/// A floor of the domain, a periodic x, and a heap of grains with one in flight.
TEST(GroundDistance, IsThatOfASearchThroughEverything) {
  const double dx = 0.02;
  Bounds bounds{2, {0, 0, 0}, {1, 0.6, 0}, {true, false, false}};
  Sides sides;
  sides.low[1] = 0.0;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Vec3> grains;
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 8; ++j) grains.push_back({0.93 + k * dx - (k > 3 ? 1.0 : 0.0), 0.01 + j * dx, 0});
  PhaseParticles sand("sand", 2, grains.size() + 1, 1.0, 0);
  for (const Field f : {Field::position, Field::velocity}) sand.add(f);
  for (std::size_t k = 0; k <= grains.size(); ++k)
    for (int d = 0; d < 2; ++d)
      sand.column(Field::position, d)[k] = k < grains.size() ? grains[k][static_cast<std::size_t>(d)] : 0.45;
  GroundDistance ground(bounds, sides, dx, true);
  const GroundDistance::Ground phases[] = {{&sand, dx}};
  ground.refresh(phases);
  double worst = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3 x{uniform(random), 0.6 * uniform(random), 0};
    double naive = x[1];
    for (const Vec3& g : grains) {
      double r = x[0] - g[0];
      r -= std::round(r);
      naive = std::min(naive, std::hypot(r, x[1] - g[1]) - 0.5 * dx);
    }
    worst = std::max(worst, std::abs(ground.distance(x) - std::max(naive, 0.0)));
  }
  EXPECT_LT(worst, 0.05 * dx) << "and the grain in flight is no ground";
}

/// A periodic fluid with random fields and a smooth wall in it.
sets::Cast eddies_and_wall(int dimensions, bool mixed) {
  sets::Uniform random(31);
  const Bounds b =
      dimensions == 2 ? sets::box(2, {9, 8, 0}, {true, true, false}) : sets::box(3, {6, 5, 7}, {true, true, true});
  std::vector<PhaseParticles> two;
  two.push_back(sets::phase(dimensions, sets::lattice(b, 1.0, 0.2, random), 1.2,
                            {Field::velocity, Field::density, Field::pressure, Field::acceleration, Field::density_rate,
                             Field::shift_velocity, Field::anisotropy, Field::eddy_viscosity, Field::ground_distance}));
  two.push_back(sets::phase(dimensions, sets::scattered(b, 25, random), 1.0,
                            {Field::velocity, Field::density, Field::pressure}, 1000));
  for (auto& p : two) {
    sets::randomise(p, Field::velocity, -2, 2, random);
    sets::randomise(p, Field::density, 1.0, 1.4, random);
    sets::randomise(p, Field::pressure, -3, 8, random);
  }
  sets::randomise(two[0], Field::anisotropy, -0.2, 0.2, random);
  return {b,
          std::move(two),
          {{0, 0, 3.0}, {0, 1, 2.2}},
          0.1,
          mixed ? simd::width_in_use<float>() : simd::width_in_use<double>()};
}

/// The rates of that fluid: of the laminar pass, or of the turbulent one with all viscosities equal. `roots`: each
/// particle brings its own; otherwise all have the entry's.
sets::Cast rated(int dimensions, bool mixed, bool turbulent, bool roots) {
  constexpr double mu = 0.7, density = 1.15;
  sets::Cast cast = eddies_and_wall(dimensions, mixed);
  FluidParameters q{};
  q.reference_density = density;
  q.sound_speed = 12.0;
  q.diffusivity = 0.8;
  q.smoothing_length = 1.5;
  q.gravity = {0.4, -9.81, 0.0};
  std::vector<CompactRecords> compact(2, CompactRecords(cast.bounds));
  std::array<std::size_t, 2> count{};
  for (std::size_t p = 0; p < 2; ++p) {
    count[p] = cast.phases[p].size() + cast.neighbours.grid(p).images();
    compact[p].resize(cast.phases[p].size(), cast.neighbours.grid(p).images());
    dimensions == 2 ? compact[p].copy<2>(cast.motion[p], count[p]) : compact[p].copy<3>(cast.motion[p], count[p]);
  }
  const std::vector<FluidNeighbour> pairs{
      {&cast.list(0), &cast.motion[0], KernelKind::wendland_c2, 3.0, mu, true, &compact[0]},
      {&cast.list(1), &cast.motion[1], KernelKind::cubic_spline, 2.2, mu, true, &compact[1]}};
  auto& fluid = cast.phases[0];
  EddyParameters none;
  none.density = density;
  none.viscosity = mu / density;
  EddyRecords records;
  records.resize(fluid.size(), cast.neighbours.grid(0).images());
  std::fill_n(records.root.begin(), fluid.size(), std::sqrt(mu));
  records.fill_images(fluid.size(), cast.neighbours.grid(0));
  if (dimensions == 2) records.give_roots(compact[0], count[0]);
  if (dimensions == 2) records.give_roots(cast.motion[0], count[0]);
  std::vector<EddyNeighbour> entries(2);
  for (std::size_t c = 0; c < 2; ++c) entries[c].pair = pairs[c];
  entries[0].eddies = roots ? &records : nullptr;
  entries[0].root = std::sqrt(mu);
  entries[1].friction = Friction::smooth;
  const auto rate = [&](const auto& own) {
    if (turbulent) eddy_rates(fluid, own, records, entries, q, none);
    else fluid_rates(fluid, own, pairs, q, FluidScheme::consistent);
  };
  if (mixed) rate(compact[0]);
  else rate(cast.motion[0]);
  return cast;
}

/// Largest difference of a column, in units of its largest value.
double difference(const sets::Cast& one, const sets::Cast& other, Field field, int component) {
  double worst = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < one.phases[0].size(); ++k) {
    const double a = one.phases[0].column(field, component)[k];
    worst = std::max(worst, std::abs(other.phases[0].column(field, component)[k] - a));
    largest = std::max(largest, std::abs(a));
  }
  EXPECT_GT(largest, 0.0);
  return worst / largest;
}

TEST(EddyRates, WithoutEddiesAreTheLaminarOnes) {
  for (const int dimensions : {2, 3})
    for (const bool mixed : {false, true})
      for (const bool roots : {false, true}) {
        SCOPED_TRACE(::testing::Message() << dimensions << "D, " << (mixed ? "mixed" : "double") << ", roots of "
                                          << (roots ? "each" : "the entry"));
        const auto laminar = rated(dimensions, mixed, false, roots), turbulent = rated(dimensions, mixed, true, roots);
        const double rounding = mixed ? 1e-6 : 1e-13;
        for (int d = 0; d < dimensions; ++d)
          EXPECT_LT(difference(laminar, turbulent, Field::acceleration, d), rounding);
        EXPECT_LT(difference(laminar, turbulent, Field::density_rate, 0), rounding);
      }
}

}  // namespace
}  // namespace barchan
