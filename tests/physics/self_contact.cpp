// A body that touches itself: as two bodies do, momentum and energy stay, and where nothing touches nothing changes.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

const std::string scene = "verification/self_contact",
                  silent = "interactions={ kernel = \"wendland-c2\", rubber-rubber = { radius = 1.6 } }";

/// The same fork as an updated Lagrangian body; `says`: of its entry, after the radius.
std::vector<std::string> updated(const std::string& says = ", restitution = 1") {
  return {
      "phases.rubber={ kind = \"elastic\", formulation = \"updated-lagrangian\", density = 1200, young = 1e7, poisson "
      "= 0.4 }",
      "interactions={ kernel = \"cubic-spline\", rubber-rubber = { radius = 2.1" + says + " } }",
      "output.fields=[\"von_mises_stress\"" + std::string(says.empty() ? "]" : ", \"contact_force\"]")};
}

/// Place and velocity by id.
std::vector<std::array<double, 4>> motion_of(const PhaseParticles& p) {
  std::vector<std::array<double, 4>> rows(p.size());
  for (std::size_t k = 0; k < p.size(); ++k)
    for (int d = 0; d < 2; ++d) {
      auto& row = rows[static_cast<std::size_t>(p.id()[k] - p.first_id())];
      row[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
      row[static_cast<std::size_t>(d) + 2] = p.column(Field::velocity, d)[k];
    }
  return rows;
}

/// The sum of the columns that begin with this, or of their sizes.
double sum_of(const Simulation& run, const std::string& begin, bool sizes = false) {
  const auto names = run.history_columns();
  const auto row = run.history_row();
  double sum = 0.0;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k].starts_with(begin)) sum += sizes ? std::abs(row[k]) : row[k];
  return sum;
}

/// m, between the middles of the ends of the prongs.
double ends_apart(Drive& d) { return sum_of(d.simulation(), "upper_y") - sum_of(d.simulation(), "lower_y"); }

double energy_of(const Simulation& run) {
  return sum_of(run, "rubber_kinetic_energy") + sum_of(run, "rubber_strain_energy") +
         sum_of(run, "rubber_hourglass_energy");
}

/// m, the distance of the nearest particles of both prongs in the step in which the first force of contact is felt.
double first_distance(Drive& drive, std::size_t phases) {
  for (int step = 0; step < 2000; ++step) {
    drive.simulation().step(1.0);
    std::vector<std::array<double, 2>> upper, lower;
    bool felt = false;
    for (std::size_t phase = 0; phase < phases; ++phase) {
      const PhaseParticles& p = drive.phase(phase);
      for (std::size_t k = 0; k < p.size(); ++k) {
        const double x = p.column(Field::position)[k], y = p.column(Field::position, 1)[k];
        if (x > 0.01) (y > 0.0 ? upper : lower).push_back({x, y});
        felt = felt || p.column(Field::contact_force, 1)[k] != 0.0;
      }
    }
    if (!felt) continue;
    double nearest = 1e300;
    for (const auto& [x, y] : upper)
      for (const auto& [s, t] : lower) nearest = std::min(nearest, std::hypot(x - s, y - t));
    return nearest;
  }
  return 0.0;
}

TEST(SelfContact, PartsOfABodyTouchWhereTwoBodiesDo) {
  Drive fork(scene);
  // The same with a handle that is cut between the prongs: two bodies.
  const std::string speed = "velocity = [0, \"-1.7*(max(x - 0.006, 0)/0.034)^2*((y > 0) - (y < 0))\"] }";
  const std::string body = " = { kind = \"elastic\", density = 1200, young = 1e7, poisson = 0.4 }";
  Drive halves(scene,
               {"phases={ rubber" + body + ", other" + body + " }",
                "interactions={ kernel = \"wendland-c2\", rubber-rubber = 1.6, other-other = 1.6, rubber-other = { "
                "restitution = 1 } }",
                "fill=[{ phase = \"rubber\", shape = { polygon = [[0, 0.001], [0.006, 0.001], [0.006, 0.002], [0.04, "
                "0.002], [0.04, 0.008], [0, 0.008]] }, " +
                    speed +
                    ", { phase = \"other\", shape = { polygon = [[0, -0.001], [0.006, -0.001], [0.006, -0.002], [0.04, "
                    "-0.002], [0.04, -0.008], [0, -0.008]] }, " +
                    speed + "]",
                "marker=[]"});
  const double one = first_distance(fork, 1) / 1e-3, two = first_distance(halves, 2) / 1e-3;
  report("distance at the first touch, dx", one, 1.0);
  report("less that of two bodies, dx", one - two, 0.1);
  EXPECT_GT(two, 0.9);
  EXPECT_NEAR(one, two, 0.1);
}

TEST(SelfContact, ProngsBounceAndKeepMomentumAndEnergy) {
  Drive fork(scene), broken(scene, {silent});
  const double before = energy_of(fork.simulation());
  const double scale = 1.0 * fork.phase(0).mass() * static_cast<double>(fork.phase(0).size());  // of 1 m/s
  double drift = 0.0, nearest = 1e300, through = 1e300;
  for (int k = 1; k <= 50; ++k) {
    const double time = 2e-4 * k;
    fork.to(time);
    broken.to(time);
    drift = std::max(drift, sum_of(fork.simulation(), "momentum_", true) / scale);
    nearest = std::min(nearest, ends_apart(fork));
    through = std::min(through, ends_apart(broken));
  }
  const double change = energy_of(fork.simulation()) / before - 1.0;
  report("momentum over that of 1 m/s", drift, 1e-12);
  report("energy after they part over that before - 1", change, 0.01);
  report("nearest middles of the ends, m; 6 mm of rubber", nearest, 5.5e-3);
  report("without the entry, m", through, 4e-3);
  EXPECT_LT(drift, 1e-12);
  EXPECT_LT(std::abs(change), 0.01);
  EXPECT_GT(nearest, 5.5e-3);
  EXPECT_LT(through, 4e-3) << "without the entry they swing through each other";
}

// Of an updated Lagrangian body the kernel holds the prongs apart too early; with the entry stress acts only between
// what is near in the first shape.
TEST(SelfContact, ProngsOfAnUpdatedLagrangianBodyTouchWithTheirSurfaces) {
  Drive fork(scene, updated()), by_kernel(scene, updated(""));
  const double before = energy_of(fork.simulation());
  const double scale = 1.0 * fork.phase(0).mass() * static_cast<double>(fork.phase(0).size());
  double drift = 0.0, nearest = 1e300, early = 1e300;
  for (int k = 1; k <= 50; ++k) {
    fork.to(2e-4 * k);
    by_kernel.to(2e-4 * k);
    drift = std::max(drift, sum_of(fork.simulation(), "momentum_", true) / scale);
    nearest = std::min(nearest, ends_apart(fork));
    early = std::min(early, ends_apart(by_kernel));
  }
  const double change = energy_of(fork.simulation()) / before - 1.0;
  report("momentum over that of 1 m/s", drift, 1e-12);
  report("energy after they part over that before - 1", change, 0.01);
  report("nearest middles of the ends, m; 6 mm of rubber", nearest, 5.5e-3);
  report("by the kernel, m", early, 6.3e-3);
  EXPECT_LT(drift, 1e-12);
  EXPECT_LT(std::abs(change), 0.01);
  EXPECT_NEAR(nearest, 6e-3, 1e-4);
  EXPECT_GT(early, 6.3e-3);
}

TEST(SelfContact, ChangesNothingWhereNothingTouches) {
  const std::string gentle = "fill.0.velocity=[0, \"-0.6*(max(x - 0.006, 0)/0.034)^2*((y > 0) - (y < 0))\"]",
                    step = "time.step=3e-6";
  Drive with(scene, {gentle, step}), without(scene, {gentle, step, silent});
  with.to(6e-3);
  without.to(6e-3);
  EXPECT_EQ(motion_of(with.phase(0)), motion_of(without.phase(0)));

  std::vector<std::string> contact = updated(), none = updated("");
  for (auto* sets : {&contact, &none}) sets->insert(sets->end(), {gentle, "time.step=2e-6"});
  Drive one(scene, contact), other(scene, none);
  one.to(3e-3);
  other.to(3e-3);
  EXPECT_EQ(motion_of(one.phase(0)), motion_of(other.phase(0)));
}

void keeps_its_bits(const std::vector<std::string>& sets) {
  Drive run(scene, sets), other(scene, sets);
  run.to(2.5e-3);
  double felt = 0.0;
  const PhaseParticles& p = run.phase(0);
  for (std::size_t k = 0; k < p.size(); ++k) felt = std::max(felt, std::abs(p.column(Field::contact_force, 1)[k]));
  EXPECT_GT(felt, 0.0) << "the prongs touch";
  Archive written;
  run.simulation().archive(written);
  Archive saved(written.bytes());
  other.simulation().archive(saved);
  saved.finish();
  const int threads = omp_get_max_threads();
  const auto go_on = [](Drive& drive, int on) {
    omp_set_num_threads(on);
    for (int k = 0; k < 300; ++k) drive.simulation().step(1.0);
  };
  go_on(run, 1);
  go_on(other, 2);
  omp_set_num_threads(threads);
  EXPECT_EQ(motion_of(run.phase(0)), motion_of(other.phase(0)));
  EXPECT_EQ(run.simulation().history_row(), other.simulation().history_row());
}

TEST(SelfContact, KeepsItsBitsOnOtherThreadsAndAfterARestart) {
  keeps_its_bits({});
  keeps_its_bits(updated());
}

}  // namespace
}  // namespace barchan
