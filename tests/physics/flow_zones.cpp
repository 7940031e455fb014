// Fluids that enter and leave: a stream and a channel stay as they are, sound leaves, threads and restarts change no
// bit.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

/// A box of fluid with open ends along x. `more`: further sections.
std::string open_box(const std::string& size, const std::string& spacing, const std::string& fluid,
                     const std::string& fill, const std::string& inflow, const std::string& more) {
  return "spacing = " + spacing + "\n[domain]\nsize = " + size + more +
         "\n[phases.air]\nkind = \"fluid\"\ndensity = 1\nsound-speed = 10\n" + fluid +
         "\n[[fill]]\nphase = \"air\"\nshape = \"the-rest\"\n" + fill +
         "\n[[inflow]]\nphase = \"air\"\nside = \"left\"\n" + inflow +
         "\n[[outflow]]\nphase = \"air\"\nside = \"right\"\n[time]\nend = 10\nlargest-speed = 1\n";
}
const std::string periodic_y = "\nperiodic = [\"y\"]\n[interactions]\nair-air = 2.1";

struct OpenRun {
  explicit OpenRun(const std::string& text) : scene(parse_scene(text, "test.toml")), blocks(make_particles(scene)) {
    simulation = std::make_unique<Simulation>(scene, make_plan(scene, blocks), blocks);
  }
  void run(double until) {
    while (simulation->time() < until - 1e-12) simulation->step(until - simulation->time());
  }
  double column(const std::string& name) const {
    const HistoryRow row = simulation->history();
    for (std::size_t k = 0; k < row.names.size(); ++k)
      if (row.names[k].starts_with(name)) return row.values[k];
    ADD_FAILURE() << "no column " << name;
    return 0.0;
  }
  /// The largest of |value(x, v, p)| over the fluid in the domain.
  double worst(const std::function<double(const Vec3&, const Vec3&, double)>& value) const {
    const PhaseParticles& p = simulation->phases()[0];
    double most = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      Vec3 x{}, v{};
      for (int d = 0; d < p.dimensions(); ++d) {
        x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
        v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d)[k];
      }
      if (simulation->plan().in_domain(p, k))
        most = std::max(most, std::abs(value(x, v, p.column(Field::pressure)[k])));
    }
    return most;
  }
  Scene scene;
  std::vector<ParticleBlock> blocks;
  std::unique_ptr<Simulation> simulation;
};

TEST(FlowZones, AUniformStreamStaysAsItIs) {
  for (const char* scheme : {"consistent", "plain"}) {
    const bool plain = std::string(scheme) == "plain";
    OpenRun open(open_box("[1, 0.4]", "0.05", "scheme = \"" + std::string(scheme) + "\"",
                          "perturb = 0.2\nvelocity = [1, 0]", "velocity = [1, 0]",
                          plain ? "\nperiodic = [\"y\"]\n[interactions]\nair-air = 3.0" : periodic_y));
    open.run(4.0);  // four lengths
    const double error = open.worst([](const Vec3&, const Vec3& v, double) { return std::hypot(v[0] - 1.0, v[1]); });
    EXPECT_LT(error, 0.01) << scheme;
    const double in = open.column("air_left_in"), out = open.column("air_right_out");
    EXPECT_NEAR(in, 4.0 * 0.4, 0.4 * 0.06) << scheme;  // whole rows
    EXPECT_NEAR(out, in, 0.4 * 0.06) << scheme;
  }
}

TEST(FlowZones, AChannelKeepsItsProfile) {
  std::string text = open_box("[2, 1]", "0.1", "viscosity = 0.02\n[phases.wall]\nkind = \"wall\"",
                              "perturb = 0.2\nvelocity = [\"4*y*(1 - y)\", 0]\npressure = \"-0.16*(x - 2)\"\n"
                              "[[fill]]\nphase = \"wall\"\nshape = { sides = [\"bottom\", \"top\"] }",
                              "velocity = [\"4*y*(1 - y)\", 0]", "\n[interactions]\nair-air = 2.1\nair-wall = 2.1");
  OpenRun open(text);
  open.run(12.0);
  const double error =
      open.worst([](const Vec3& x, const Vec3& v, double) { return v[0] - 4.0 * x[1] * (1.0 - x[1]); });
  EXPECT_LT(error, 0.03);  // 10 particles across; of 1 m/s
  EXPECT_NEAR(open.column("air_mean_vx"), 2.0 / 3.0, 0.015);
  // At the start rows stood a spacing apart; under the pressure of the flow they stand closer, and more is there.
  const double in = open.column("air_left_in"), out = open.column("air_right_out");
  open.run(24.0);
  EXPECT_NEAR((open.column("air_left_in") - in) / (open.column("air_right_out") - out), 1.0, 5e-3);
}

/// A pulse of sound leaves through both ends: what is left of its amplitude there. Without the delay of an inflow's
/// pressure 0.12 were left, with the layer's push on every velocity a channel began to swing.
TEST(FlowZones, SoundLeaves) {
  OpenRun open(open_box("[1, 0.1]", "0.01", "", "pressure = \"0.01*exp(-((x - 0.5)/0.05)^2)\"", "velocity = [0, 0]",
                        periodic_y));
  open.run(0.045);
  const auto pressure = [](const Vec3&, const Vec3&, double p) { return p; };
  const double amplitude = open.worst(pressure);
  open.run(0.08);
  EXPECT_LT(open.worst(pressure) / amplitude, 0.01);
  open.run(0.15);
  EXPECT_LT(open.worst(pressure) / amplitude, 0.0125);
}

/// Sound of 20 spacings that comes obliquely to an inflow, 45 degrees: what comes back of its amplitude at the side.
TEST(FlowZones, ObliqueSoundLeavesThroughTheLayerOfAnInflow) {
  const auto left_over = [](const std::string& layer) {
    const std::string wave = "0.01*exp(-((x - 0.9)/0.25)^2)*cos(2*pi*(x + y)/0.28)";
    OpenRun open(
        open_box("[1.6, 0.28]", "0.01", "",
                 "pressure = \"" + wave + "\"\nvelocity = [\"-0.0707107*" + wave + "\", \"-0.0707107*" + wave + "\"]",
                 "velocity = [0, 0]\n" + layer, periodic_y));
    const auto pressure = [](const Vec3&, const Vec3&, double p) { return p; };
    open.run(0.12);
    const double amplitude = open.worst(pressure);  // the wave stands at the side
    open.run(0.27);                                 // what came back has gone 1 m along x
    return open.worst([](const Vec3& x, const Vec3&, double p) { return x[0] > 0.4 ? p : 0.0; }) / amplitude;
  };
  const double without = left_over(""), with = left_over("layer = 0.4\n");
  testing::report("oblique sound sent back by an inflow without a layer", without, 1.0);
  testing::report("with a layer of two waves", with, 0.01);
  EXPECT_LT(with, 0.01);
  EXPECT_GT(without, 2.0 * with);
}

/// Fluctuations that enter a stream arrive inside it: their size behind the side.
TEST(FlowZones, FluctuationsEnter) {
  OpenRun open(open_box("[1, 1]", "0.05", "", "velocity = [1, 0]",
                        "velocity = [1, 0]\nfluctuations = { length = 0.3, rms = [0.1, 0.1], seed = 3 }", periodic_y));
  double sum = 0.0, count = 0.0;
  for (int k = 0; k < 60; ++k) {
    open.run(0.5 + 0.05 * k);
    const PhaseParticles& p = open.simulation->phases()[0];
    for (std::size_t q = 0; q < p.size(); ++q) {
      const double x = p.column(Field::position, 0)[q];
      if (x < 0.0 || x > 0.3) continue;
      sum += std::pow(p.column(Field::velocity, 1)[q], 2);
      count += 1.0;
    }
  }
  const double rms = std::sqrt(sum / count);
  testing::report("rms of the velocity across, behind the side, over what enters", rms / 0.1, 1.2);
  EXPECT_NEAR(rms / 0.1, 1.0, 0.25);
}

/// The water drags the walls of the domain by dp/dx H L = 12 rho nu U L/H. They go on beyond both sides, 1.7 times as
/// long in all: what happens there is no force on the walls of the scene.
TEST(FlowZones, TheForceOnWallsIsThatOfTheDomain) {
  testing::Drive channel("verification/open_channel", {"spacing=0.1", "force=[{ name = \"w\", phase = \"wall\" }]"});
  const auto impulse = [&] {
    const HistoryRow row = channel.simulation().history();
    const auto found = std::find_if(row.names.begin(), row.names.end(),
                                    [](const std::string& name) { return name.starts_with("w_impulse_x ["); });
    return found == row.names.end() ? 0.0 : row.values[static_cast<std::size_t>(found - row.names.begin())];
  };
  channel.to(1.0);
  const double before = impulse();
  channel.to(3.0);
  const double drag = 0.5 * (impulse() - before), exact = 12.0 * 0.02 * 4.0;
  testing::report("drag of the channel over 12 rho nu U L/H", drag / exact, 1.05);
  EXPECT_NEAR(drag / exact, 1.0, 0.05);
}

/// The fluid follows an inflow that changes: its mean speed and how much of it there is, on the way and at the end.
/// Before, the inflow held back as if the pressure that stops a fluid were sound, and went on without it: the box
/// emptied to a fifteenth.
void expect_to_follow(const std::string& start, const std::string& given, const std::function<double(double)>& speed,
                      double from, double until) {
  SCOPED_TRACE(given);
  OpenRun open(open_box("[1, 0.2]", "0.025", "", "perturb = 0.1\nvelocity = " + start,
                        "velocity = [\"" + given + "\", 0]", periodic_y));
  const auto inside = [&] {
    const PhaseParticles& p = open.simulation->phases()[0];
    double number = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k) number += open.simulation->plan().in_domain(p, k) ? 1.0 : 0.0;
    return number;
  };
  const double number = inside();
  for (double t = from; t <= until; t += 0.25) {
    open.run(t);
    EXPECT_NEAR(open.column("air_mean_vx"), speed(t), 0.05) << t;
    EXPECT_NEAR(inside() / number, 1.0, 0.03) << t;  // a row is 0.025
  }
}

TEST(FlowZones, FollowAnInflowThatChanges) {
  expect_to_follow(
      "[1, 0]", "t < 0.5 ? 1 : 0", [](double) { return 0.0; }, 1.5, 2.0);
  expect_to_follow(
      "[1, 0]", "max(-1, min(1, 2 - t))", [](double t) { return std::max(-1.0, std::min(1.0, 2.0 - t)); }, 0.25, 4.0);
  expect_to_follow(
      "[0, 0]", "0.5 - 0.5*cos(pi*t)", [](double t) { return 0.5 - 0.5 * std::cos(3.14159265 * t); }, 0.25, 4.0);
  expect_to_follow(
      "[0, 0]", "1", [](double) { return 1.0; }, 1.5, 2.0);
}

/// Before, a row of particles was pushed through the next one: the run ended.
TEST(FlowZones, AnOutflowBringsItsPressure) {
  std::string text = open_box("[1, 0.2]", "0.025", "", "velocity = [1, 0]", "velocity = [1, 0]", periodic_y);
  text.insert(text.find("[time]"), "pressure = 7\n");  // 7 % of rho c^2
  OpenRun open(text);
  open.run(3.0);
  EXPECT_NEAR(open.column("air_mean_pressure"), 7.0, 0.2);
  EXPECT_NEAR(open.column("air_mean_vx"), 1.0, 0.1);
}

void expect_same_bits(const OpenRun& a, const OpenRun& b) {
  const PhaseParticles &p = a.simulation->phases()[0], &q = b.simulation->phases()[0];
  ASSERT_EQ(p.id(), q.id());
  for (const Field field : {Field::position, Field::velocity, Field::density, Field::pressure})
    for (int c = 0; c < p.components(field); ++c)
      EXPECT_EQ(std::memcmp(p.column(field, c), q.column(field, c), p.size() * sizeof(double)), 0);
  EXPECT_EQ(a.simulation->history_row(), b.simulation->history_row());
}

TEST(FlowZones, HaveTheSameBitsOnTwoThreadsAndFromACheckpoint) {
  const std::string text = open_box("[1, 0.4]", "0.05", "", "perturb = 0.2\nvelocity = [\"1 + 0.2*sin(5*pi*y)\", 0]",
                                    "velocity = [\"cos(3*t) + 0.2*sin(5*pi*y)\", 0]\nlayer = 0.2\n"
                                    "fluctuations = { length = 0.2, rms = [0.1, 0.1] }",
                                    periodic_y);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  OpenRun straight(text);
  for (int k = 0; k < 150; ++k) straight.simulation->step(1e300);
  Archive saved;
  straight.simulation->archive(saved);
  for (int k = 0; k < 150; ++k) straight.simulation->step(1e300);
  omp_set_num_threads(2);
  OpenRun two(text);
  for (int k = 0; k < 300; ++k) two.simulation->step(1e300);
  expect_same_bits(straight, two);
  OpenRun again(text);
  Archive loaded(saved.bytes());
  again.simulation->archive(loaded);
  for (int k = 0; k < 150; ++k) again.simulation->step(1e300);
  expect_same_bits(straight, again);
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace barchan
