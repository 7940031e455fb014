// Relaxed packing: the number of places, how even they are, and the layer along the border.
#include "start/relaxed.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "start/generate.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::square_text;
using testing::with;

constexpr double dx = 0.1;

/// One fluid in a domain of 3 m (three dimensions: 1.4 m).
Scene one(const std::string& shape, int dimensions = 2) {
  std::string text = with(square_text, "\"the-rest\"", shape + "\npacking = \"relaxed\"");
  if (dimensions == 2) return parse_scene(with(text, "size = [1, 1]", "size = [3, 3]"), "s.toml");
  return parse_scene("dimensions = 3\n" + with(text, "size = [1, 1]", "size = [1.4, 1.4, 1.4]"), "s.toml");
}

/// A gear of ten trapezoidal teeth, 2.2 spacings wide at their tips and 3 high, as corners.
std::string gear() {
  std::ostringstream text;
  text << "{ polygon = [";
  for (int tooth = 0; tooth < 10; ++tooth)
    for (const auto& [r, part] :
         {std::pair{0.9, -0.32}, std::pair{1.2, -0.15}, std::pair{1.2, 0.15}, std::pair{0.9, 0.32}}) {
      const double a = 2.0 * std::numbers::pi * (tooth + part) / 10.0;
      text << (tooth + part > -0.3 ? ", " : "") << '[' << 1.5 + r * std::cos(a) << ", " << 1.5 + r * std::sin(a) << ']';
    }
  text << "] }";
  return text.str();
}

struct Measured {
  Evenness even;
  std::size_t count = 0;
  double least_depth = 1e300;  // spacings
  std::size_t in_layer = 0;    // nearer to the border than 0.75 spacings
  double volume_error = 0.0;   // of the shape's, by its known content
};

Measured measure(const Scene& scene, double content, std::size_t fill = 0, std::size_t phase = 0) {
  const auto x = generate(scene)[phase].position;
  const Solid region = region_of_fill(scene, fill, 5 * dx);
  Measured m{evenness_of(scene, fill, x), x.size(), 1e300, 0, 0.0};
  for (const Vec3& place : x) {
    const double depth = region.depth(place) / dx;
    m.least_depth = std::min(m.least_depth, depth);
    m.in_layer += depth < 0.75;
  }
  m.volume_error = static_cast<double>(x.size()) * std::pow(dx, scene.dimensions) / content - 1.0;
  ::testing::Test::RecordProperty("least_distance", std::to_string(m.even.least_distance));
  std::printf(
      "  %zu places, volume %+.2f %%, least distance %.3f dx, sums %.3f to %.3f (mean %.3f), least depth %.3f dx, "
      "layer of %zu\n",
      m.count, 100 * m.volume_error, m.even.least_distance, m.even.least_sum, m.even.largest_sum, m.even.mean_sum,
      m.least_depth, m.in_layer);
  return m;
}

TEST(Relaxed, ADiscHasRoundRows) {
  const Measured m = measure(one("{ disc = { centre = [1.53, 1.47], radius = 1 } }"), std::numbers::pi);
  EXPECT_NEAR(m.volume_error, 0.0, 0.003) << "half a particle is 0.0016";
  EXPECT_GT(m.even.least_distance, 0.8);
  EXPECT_GT(m.even.least_sum, 0.95);
  EXPECT_LT(m.even.largest_sum, 1.05);
  EXPECT_GT(m.least_depth, 0.49);
  EXPECT_NEAR(static_cast<double>(m.in_layer), 2.0 * std::numbers::pi * 9.5, 5.0);
}

TEST(Relaxed, ASquareThatFitsNoRows) {
  const Measured m = measure(one("{ polygon = [[0.5, 0.5], [1.53, 0.5], [1.53, 1.53], [0.5, 1.53]] }"), 1.03 * 1.03);
  EXPECT_NEAR(m.volume_error, 0.0, 0.006) << "half a particle is 0.005";
  EXPECT_GT(m.even.least_distance, 0.8);
  EXPECT_GT(m.even.least_sum, 0.93);
  EXPECT_LT(m.even.largest_sum, 1.07);
  EXPECT_GT(m.least_depth, 0.48);
}

TEST(Relaxed, ASquareThatFitsRowsKeepsThem) {
  const auto rows = generate(parse_scene(with(with(square_text, "size = [1, 1]", "size = [3, 3]"), "\"the-rest\"",
                                              "{ box = { min = [0.5, 0.5], max = [1.5, 1.5] } }"),
                                         "s.toml"))[0]
                        .position;
  const auto relaxed = generate(one("{ box = { min = [0.5, 0.5], max = [1.5, 1.5] } }"))[0].position;
  ASSERT_EQ(relaxed.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_LT(norm(relaxed[i] - rows[i]), 0.05 * dx);
}

TEST(Relaxed, TeethOfAGear) {
  const Scene scene = one(gear());
  const Solid region = region_of_fill(scene, 0, dx);
  double content = 0.0;  // by counting on a fine lattice
  for (double x = 0.005; x < 3.0; x += 0.01)
    for (double y = 0.005; y < 3.0; y += 0.01) content += region.depth({x, y, 0}) > 0.0 ? 1e-4 : 0.0;
  const Measured m = measure(scene, content);
  EXPECT_NEAR(m.volume_error, 0.0, 0.004);
  EXPECT_GT(m.even.least_distance, 0.7);
  EXPECT_GT(m.even.least_sum, 0.85);
  EXPECT_LT(m.even.largest_sum, 1.15);
  EXPECT_GT(m.least_depth, 0.4);
}

TEST(Relaxed, ABall) {
  const Measured m =
      measure(one("{ sphere = { centre = [0.7, 0.7, 0.7], radius = 0.5 } }", 3), 4.0 / 3.0 * std::numbers::pi * 0.125);
  EXPECT_NEAR(m.volume_error, 0.0, 0.005);
  EXPECT_GT(m.even.least_distance, 0.7);
  EXPECT_GT(m.even.least_sum, 0.9);
  EXPECT_LT(m.even.largest_sum, 1.1);
  EXPECT_GT(m.least_depth, 0.48);
}

/// A post in a channel that is periodic along x, and the fluid round it.
Scene post() {
  const std::string text =
      with(with(with(with(square_text, "size = [1, 1]", "size = [3, 2]\nperiodic = [\"x\"]"), "[interactions]",
                     "[phases.post]\nkind = \"wall\"\n[interactions]\nair-post = 2.1"),
                "[[fill]]",
                "[[fill]]\nphase = \"post\"\nshape = { disc = { centre = [0.1, 1.03], radius = 0.4 } }\npacking = "
                "\"relaxed\"\n[[fill]]"),
           "\"the-rest\"", "\"the-rest\"\npacking = \"relaxed\"");
  return parse_scene(text, "s.toml");
}

TEST(Relaxed, FluidGoesRoundABodyAcrossAPeriodicSide) {
  const Scene scene = post();
  const Measured m = measure(scene, 6.0 - 0.16 * std::numbers::pi, 1, 0);
  EXPECT_NEAR(m.volume_error, 0.0, 0.001);
  EXPECT_GT(m.even.least_distance, 0.75);
  EXPECT_GT(m.even.least_sum, 0.93);
  EXPECT_LT(m.even.largest_sum, 1.07);
  EXPECT_GT(m.least_depth, 0.48);
}

TEST(Relaxed, WallsKnowTheirSurface) {
  const auto post_block = generate(post())[1];
  ASSERT_EQ(post_block.depth.size(), post_block.position.size());
  EXPECT_TRUE(post_block.bend.empty());
  std::size_t outermost = 0;
  for (std::size_t i = 0; i < post_block.position.size(); ++i) {
    Vec3 r = post_block.position[i] - Vec3{0.1, 1.03, 0};
    r[0] -= 3.0 * std::round(r[0] / 3.0);
    EXPECT_NEAR(post_block.depth[i], 0.4 - norm(r), 1e-6);
    if (norm(r) > 0.1) { EXPECT_NEAR(dot(post_block.normal[i], r) / norm(r), 1.0, 1e-6); }
    outermost += post_block.depth[i] < 0.75 * dx;
  }
  EXPECT_NEAR(static_cast<double>(outermost), 2.0 * std::numbers::pi * 3.5, 2.0);
}

TEST(Relaxed, SameBitsOnAnyNumberOfThreads) {
  const Scene scene =
      parse_scene(with(with(with(square_text, "size = [1, 1]", "size = [8, 8]"), "\"the-rest\"",
                            "{ disc = { centre = [4.03, 3.98], radius = 3.9 } }\npacking = \"relaxed\""),
                       "spacing = 0.1", "spacing = 0.05"),
                  "s.toml");  // 24.5 m of border, 8 spacings deep: some 3800 places move
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one_thread = generate(scene)[0].position;
  omp_set_num_threads(3);
  const auto three = generate(scene)[0].position;
  omp_set_num_threads(before);
  EXPECT_EQ(one_thread, three);
}

TEST(Relaxed, NeedsABorder) {
  const auto refused = [](const std::string& shape) {
    try {
      one(shape);
    } catch (const SceneError& error) { return std::string(error.what()); }
    return std::string();
  };
  EXPECT_NE(refused("{ formula = \"x - 1\" }").find("fill.0.packing: relaxed places follow a border"),
            std::string::npos);
  EXPECT_NE(refused("{ bed = 0.3 }").find("relaxed places follow a border"), std::string::npos);
  EXPECT_EQ(refused("\"the-rest\""), "");
}

}  // namespace
}  // namespace barchan
