// The parts of a fluid's rates, for the books of its energy: together they are the rates, each is what its name says,
// and asking for them changes nothing. And the energy of compression against the integral that it is.
#include "models/fluid/rate_parts.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "models/fluid/energy_books.hpp"
#include "unit/naive_fluid.hpp"

namespace barchan {
namespace {

using namespace sets;

struct PartsCase {
  FluidScheme scheme;
  int dimensions;
  bool surface;
  std::string name() const {
    return (scheme == FluidScheme::plain ? "Plain" : "Consistent") + std::to_string(dimensions) + "D" +
           (surface ? "Surface" : "Whole");
  }
};
void PrintTo(const PartsCase& c, std::ostream* out) { *out << c.name(); }

class RatePartsOf : public ::testing::TestWithParam<PartsCase> {};
INSTANTIATE_TEST_SUITE_P(
    Schemes, RatePartsOf,
    ::testing::Values(PartsCase{FluidScheme::plain, 2, false}, PartsCase{FluidScheme::plain, 2, true},
                      PartsCase{FluidScheme::plain, 3, false}, PartsCase{FluidScheme::plain, 3, true},
                      PartsCase{FluidScheme::consistent, 2, false}, PartsCase{FluidScheme::consistent, 2, true},
                      PartsCase{FluidScheme::consistent, 3, false}, PartsCase{FluidScheme::consistent, 3, true}),
    [](const auto& c) { return c.param.name(); });

/// Random fields; with a surface: holes, and spray above.
Cast random_fluid(const PartsCase& c, Uniform& random) {
  const Bounds b =
      c.dimensions == 2 ? box(2, {11, 13, 0}, {true, !c.surface, false}) : box(3, {7, 10, 7}, {true, !c.surface, true});
  std::vector<Vec3> places;
  for (const Vec3& x : lattice(b, 1.0, 0.25, random))
    if (!c.surface || random(0, 1) < (x[1] > 0.75 * b.high[1] ? 0.3 : 0.93)) places.push_back(x);
  std::vector<Field> fields{Field::velocity,     Field::density,        Field::pressure,  Field::acceleration,
                            Field::density_rate, Field::shift_velocity, Field::anisotropy};
  if (c.surface) fields.insert(fields.end(), {Field::wholeness, Field::surface_normal});
  std::vector<PhaseParticles> one;
  one.push_back(phase(c.dimensions, places, 1.2, fields));
  randomise(one[0], Field::density, 1.0, 1.4, random);
  for (const Field f : {Field::velocity, Field::pressure}) randomise(one[0], f, -2, 3, random);
  randomise(one[0], Field::anisotropy, -0.2, 0.2, random);
  if (c.surface) randomise(one[0], Field::surface_normal, -0.2, 0.2, random);
  return Cast(b, std::move(one), {{0, 0, 3.0}});
}

FluidParameters with_everything(const PartsCase& c) {
  FluidParameters q{};
  q.reference_density = 1.15;
  q.sound_speed = 10.0;
  q.smoothing_length = 1.5;
  q.lattice_moment = 1.0;
  q.ends = c.surface;
  q.diffusivity = 0.8;
  q.source_diffusivity = 0.5;
  q.shift_speed = 0.9;
  q.shift_limit = 0.25;
  q.gravity = {0.4, -9.81, c.dimensions == 3 ? 0.7 : 0.0};
  q.acceleration = {1.5, 0.25, 0.0};
  q.void_pressure = -0.9;
  if (c.surface) {
    q.loosening = 3.0;
    q.least_viscosity = 0.3;
    q.surface_depth = 0.5;
    q.stressed = true;
    q.surface_viscosity = 0.6;
    q.layer_share = 0.3;
  } else {
    q.calming = 3.0;
  }
  return q;
}

TEST_P(RatePartsOf, AreTheRates) {
  Uniform random(31);
  Cast cast = random_fluid(GetParam(), random);
  const FluidParameters q = with_everything(GetParam());
  const std::vector<FluidNeighbour> own{{&cast.list(0), &cast.motion[0], KernelKind::wendland_c2, 3.0, 0.07, true}};
  PhaseParticles& fluid = cast.phases[0];
  PhaseParticles before = fluid;
  PartColumns parts;
  parts.fit(fluid.size(), fluid.dimensions());
  parts.centring = 0.003;
  fluid_rate_parts(fluid, cast.motion[0], own, q, GetParam().scheme, parts);
  for (const auto& about : field_table)
    for (int c = 0; fluid.has(about.id) && c < fluid.components(about.id); ++c)
      EXPECT_EQ(std::memcmp(fluid.column(about.id, c), before.column(about.id, c), fluid.size() * sizeof(double)), 0)
          << about.name;
  fluid_rates(fluid, cast.motion[0], own, q, GetParam().scheme);
  std::vector<double> sum(fluid.size());
  for (int d = 0; d < fluid.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    for (std::size_t k = 0; k < fluid.size(); ++k)
      sum[k] = parts.pressure[c][k] + parts.friction[c][k] + parts.stress[c][k] + parts.turning[c][k] +
               parts.carried[c][k] + q.gravity[c] + q.acceleration[c];
    EXPECT_LT(difference(fluid.column(Field::acceleration, d), sum), 1e-12) << d;
  }
  for (std::size_t k = 0; k < fluid.size(); ++k)
    sum[k] = parts.squeezed[k] + parts.diffused[k] + parts.moved[k] + parts.renewed[k];
  EXPECT_LT(difference(fluid.column(Field::density_rate), sum), 1e-12);
}

/// What a part is: it goes with the number that makes it, and no other part does.
TEST_P(RatePartsOf, FollowTheirNumbers) {
  Uniform random(32);
  Cast cast = random_fluid(GetParam(), random);
  const auto parts_of = [&](const FluidParameters& q, double mu) {
    const std::vector<FluidNeighbour> own{{&cast.list(0), &cast.motion[0], KernelKind::wendland_c2, 3.0, mu, true}};
    PartColumns parts;
    parts.fit(cast.phases[0].size(), cast.phases[0].dimensions());
    parts.centring = 0.003;
    fluid_rate_parts(cast.phases[0], cast.motion[0], own, q, GetParam().scheme, parts);
    return parts;
  };
  const FluidParameters q = with_everything(GetParam());
  const PartColumns all = parts_of(q, 0.9);
  FluidParameters less = q;
  less.diffusivity = less.source_diffusivity = 0.0;
  const PartColumns undiffused = parts_of(less, 0.9);
  EXPECT_EQ(all.squeezed, undiffused.squeezed);
  EXPECT_NE(all.diffused, undiffused.diffused);
  less = q;
  less.shift_speed = 0.0;
  const PartColumns unshifted = parts_of(less, 0.9);
  if (GetParam().scheme == FluidScheme::consistent) { EXPECT_NE(all.moved, unshifted.moved); }
  EXPECT_EQ(unshifted.moved, std::vector<double>(all.moved.size(), 0.0));
  less = q;
  less.loosening = less.calming = 0.0;
  const PartColumns kept = parts_of(less, 0.9);
  if (GetParam().surface || GetParam().scheme == FluidScheme::consistent) { EXPECT_NE(all.renewed, kept.renewed); }
  EXPECT_EQ(kept.renewed, std::vector<double>(all.renewed.size(), 0.0));
  less = q;
  less.least_viscosity = 0.0;
  const PartColumns frictionless = parts_of(less, 0.0);
  for (const double f : frictionless.friction[0]) ASSERT_EQ(f, 0.0);
  EXPECT_EQ(frictionless.carried[0], all.carried[0]);
}

TEST(CompressionEnergy, IsTheIntegralOfThePressure) {
  for (const double exponent : {1.0, 7.0})
    for (const double end : {0.9, 1.0001, 1.05}) {
      const PressureLaw law{1000.0, 20.0, exponent, 50.0};
      const int steps = 2000;
      double sum = 0.0;
      for (int k = 0; k < steps; ++k) {  // midpoints
        const double rho = 1000.0 * (1.0 + (end - 1.0) * (k + 0.5) / steps);
        sum += (law(rho) - law.background) / (rho * rho) * 1000.0 * (end - 1.0) / steps;
      }
      EXPECT_NEAR(compression_energy(law, 1000.0 * end) / sum, 1.0, 1e-6) << exponent << " " << end;
      EXPECT_EQ(compression_energy(law, 1000.0), 0.0);
    }
}

}  // namespace
}  // namespace barchan
