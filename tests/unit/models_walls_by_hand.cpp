// Parts of models on a few particles, against values by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/kernel.hpp"
#include "models/bodies/body_forces.hpp"
#include "models/coupling/rigid_in_fluid.hpp"
#include "models/fluid/energy.hpp"
#include "models/fluid/turbulence.hpp"
#include "models/forces.hpp"
#include "models/row_mean.hpp"
#include "physics/small_scenes.hpp"
#include "unit/particle_sets.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using namespace sets;
using testing::with;

// A body and the fluid about it that turn as one: w x r for every pair. Their friction has no torque on any particle.
TEST(ModelsByHand, AFluidThatTurnsWithABodyHasNoTorqueOnIt) {
  for (const int dimensions : {2, 3}) {
    const Bounds b = box(dimensions, {8, 8, 8}, {false, false, false});
    Uniform random(3);
    std::vector<Vec3> places[2];
    for (const Vec3& x : lattice(b, 1.0, 0.2, random))
      places[norm(x - Vec3{4, 4, x[2] > 0 ? 4.0 : 0.0}) < 2.5 ? 0 : 1].push_back(x);
    const Vec3 rate = dimensions == 2 ? Vec3{0, 0, 1.5} : Vec3{0.4, -0.8, 1.5};
    std::vector<PhaseParticles> p;
    for (const auto& x : places) {
      p.push_back(phase(dimensions, x, 1.0, {Field::velocity, Field::density}, p.empty() ? 0 : 10000));
      for (std::size_t k = 0; k < x.size(); ++k) {
        const Vec3 v = cross(rate, x[k]);
        for (int d = 0; d < dimensions; ++d) p.back().column(Field::velocity, d)[k] = v[static_cast<std::size_t>(d)];
        p.back().column(Field::density)[k] = random(0.8, 1.2);
      }
    }
    Cast cast(b, std::move(p), {{0, 1, 2.2}});
    const std::size_t n = cast.phases[0].size();
    const FluidNeighbour fluid{&cast.list(0), &cast.motion[1], KernelKind::wendland_c2, 2.2, 0.7, false};
    std::vector<Vec3> rates(n, rate), areas(n), couples(n), still(n);
    turning_friction(cast.motion[0], std::span(&fluid, 1), rates, areas, couples, dimensions);
    double most = 0.0, size = 0.0;
    for (const Vec3& c : couples) most = std::max(most, norm(c));
    turning_friction(cast.motion[0], std::span(&fluid, 1), still, areas, couples, dimensions);
    for (const Vec3& c : couples) size = std::max(size, norm(c));
    EXPECT_GT(size, 0.01) << "a body that is held feels one";
    EXPECT_LT(most, 1e-12 * size) << dimensions;
  }
}

// rho nu_t is a dynamic viscosity: a root squared is density times kinematic viscosity.
TEST(ModelsByHand, RootsOfEddiesAreOfTheDynamicViscosity) {
  const Bounds b = box(2, {8, 8, 0}, {true, false, false});
  auto fluid = phase(2, {{1, 1, 0}, {2, 5, 0}}, 1.0, {Field::velocity, Field::ground_distance, Field::eddy_viscosity});
  fluid.column(Field::eddy_viscosity)[0] = 0.3;
  fluid.column(Field::eddy_viscosity)[1] = 0.7;
  EddyRecords records;
  records.resize(2, 0);
  EddyParameters e;
  e.density = 4.0;
  e.viscosity = 0.1;
  e.spacing = 1.0;
  Sides sides;
  sides.low[1] = 0.0;
  EXPECT_NEAR(pack_eddies(fluid, records, GroundDistance(b, sides, 1.0, true), e), 0.8, 1e-15);
  EXPECT_NEAR(records.root[0] * records.root[0], 4.0 * 0.4, 1e-14);
  EXPECT_NEAR(records.root[1] * records.root[1], 4.0 * 0.8, 1e-14);
  EXPECT_NEAR(records.touch[0], 4.0 * 0.1, 1e-15);
}

TEST(ModelsByHand, AZoneActsOnEachComponent) {
  Scene scene;
  Forcing forcing;
  forcing.phase = "phase";
  forcing.rate = {"", 10.0};
  forcing.velocity = {Expression{"", 1.0}, Expression{"", -2.0}, Expression{"", 0.5}};
  if (!forcing.relaxes()) GTEST_FAIL() << "a forcing with a rate is a zone";
  scene.forcings.push_back(forcing);
  const Forces forces(scene, "phase");
  auto p = phase(3, {{0, 0, 0}}, 1.0, {Field::velocity, Field::acceleration});
  const double speed[3] = {0.25, 3.0, -1.0}, target[3] = {1.0, -2.0, 0.5};
  for (int d = 0; d < 3; ++d) p.column(Field::velocity, d)[0] = speed[d];
  forces.relax(p, 0.0, 1e-3);
  for (int d = 0; d < 3; ++d)
    EXPECT_NEAR(p.column(Field::acceleration, d)[0], 10.0 * (target[d] - speed[d]), 1e-13) << d;
}

// Sides push inwards, lower ones up and upper ones down, the same.
TEST(ModelsByHand, SidesPushBodiesInwards) {
  const BodyContactLaw law = BodyContactLaw::of(1.0, 100.0, 1.0, 1.0, 0.0);
  for (const int dimensions : {2, 3}) {
    auto body = phase(dimensions, {{5, 0.4, 0}, {5, 9.6, 0}, {5, 5, 0}}, 2.0, {Field::velocity, Field::acceleration});
    body_side_forces(body, BodySide{1, 1.0, 0.0}, 0.5, law, 1e-3);
    body_side_forces(body, BodySide{1, -1.0, 10.0}, 0.5, law, 1e-3);
    const double* a = body.column(Field::acceleration, 1);
    EXPECT_NEAR(a[0], 0.1 * 100.0 / 2.0, 1e-9);  // it overlaps by 0.1 and rests
    EXPECT_NEAR(a[1], -a[0], 1e-9);
    EXPECT_EQ(a[2], 0.0);
    EXPECT_EQ(body.column(Field::acceleration, 0)[0], 0.0);
  }
}

// Steps of 0.1 s at the forces 2, 4, 8 N, and an impulse of 0.3 N s: (0.3 + 0.6 + 0.3)/0.2 N.
TEST(ModelsByHand, TheMeanForceOfARowIsItsImpulseOverItsTime) {
  RowMean mean;
  mean.start({2, 0, 0});
  EXPECT_EQ(mean.value()[0], 2.0);
  mean.add({4, 0, 0}, 0.1);
  mean.add({8, 0, 0}, 0.1, {0.3, 0, 0});
  EXPECT_NEAR(mean.value()[0], 6.0, 1e-14);
  mean.begin_row();
  EXPECT_NEAR(mean.value()[0], 6.0, 1e-14) << "where no step was made, that before";
  mean.add({8, 0, 0}, 0.1);
  EXPECT_NEAR(mean.value()[0], 8.0, 1e-14);
}

const std::string channel = R"toml(
spacing = 0.1
[domain]
size = [1, 1]
[phases.water]
kind = "fluid"
density = 1000
sound-speed = 10
[phases.wall]
kind = "wall"
[interactions]
water-water = 2.6
water-wall = 2.6
[[fill]]
phase = "wall"
shape = { sides = ["bottom", "top", "left", "right"] }
[[fill]]
phase = "water"
shape = "the-rest"
[time]
end = 1
)toml";

TEST(ModelsByHand, NormalsOfSidesPointInwardsAsDeepAsTheyAre) {
  const auto run = small::simulation(channel);
  const PhaseParticles& wall = run->state().phases[1];
  std::size_t seen = 0;
  for (std::size_t k = 0; k < wall.size(); ++k) {
    const Vec3 x = position(wall, k), n = vector(wall, Field::wall_normal, k);
    const double depth = wall.column(Field::wall_depth)[k];
    const Vec3 surface = x + depth * n;  // the nearest place of the domain
    for (std::size_t d = 0; d < 2; ++d) EXPECT_NEAR(surface[d], std::clamp(x[d], 0.0, 1.0), 1e-12) << k;
    EXPECT_GT(depth, 0.0);
    ++seen;
  }
  EXPECT_GT(seen, 80u);
}

const std::string top = R"toml(
dimensions = 3
spacing = 0.02
[domain]
size = [1, 1, 1]
[phases.top]
kind = "rigid"
density = 1000
[interactions]
[[fill]]
phase = "top"
shape = { box = { min = [0.4, 0.4, 0.4], max = [0.6, 0.52, 0.44] } }
angular-velocity = [3, 5, -2]
[time]
end = 1
step = 1e-4
)toml";

// The accelerations of the particles of a body are what their velocities change by; a body free of forces has those of
// its turning and of the gyroscopic torque.
TEST(ModelsByHand, ParticlesOfABodyAreAcceleratedAsTheyMove) {
  const auto run = small::simulation(top);
  for (int k = 0; k < 5; ++k) run->step(1.0);
  const PhaseParticles& p = run->state().phases[0];
  const auto columns_of = [&](Field field) {
    std::vector<Vec3> all(p.size());
    for (std::size_t k = 0; k < p.size(); ++k)
      all[static_cast<std::size_t>(p.id()[k] - p.first_id())] = vector(p, field, k);
    return all;
  };
  const auto v0 = columns_of(Field::velocity), a0 = columns_of(Field::acceleration);
  const double start = run->time();
  run->step(1.0);
  const auto v1 = columns_of(Field::velocity), a1 = columns_of(Field::acceleration);
  const double dt = run->time() - start;
  double worst = 0.0, most = 0.0;
  for (std::size_t k = 0; k < v0.size(); ++k) {
    most = std::max(most, norm(a0[k]));
    worst = std::max(worst, norm(1.0 / dt * (v1[k] - v0[k]) - 0.5 * (a0[k] + a1[k])));
  }
  EXPECT_GT(most, 1.0);
  EXPECT_LT(worst, 1e-5 * most);
}

const std::string one_grain = R"toml(
spacing = 0.1
[domain]
size = [1, 1, 1]
periodic = ["x", "y", "z"]
[phases.air]
kind = "fluid"
density = 2
[phases.sand]
kind = "grains"
density = 1000
[interactions]
air-air = 2.6
air-sand = { radius = 2.6, drag = 0.5 }
[[fill]]
phase = "sand"
shape = { points = [[0.55, 0.55, 0.55]] }
[[fill]]
phase = "air"
shape = "the-rest"
velocity = [3, 0, 0]
[time]
end = 1
)toml";

// 1/2 C_D rho A U^2 of a sphere of one spacing, times the fluid's share of its neighbourhood.
TEST(ModelsByHand, DragOnAGrainIsThatOfItsCrossSection) {
  for (const int dimensions : {2, 3}) {
    std::vector<std::string> flat{"dimensions=" + std::to_string(dimensions)};
    if (dimensions == 2)
      flat.insert(flat.end(), {"domain.size=[1, 1]", "domain.periodic=[\"x\", \"y\"]", "fill.1.velocity=[3, 0]",
                               "fill.0.shape={ points = [[0.55, 0.55]] }"});
    auto run = small::simulation(one_grain, flat);
    const auto with = run->state().phases[1].column(Field::acceleration, 0)[0];
    flat.emplace_back("interactions.air-sand={ radius = 2.6, drag = 1.0 }");
    run = small::simulation(one_grain, flat);
    const auto twice = run->state().phases[1].column(Field::acceleration, 0)[0];
    const auto& sand = run->state().phases[1];
    const double section = dimensions == 2 ? 0.1 : 0.25 * std::numbers::pi * 0.01;
    double share = 0.0;
    const double volume = std::pow(0.1, dimensions);
    with_kernel<double>(run->plan().entries[1].kernel, 0.26, dimensions, [&](const auto& kernel) {
      for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j)
          for (int k = dimensions == 3 ? -2 : 0; k <= (dimensions == 3 ? 2 : 0); ++k)
            if (i != 0 || j != 0 || k != 0) share += volume * kernel.value(0.1 * std::sqrt(i * i + j * j + k * k));
    });
    EXPECT_NEAR((twice - with) * sand.mass(), 0.5 * 0.5 * 2.0 * section * 9.0 * share, 1e-3 * section) << dimensions;
  }
}

// The forces are of velocities that are older by `age` than the accelerations: the power changes by f.a times that.
TEST(ModelsByHand, TheHeatOfAFluidIsOfTheVelocitiesOfNow) {
  for (const int dimensions : {2, 3}) {
    const Bounds b = box(dimensions, {6, 6, 6}, {true, true, true});
    Uniform random(9);
    std::vector<PhaseParticles> p;
    p.push_back(phase(dimensions, lattice(b, 1.0, 0.2, random), 1.0,
                      {Field::velocity, Field::density, Field::pressure, Field::acceleration, Field::energy_rate}));
    randomise(p[0], Field::velocity, -1.0, 1.0, random);
    randomise(p[0], Field::density, 0.8, 1.2, random);
    randomise(p[0], Field::pressure, -1.0, 1.0, random);
    randomise(p[0], Field::acceleration, -1.0, 1.0, random);
    Cast cast(b, std::move(p), {{0, 0, 2.2}});
    PhaseParticles& fluid = cast.phases[0];
    const FluidNeighbour pair{&cast.list(0), &cast.motion[0], KernelKind::wendland_c2, 2.2, 0.7, false};
    const double age = 0.3;
    std::vector<double> expected, rates[2];
    for (std::size_t k = 0; k < fluid.size(); ++k) {
      Vec3 force{};  // by volume
      for_all_pairs(b, fluid, k, fluid, true, 2.2, [&](std::size_t j, const Vec3& r, const std::array<int, 3>&) {
        const WendlandC2<double> kernel(2.2, dimensions);
        const double vf = fluid.mass() / fluid.column(Field::density)[j] * kernel.derivative(norm(r)) / norm(r);
        const Vec3 v = vector(fluid, Field::velocity, k) - vector(fluid, Field::velocity, j);
        force =
            force + 2.0 * 0.7 * vf * v - vf * (fluid.column(Field::pressure)[k] + fluid.column(Field::pressure)[j]) * r;
      });
      expected.push_back(-age * dot(force, vector(fluid, Field::acceleration, k)) / fluid.column(Field::density)[k]);
    }
    for (const bool late : {false, true}) {
      fluid_energy(fluid, cast.motion[0], std::span(&pair, 1), std::span<const SolidNeighbour>(), late ? age : 0.0);
      const double* rate = fluid.column(Field::energy_rate);
      rates[late ? 1 : 0].assign(rate, rate + fluid.size());
    }
    for (std::size_t k = 0; k < fluid.size(); ++k) rates[1][k] -= rates[0][k];
    EXPECT_LT(difference(rates[1].data(), expected), 1e-12) << dimensions;
  }
}

double told(const Simulation& run, const std::string& name) {
  const auto names = run.history_columns();
  const auto at =
      std::find_if(names.begin(), names.end(), [&](const std::string& each) { return each.starts_with(name); });
  return at == names.end() ? NAN : run.history_row()[static_cast<std::size_t>(at - names.begin())];
}

// A ball that bounces off a floor gives it downwards what it gets upwards, and turns it about the place of the meter.
TEST(ModelsByHand, AFloorGetsWhatABallLoses) {
  const auto run = small::simulation(R"toml(
spacing = 1e-3
[domain]
size = [0.05, 0.05]
[phases.ball]
kind = "grains"
density = 2650
diameter = 1e-3
restitution = 0.5
[phases.floor]
kind = "wall"
[interactions]
ball-ball = { law = "linear" }
ball-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "ball"
shape = { points = [[0.03, 0.00055]] }
velocity = [0, -1]
[[force]]
name = "floor"
phase = "floor"
about = [0.01, 0]
[time]
end = 1
largest-speed = 1
)toml");
  while (run->time() < 2e-3) run->step(2e-3 - run->time());
  const PhaseParticles& ball = run->state().phases[0];
  const double gain = ball.mass_of(0) * (ball.column(Field::velocity, 1)[0] + 1.0);
  EXPECT_GT(ball.column(Field::velocity, 1)[0], 0.4);
  EXPECT_NEAR(told(*run, "floor_impulse_y ["), -gain, 1e-9 * gain);
  EXPECT_NEAR(told(*run, "floor_torque_z [") * run->time(), -0.02 * gain, 1e-9 * gain) << "a mean of the one row";
}

const std::string block = R"toml(
spacing = 0.1
[domain]
size = [2, 2]
[phases.block]
kind = "elastic"
density = 1000
young = 1e6
[interactions]
block-block = 1.6
[[fill]]
phase = "block"
shape = { box = { min = [0.5, 0.5], max = [0.9, 1.3] } }
velocity = ["x + 2*y", "-y"]
[[forcing]]
phase = "block"
acceleration = [3, -2]
[[force]]
name = "block"
phase = "block"
about = [0.2, 0.1]
[time]
end = 1
)toml";

TEST(ModelsByHand, AMeterTellsForceAndTorqueOfWhatPushes) {
  const auto run = small::simulation(with(block, "velocity = [\"x + 2*y\", \"-y\"]\n", ""));
  const double mass = 1000.0 * 0.4 * 0.8;
  EXPECT_NEAR(told(*run, "block_force_x ["), 3.0 * mass, 1e-6 * mass);
  EXPECT_NEAR(told(*run, "block_force_y ["), -2.0 * mass, 1e-6 * mass);
  EXPECT_NEAR(told(*run, "block_torque_z ["), mass * (0.5 * -2.0 - 0.8 * 3.0), 1e-6 * mass)
      << "its middle is at (0.7, 0.9)";
}

// Means over 32 particles, and half of the kernel's radius.
TEST(ModelsByHand, FramesAndRowsTellTheSmoothingLengthAndTheMeanSpeed) {
  const auto run = small::simulation(block);
  EXPECT_NEAR(told(*run, "block_mean_vx [m/s]"), 0.7 + 2.0 * 0.9, 1e-12);
  EXPECT_NEAR(told(*run, "momentum_y ["), -0.9 * 320.0, 1e-9);
  const Frame frame = run->frame(0);
  for (const FrameField& field : frame.fields) {
    if (field.name != "smoothing_length") continue;
    ASSERT_EQ(field.values.size(), 32u);
    EXPECT_NEAR(field.values[7], 0.08, 1e-15);
    return;
  }
  ADD_FAILURE() << "no smoothing length";
}

}  // namespace
}  // namespace barchan
