// Grains in air without particles: settling, a hop, a cloud and the air that it stops, and the books of both.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "measure/measurements.hpp"
#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

/// One grain: several threads would only wait for each other.
class AirColumnScene : public ::testing::Test {
 protected:
  AirColumnScene() { omp_set_num_threads(1); }
  ~AirColumnScene() override { omp_set_num_threads(threads_); }

 private:
  int threads_ = omp_get_max_threads();
};

double column_of(const Simulation& s, const std::string& name) {
  const auto names = s.history_columns();
  const auto row = s.history_row();
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k].substr(0, names[k].find(" [")) == name) return row[k];
  ADD_FAILURE() << "no column " << name;
  return 0.0;
}

TEST_F(AirColumnScene, AGrainSettlesAsTabulated) {
  Drive drive("verification/settling");
  // Speed and way, by an integration with a fine step (docs/saltation.md).
  const double table[][3] = {{.05, .456619, .011721},
                             {.1, .832036, .044293},
                             {.2, 1.344636, .155544},
                             {.5, 1.832938, .655712},
                             {1, 1.896376, 1.596073}};
  const PhaseParticles& sand = drive.phase(1);
  const double start = sand.column(Field::position, 1)[0];
  double worst = 0.0;
  for (const auto& [t, v, way] : table) {
    drive.to(t);
    worst = std::max({worst, std::abs(-sand.column(Field::velocity, 1)[0] / v - 1.0),
                      std::abs((start - sand.column(Field::position, 1)[0]) / way - 1.0)});
  }
  report("settling: speed and way, largest error", worst, 0.005);
  EXPECT_LT(worst, 0.005);
}

/// In water a grain weighs 0.62 of what it weighs in air. Exact: g (1 - rho/rho_s) = 18 mu v (1 + 0.15 Re^0.687)/(rho_s
/// d^2).
TEST_F(AirColumnScene, AGrainInWaterIsBorneByIt) {
  const double density = 998.0, nu = 1.004e-6, solid = 2650.0, d = 2.5e-4;
  double low = 0.0, high = 1.0;
  for (int k = 0; k < 100; ++k) {
    const double v = 0.5 * (low + high), re = v * d / nu;
    const double drag = 18.0 * density * nu * v * (1.0 + 0.15 * std::pow(re, 0.687)) / (solid * d * d);
    (drag > 9.81 * (1.0 - density / solid) ? high : low) = v;
  }
  Drive drive("verification/settling", {"phases.air.density=998", "phases.air.viscosity=1.004e-6",
                                        "interactions.air-sand.buoyancy=true", "time.end=0.1"});
  drive.to(0.1);
  const double error = std::abs(-drive.phase(1).column(Field::velocity, 1)[0] / low - 1.0);
  report("settling in water: terminal speed", error, 0.003);
  EXPECT_LT(error, 0.003);
}

/// A step ten times as long (and the relaxation time a hundredth: grains as heavy as air) stays at the terminal speed.
TEST_F(AirColumnScene, ALongStepIsStable) {
  Drive drive("verification/settling", {"phases.sand.density=5", "time.step=3e-3", "time.end=0.3"});
  drive.to(0.3);
  const double tau = 5.0 * 6.25e-8 / (18.0 * 1.81e-5);
  const double v = -drive.phase(1).column(Field::velocity, 1)[0];
  EXPECT_LT(tau, 1e-3) << "the step is three times the relaxation time";
  EXPECT_NEAR(v, 9.81 * tau, 0.05 * 9.81 * tau);
}

struct Hop {
  double u, v, degrees, time, length, apex, speed, angle;
};

TEST_F(AirColumnScene, HopsAreThoseOfTheReference) {
  const Hop hops[] = {{0.3, 1.0, 50, .13330, .31423, .02192, 3.4961, 9.63},
                      {0.4, 0.5, 50, .07106, .12132, .00621, 2.7621, 6.74},
                      {0.4, 1.0, 50, .13033, .41745, .02101, 4.7712, 6.85},
                      {0.4, 1.5, 40, .15856, .62933, .03119, 5.5682, 7.02}};
  for (const Hop& hop : hops) {
    const double angle = hop.degrees * std::numbers::pi / 180.0;
    char u[80], v[80];
    std::snprintf(u, sizeof u, "phases.air.log-profile.friction-velocity=%g", hop.u);
    std::snprintf(v, sizeof v, "fill.0.velocity=[%.9g, %.9g]", hop.v * std::cos(angle), hop.v * std::sin(angle));
    Drive drive("verification/hop", {u, v, "time.end=0.2"});
    const PhaseParticles& sand = drive.phase(1);
    const auto x = [&](int d) { return sand.column(Field::position, d)[0]; };
    const double x0 = x(0), y0 = x(1);
    double apex = 0.0, before = 0.0;
    while (x(1) >= y0 || drive.simulation().steps() == 0) {
      before = x(1);
      drive.simulation().step(1.0);
      apex = std::max(apex, x(1) - y0);
    }
    const double share = (y0 - x(1)) / (before - x(1)), dt = drive.simulation().last_step();
    const double vx = sand.column(Field::velocity, 0)[0], vy = sand.column(Field::velocity, 1)[0];
    const double time = drive.simulation().time() - share * dt, length = x(0) - x0 - share * dt * vx;
    const double worst = std::max({std::abs(time / hop.time - 1.0), std::abs(length / hop.length - 1.0),
                                   std::abs(apex / hop.apex - 1.0), std::abs(std::hypot(vx, vy) / hop.speed - 1.0)});
    report("hop: time, length, height, speed, largest error", worst, 0.01);
    EXPECT_LT(worst, 0.01);
    EXPECT_NEAR(std::atan2(-vy, vx) * 180.0 / std::numbers::pi, hop.angle, 0.3);
  }
}

/// Grains at rest, one in each row, stop a uniform wind: mass loading 2.163. `more` goes to the end of the air's
/// section.
std::string cloud(const std::string& more) {
  return R"toml(
spacing = 2.5e-4
[domain]
size = [0.25, 0.02]
periodic = ["x"]
[phases.sand]
kind = "grains"
density = 2650
[phases.air]
kind = "column"
density = 1.225
viscosity = 1.477551e-5
)toml" + more +
         R"toml(
[interactions]
air-sand = { drag = "stokes" }
[[fill]]
phase = "sand"
shape = { box = { min = [0, 0], max = [2.5e-4, 0.02] } }
[time]
end = 1
step = 2e-5
)toml";
}

TEST_F(AirColumnScene, CloudAndAirRelaxToTheirCommonSpeed) {
  const auto run = small::simulation(cloud("speed = 5\nslip = \"free-slip\"\nmixing-length = \"none\""));
  const double loading = 80 * 2650 * 6.25e-8 / (1.225 * 0.25 * 0.02), tau = 2650 * 6.25e-8 / (18 * 1.81e-5);
  const double common = 5.0 / (1.0 + loading), air_mass = 1.225 * 0.25 * 0.02;
  for (const double t : {0.05, 0.16, 0.32}) {
    while (run->time() < t * (1 - 1e-12)) run->step(t - run->time());
    const double left = std::exp(-(1.0 + loading) * run->time() / tau);
    const double grains = column_of(*run, "sand_mean_vx"), air = column_of(*run, "air_momentum_x") / air_mass;
    const double rate_of_grains = -std::log(1.0 - grains / common) / t,
                 rate_of_air = -std::log((air - common) / (5.0 - common)) / t;
    const double rate = (1.0 + loading) / tau;
    report("cloud: rate of the grains, error", rate_of_grains / rate - 1.0, 0.01);
    report("cloud: rate of the air, error", rate_of_air / rate - 1.0, 0.01);
    EXPECT_NEAR(rate_of_grains / rate, 1.0, 0.01) << left;
    EXPECT_NEAR(rate_of_air / rate, 1.0, 0.01);
  }
}

/// Momentum of air and grains is what top and bottom gave, at every step: point grains of a common step, and spheres.
TEST_F(AirColumnScene, MomentumIsClosed) {
  const std::string wind = "friction-velocity = \"0.4 + 0.3*sin(50*t)\"\nspeed = 3\n";
  std::string spheres = cloud(wind);
  const std::string density = "density = 2650";
  spheres.insert(spheres.find(density) + density.size(),
                 "\ndiameter = { mean = 2.3e-4, spread = 0.08 }\nrestitution = 0.8\nfriction = 0.5");
  spheres.insert(spheres.find("[[fill]]"), "sand-sand = { law = \"linear\" }\n");
  spheres.replace(spheres.find("step = 2e-5"), 11, "largest-speed = 5");
  std::string crowd = cloud(wind);
  crowd.replace(crowd.find("stokes"), 6, "di-felice");
  std::string turning = spheres;
  turning.replace(turning.find("\"stokes\""), 8, "\"stokes\", magnus = true");
  std::string gusty = spheres;
  gusty.replace(gusty.find("\"stokes\""), 8, "\"duran\", gusts = 0.38, lift = 0.85");
  for (const std::string& text : {cloud(wind), crowd, spheres, turning, gusty}) {
    const auto run = small::simulation(text);
    const auto total = [&] {
      return column_of(*run, "momentum_x") + column_of(*run, "air_momentum_x") -
             column_of(*run, "air_boundary_impulse_x");
    };
    const double before = total(), scale = column_of(*run, "air_momentum_x");
    double worst = 0.0;
    for (int k = 0; k < 400; ++k) {
      run->step(1.0);
      worst = std::max(worst, std::abs(total() - before) / scale);
    }
    report("momentum of air and grains, error", worst, 1e-10);
    EXPECT_LT(worst, 1e-10);
    EXPECT_GT(column_of(*run, "momentum_x"), 1e-3 * scale) << "the grains have got some of it";
  }
}

/// Of a grain at rest in a held wind U(y): C (U+ - U-)/U of its drag, and gusts that change both by one factor.
TEST_F(AirColumnScene, LiftIsAShareOfTheDrag) {
  const std::vector<std::string> wind{"phases.air.held=true", "phases.air.log-profile.friction-velocity=0.4",
                                      "fill.0.velocity=[0, 0]", "time.end=2e-4"};
  const auto drag_and_lift = [&](const std::string& drag) {
    auto keys = wind;
    keys.push_back("interactions.air-sand={ drag = \"stokes\"" + drag + " }");
    Drive drive("verification/hop", keys);
    drive.simulation().step(1e-4);
    const PhaseParticles& sand = drive.phase(1);
    return std::array<double, 3>{sand.column(Field::drag_acceleration, 0)[0],
                                 sand.column(Field::drag_acceleration, 1)[0], sand.column(Field::position, 1)[0]};
  };
  const auto bare = drag_and_lift(""), lifted = drag_and_lift(", lift = 0.85"),
             gusty = drag_and_lift(", lift = 0.85, gusts = 0.38");
  EXPECT_NEAR(bare[1] / bare[0], 0.0, 1e-3) << "it begins to fall";
  EXPECT_EQ(lifted[0], bare[0]);
  const double d = 2.5e-4, z0 = 8.3e-6, y = bare[2];
  const double share = 0.85 * std::log((y + 0.25 * d) / (y - 0.25 * d)) / std::log(y / z0);
  report("lift over drag, over its formula", lifted[1] / lifted[0] / share, 1.05);
  EXPECT_NEAR(lifted[1] / lifted[0] / share, 1.0, 0.05);
  EXPECT_NE(gusty[0], lifted[0]);
  EXPECT_NEAR(gusty[1] / gusty[0], lifted[1] / lifted[0], 0.02 * share) << "Stokes: drag and lift grow alike";
}

/// A wind along -x, and grains in it, are the mirror image of one along x: of a held profile, and of air that the
/// grains slow down.
TEST_F(AirColumnScene, AWindAlongMinusXIsTheMirrorImage) {
  const std::string held = "held = true\nlog-profile = { friction-velocity = UU, roughness = 1e-5 }";
  for (const std::string& wind :
       {held, std::string("friction-velocity = UU"), std::string("friction-velocity = \"UU*(1+9*t)\""),
        std::string("friction-velocity = UU\naveraging = 0.01")}) {
    std::vector<std::unique_ptr<Simulation>> runs;
    for (const char* const u : {"0.4", "-0.4"}) {
      std::string text = cloud(wind);
      text.replace(text.find("UU"), 2, u);
      runs.push_back(small::simulation(text));
      for (int k = 0; k < 200; ++k) runs.back()->step(1.0);
    }
    const PhaseParticles &a = runs[0]->phases()[0], &b = runs[1]->phases()[0];
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a.column(Field::velocity, 0)[k], -b.column(Field::velocity, 0)[k]) << wind;
      EXPECT_EQ(a.column(Field::velocity, 1)[k], b.column(Field::velocity, 1)[k]) << wind;
    }
    EXPECT_GT(std::abs(a.column(Field::velocity, 0)[a.size() - 1]), 1e-3);
    const AirProfile &air = runs[0]->state().air[0], &mirrored = runs[1]->state().air[0];
    for (std::size_t k = 0; k < air.cells(); ++k) {
      EXPECT_EQ(air.speed[k], -mirrored.speed[k]) << wind;
      EXPECT_EQ(air.stress[k + 1], -mirrored.stress[k + 1]) << wind;
    }
    EXPECT_EQ(runs[0]->plan().phases[1].wind.largest_speed, runs[1]->plan().phases[1].wind.largest_speed);
  }
}

/// What instruments tell of a logarithmic wind that is held: u*/kappa ln(y/y0) at each height, rho u*|u*| everywhere,
/// and of its momentum the integral. It loses nothing to the grains.
TEST_F(AirColumnScene, AHeldLogarithmicWindIsMeasuredByHeight) {
  for (const double u : {0.4, -0.3}) {
    char wind[96];
    std::snprintf(wind, sizeof wind, "held = true\nlog-profile = { friction-velocity = %g, roughness = 2e-5 }", u);
    std::string text = cloud(wind);
    text.insert(text.find("[time]"), "[[saltation]]\nname = \"s\"\nphase = \"sand\"\n");
    const auto run = small::simulation(text);
    for (int k = 0; k < 30; ++k) run->step(1.0);
    Measurements measurements(run->plan().instruments, run->plan().bounds, {2650.0, 1.225});
    measurements.sample(run->state());
    const Table table = measurements.table(0);
    const auto field = [&](const char* name) {
      for (const FrameField& f : table.fields)
        if (f.name == name) return f.values;
      ADD_FAILURE() << name;
      return std::vector<double>(table.places.size(), 0.0);
    };
    const std::vector<double> speed = field("air_speed"), stress = field("air_stress");
    for (std::size_t row = 0; row < table.places.size(); ++row) {
      EXPECT_NEAR(speed[row], u / 0.4 * std::log(table.places[row][1] / 2e-5), 1e-12) << row;
      EXPECT_NEAR(stress[row], 1.225 * u * std::abs(u), 1e-12) << row;
    }
    EXPECT_NEAR(column_of(*run, "s_bed_friction_velocity"), u, 1e-12);
    const double integral = u / 0.4 * (0.02 * std::log(0.02 / 2e-5) - 0.02 + 2e-5);
    EXPECT_NEAR(column_of(*run, "air_momentum_x"), 1.225 * 0.25 * integral, 1e-9);
  }
}

/// The bits do not depend on the number of threads.
TEST_F(AirColumnScene, SaltationHasTheSameBitsOnAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<std::vector<double>> rows;
  std::vector<std::vector<char>> states;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    Drive drive("saltation");
    for (int k = 0; k < 60; ++k) drive.simulation().step(1.0);
    rows.push_back(drive.simulation().history_row());
    Archive a;
    for (const auto& p : drive.simulation().phases()) const_cast<PhaseParticles&>(p).archive(a);
    for (const auto& p : drive.simulation().state().air) const_cast<AirProfile&>(p).archive(a);
    states.push_back(a.bytes());
  }
  omp_set_num_threads(before);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_EQ(std::memcmp(rows[0].data(), rows[k].data(), rows[0].size() * sizeof(double)), 0);
    EXPECT_EQ(states[0], states[k]);
  }
}

}  // namespace
}  // namespace barchan
