// velocity_gradient and shear_rate of a laminar fluid, which output.fields asks for.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "small_scenes.hpp"

namespace barchan {
namespace {

using std::numbers::pi;

const std::string couette = R"toml(
spacing = 0.05
[domain]
size = [1, 1]
periodic = ["x"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-2
sound-speed = 20
[phases.floor]
kind = "wall"
[phases.lid]
kind = "wall"
velocity = [2, 0]
[interactions]
water-water = {}
water-floor = {}
water-lid = {}
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "lid"
shape = { sides = ["top"] }
[[fill]]
phase = "water"
shape = "the-rest"
velocity = ["2*y", 0]
perturb = 0.2
[time]
end = 1
largest-speed = 2
[output]
fields = ["velocity_gradient", "shear_rate"]
)toml";

const FrameField& field(const Frame& frame, const std::string& name) {
  return *std::find_if(frame.fields.begin(), frame.fields.end(), [&](const FrameField& f) { return f.name == name; });
}

/// Corrected sums are exact of a linear velocity, wherever the particles stand, to the walls.
TEST(VelocityGradient, IsThatOfALinearFlowBetweenWalls) {
  for (const char* precision : {"double", "mixed"}) {
    const auto run = small::simulation("precision = \"" + std::string(precision) + "\"\n" + couette);
    for (int step = 0; step < 2; ++step) {
      const Frame frame = run->frame(step);
      const FrameField &gradient = field(frame, "velocity_gradient"), &shear = field(frame, "shear_rate");
      ASSERT_EQ(gradient.components, 4);
      for (std::size_t k = 0; k < frame.size(); ++k) {
        if (frame.phase[k] != 0) continue;
        const double y = frame.points[3 * k + 1], near = step == 0 && y > 0.15 && y < 0.85 ? 1e-9 : 0.1;
        for (int c = 0; c < 4; ++c)
          ASSERT_NEAR(gradient.values[4 * k + static_cast<std::size_t>(c)], c == 1 ? 2.0 : 0.0, near) << y;
        ASSERT_NEAR(shear.values[k], 2.0, near);
      }
      run->step(1.0);
    }
  }
}

/// Of vortices, images and lists are those of the moment; in 3D too. u = sin(pi x) cos(pi y), v = -cos(pi x) sin(pi y).
TEST(VelocityGradient, OfVorticesConverges) {
  for (const int dimensions : {2, 3}) {
    double before = 0.0;
    for (const int n : {16, 32}) {
      const bool flat = dimensions == 2;
      const std::string text = "spacing = " + std::to_string(2.0 / n) + "\ndimensions = " + std::to_string(dimensions) +
                               "\n[domain]\nsize = [2, 2" + (flat ? "]" : ", 1]") + "\nperiodic = [\"x\", \"y\"" +
                               (flat ? "]" : ", \"z\"]") + R"toml(
[phases.water]
kind = "fluid"
density = 1
viscosity = 0.01
sound-speed = 10
[interactions]
water-water = {}
[[fill]]
phase = "water"
shape = "the-rest"
velocity = ["sin(pi*x)*cos(pi*y)", "-cos(pi*x)*sin(pi*y)")toml" +
                               std::string(flat ? "]" : ", 0]") + R"toml(
[time]
end = 1
largest-speed = 1
[output]
fields = ["velocity_gradient", "shear_rate"]
)toml";
      const auto run = small::simulation(text);
      const Frame frame = run->frame(0);
      const FrameField &gradient = field(frame, "velocity_gradient"), &shear = field(frame, "shear_rate");
      double worst = 0.0;
      for (std::size_t k = 0; k < frame.size(); ++k) {
        const double x = pi * frame.points[3 * k], y = pi * frame.points[3 * k + 1], c = std::cos(x) * std::cos(y),
                     s = std::sin(x) * std::sin(y);
        const auto at = [&](int i, int j) {
          return 1.0 / pi *
                 gradient.values[static_cast<std::size_t>(gradient.components) * k +
                                 static_cast<std::size_t>(i * dimensions + j)];
        };
        for (const double error :
             {at(0, 0) - c, at(0, 1) + s, at(1, 0) - s, at(1, 1) + c, shear.values[k] / pi - 2.0 * std::abs(c)})
          worst = std::max(worst, std::abs(error));
      }
      if (n == 32) {
        EXPECT_LT(worst, 0.03);
        EXPECT_LT(worst, before / 3.5) << "second order";
      }
      before = worst;
    }
  }
}

/// Who does not ask has the same bits: no column, no record more.
TEST(VelocityGradient, IsNothingToAStep) {
  const auto with = small::simulation(couette), without = small::simulation(couette, {"output.fields=[]"});
  for (int step = 0; step < 20; ++step) {
    with->step(1.0);
    without->step(1.0);
    with->frame(0);
  }
  EXPECT_FALSE(without->phases()[0].has(Field::velocity_gradient));
  for (const Field f : {Field::position, Field::velocity, Field::density})
    for (std::size_t k = 0; k < with->phases()[0].size(); ++k)
      ASSERT_EQ(with->phases()[0].column(f, 0)[k], without->phases()[0].column(f, 0)[k]);
}

}  // namespace
}  // namespace barchan
