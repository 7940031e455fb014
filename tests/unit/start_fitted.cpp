// Rows fitted to the ground: no gap, no overlap, every particle its volume, and walls that know their surface.
#include "start/fitted.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "checks/reader.hpp"
#include "start/generate.hpp"
#include "start/places.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::square_text;
using testing::with;

/// Four by two metres of air over a wall with this dune, periodic along x (and four deep along a periodic z).
Scene over(const std::string& bed, int dimensions = 2) {
  std::string text = with(with(square_text, "air-air = 3.0\n", "air-air = 3.0\nair-hill = 3.0\n"), "density = 1\n",
                          "density = 1\n[phases.hill]\nkind = \"wall\"\n");
  text = with(text, "[[fill]]", "[[fill]]\nphase = \"hill\"\nshape = { " + bed + " }\npacking = \"fitted\"\n[[fill]]");
  text = with(text, "\"the-rest\"", "\"the-rest\"\npacking = \"fitted\"");
  if (dimensions == 2) return parse_scene(with(text, "size = [1, 1]", "size = [4, 2]\nperiodic = [\"x\"]"), "s.toml");
  return parse_scene("dimensions = 3\n" + with(text, "size = [1, 1]", "size = [4, 2, 2]\nperiodic = [\"x\", \"z\"]"),
                     "s.toml");
}

const std::string hill = "bed = 0.23, dune = { form = \"formula\", formula = \"0.2*(1 - cos(pi*x/2))\" }";

TEST(FittedRows, FillTheAirAndKeepApart) {
  const Scene scene = over(hill);
  const auto blocks = generate(scene);
  const auto &air = blocks[0].position, &wall = blocks[1].position;
  // 4 x 2 m^2 less a ground 0.43 m high in the mean
  EXPECT_NEAR(static_cast<double>(air.size()) * 0.01, 4 * (2 - 0.43), 0.05) << "whole rows";
  EXPECT_EQ(wall.size(), 4u * 40u);
  const PeriodicSpace space(scene.domain);
  double least = 1e300;
  for (std::size_t i = 0; i < air.size(); ++i) {
    EXPECT_GE(air[i][1], ground_height(scene, air[i][0], 0) + 0.045);
    EXPECT_LE(air[i][1], 1.955);
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, space.distance(air[i], air[j]));
    for (const auto& w : wall) least = std::min(least, space.distance(air[i], w));
  }
  EXPECT_GT(least, 0.09) << "a slope of 0.31 brings rows nearer by a twentieth";
}

TEST(FittedRows, OnFlatGroundAreRows) {
  const auto fitted = generate(over("bed = 0.3"))[0].position;
  std::string rows = with(square_text, "size = [1, 1]", "origin = [0, 0.3]\nsize = [4, 1.7]\nperiodic = [\"x\"]");
  const auto expected = generate(parse_scene(rows, "s.toml"))[0].position;
  ASSERT_EQ(fitted.size(), expected.size());
  const PeriodicSpace space(over("bed = 0.3").domain);
  for (const auto& x : expected) {
    double least = 1e300;
    for (const auto& y : fitted) least = std::min(least, space.distance(x, y));
    EXPECT_LT(least, 1e-12);
  }
}

TEST(FittedRows, WallsKnowTheirSurface) {
  for (const int dimensions : {2, 3}) {
    const Scene scene = over(hill, dimensions);
    const auto wall = generate(scene)[1];
    ASSERT_EQ(wall.depth.size(), wall.position.size());
    for (std::size_t k = 0; k < wall.position.size(); ++k) {
      const Vec3 foot = wall.position[k] + wall.depth[k] * wall.normal[k];
      EXPECT_NEAR(foot[1], ground_height(scene, foot[0], foot[2]), 1e-4);
      const double slope = 0.1 * std::numbers::pi * std::sin(0.5 * std::numbers::pi * foot[0]);
      EXPECT_NEAR(-wall.normal[k][0] / wall.normal[k][1], slope, 2e-3);
      EXPECT_NEAR(wall.normal[k][2], 0.0, 1e-9);
      const double second = 0.05 * std::pow(std::numbers::pi, 2) * std::cos(0.5 * std::numbers::pi * foot[0]);
      EXPECT_NEAR(wall.bend[k][0], second / std::hypot(1.0, slope), 0.01);
      EXPECT_NEAR(wall.bend[k][2], 0.0, 1e-9);
    }
  }
}

TEST(FittedRows, TheRushilHillIsItsFormula) {
  const Scene scene = over("bed = 0, dune = { form = \"rushil\", height = 0.2, length = 1.2, at = 2 }");
  const double a = 0.6, m = 0.2 / a + std::hypot(0.2 / a, 1.0);
  for (const double t : {0.0, 0.1, 0.3, 0.5, 0.59, 0.6}) {
    const double share = a * a / (t * t + m * m * (a * a - t * t));
    const double z = 0.5 * m * std::sqrt(a * a - t * t) * (1.0 - share);
    for (const double side : {-1.0, 1.0})
      EXPECT_NEAR(ground_height(scene, 2.0 + side * 0.5 * t * (1.0 + share), 0), z, 1e-12) << t;
  }
  EXPECT_NEAR(ground_height(scene, 2, 0), 0.2, 1e-12);
  EXPECT_EQ(ground_height(scene, 2.61, 0), 0.0);
}

}  // namespace
}  // namespace barchan
