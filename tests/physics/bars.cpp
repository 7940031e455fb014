// Bars in impact against exact solutions: waves of c = sqrt((lambda + 2 mu)/rho), 5936 m/s.
#include <cmath>
#include <numeric>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

constexpr double length = 0.040, wave = 5936.0, speed = 10.0;  // m, m/s, m/s

/// The bar's speed in the mean, m/s.
double mean_speed(const PhaseParticles& p) {
  double sum = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) sum += p.column(Field::velocity)[k];
  return sum / static_cast<double>(p.size());
}

struct Impact {
  double half, twentieth;    // time with more than that share of the exact force, over 2L/c
  double restitution, left;  // left: of the speed of A
};

Impact impact(const std::vector<std::string>& sets) {
  Drive drive("verification/two_bars", sets);
  auto& s = drive.simulation();
  const double exact = 2.0 * length / wave;
  double before = 0.0;
  std::array<double, 2> first{-1.0, -1.0}, last{};
  while (s.time() < 2.7e-5) {
    const double begin = s.time();
    s.step(1.0);
    const double gain = (mean_speed(drive.phase(1)) - before) / (s.time() - begin);
    before = mean_speed(drive.phase(1));
    for (const std::size_t k : {0u, 1u})
      if (gain > (k == 0 ? 0.5 : 0.05) * speed / exact) {
        if (first[k] < 0.0) first[k] = begin;
        last[k] = s.time();
      }
  }
  const double a = mean_speed(drive.phase(0)), b = mean_speed(drive.phase(1));
  return {(last[0] - first[0]) / exact, (last[1] - first[1]) / exact, (b - a) / speed, a / speed};
}

TEST(TotalLagrangianBodies, TwoEqualBarsTouchForTheExactTime) {
  const Impact bars = impact({"phases.a.wave-correction=false", "phases.b.wave-correction=false"});
  report("time of contact over 2L/c - 1", bars.half - 1.0, 0.02);
  report("restitution", bars.restitution, 0.98);
  report("speed of A over V", bars.left, 0.02);
  EXPECT_NEAR(bars.half, 1.0, 0.02);
  EXPECT_GE(bars.restitution, 0.98);
  EXPECT_LE(std::abs(bars.left), 0.02);
}

TEST(TotalLagrangianBodies, BarsThatCarryShortWavesTouchForTheExactTimeToATwentieth) {
  const Impact bars = impact({});
  report("time with a twentieth of the force over 2L/c - 1", bars.twentieth - 1.0, 0.01);
  report("time with half of it over 2L/c - 1", bars.half - 1.0, 0.01);
  report("restitution", bars.restitution, 0.995);
  EXPECT_NEAR(bars.twentieth, 1.0, 0.01);
  EXPECT_NEAR(bars.half, 1.0, 0.01);
  EXPECT_GE(bars.restitution, 0.995);
  EXPECT_LE(std::abs(bars.left), 0.0025);
}

/// `hits` bars in a row hit as many at rest, all of them touch from the start: the speed of each at the end over V.
std::vector<double> row_of_bars(std::size_t hits) {
  const std::size_t all = 2 * hits;
  std::string text = "dimensions = 2\nspacing = 1e-3\n[domain]\nperiodic = [\"y\"]\nsize = [" +
                     std::to_string(0.01 + length * static_cast<double>(all + 1)) + ", 0.005]\n";
  std::string touching = "[interactions]\n", fills;
  for (std::size_t k = 0; k < all; ++k) {
    const std::string name = "b" + std::to_string(k), next = "b" + std::to_string(k + 1);
    text += "[phases." + name +
            "]\nkind = \"elastic\"\ndensity = 7870\nyoung = 206e9\npoisson = 0.3\nwave-correction = true\n";
    touching += name + "-" + name + " = { radius = 1.6, kernel = \"wendland-c2\" }\n";
    if (k + 1 < all) touching += name + "-" + next + " = { restitution = 1 }\n";
    const double low = 0.005 + length * static_cast<double>(k);
    fills += "[[fill]]\nphase = \"" + name + "\"\nshape = { box = { min = [" + std::to_string(low) + ", 0], max = [" +
             std::to_string(low + length) + ", 0.005] } }\n" + (k < hits ? "velocity = [10, 0]\n" : "");
  }
  Scene scene = parse_scene(text + touching + fills + "[time]\nend = 1\nlargest-speed = 20\n", "bars.toml");
  const auto blocks = generate(scene);
  Simulation run(scene, make_plan(scene, blocks), blocks);
  while (run.time() < 1.3 * length / wave * static_cast<double>(all + 1)) run.step(1.0);
  std::vector<double> speeds;
  for (const PhaseParticles& bar : run.phases()) speeds.push_back(mean_speed(bar) / speed);
  return speeds;
}

TEST(TotalLagrangianBodies, BarsGiveAsManyBarsTheirSpeed) {
  for (const std::size_t hits : {2u, 5u}) {
    const std::vector<double> v = row_of_bars(hits);
    const auto middle = v.begin() + static_cast<std::ptrdiff_t>(hits);
    const double n = static_cast<double>(hits), left = std::accumulate(v.begin(), middle, 0.0) / n,
                 given = std::accumulate(middle, v.end(), 0.0) / n;
    report(std::to_string(hits) + " bars hit as many: restitution of the rows", given - left, 0.98);
    EXPECT_NEAR(given - left, 1.0, 0.02);
    for (std::size_t k = 0; k < v.size(); ++k) EXPECT_NEAR(v[k], k < hits ? 0.0 : 1.0, 0.025) << "bar " << k;
  }
}

}  // namespace
}  // namespace barchan
