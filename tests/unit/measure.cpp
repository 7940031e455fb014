// Measuring: the search against the slow way, fits against fields that they reproduce, averages against a calculation
// by hand, and the simulation left as it was.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cstring>

#include "measure/measurements.hpp"
#include "physics/small_scenes.hpp"
#include "unit/particle_sets.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::square_text;
using testing::with;

constexpr double spacing = 0.1, radius = 0.28;

/// The instruments of a run.
Measurements measurements(const Simulation& run) {
  std::vector<double> densities;
  for (const auto& p : run.scene().phases) densities.push_back(p.density);
  return {run.plan().instruments, run.plan().bounds, densities};
}

/// Fluid at these places, of volume spacing^d, at rest.
PhaseParticles fluid_at(const std::vector<Vec3>& x, int dimensions) {
  PhaseParticles p("air", dimensions, x.size(), 2.0 * std::pow(spacing, dimensions), 0);
  for (const Field f : {Field::position, Field::velocity, Field::density, Field::pressure}) p.add(f);
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (int d = 0; d < dimensions; ++d) p.column(Field::position, d)[i] = x[i][static_cast<std::size_t>(d)];
    p.column(Field::density)[i] = 2.0;
  }
  return p;
}

/// Sets velocity component c (the pressure behind the last) of every particle to f(x).
template <class F>
void set(PhaseParticles& p, int c, F&& f) {
  double* column = c < p.dimensions() ? p.column(Field::velocity, c) : p.column(Field::pressure);
  for (std::size_t i = 0; i < p.size(); ++i) {
    Vec3 x{};
    for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[i];
    column[i] = f(x);
  }
}

class Dimensions : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Measure, Dimensions, ::testing::Values(2, 3));

TEST_P(Dimensions, LookupFindsWhoIsNear) {
  sets::Uniform random(1);
  for (const Vec3 size : {Vec3{2.0, 1.1, 0.9}, Vec3{0.6, 0.57, 0.6}})  // many cells; two a period, each visited once
    for (const bool periodic : {false, true}) {
      const Bounds b = sets::box(GetParam(), size, {periodic, false, periodic}, {-0.3, 0.2, 0.1});
      const auto x = sets::scattered(b, 500, random);
      Lookup lookup(b, radius);
      const auto p = fluid_at(x, GetParam());
      lookup.build(p);
      for (const Vec3& at : sets::scattered(b, 50, random)) {
        std::vector<std::size_t> found, expected;
        lookup.neighbours(at, [&](std::size_t i, const Vec3& r, double r2) {
          found.push_back(i);
          EXPECT_DOUBLE_EQ(dot(r, r), r2);
        });
        for (std::size_t i = 0; i < x.size(); ++i) {
          Vec3 r = x[i] - at;
          for (std::size_t d = 0; d < 3; ++d)
            if (b.periodic[d] && size[d] > 0 && d < static_cast<std::size_t>(GetParam()))
              r[d] -= size[d] * std::round(r[d] / size[d]);
          if (norm(r) < radius) expected.push_back(i);
        }
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected);
      }
    }
}

TEST_P(Dimensions, InterpolationIsExactForALinearFieldOnDisturbedParticles) {
  const int dimensions = GetParam();
  sets::Uniform random(2);
  const Bounds b = sets::box(dimensions, {1, 1, 1}, {false, false, false});
  auto p = fluid_at(sets::lattice(b, spacing, 0.3, random), dimensions);
  const auto field = [](int c, const Vec3& x) { return 0.5 + c + (1 - c) * x[0] + 3 * x[1] - c * x[2]; };
  for (int c = 0; c <= dimensions; ++c) set(p, c, [&](const Vec3& x) { return field(c, x); });
  Lookup lookup(b, radius);
  lookup.build(p);
  const FluidView fluid(p);
  for (const KernelKind kind : {KernelKind::cubic_spline, KernelKind::wendland_c2}) {
    int found = 0;
    auto places = sets::scattered(b, 40, random);
    places.push_back(b.low);  // a corner, where a quarter or an eighth of the kernel is covered
    places.push_back({0.5, 0.0, dimensions == 3 ? 0.5 : 0.0});
    for (const Vec3& at : places) {
      const Reading r = interpolate(at, fluid, lookup, ReadyKernel(kind, radius, dimensions), radius);
      if (!r.found) continue;  // in a corner, where too little of the kernel is covered
      ++found;
      for (int c = 0; c <= dimensions; ++c) EXPECT_NEAR(r.value[static_cast<std::size_t>(c)], field(c, at), 1e-11) << c;
    }
    EXPECT_GT(found, 35);
    const Reading middle = interpolate({0.5, 0.5, dimensions == 3 ? 0.5 : 0.0}, fluid, lookup,
                                       ReadyKernel(kind, radius, dimensions), radius);
    EXPECT_NEAR(middle.fraction, 1.0, 0.1);
  }
}

TEST(Interpolation, FewParticlesGiveTheirMeanAndNoneGiveNothing) {
  const Bounds b = sets::box(2, {1, 1, 0}, {false, false, false});
  const ReadyKernel kernel(KernelKind::wendland_c2, radius, 2);
  auto p = fluid_at({{0.5, 0.5, 0}}, 2);
  set(p, 0, [](const Vec3&) { return 7.0; });
  Lookup lookup(b, radius);
  lookup.build(p);
  const Reading near = interpolate({0.52, 0.5, 0}, FluidView(p), lookup, kernel, radius);
  EXPECT_TRUE(near.found);
  EXPECT_DOUBLE_EQ(near.value[0], 7.0);
  EXPECT_LT(near.fraction, 0.5);
  EXPECT_FALSE(interpolate({0.77, 0.5, 0}, FluidView(p), lookup, kernel, radius).found) << "at the kernel's rim";
  EXPECT_FALSE(interpolate({0.1, 0.1, 0}, FluidView(p), lookup, kernel, radius).found);
}

TEST_P(Dimensions, SlopeAtAWallIsExactForAParabolaThatChangesAlongTheWall) {
  const int dimensions = GetParam();
  sets::Uniform random(3);
  const Bounds b = sets::box(dimensions, {1, 1, 1}, {false, false, false});
  auto p = fluid_at(sets::lattice(b, spacing, 0.2, random), dimensions);
  const Vec3 at{0.5, 1.0, dimensions == 3 ? 0.5 : 0.0}, wall{0.25, 0, 0};
  const auto profile = [&](const Vec3& x) {
    const double n = 1.0 - x[1];
    return 0.25 + 0.01 + n * (4.0 + 2.0 * (x[0] - at[0]) - (x[2] - at[2])) - 3.0 * n * n;
  };
  set(p, 0, profile);
  set(p, dimensions, [](const Vec3& x) { return 5.0 * x[0] + x[1]; });
  Lookup lookup(b, 1.5 * radius);
  lookup.build(p);
  const Reading r = wall_slope({at, {0.0, -1.0, 0.0}, wall}, FluidView(p), lookup,
                               ReadyKernel(KernelKind::wendland_c2, 1.5 * radius, dimensions), 1.5 * radius);
  ASSERT_TRUE(r.found);
  EXPECT_NEAR(r.value[0], 4.0, 1e-10) << "a slip of 0.01 is no shear";
  EXPECT_NEAR(r.value[1], 0.0, 1e-10);
  EXPECT_NEAR(r.value[static_cast<std::size_t>(dimensions)], 3.5, 1e-11) << "pressure";
}

/// On ground that leans, the slope is that along the normal, and what is across the wall is no shear.
TEST_P(Dimensions, SlopeAtALeaningWallIsExactForAParabola) {
  const int dimensions = GetParam();
  sets::Uniform random(5);
  const Bounds b = sets::box(dimensions, {1, 1, 1}, {false, false, false});
  auto p = fluid_at(sets::lattice(b, spacing, 0.2, random), dimensions);
  const Vec3 at{0.5, 0.4, dimensions == 3 ? 0.5 : 0.0};
  const Vec3 normal = dimensions == 3 ? Vec3{-0.36, 0.8, 0.48} : Vec3{-0.6, 0.8, 0.0};
  const Vec3 along = dimensions == 3 ? (1.0 / std::hypot(0.8, 0.36)) * Vec3{0.8, 0.36, 0.0} : Vec3{0.8, 0.6, 0.0};
  const auto speed = [&](const Vec3& x) {
    const double n = dot(normal, x - at), s = dot(along, x - at);
    return 0.01 + n * (4.0 + 2.0 * s) - 3.0 * n * n;
  };
  for (int c = 0; c < dimensions; ++c)
    set(p, c, [&](const Vec3& x) {
      const auto d = static_cast<std::size_t>(c);
      return speed(x) * along[d] + 2.5 * dot(normal, x - at) * normal[d];
    });
  Lookup lookup(b, 1.5 * radius);
  lookup.build(p);
  const Reading r = wall_slope({at, normal, {}}, FluidView(p), lookup,
                               ReadyKernel(KernelKind::wendland_c2, 1.5 * radius, dimensions), 1.5 * radius);
  ASSERT_TRUE(r.found);
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d)
    EXPECT_NEAR(r.value[d], 4.0 * along[d], 1e-9) << d;
}

/// A row of particles at one height: the stress is that of the law at this height, against the wall's own motion, along
/// the wall; of rows at several heights the sum over the wall is that of the particles with their weights.
TEST_P(Dimensions, StressOfRoughGroundIsThatOfTheLaw) {
  const int dimensions = GetParam();
  sets::Uniform random(6);
  const Bounds b = sets::box(dimensions, {1, 1, 1}, {true, false, true});
  std::vector<Vec3> row;
  for (const Vec3& x : sets::lattice(b, spacing, 0.0, random))
    if (x[1] < spacing) row.push_back(x);
  auto p = fluid_at(row, dimensions);
  p.add(Field::ground_distance);
  set(p, 0, [](const Vec3&) { return 3.0; });
  set(p, 1, [](const Vec3&) { return 7.0; });
  std::fill_n(p.column(Field::ground_distance), p.size(), 0.5 * spacing);
  Lookup lookup(b, radius);
  lookup.build(p);
  const RoughWall wall{1.2, 1e-3, spacing};
  const WallPoint at{{0.5, 0.0, dimensions == 3 ? 0.5 : 0.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}};
  const Reading r =
      rough_stress(at, wall, FluidView(p), lookup, ReadyKernel(KernelKind::wendland_c2, radius, dimensions), radius);
  ASSERT_TRUE(r.found);
  const double law = 0.4 / std::log(0.05 / 1e-3);
  EXPECT_NEAR(r.value[0], 1.2 * law * law * 4.0, 1e-12);
  EXPECT_EQ(r.value[1], 0.0);
}

TEST(Averages, OfThreeSamplesByHand) {
  Accumulators a;
  a.count = {0};
  a.mean.assign(2, 0.0);
  a.comoment.assign(3, 0.0);
  Average average(a, 0, 0, 0, 2);
  EXPECT_EQ(average.covariance(0, 0), 0.0);
  // q0 = 1, 2, 6: mean 3, squares of q' 4 + 1 + 9; q1 = 1e9 + (0, 3, 0): q' = -1, 2, -1; products 2 - 2 - 3.
  for (const auto& q : {std::array{1.0, 1e9}, std::array{2.0, 1e9 + 3.0}, std::array{6.0, 1e9}}) average.add(q);
  EXPECT_EQ(average.count(), 3);
  EXPECT_DOUBLE_EQ(average.mean(0), 3.0);
  EXPECT_DOUBLE_EQ(average.mean(1), 1e9 + 1.0);
  EXPECT_DOUBLE_EQ(average.covariance(0, 0), 14.0 / 3.0);
  EXPECT_NEAR(average.covariance(1, 1), 2.0, 1e-6) << "nothing is lost beside a mean of 10^9";
  EXPECT_NEAR(average.covariance(0, 1), -1.0, 1e-6);
  EXPECT_EQ(average.covariance(1, 0), average.covariance(0, 1));
}

/// The square, ten particles a side, with two slices in its lower half; right third left out.
const std::string sliced = with(square_text, "[time]", R"([[profile]]
name = "p"
phase = "air"
box = { min = [0, 0], max = [0.7, 0.48] }
count = 2
every = 1e-9
[time])");

const FrameField& field(const Table& table, const std::string& name) {
  for (const auto& f : table.fields)
    if (f.name == name) return f;
  throw std::out_of_range(name);
}

TEST(Slices, MeansAndFluctuationsByHand) {
  const auto run = small::simulation(sliced, {"phases.air.sound-speed=100"});  // faster than what is set below
  Measurements m = measurements(*run);
  auto& p = run->phases()[0];
  // Rows of seven particles at y = 0.05, 0.15 below 0.24, where the slices meet, and three rows above. u is linear in
  // y, with a fluctuation of +-0.5 that alternates along x; v that of the opposite sign, twice as large.
  const auto sign = [](const Vec3& x) { return std::lround(x[0] / spacing - 0.5) % 2 == 0 ? 1.0 : -1.0; };
  for (const double time : {1.0, -1.0}) {  // the second sample reverses the signs, so that their means vanish
    set(p, 0, [&](const Vec3& x) { return 10.0 * x[1] + 0.5 * time * sign(x); });
    set(p, 1, [&](const Vec3& x) { return -1.0 * time * sign(x); });
    set(p, 2, [&](const Vec3& x) { return 3.0 + 2.0 * time + 100.0 * x[1]; });
    if (time < 0) {
      run->step(1e-8);  // 10^-8 m/s and less away from what is set again
      set(p, 0, [&](const Vec3& x) { return 10.0 * x[1] + 0.5 * time * sign(x); });
      set(p, 1, [&](const Vec3& x) { return -1.0 * time * sign(x); });
      set(p, 2, [&](const Vec3& x) { return 3.0 + 2.0 * time + 100.0 * x[1]; });
    }
    m.sample(run->state());
  }
  const Table t = m.table(0);
  EXPECT_EQ(t.moments, 2);
  ASSERT_EQ(t.places.size(), 2u);
  EXPECT_DOUBLE_EQ(t.places[0][1], 0.12);
  EXPECT_DOUBLE_EQ(t.places[1][0], 0.35);
  const auto at = [&](const char* name, std::size_t k) { return field(t, name).values[k]; };
  EXPECT_EQ(at("samples", 0), 2 * 14);
  EXPECT_EQ(at("samples", 1), 2 * 21);
  EXPECT_NEAR(at("velocity_mean", 0), 1.2, 1e-5) << "at the middle of the slice, not of its particles";
  EXPECT_NEAR(at("velocity_mean", 3), 3.6, 1e-5);
  EXPECT_NEAR(at("velocity_mean", 1), 0.0, 1e-5);
  EXPECT_NEAR(at("velocity_rms", 0), 0.5, 1e-5) << "the gradient within the slice is no fluctuation";
  EXPECT_NEAR(at("velocity_rms", 1), 1.0, 1e-5);
  EXPECT_NEAR(at("reynolds_shear_stress", 0), 0.5, 1e-5);
  EXPECT_NEAR(at("pressure_mean", 0), 15.0, 1e-4);
  EXPECT_NEAR(at("pressure_rms", 0), 2.0, 1e-4);
  EXPECT_NEAR(at("volume_fraction", 0), 14 * 0.01 / (0.24 * 0.7), 1e-6);
  EXPECT_NEAR(at("volume_fraction", 1), 21 * 0.01 / (0.24 * 0.7), 1e-6);
  EXPECT_EQ(at("velocity_mean", 2), 0.0);
}

/// Grains of known masses and speeds: the flux of each column of x, and their mean that of all grains.
TEST_P(Dimensions, FluxOfGrainsAlongTheGroundByHand) {
  const bool solid = GetParam() == 3;
  const std::string text = std::string("dimensions = ") + (solid ? "3" : "2") + R"toml(
spacing = 0.1
[domain]
size = )toml" + (solid ? "[1, 1, 0.5]" : "[1, 1]") +
                           R"toml(
periodic = ["x"]
[phases.sand]
kind = "grains"
density = 1000
diameter = 0.01
stiffness = 1000
[interactions]
sand-sand = { law = "linear" }
[[fill]]
phase = "sand"
shape = { points = )toml" +
                           (solid ? "[[0.05, 0.2, 0.1], [0.3, 0.9, 0.2], [0.45, 0.1, 0.3]]"
                                  : "[[0.05, 0.2], [0.3, 0.9], [0.45, 0.1]]") +
                           R"toml( }
[[profile]]
name = "q"
phase = "sand"
box = { min = )toml" + (solid ? "[0, 0, 0], max = [1, 1, 0.5]" : "[0, 0], max = [1, 1]") +
                           R"toml( }
along = "x"
count = 4
every = 1e-9
[time]
end = 1
step = 1e-9
)toml";
  const auto run = small::simulation(text);
  Measurements m = measurements(*run);
  auto& p = run->phases()[0];
  const double mass = p.mass_of(0), deep = solid ? 0.5 : 1.0;
  const auto speeds = [&](double first, double second, double third) {
    double* v = p.column(Field::velocity, 0);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double x = p.column(Field::position, 0)[k];
      v[k] = x < 0.2 ? first : x < 0.4 ? second : third;
    }
  };
  speeds(1.0, 2.0, 4.0);
  m.sample(run->state());
  speeds(3.0, 2.0, -1.0);
  run->step(1e-9);
  speeds(3.0, 2.0, -1.0);
  m.sample(run->state());
  const Table t = m.table(0);
  ASSERT_EQ(t.moments, 2);
  const auto q = [&](std::size_t k) { return field(t, "flux").values[k]; };
  const double of_one = mass / (0.25 * deep);
  EXPECT_NEAR(q(0), of_one * 2.0, 1e-12 * of_one);
  EXPECT_NEAR(q(1), of_one * (2.0 + 1.5), 1e-12 * of_one) << "two grains, of which one turned back";
  EXPECT_EQ(q(2), 0.0) << "an empty column has no flux, not an unknown one";
  EXPECT_EQ(q(3), 0.0);
  EXPECT_NEAR((q(0) + q(1) + q(2) + q(3)) / 4.0, mass * 5.5 / deep, 1e-12 * mass);
  EXPECT_NEAR(field(t, "mass_flux").values[3], q(1), 1e-12 * of_one) << "a box of one metre";
}

/// The channel with one of each.
const std::string measured = with(small::channel, "[time]", R"([[probe]]
name = "a"
phase = "water"
at = [0.15, 0.1]
every = 2e-4
start = 1e-3
[[profile]]
name = "line"
phase = "water"
from = [0.1, 0]
to = [0.1, 0.2]
every = 3e-4
[[profile]]
name = "slices"
phase = "water"
box = { min = [0, 0], max = [0.3, 0.2] }
[[grid]]
name = "g"
phase = "water"
spacing = 0.02
every = 1e-3
[[wall-shear]]
name = "floor"
phase = "water"
wall = "floor"
count = 4
every = 2e-3
[time])");

struct Result {
  Accumulators memory;
  std::vector<double> state;
  double time = 0;
};

Result after(int threads, bool measure) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  const auto run = small::simulation(measured, {"time.end=0.1"});
  Measurements m = measurements(*run);
  if (measure) m.sample(run->state());
  for (int k = 0; k < 80; ++k) {
    run->step(1.0);
    if (measure) m.sample(run->state());
  }
  omp_set_num_threads(before);
  Result r{m.accumulators(), {}, run->time()};
  for (const auto& p : run->phases())
    for (const auto& about : field_table)
      if (p.has(about.id))
        for (int c = 0; c < p.components(about.id); ++c)
          r.state.insert(r.state.end(), p.column(about.id, c), p.column(about.id, c) + p.size());
  return r;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(Measurements, LeaveTheSimulationAsItIs) {
  const Result with_it = after(1, true), without = after(1, false);
  EXPECT_EQ(with_it.time, without.time);
  EXPECT_TRUE(same_bits(with_it.state, without.state));
  EXPECT_GT(*std::min_element(with_it.memory.moments.begin(), with_it.memory.moments.end()), 1);
}

TEST(Measurements, HaveTheSameBitsOnAnyNumberOfThreads) {
  const Result one = after(1, true), two = after(2, true);
  EXPECT_EQ(one.memory.moments, two.memory.moments);
  EXPECT_EQ(one.memory.count, two.memory.count);
  EXPECT_TRUE(same_bits(one.memory.mean, two.memory.mean));
  EXPECT_TRUE(same_bits(one.memory.comoment, two.memory.comoment));
  EXPECT_TRUE(same_bits(one.memory.fraction, two.memory.fraction));
}

TEST(Measurements, AreTakenAtTheFirstStepAtOrAfterTheirTime) {
  const auto run = small::simulation(
      with(with(sliced, "every = 1e-9", "every = 0.25\nstart = 0.5"), "end = 1", "end = 2\nstep = 1e-3"),
      {"domain.periodic=['x', 'y']"});  // nothing escapes
  Measurements m = measurements(*run);
  std::vector<double> times;
  std::int64_t before = 0;
  const auto look = [&] {
    m.sample(run->state());
    if (m.accumulators().moments[0] > before) times.push_back(run->time());
    before = m.accumulators().moments[0];
  };
  look();
  for (const double to : {0.3, 0.499, 0.5, 0.501, 0.7505, 0.7515, 1.3, 1.4, 1.5})
    while (run->time() < to * (1 - 1e-12)) {
      run->step(to - run->time());
      if (to > 1.2 && run->time() < 1.29) continue;  // nobody looks while 1.0 and 1.25 go by: one sample, not two
      look();
    }
  ASSERT_EQ(times.size(), 4u);
  EXPECT_NEAR(times[0], 0.5, 1e-12);
  EXPECT_NEAR(times[1], 0.75, 1.001e-3);
  EXPECT_NEAR(times[2], 1.29, 1.001e-3);
  EXPECT_NEAR(times[3], 1.5, 1e-9);
}

TEST(Measurements, ThePlanSaysWhatIsMeasuredAndWhatIsNot) {
  const Scene scene = parse_scene(sliced, "s.toml");
  const Plan plan = make_plan(scene, generate(scene));
  const std::string text = to_text(plan, scene);
  EXPECT_NE(text.find("measured profile p (air, 2 slices, every 1e-09 s from 0 s)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("not measured probe, gauge, grid, wall-shear, saltation\n"), std::string::npos) << text;
  const Scene plain = parse_scene(square_text, "s.toml");
  EXPECT_TRUE(make_plan(plain, generate(plain)).instruments.empty());
}

}  // namespace
}  // namespace barchan
