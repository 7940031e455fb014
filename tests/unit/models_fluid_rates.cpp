// The fluid pass against naive twins written from the formulas in the heads of the laws, plain and consistent, in two
// and three dimensions, with a wall as second entry; and the exactness that the consistent operators promise.
#include "models/fluid/fluid_rates.hpp"

#include <gtest/gtest.h>

#include "kernels/kernel.hpp"
#include "laws/joined_fluids.hpp"
#include "models/fluid/interface_distance.hpp"
#include "unit/naive_fluid.hpp"

namespace barchan {
namespace {

using namespace sets;

struct RatesCase {
  int dimensions;
  FluidScheme scheme;
  KernelKind kernel;
  std::string name() const {
    return (scheme == FluidScheme::plain ? "Plain" : "Consistent") + std::to_string(dimensions) + "D" +
           (kernel == KernelKind::wendland_c2 ? "Wendland" : "Spline");
  }
};
void PrintTo(const RatesCase& c, std::ostream* out) { *out << c.name(); }

class FluidPass : public ::testing::TestWithParam<RatesCase> {};

/// A perturbed periodic fluid (phase 0) and a wall (phase 1) within reach of some of it, all fields random.
Cast fluid_and_wall(int dimensions, Uniform& random, std::size_t padding = simd::width_in_use<double>()) {
  const Bounds b = dimensions == 2 ? box(2, {9, 8, 0}, {true, true, false}) : box(3, {6, 5, 7}, {true, true, true});
  std::vector<PhaseParticles> two;
  two.push_back(phase(dimensions, lattice(b, 1.0, 0.25, random), 1.2,
                      {Field::velocity, Field::density, Field::pressure, Field::acceleration, Field::density_rate,
                       Field::shift_velocity, Field::anisotropy}));
  two.push_back(
      phase(dimensions, scattered(b, 25, random), 1.0, {Field::velocity, Field::density, Field::pressure}, 1000));
  for (auto& p : two) {
    randomise(p, Field::velocity, -2, 2, random);
    randomise(p, Field::density, 1.0, 1.4, random);
    randomise(p, Field::pressure, -3, 8, random);
  }
  randomise(two[0], Field::anisotropy, -0.2, 0.2, random);
  return Cast(b, std::move(two), {{0, 0, 3.0}, {0, 1, 2.2}}, 0.1, padding);
}

FluidParameters bare() {  // density 1, nothing but pressure and friction
  FluidParameters q{};
  q.reference_density = 1.0;
  q.sound_speed = 10.0;
  return q;
}

FluidParameters parameters(int dimensions) {
  FluidParameters q = bare();
  q.reference_density = 1.15;
  q.sound_speed = 12.0;
  q.diffusivity = 0.8;
  q.source_diffusivity = 0.5;
  q.shift_speed = 0.9;
  q.shift_limit = 0.25;  // some particles are limited, some are not
  q.smoothing_length = 1.5;
  q.gravity = {0.4, -9.81, dimensions == 3 ? 0.7 : 0.0};
  q.acceleration = {1.5, 0.25, dimensions == 3 ? -0.6 : 0.0};
  return q;
}

TEST_P(FluidPass, EqualsTheNaiveSums) {
  const auto [dimensions, scheme, kernel] = GetParam();
  Uniform random(11);
  Cast cast = fluid_and_wall(dimensions, random);
  const std::vector<FluidNeighbour> neighbours{
      {&cast.list(0), &cast.motion[0], kernel, 3.0, 0.7, true},
      {&cast.list(1), &cast.motion[1], KernelKind::cubic_spline, 2.2, 1.9, false}};
  const std::vector<naive::Entry> entries{{0, kernel, 3.0, 0.7, true}, {1, KernelKind::cubic_spline, 2.2, 1.9, false}};
  const FluidParameters q = parameters(dimensions);
  const auto expected = scheme == FluidScheme::plain ? naive::plain_rates(cast, 0, entries, q)
                                                     : naive::consistent_rates(cast, 0, entries, q);
  auto& fluid = cast.phases[0];
  fluid_rates(fluid, cast.motion[0], neighbours, q, scheme);
  // Sums of some thirty terms of both signs in another order; the consistent scheme inverts a matrix besides.
  const double rounding = scheme == FluidScheme::plain ? 1e-13 : 1e-12;
  for (int d = 0; d < dimensions; ++d) {
    const auto c = static_cast<std::size_t>(d);
    EXPECT_LT(difference(fluid.column(Field::acceleration, d), expected.acceleration[c]), rounding);
    EXPECT_LT(difference(fluid.column(Field::shift_velocity, d), expected.shift[c]), rounding);
  }
  EXPECT_LT(difference(fluid.column(Field::density_rate), expected.density), rounding);
  for (int c = 0; scheme == FluidScheme::consistent && c < fluid.components(Field::anisotropy); ++c) {
    EXPECT_LT(difference(fluid.column(Field::anisotropy, c), expected.anisotropy[static_cast<std::size_t>(c)]),
              rounding);
  }
  EXPECT_GT(expected.limited, 0);
  EXPECT_LT(expected.limited, static_cast<int>(fluid.size()));
}

// A particle on the place of another, of its own phase and of the wall: rates are finite in both precisions.
TEST_P(FluidPass, CoincidentParticlesKeepRatesFinite) {
  const auto [dimensions, scheme, kernel] = GetParam();
  for (const bool mixed : {false, true}) {
    Uniform random(11);
    Cast first = fluid_and_wall(dimensions, random);
    auto& phases = first.phases;
    for (int d = 0; d < dimensions; ++d) {
      double* x = phases[0].column(Field::position, d);
      x[1] = x[0];
      phases[1].column(Field::position, d)[0] = x[2];
    }
    const std::size_t padding = mixed ? simd::width_in_use<float>() : simd::width_in_use<double>();
    Cast cast(first.bounds, std::move(phases), first.directions, 0.1, padding);
    std::vector<CompactRecords> compact(2, CompactRecords(cast.bounds));
    for (std::size_t p = 0; p < 2; ++p) {
      const std::size_t n = cast.phases[p].size(), images = cast.neighbours.grid(p).images();
      compact[p].resize(n, images);
      dimensions == 2 ? compact[p].copy<2>(cast.motion[p], n + images) : compact[p].copy<3>(cast.motion[p], n + images);
    }
    const std::vector<FluidNeighbour> neighbours{
        {&cast.list(0), &cast.motion[0], kernel, 3.0, 0.7, true, &compact[0]},
        {&cast.list(1), &cast.motion[1], KernelKind::cubic_spline, 2.2, 1.9, false, &compact[1]}};
    auto& fluid = cast.phases[0];
    if (mixed) fluid_rates(fluid, compact[0], neighbours, parameters(dimensions), scheme);
    else fluid_rates(fluid, cast.motion[0], neighbours, parameters(dimensions), scheme);
    for (std::size_t k = 0; k < fluid.size(); ++k) {
      EXPECT_TRUE(std::isfinite(fluid.column(Field::density_rate)[k])) << k;
      for (int d = 0; d < dimensions; ++d) EXPECT_LT(std::abs(fluid.column(Field::acceleration, d)[k]), 1e4) << k;
    }
  }
}

TEST_P(FluidPass, MixedPrecisionEqualsTheNaiveSumsToSinglePrecision) {
  const auto [dimensions, scheme, kernel] = GetParam();
  Uniform random(11);
  Cast cast = fluid_and_wall(dimensions, random, simd::width_in_use<float>());
  std::vector<CompactRecords> compact(2, CompactRecords(cast.bounds));
  for (std::size_t p = 0; p < 2; ++p) {
    const std::size_t n = cast.phases[p].size(), images = cast.neighbours.grid(p).images();
    compact[p].resize(n, images);
    dimensions == 2 ? compact[p].copy<2>(cast.motion[p], n + images) : compact[p].copy<3>(cast.motion[p], n + images);
  }
  const std::vector<FluidNeighbour> neighbours{
      {&cast.list(0), &cast.motion[0], kernel, 3.0, 0.7, true, &compact[0]},
      {&cast.list(1), &cast.motion[1], KernelKind::cubic_spline, 2.2, 1.9, false, &compact[1]}};
  const std::vector<naive::Entry> entries{{0, kernel, 3.0, 0.7, true}, {1, KernelKind::cubic_spline, 2.2, 1.9, false}};
  const FluidParameters q = parameters(dimensions);
  const auto expected = scheme == FluidScheme::plain ? naive::plain_rates(cast, 0, entries, q)
                                                     : naive::consistent_rates(cast, 0, entries, q);
  auto& fluid = cast.phases[0];
  fluid_rates(fluid, compact[0], neighbours, q, scheme);
  const double rounding = 3e-6;  // some thirty terms of either sign, each to 6e-8
  for (int d = 0; d < dimensions; ++d) {
    const auto c = static_cast<std::size_t>(d);
    EXPECT_LT(difference(fluid.column(Field::acceleration, d), expected.acceleration[c]), rounding);
    EXPECT_LT(difference(fluid.column(Field::shift_velocity, d), expected.shift[c]), rounding);
  }
  const double off = difference(fluid.column(Field::density_rate), expected.density);
  EXPECT_LT(off, rounding);
  EXPECT_GT(off, 1e-12) << "this was meant to be single precision";
}

INSTANTIATE_TEST_SUITE_P(Schemes, FluidPass,
                         ::testing::Values(RatesCase{2, FluidScheme::plain, KernelKind::cubic_spline},
                                           RatesCase{3, FluidScheme::plain, KernelKind::wendland_c2},
                                           RatesCase{2, FluidScheme::consistent, KernelKind::wendland_c2},
                                           RatesCase{2, FluidScheme::consistent, KernelKind::cubic_spline},
                                           RatesCase{3, FluidScheme::consistent, KernelKind::wendland_c2}),
                         [](const auto& c) { return c.param.name(); });

// A few particles in the open, as air among flying grains: the gradient cannot be corrected, and nothing blows up.
TEST(ConsistentOperators, ParticlesWithTooFewNeighboursGoUncorrected) {
  for (const int dimensions : {2, 3}) {
    Uniform random(14);
    const Bounds b = box(dimensions, {9, 9, 9}, {false, false, false});
    std::vector<PhaseParticles> one;
    one.push_back(phase(dimensions, {{1, 1, 1}, {2.2, 1.1, 1}, {1.2, 2.3, 1.4}, {7, 7, 7}}, 1.0,
                        {Field::velocity, Field::density, Field::pressure, Field::acceleration, Field::density_rate,
                         Field::shift_velocity, Field::anisotropy}));
    for (const Field f : {Field::velocity, Field::pressure, Field::anisotropy}) randomise(one[0], f, -0.2, 0.3, random);
    randomise(one[0], Field::density, 0.9, 1.1, random);
    Cast cast(b, std::move(one), {{0, 0, 3.0}});
    auto& fluid = cast.phases[0];
    const std::vector<FluidNeighbour> own{{&cast.list(0), &cast.motion[0], KernelKind::wendland_c2, 3.0, 0.7, true}};
    FluidParameters q = parameters(dimensions);
    q.ends = true;
    const auto expected = naive::consistent_rates(cast, 0, {{0, KernelKind::wendland_c2, 3.0, 0.7, true}}, q);
    fluid_rates(fluid, cast.motion[0], own, q, FluidScheme::consistent);
    EXPECT_EQ(expected.uncorrected, 4);
    for (int d = 0; d < dimensions; ++d)
      EXPECT_LT(difference(fluid.column(Field::acceleration, d), expected.acceleration[static_cast<std::size_t>(d)]),
                1e-12);
    EXPECT_LT(difference(fluid.column(Field::density_rate), expected.density), 1e-12);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(fluid.column(Field::anisotropy, 0)[k], 0.0);
  }
}

// The plain scheme's pair sums do not ask for a shift field.
TEST(FluidPassFields, NoShiftFieldNoShift) {
  Uniform random(12);
  const Bounds b = box(2, {6, 6, 0}, {true, true, false});
  std::vector<PhaseParticles> one;
  one.push_back(phase(2, lattice(b, 1.0, 0.2, random), 1.0,
                      {Field::velocity, Field::density, Field::pressure, Field::acceleration, Field::density_rate}));
  randomise(one[0], Field::density, 0.9, 1.1, random);
  randomise(one[0], Field::pressure, 0.9, 1.1, random);
  Cast cast(b, std::move(one), {{0, 0, 3.0}});
  const std::vector<FluidNeighbour> own{{&cast.list(0), &cast.motion[0], KernelKind::wendland_c2, 3.0, 0.0, true}};
  fluid_rates(cast.phases[0], cast.motion[0], own, parameters(2), FluidScheme::plain);
  EXPECT_FALSE(cast.phases[0].has(Field::shift_velocity));
  EXPECT_NE(cast.phases[0].column(Field::acceleration, 0)[3], 0.0);
}

/// Two fluids, the light one (phase 0) above y = `surface`, the heavy one below.
Cast light_over_heavy(int dimensions, double surface, Uniform& random,
                      std::size_t padding = simd::width_in_use<double>()) {
  const Bounds b = dimensions == 2 ? box(2, {9, 10, 0}, {true, false, false}) : box(3, {6, 8, 7}, {true, false, true});
  std::array<std::vector<Vec3>, 2> places;
  for (const Vec3& x : lattice(b, 1.0, 0.2, random)) places[x[1] > surface ? 0 : 1].push_back(x);
  std::vector<PhaseParticles> two;
  for (const int k : {0, 1}) {
    two.push_back(phase(dimensions, places[static_cast<std::size_t>(k)], k == 0 ? 1.2 : 1200.0,
                        {Field::velocity, Field::density, Field::pressure, Field::acceleration, Field::density_rate,
                         Field::shift_velocity, Field::anisotropy},
                        1000 * k));
    std::fill_n(two.back().column(Field::density), two.back().size(), two.back().mass());
  }
  return Cast(b, std::move(two), {{0, 0, 3.0}, {0, 1, 2.6}, {1, 1, 3.0}, {1, 0, 2.6}}, 0.1, padding);
}

/// The distances of both fluids' particles from the plane y = `surface`, in their records (2D) and as arrays. No plane
/// is found: all between the weights of the two fluids is weight.
struct Distances {
  std::array<std::vector<double>, 2> plain;
  std::array<EddyRecords, 2> records;
  std::array<InterfacePlanes, 2> planes;
  Distances(Cast& cast, double surface, std::vector<CompactRecords>* compact = nullptr) {
    for (std::size_t p = 0; p < 2; ++p) {
      const PhaseParticles& fluid = cast.phases[p];
      const CellGrid& grid = cast.neighbours.grid(p);
      records[p].resize(fluid.size(), grid.images());
      planes[p].normal.assign(fluid.size() * static_cast<std::size_t>(fluid.dimensions()), 0.0);
      planes[p].spread.assign(fluid.size(), 0.0);
      for (std::size_t k = 0; k < fluid.size(); ++k) {
        plain[p].push_back(std::max(std::abs(position(fluid, k)[1] - surface), 0.01));
        records[p].root[k] = plain[p][k];
      }
      records[p].fill_images(fluid.size(), grid);
      if (fluid.dimensions() != 2) continue;
      const std::size_t all = fluid.size() + grid.images();
      if (compact) records[p].give_roots((*compact)[p], all);
      records[p].give_roots(cast.motion[p], all);
    }
  }
};

// Two fluids joined by an entry: random fields, so that pressure differences lie on both sides of what is weight.
TEST(JoinedFluids, EqualTheNaiveSums) {
  for (const int dimensions : {2, 3}) {
    for (const bool mixed : {false, true}) {
      Uniform random(15);
      const double surface = dimensions == 2 ? 5.0 : 4.0;
      Cast cast = light_over_heavy(dimensions, surface, random,
                                   mixed ? simd::width_in_use<float>() : simd::width_in_use<double>());
      for (auto& p : cast.phases) {
        randomise(p, Field::velocity, -2, 2, random);
        randomise(p, Field::pressure, -9000, 9000, random);
        randomise(p, Field::anisotropy, -0.2, 0.2, random);
      }
      cast.pack();
      std::vector<CompactRecords> compact(2, CompactRecords(cast.bounds));
      for (std::size_t p = 0; p < 2; ++p) {
        const std::size_t n = cast.phases[p].size(), images = cast.neighbours.grid(p).images();
        compact[p].resize(n, images);
        dimensions == 2 ? compact[p].copy<2>(cast.motion[p], n + images)
                        : compact[p].copy<3>(cast.motion[p], n + images);
      }
      const Distances distances(cast, surface, &compact);
      FluidParameters q = parameters(dimensions);
      q.reference_density = 1.2;
      q.distances = &distances.records[0];
      q.planes = &distances.planes[0];
      const auto spline = KernelKind::wendland_c2;
      const std::vector<FluidNeighbour> neighbours{
          {&cast.list(0), &cast.motion[0], spline, 3.0, 0.7, true, &compact[0]},
          {&cast.list(1), &cast.motion[1], spline, 2.6, 1.3, false, &compact[1], 1200.0, 9.0, &distances.records[1]}};
      const auto expected =
          naive::consistent_rates(cast, 0,
                                  {{0, spline, 3.0, 0.7, true},
                                   {1, spline, 2.6, 1.3, false, 1200.0, 9.0, &distances.plain[0], &distances.plain[1]}},
                                  q);
      auto& fluid = cast.phases[0];
      if (mixed) fluid_rates(fluid, compact[0], neighbours, q, FluidScheme::consistent);
      else fluid_rates(fluid, cast.motion[0], neighbours, q, FluidScheme::consistent);
      const double rounding = mixed ? 1e-5 : 1e-12;
      for (int d = 0; d < dimensions; ++d)
        EXPECT_LT(difference(fluid.column(Field::acceleration, d), expected.acceleration[static_cast<std::size_t>(d)]),
                  rounding);
      EXPECT_LT(difference(fluid.column(Field::density_rate), expected.density), rounding);
    }
  }
}

// At rest, whatever the arrangement: the weight of the heavy fluid accelerates neither. Of the pull towards the middle
// between two particles, a hundredth of the weights' difference, a fraction is left. And where the distances are those
// of a plane, a shear stress that is the same in both fluids accelerates neither: the velocity is linear in each.
TEST(JoinedFluids, StayAtRestAndBearOneShearStress) {
  constexpr double g = 9.81, surface = 5.0, stress = 3.0;
  const std::array<double, 2> viscosity{0.02, 5.0};
  for (const std::size_t who : {0u, 1u}) {
    Uniform random(16);
    Cast cast = light_over_heavy(2, surface, random);
    for (std::size_t phase = 0; phase < 2; ++phase) {
      PhaseParticles& p = cast.phases[phase];
      for (std::size_t k = 0; k < p.size(); ++k) {
        const double y = position(p, k)[1] - surface;
        p.column(Field::pressure)[k] = -p.mass() * g * y;
        p.column(Field::velocity, 0)[k] = stress / viscosity[phase] * y;
      }
    }
    cast.pack();
    const Distances distances(cast, surface);
    FluidParameters q = bare();
    q.reference_density = cast.phases[who].mass();
    q.gravity = {0, -g, 0};
    q.distances = &distances.records[who];
    q.planes = &distances.planes[who];
    const auto wendland = KernelKind::wendland_c2;
    const std::size_t own = who == 0 ? 0 : 2;
    std::vector<FluidNeighbour> neighbours{
        {&cast.list(own), &cast.motion[who], wendland, 3.0, viscosity[who], true},
        {&cast.list(own + 1), &cast.motion[1 - who], wendland, 2.6, 0, false, nullptr, cast.phases[1 - who].mass(),
         viscosity[1 - who], &distances.records[1 - who]}};
    auto& fluid = cast.phases[who];
    fluid_rates(fluid, cast.motion[who], neighbours, q, FluidScheme::consistent);
    std::array<std::vector<double>, 2> rubbed;
    for (std::size_t d = 0; d < 2; ++d) {
      const double* a = fluid.column(Field::acceleration, static_cast<int>(d));
      rubbed[d].assign(a, a + fluid.size());
    }
    for (int c = 0; c < 2; ++c) std::fill_n(fluid.column(Field::anisotropy, c), fluid.size(), 0.0);
    neighbours[0].viscosity = neighbours[1].beyond = 0.0;
    fluid_rates(fluid, cast.motion[who], neighbours, q, FluidScheme::consistent);
    int near = 0;
    for (std::size_t k = 0; k < fluid.size(); ++k) {
      const double y = position(fluid, k)[1];
      if (y < 3.6 || y > 6.4) continue;
      ++near;
      for (std::size_t d = 0; d < 2; ++d)
        EXPECT_NEAR(rubbed[d][k], fluid.column(Field::acceleration, static_cast<int>(d))[k], 1e-11 * stress);
      EXPECT_LT(std::hypot(rubbed[0][k], rubbed[1][k]), 0.005 * g);
    }
    EXPECT_GT(near, 5);
  }
}

// What a gives b gets, whatever their viscosities and distances: m_a f_ab = -m_b f_ba.
TEST(JoinedFluids, RubAsOneOnTheOther) {
  using Law = JoinedFluids<2>;
  const std::array<double, 2> mu{3.0, 0.004}, distance{0.3, 1.1}, r{0.7, -1.2}, back{-0.7, 1.2};
  const std::array<std::array<double, 2>, 2> v{{{1.0, 2.0}, {-0.5, 0.25}}};
  std::array<std::array<double, 2>, 2> force;
  for (std::size_t a : {0u, 1u}) {
    const std::size_t b = 1 - a;
    Law::Own<double> own{};
    own.v = v[a];
    own.distance = distance[a];
    own.share = 1.0;
    own.rubbing = mu[b] / mu[a];
    Law::Sums<double> s{};
    Law::add(own, a == 0 ? r : back, 1.93, -0.4, v[b].data(), 0.0, 1.0, distance[b], s);
    for (std::size_t d = 0; d < 2; ++d) force[a][d] = mu[a] * s.viscous[d];
  }
  for (std::size_t d = 0; d < 2; ++d) EXPECT_NEAR(force[0][d], -force[1][d], 1e-14 * std::abs(force[0][d]));
}

/// Rows of two fluids on both sides of y = 0, strained by `strain` across it, so many of each; coordinates moved by at
/// most `perturb` spacings.
Cast rows_beside_an_interface(int dimensions, double strain, double perturb, Uniform& random) {
  const double wide = dimensions == 2 ? 12.0 / (1.0 + strain) : 7.0 / std::sqrt(1.0 + strain);
  const int along = dimensions == 2 ? 12 : 7;
  const Bounds b = box(dimensions, {wide, 12.0 * (1.0 + strain), wide}, {true, false, dimensions == 3},
                       {0, -6.0 * (1.0 + strain), 0});
  std::vector<PhaseParticles> two;
  for (const int side : {1, -1}) {
    std::vector<Vec3> places;
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < along; ++i)
        for (int k = 0; k < (dimensions == 3 ? along : 1); ++k)
          places.push_back({wide / along * (i + 0.5 + random(-perturb, perturb)),
                            side * (1.0 + strain) * (j + 0.5 + random(-perturb, perturb)),
                            dimensions == 3 ? wide / along * (k + 0.5 + random(-perturb, perturb)) : 0.0});
    two.push_back(phase(dimensions, places, 1.0, {}, side == 1 ? 0 : 1000));
  }
  return Cast(b, std::move(two), {{0, 0, 2.6}, {0, 1, 2.6}, {1, 1, 2.6}, {1, 0, 2.6}});
}

/// The largest and the mean square error of the first row's distances.
std::array<double, 2> distance_errors(int dimensions, double strain, double perturb) {
  Uniform random(17);
  Cast cast = rows_beside_an_interface(dimensions, strain, perturb, random);
  const auto wendland = KernelKind::wendland_c2;
  const InterfaceDistance distance({wendland, 2.6, 1.0}, {wendland, 2.6, 1.0}, dimensions);
  const std::vector<PairEntry<InterfaceSide>> entries{{&cast.list(0), &cast.motion[0], wendland, 2.6, {{}, 1.0}},
                                                      {&cast.list(1), &cast.motion[1], wendland, 2.6, {{}, 0.0}}};
  const PhaseParticles& p = cast.phases[0];
  AlignedVector<double> found(p.size());
  find_interface(p.size(), dimensions, cast.motion[0], entries, distance, found);
  std::array<double, 2> error{};
  int count = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double y = position(p, k)[1];
    if (y > 0.95 * (1.0 + strain)) continue;
    ++count;
    error[0] = std::max(error[0], std::abs(found[k] - y));
    error[1] += (found[k] - y) * (found[k] - y);
  }
  EXPECT_GE(count, 12);
  return {error[0], std::sqrt(error[1] / count)};
}

// The first row of a lattice is half a spacing from the interface, to rounding of the table, and about as exactly where
// the fluids are strained; of disturbed particles the distance is known to a fraction of what they are moved by.
TEST(InterfaceDistance, OfRows) {
  for (const int dimensions : {2, 3}) {
    EXPECT_LT(distance_errors(dimensions, 0.0, 0.0)[0], 1e-3);
    for (const double strain : {-0.1, 0.1}) EXPECT_LT(distance_errors(dimensions, strain, 0.0)[0], 0.02);
    EXPECT_LT(distance_errors(dimensions, 0.0, 0.2)[1], 0.08);
  }
}

/// A perturbed block of fluid with given pressure and velocity, rates by the consistent scheme, twice, so that the
/// weights of the Laplacian are those of this arrangement.
class ConsistentBlock {
 public:
  template <class Pressure, class Velocity>
  ConsistentBlock(int dimensions, double perturb, int passes, const FluidParameters& q, double mu, Pressure&& p_of,
                  Velocity&& v_of)
      : cast_(make(dimensions, perturb, p_of, v_of)) {
    const std::vector<FluidNeighbour> own{{&cast_.list(0), &cast_.motion[0], KernelKind::wendland_c2, 3.0, mu, true}};
    for (int k = 0; k < passes; ++k) fluid_rates(cast_.phases[0], cast_.motion[0], own, q, FluidScheme::consistent);
  }
  /// Calls f(k, x) for every particle whose whole support lies inside the block.
  template <class F>
  void inside(F&& f) const {
    int seen = 0;
    for (std::size_t k = 0; k < cast_.phases[0].size(); ++k) {
      const Vec3 x = position(cast_.phases[0], k);
      bool deep = true;
      for (std::size_t d = 0; d < static_cast<std::size_t>(cast_.bounds.dimensions); ++d)
        deep = deep && x[d] > 3.6 && x[d] < cast_.bounds.high[d] - 3.6;
      if (!deep) continue;
      ++seen;
      f(k, x);
    }
    EXPECT_GT(seen, 5);
  }
  double acceleration(std::size_t k, int d) const { return cast_.phases[0].column(Field::acceleration, d)[k]; }
  double density_rate(std::size_t k) const { return cast_.phases[0].column(Field::density_rate)[k]; }
  Vec3 shift(std::size_t k) const { return vector(cast_.phases[0], Field::shift_velocity, k); }

 private:
  template <class Pressure, class Velocity>
  static Cast make(int dimensions, double perturb, Pressure&& p_of, Velocity&& v_of) {
    Uniform random(13);
    const Bounds b =
        dimensions == 2 ? box(2, {12, 12, 0}, {false, false, false}) : box(3, {10, 10, 10}, {false, false, false});
    std::vector<PhaseParticles> one;
    one.push_back(phase(dimensions, lattice(b, 1.0, perturb, random), 1.0,
                        {Field::velocity, Field::density, Field::pressure, Field::acceleration, Field::density_rate,
                         Field::shift_velocity, Field::anisotropy}));
    auto& p = one[0];
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Vec3 x = position(p, k), v = v_of(x);
      p.column(Field::density)[k] = 1.0;
      p.column(Field::pressure)[k] = p_of(x);
      for (int d = 0; d < dimensions; ++d) p.column(Field::velocity, d)[k] = v[static_cast<std::size_t>(d)];
    }
    return Cast(b, std::move(one), {{0, 0, 3.0}});
  }
  Cast cast_;
};

Vec3 at_rest(const Vec3&) { return {0, 0, 0}; }
double no_pressure(const Vec3&) { return 0.0; }

TEST(ConsistentOperators, PressureGradientIsExactForLinearFields) {
  for (const int dimensions : {2, 3}) {
    const ConsistentBlock block(
        dimensions, 0.3, 1, bare(), 0.9, [](const Vec3& x) { return 3.0 + 2.0 * x[0] - 5.0 * x[1] + 0.5 * x[2]; },
        at_rest);
    block.inside([&](std::size_t k, const Vec3&) {
      EXPECT_NEAR(block.acceleration(k, 0), -2.0, 1e-10);
      EXPECT_NEAR(block.acceleration(k, 1), 5.0, 1e-10);
      if (dimensions == 3) { EXPECT_NEAR(block.acceleration(k, 2), -0.5, 1e-10); }
    });
  }
}

// Divergence 0.75 (0.5 in 2D), no friction, and the transported rate du . grad v.
TEST(ConsistentOperators, VelocityGradientIsExactForLinearFields) {
  for (const int dimensions : {2, 3}) {
    FluidParameters q = bare();
    q.shift_speed = 0.5;
    q.shift_limit = 0.1;
    q.smoothing_length = 1.5;
    const auto linear = [](const Vec3& x) {
      return Vec3{1.0 + 2.0 * x[0] + 3.0 * x[1] - x[2], -0.7 * x[0] - 1.5 * x[1], 0.2 * x[0] + 0.25 * x[2]};
    };
    const ConsistentBlock block(dimensions, 0.3, 1, q, 1e3, no_pressure, linear);
    const Vec3 origin = linear({0, 0, 0});
    block.inside([&](std::size_t k, const Vec3&) {
      EXPECT_NEAR(block.density_rate(k), dimensions == 2 ? -0.5 : -0.75, 1e-10);
      const Vec3 du = block.shift(k), transported = linear(du) - origin;
      EXPECT_GT(norm(du), 0.0);
      for (int d = 0; d < dimensions; ++d)  // the friction is mu times a sum that cancels: 1e3 times the rounding
        EXPECT_NEAR(block.acceleration(k, d), transported[static_cast<std::size_t>(d)], 1e-10);
    });
  }
}

// A quadratic velocity: the Laplacian needs the second moments, which the weights of the pass before make isotropic.
TEST(ConsistentOperators, LaplacianOfAQuadraticIsCorrectedForAnisotropy) {
  for (const int dimensions : {2, 3}) {
    const auto quadratic = [](const Vec3& x) {
      return Vec3{x[0] * x[0] - 3.0 * x[1] * x[1], x[0] * x[1], 0.5 * x[2] * x[2]};
    };
    const auto rms_error = [&](int passes) {
      const ConsistentBlock block(dimensions, 0.15, passes, bare(), 1.0, no_pressure, quadratic);
      double sum = 0.0;
      int n = 0;
      block.inside([&](std::size_t k, const Vec3&) {
        sum += std::pow(block.acceleration(k, 0) + 4.0, 2) + std::pow(block.acceleration(k, 1), 2);
        ++n;
      });
      return std::sqrt(sum / n);
    };
    const double bare = rms_error(1), corrected = rms_error(2);
    // 0.26 and 0.22 of a Laplacian of 4 without the weights, 0.028 and 0.021 with them: what is left comes from the
    // third moments, which first-order weights leave alone.
    EXPECT_LT(corrected, 0.01 * 4.0);
    EXPECT_LT(corrected, 0.15 * bare);
  }
}

}  // namespace
}  // namespace barchan
