// A sphere whose contacts take no energy, on a floor at the overlap that carries its weight.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

double value(const Simulation& run, const std::string& column) {
  const auto names = run.history_columns();
  const auto at = std::find(names.begin(), names.end(), column);
  return at == names.end() ? NAN : run.history_row()[static_cast<std::size_t>(at - names.begin())];
}

std::string text(double x) {
  char t[32];
  std::snprintf(t, sizeof t, "%.17g", x);
  return t;
}

struct Spring {
  std::string law, keys;
  double overlap;  // m, under the weight
};

// Nothing damps it: a spring that is softer than its stiffness lets it oscillate about a deeper place for ever.
TEST(SpheresWithoutLoss, StayAtTheOverlapOfTheirWeight) {
  constexpr double d = 5e-3, weight = 2500.0 * std::numbers::pi / 6.0 * d * d * d * 9.81, stiffness = 2000.0,
                   young = 1e7;
  const double modulus = 4.0 / 3.0 * 0.5 * young / (1.0 - 0.09) * std::sqrt(0.5 * d);
  for (const Spring& spring : {Spring{"linear", "stiffness = 2000", weight / stiffness},
                               Spring{"hertz", "young = 1e7\npoisson = 0.3", std::pow(weight / modulus, 2.0 / 3.0)}}) {
    const auto run = small::simulation(R"toml(
dimensions = 3
spacing = 5e-3
[domain]
size = [0.05, 0.05, 0.05]
gravity = [0, -9.81, 0]
[phases.ball]
kind = "grains"
density = 2500
diameter = 5e-3
restitution = 1
)toml" + spring.keys + R"toml(
[phases.floor]
kind = "wall"
[interactions]
ball-ball = { law = ")toml" + spring.law +
                                       R"toml(" }
ball-floor = { law = ")toml" + spring.law +
                                       R"toml(" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "ball"
shape = { points = [[0.025, )toml" + text(0.5 * d - spring.overlap) +
                                       R"toml(, 0.025]] }
[time]
end = 1
largest-speed = 0.1
)toml");
    for (int k = 0; k < 1000; ++k) run->step(1.0);
    EXPECT_NEAR(value(*run, "contacts_deepest") * d, spring.overlap, 1e-8 * spring.overlap) << spring.law;
    EXPECT_LT(value(*run, "ball_largest_speed [m/s]"), 1e-10) << spring.law;
  }
}

}  // namespace
}  // namespace barchan
