// The generators: counts, exact periods, no overlap, no gaps, the wind profile, the same particles every time.
#include "start/generate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "physics/small_scenes.hpp"
#include "start/places.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::dune_text;
using testing::square_text;
using testing::with;

std::vector<Vec3> all_positions(const std::vector<ParticleBlock>& blocks) {
  std::vector<Vec3> all;
  for (const ParticleBlock& block : blocks) all.insert(all.end(), block.position.begin(), block.position.end());
  return all;
}

/// The naive twin of every search in the generators: all pairs.
double least_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const PeriodicSpace& space) {
  double least = 1e300;
  for (const Vec3& x : a)
    for (const Vec3& y : b)
      if (&x != &y) least = std::min(least, space.distance(x, y));
  return least;
}

double nearest_to(const Vec3& x, const std::vector<Vec3>& places, const PeriodicSpace& space) {
  double least = 1e300;
  for (const Vec3& y : places) least = std::min(least, space.distance(x, y));
  return least;
}

std::string fault_of(const Scene& scene) {
  try {
    generate(scene);
  } catch (const SceneError& error) { return error.what(); }
  return "";
}

/// A unit square of grains with the given shape and packing; periodic in x unless told otherwise.
Scene grains(const std::string& shape, const std::string& more = "", const std::string& size = "[1, 1]") {
  std::string text =
      with(with(square_text, "kind = \"fluid\"", "kind = \"grains\""), "\"the-rest\"", shape + "\n" + more);
  return parse_scene(with(text, "size = [1, 1]", "size = " + size + "\nperiodic = [\"x\"]"), "s.toml");
}

TEST(Generate, RowsStartHalfASpacingInsideAndArePeriodic) {
  const Scene scene = parse_scene(
      with(square_text, "size = [1, 1]", "origin = [-3, 2]\nsize = [1, 2]\nperiodic = [\"x\", \"y\"]"), "s.toml");
  const auto blocks = generate(scene);
  ASSERT_EQ(blocks.size(), 1u);
  const auto& x = blocks[0].position;
  ASSERT_EQ(x.size(), 200u);
  EXPECT_NEAR(x.front()[0], -2.95, 1e-14);
  EXPECT_NEAR(x.front()[1], 2.05, 1e-14);
  EXPECT_EQ(x.front()[2], 0.0);
  const PeriodicSpace space(scene.domain);
  for (const Vec3& place : x) {
    std::vector<Vec3> others = x;
    std::erase(others, place);
    EXPECT_NEAR(nearest_to(place, others, space), 0.1, 1e-13);
    EXPECT_NEAR(nearest_to(place + Vec3{0.1, 0, 0}, x, space), 0.0, 1e-13)
        << "every particle has a neighbour on its right";
    EXPECT_NEAR(nearest_to(place + Vec3{0, 0.1, 0}, x, space), 0.0, 1e-13);
  }
  EXPECT_TRUE(blocks[0].pressure.empty());
}

TEST(Generate, SpacingsThatBinaryNumbersCannotHoldGiveTheRightCount) {
  for (const int n : {7, 10, 30, 49, 100, 333}) {
    char spacing[64];
    std::snprintf(spacing, sizeof spacing, "spacing = %.17g", 1.0 / n);
    const Scene scene = parse_scene(
        with(with(square_text, "spacing = 0.1", spacing), "size = [1, 1]", "size = [1, 1]\nperiodic = [\"x\"]"),
        "s.toml");
    EXPECT_EQ(generate(scene)[0].position.size(), static_cast<std::size_t>(n * n)) << n;
  }
}

TEST(Generate, StaggeredRowsTouchSixNeighboursAcrossThePeriod) {
  const Scene scene = grains("{ bed = 0.5 }", "packing = \"staggered\"");
  const auto x = generate(scene)[0].position;
  const PeriodicSpace space(scene.domain);
  EXPECT_NEAR(least_distance(x, x, space), 0.1, 1e-13);
  EXPECT_EQ(x.size(), 60u) << "rows at 0.05, 0.1366, 0.2232, 0.3098, 0.3964 and 0.4830 m";
  for (const Vec3& place : x) {
    if (place[1] < 0.06 || place[1] > 0.42) continue;
    EXPECT_EQ(std::count_if(x.begin(), x.end(), [&](const Vec3& y) { return space.distance(place, y) < 0.1001; }), 7);
  }
}

TEST(Generate, ClosePackingInThreeDimensionsTouchesTwelveNeighbours) {
  const double depth = std::sqrt(3.0);
  char size[64];
  std::snprintf(size, sizeof size, "[1, 1, %.17g]\nperiodic = [\"x\", \"z\"]", depth * 0.5);
  std::string text = with(with(square_text, "kind = \"fluid\"", "kind = \"grains\""), "\"the-rest\"",
                          "{ bed = 0.6 }\npacking = \"staggered\"");
  const Scene scene = parse_scene("dimensions = 3\n" + with(text, "[1, 1]", size), "s.toml");
  const auto x = generate(scene)[0].position;
  const PeriodicSpace space(scene.domain);
  EXPECT_NEAR(least_distance(x, x, space), 0.1, 1e-12);
  for (const Vec3& place : x) {
    if (place[1] < 0.06 || place[1] > 0.45) continue;
    EXPECT_EQ(std::count_if(x.begin(), x.end(), [&](const Vec3& y) { return space.distance(place, y) < 0.1001; }), 13);
  }
}

TEST(Generate, APeriodThatStaggeredRowsDoNotFitIsRefusedWithTheNearestThatDo) {
  const std::string text = with(with(square_text, "kind = \"fluid\"", "kind = \"grains\""), "\"the-rest\"",
                                "\"the-rest\"\npacking = \"staggered\"");
  EXPECT_EQ(fault_of([&] {
              Scene scene = parse_scene(text, "s.toml");
              scene.domain.periodic[1] = true;
              return scene;
            }()),
            "s.toml:3:8: domain.size: 1 m along the periodic axis y is not a whole number of staggered double rows "
            "(0.173205080756888 m); expected "
            "0.866025403784439 or 1.03923048454133 m");
  EXPECT_EQ(
      fault_of([&] {
        Scene scene = parse_scene(square_text, "s.toml");
        scene.domain.size[0] = 1.03;
        scene.domain.periodic[0] = true;
        return scene;
      }()),
      "s.toml:3:8: domain.size: 1.03 m along the periodic axis x is not a whole number of spacings (0.1 m); expected "
      "1 or 1.1 m");
}

TEST(Generate, RandomGrainsDoNotTouchAndAreTheSameEveryTime) {
  const Scene scene = grains("\"the-rest\"", "packing = \"random\"\nseed = 5", "[4, 4]");
  const auto x = generate(scene)[0].position, again = generate(scene)[0].position;
  const PeriodicSpace space(scene.domain);
  EXPECT_GE(least_distance(x, x, space), 0.1);
  EXPECT_EQ(x, again);
  const double area = static_cast<double>(x.size()) * std::numbers::pi * 0.05 * 0.05 / (4.0 * 3.9);
  EXPECT_GT(area, 0.49) << "documented density";
  EXPECT_LT(area, 0.56) << "jamming limit of random sequential addition, 0.547";
  Scene other = scene;
  other.fills[0].seed = 6;
  EXPECT_NE(generate(other)[0].position, x);
}

TEST(Generate, RandomNumbersDoNotDependOnTheLibrary) {
  const Scene scene = parse_scene(
      with(square_text, "\"the-rest\"", "{ points = [[0.5, 0.5]] }\nperturb = 0.2\nseed = 1234567"), "s.toml");
  // splitmix64 with seed 1234567 begins 6457827717110365317, 3203168211198807973 (reference values of its authors'
  // code).
  const auto uniform = [](double bits) { return -0.02 + 0.04 * std::floor(bits / 2048.0) * 0x1p-53; };
  const Vec3 x = generate(scene)[0].position.at(0);
  EXPECT_NEAR(x[0], 0.5 + uniform(6457827717110365317.0), 1e-15);
  EXPECT_NEAR(x[1], 0.5 + uniform(3203168211198807973.0), 1e-15);
}

TEST(Generate, PerturbMovesByAtMostItsSizeAndKeepsThePeriod) {
  const std::string periodic = with(square_text, "size = [1, 1]", "size = [1, 1]\nperiodic = [\"x\", \"y\"]");
  const auto regular = generate(parse_scene(periodic, "s.toml"))[0].position;
  const Scene scene = parse_scene(periodic, "s.toml", {"fill.0.perturb=0.2"});
  const auto moved = generate(scene)[0].position;
  ASSERT_EQ(moved.size(), regular.size());
  const PeriodicSpace space(scene.domain);
  double mean = 0.0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    EXPECT_LE(std::abs(moved[i][0] - regular[i][0]), 0.02);
    EXPECT_LE(std::abs(moved[i][1] - regular[i][1]), 0.02);
    mean += space.distance(moved[i], regular[i]) / static_cast<double>(moved.size());
  }
  EXPECT_NEAR(mean, 0.02 * 0.7652, 0.0015)
      << "mean distance of a uniform point of a square of half side 1 from its centre: 0.7652";
}

TEST(Generate, AirOverADuneOfRowsNeitherOverlapsNorLeavesGaps) {
  const Scene scene = parse_scene(dune_text, "dune.toml", {"spacing=2e-3"});
  const auto blocks = generate(scene);
  const PeriodicSpace space(scene.domain);
  const auto &air = blocks[0].position, &sand = blocks[1].position;
  EXPECT_EQ(air.size() + sand.size(), 200u * 50u) << "sand and air share one lattice";
  EXPECT_NEAR(least_distance(air, sand, space), 2e-3, 1e-12);
  for (const Vec3& x : sand) EXPECT_LT(x[1], ground_height(scene, x[0], 0));
  for (const Vec3& x : air) EXPECT_GE(x[1], ground_height(scene, x[0], 0) - 1e-12);
}

TEST(Generate, AirOverAStaggeredOrShapelessDuneKeepsItsDistance) {
  for (const char* packing : {"staggered", "random"}) {
    const Scene scene = parse_scene(dune_text, "dune.toml", {"spacing=2e-3", std::string("fill.0.packing=") + packing});
    const auto blocks = generate(scene);
    const PeriodicSpace space(scene.domain);
    const auto all = all_positions(blocks);
    EXPECT_GE(least_distance(blocks[0].position, blocks[1].position, space), 0.75 * 2e-3) << packing;
    if (std::string(packing) == "random") continue;  // loose sand has holes of its own
    double largest_hole = 0.0;
    for (double x = 0; x < 0.4; x += 2.3e-3)
      for (double y = 1e-3; y < 0.05; y += 1.1e-3)
        largest_hole = std::max(largest_hole, nearest_to({x, y, 0}, all, space));
    EXPECT_LT(2.0 * largest_hole, 2.0 * 1.5 * 2e-3) << "no point is farther than 1.5 spacings from a particle";
    EXPECT_LT(largest_hole, 1.1 * 2e-3);
  }
}

TEST(Generate, ABedMayStartAboveAFloor) {
  const std::string two = "{ bed = 0.2 }\n[[fill]]\nphase = \"air\"\nshape = { bed = 0.5, from = 0.2 }";
  const Scene scene = grains(two);
  const auto x = generate(scene)[0].position;
  EXPECT_EQ(x.size(), 50u);
  EXPECT_NEAR(least_distance(x, x, PeriodicSpace(scene.domain)), 0.1, 1e-13);
}

TEST(Generate, DuneShapes) {
  Scene scene = parse_scene(dune_text, "dune.toml");
  auto& dune = *std::get<BedShape>(scene.fills[0].shape).dune;
  EXPECT_DOUBLE_EQ(ground_height(scene, 0.15, 0), 0.03);
  EXPECT_NEAR(ground_height(scene, 0.12, 0), 0.02, 1e-15) << "half height a quarter length from the crest";
  EXPECT_DOUBLE_EQ(ground_height(scene, 0.09, 0), 0.01);
  dune.at = 0.39;
  EXPECT_NEAR(ground_height(scene, 0.02, 0), 0.02, 1e-15) << "the profile repeats itself with the domain";
  EXPECT_NEAR(ground_height(scene, 0.02 + 0.4, 0), ground_height(scene, 0.02, 0), 1e-15);
  dune.form = DuneShape::Form::gaussian;
  dune.at = 0.2;
  EXPECT_NEAR(ground_height(scene, 0.26, 0), 0.02, 1e-15) << "length is the full width at half height";
  dune.form = DuneShape::Form::asymmetric;
  dune.slip_face_angle = 45;
  EXPECT_NEAR(ground_height(scene, 0.21, 0), 0.02, 1e-15) << "45 degrees: down 0.01 in 0.01";
  EXPECT_NEAR(ground_height(scene, 0.2201, 0), 0.01, 1e-15);
  EXPECT_NEAR(ground_height(scene, 0.15, 0), 0.02, 1e-15) << "windward half length 0.12 - 0.02 = 0.1";
  EXPECT_NEAR(ground_height(scene, 0.0999, 0), 0.01, 1e-15);
  dune.form = DuneShape::Form::formula;
  dune.formula = {"0.1*x + z", 0.0};
  EXPECT_NEAR(ground_height(scene, 0.2, 0.5), 0.01 + 0.02 + 0.5, 1e-15);
  scene.fills.erase(scene.fills.begin());
  EXPECT_EQ(ground_height(scene, 0.15, 0), 0.0);
}

TEST(Generate, WindIsLogarithmicOverTheGround) {
  // u at 1, 5, 10, 50 and 100 mm for u* = 0.4 m/s and y0 = d/30 = 8.333e-6 m, kappa = 0.4 (u = ln(y/y0)).
  const double height[] = {1e-3, 5e-3, 10e-3, 50e-3, 100e-3}, wind[] = {4.788, 6.397, 7.090, 8.700, 9.393};
  std::string points, text = with(square_text, "size = [1, 1]", "size = [4, 4]");
  for (std::size_t k = 0; k < 5; ++k)  // side by side: points of a fill are half a spacing apart
    points += (k == 0 ? "[" : ", [") + std::to_string(1.0 + 0.3 * static_cast<double>(k)) + ", " +
              std::to_string(0.5 + height[k]) + "]";
  text = with(
      text, "[[fill]]",
      "[phases.ground]\nkind = \"grains\"\ndensity = 1\n[[fill]]\nphase = \"ground\"\nshape = { bed = 0.5 }\n[[fill]]");
  text = with(text, "\"the-rest\"",
              "{ points = [[3, 0.6000001], " + points +
                  "] }\nvelocity = { log-profile = { friction-velocity = 0.4, roughness = 8.333e-6 } }");
  Scene scene = parse_scene(text, "s.toml");
  const auto blocks = generate(scene);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(blocks[0].velocity.at(k + 1)[0], wind[k], 6e-4) << height[k];
    EXPECT_EQ(blocks[0].velocity.at(k + 1)[1], 0.0);
  }
  EXPECT_EQ(blocks[1].velocity.at(0), (Vec3{0, 0, 0}));
  scene.fills[1].log_profile->roughness = 0.2;
  EXPECT_EQ(generate(scene)[0].velocity.at(0)[0], 0.0) << "no wind below the roughness length";
  scene.fills[1].log_profile->over_ground = false;
  EXPECT_NEAR(generate(scene)[0].velocity.at(0)[0], std::log(0.6 / 0.2), 1e-6);
  scene.fills[1].velocity[0].value = 2.0;
  EXPECT_NEAR(generate(scene)[0].velocity.at(0)[0], 2.0 + std::log(0.6 / 0.2), 1e-6) << "added to the velocity";
}

/// Between the ground and a streamline flows the same everywhere: the integral of u over the height is that of the
/// logarithm over the flat bed, and a particle's velocity points along its streamline.
TEST(Generate, WindAlongTheGroundKeepsItsFlux) {
  constexpr double bed = 0.1, height = 0.2, length = 1.6, at = 1.0, u_star = 0.4, roughness = 1e-3, top = 1.0;
  std::string points;
  constexpr int n = 400;
  const auto ground = [&](double x) {
    return bed + 0.5 * height * (1 + std::cos(2 * std::numbers::pi * (x - at) / length));
  };
  const std::array<double, 3> places{1.0, 0.7, 1.3};
  for (const double x : places)
    for (int k = 0; k < n; ++k)
      points += (points.empty() ? "[" : ", [") + std::to_string(x) + ", " +
                std::to_string(ground(x) + (k + 0.5) / n * (top - ground(x))) + "]";
  const Scene scene = parse_scene(R"toml(spacing = 1e-3
[domain]
size = [2, 1]
[phases.air]
kind = "fluid"
density = 1
[phases.ground]
kind = "wall"
spacing = 0.05
[interactions]
air-air = 2.1
air-ground = 2.1
[[fill]]
phase = "ground"
shape = { bed = 0.1, dune = { height = 0.2, length = 1.6, at = 1.0 } }
[[fill]]
phase = "air"
shape = { points = [)toml" + points + R"toml(] }
velocity = { log-profile = { friction-velocity = 0.4, roughness = 1e-3, along-ground = true } }
[time]
end = 1
)toml",
                                  "s.toml");
  const auto blocks = generate(scene);
  const auto& air = blocks.at(0);
  ASSERT_EQ(air.position.size(), places.size() * n);
  const double whole = top - bed, flux = u_star / 0.4 * (whole * std::log(whole / roughness) - whole + roughness);
  for (std::size_t p = 0; p < places.size(); ++p) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += air.velocity[p * n + k][0] * (top - ground(places[p])) / n;
    EXPECT_NEAR(sum / flux, 1.0, 2e-3) << places[p];
  }
  // Half way up on the windward side.
  const std::size_t k = n + n / 2;
  const Vec3 &x = air.position[k], &v = air.velocity[k];
  const double slope = -height * std::numbers::pi / length * std::sin(2 * std::numbers::pi * (x[0] - at) / length);
  EXPECT_NEAR(v[1] / v[0], slope * (top - x[1]) / (top - ground(x[0])), 1e-4);
  EXPECT_GT(v[1], 0.0);
}

TEST(Generate, FormulasGiveVelocityAndPressure) {
  const Scene scene = parse_scene(
      with(square_text, "\"the-rest\"", "\"the-rest\"\nvelocity = [\"sin(2*pi*x)\", \"-y\"]\npressure = \"x + y\""),
      "s.toml");
  const auto block = generate(scene)[0];
  ASSERT_EQ(block.pressure.size(), block.position.size());
  for (std::size_t i = 0; i < block.position.size(); ++i) {
    const Vec3& x = block.position[i];
    EXPECT_DOUBLE_EQ(block.velocity[i][0], std::sin(2 * std::numbers::pi * x[0]));
    EXPECT_DOUBLE_EQ(block.velocity[i][1], -x[1]);
    EXPECT_DOUBLE_EQ(block.pressure[i], x[0] + x[1]);
  }
  EXPECT_TRUE(generate(parse_scene(square_text, "s.toml", {"fill.0.pressure=hydrostatic"}))[0].pressure.empty());
  EXPECT_EQ(
      fault_of(parse_scene(square_text, "s.toml", {"fill.0.velocity=[\"1/(x-0.05)\", 0]"})),
      "--set fill.0.velocity=[\"1/(x-0.05)\", 0]: fill.0.velocity: the formula \"1/(x-0.05)\" gives inf at (0.05, "
      "0.05) m; expected a finite number at every particle");
}

/// A unit square of fluid with walls on the given sides.
Scene walled(const std::string& sides, const std::string& domain = "size = [1, 1]", const std::string& more = "") {
  std::string text = with(square_text, "size = [1, 1]", domain);
  text = with(text, "[interactions]", "[phases.wall]\nkind = \"wall\"\n[interactions]\nair-wall = 3.0");
  return parse_scene(
      with(text, "[[fill]]", "[[fill]]\nphase = \"wall\"\nshape = { sides = " + sides + " }\n" + more + "[[fill]]"),
      "s.toml");
}

TEST(Generate, WallLayersCloseTheCorners) {
  const auto count = [](const Scene& scene) { return generate(scene)[1].position.size(); };
  EXPECT_EQ(count(walled("[\"bottom\"]")), 3u * 16u) << "continued past the corners";
  EXPECT_EQ(count(walled("[\"bottom\", \"top\", \"left\", \"right\"]")), 16u * 16u - 100u) << "each corner once";
  EXPECT_EQ(count(walled("[\"bottom\", \"top\"]", "size = [1, 1]\nperiodic = [\"x\"]")), 60u) << "exactly periodic";
  const Scene scene = walled("[\"bottom\", \"top\", \"left\", \"right\"]", "origin = [5, 7]\nsize = [1, 1]");
  const auto all = all_positions(generate(scene));
  const PeriodicSpace space(scene.domain);
  EXPECT_EQ(all.size(), 256u);
  EXPECT_NEAR(least_distance(all, all, space), 0.1, 1e-12) << "wall and fluid continue one lattice";
}

TEST(Generate, AnEarlierWallKeepsTheCorner) {
  Scene scene = walled("[\"top\"]");
  Fill more = scene.fills[0];
  more.shape = SidesShape{{"left", "right", "bottom"}, 3};
  scene.fills.insert(scene.fills.begin() + 1, more);
  EXPECT_EQ(generate(scene)[1].position.size(), 156u);
}

TEST(Generate, WallsInThreeDimensions) {
  std::string text = with(square_text, "size = [1, 1]", "size = [1, 1, 1]\nperiodic = [\"x\"]");
  text = with(text, "[interactions]", "[phases.wall]\nkind = \"wall\"\n[interactions]\nair-wall = 3.0");
  text = "dimensions = 3\n" + text +
         "[[fill]]\nphase = \"wall\"\nshape = { sides = [\"bottom\", \"back\"], layers = 2 }\n";
  const auto blocks = generate(parse_scene(text, "s.toml"));
  EXPECT_EQ(blocks[0].position.size(), 1000u);
  EXPECT_EQ(blocks[1].position.size(), 10u * (14u * 14u - 12u * 12u));
}

TEST(Generate, BodiesSitOnTheirCentres) {
  const auto places = [](const std::string& shape) {
    return generate(parse_scene(with(square_text, "\"the-rest\"", shape), "s.toml"))[0].position;
  };
  const auto mean = [](const std::vector<Vec3>& x) {
    Vec3 sum{};
    for (const Vec3& place : x) sum = sum + (1.0 / static_cast<double>(x.size())) * place;
    return sum;
  };
  const auto cube = places("{ cube = { centre = [0.43, 0.57], count = 4 } }");
  EXPECT_EQ(cube.size(), 16u);
  EXPECT_NEAR(mean(cube)[0], 0.43, 1e-14);
  EXPECT_NEAR(mean(cube)[1], 0.57, 1e-14);
  EXPECT_NEAR(cube[1][0] - cube[0][0], 0.1, 1e-14);
  const auto disc = places("{ disc = { centre = [0.43, 0.57], radius = 0.2 } }");
  EXPECT_EQ(disc.size(), 13u) << "lattice points within two spacings";
  EXPECT_NEAR(mean(disc)[0], 0.43, 1e-14);
  const auto ring = places("{ ring = { centre = [0.43, 0.57], inner = 0.1, outer = 0.2 } }");
  EXPECT_EQ(ring.size(), 12u);
  EXPECT_EQ(places("{ box = { min = [0.2, 0.3], max = [0.5, 0.7] } }").size(), 12u);
  EXPECT_EQ(places("{ polygon = [[0, 0], [1, 0], [1, 0.96]] }").size(), 45u);
  EXPECT_EQ(places("{ formula = \"x > 0.5 ? 1 : -1\" }").size(), 50u);
  EXPECT_EQ(places("{ points = [[0.1, 0.1], [0.7, 0.2]] }").at(1), (Vec3{0.7, 0.2, 0}));
}

TEST(Generate, ThePapersCubesHave1331ParticlesEach) {
  std::string text = with(square_text, "size = [1, 1]", "size = [4, 2, 2]");
  text = with(text, "\"the-rest\"", "{ cube = { centre = [1, 1, 1], count = 11 } }");
  const auto x = generate(parse_scene("dimensions = 3\n" + text, "s.toml"))[0].position;
  EXPECT_EQ(x.size(), 1331u);
}

TEST(Generate, BoxesThatMeetNeitherShareNorMissParticles) {
  const std::string text = with(square_text, "\"the-rest\"", "{ box = { min = [0, 0], max = [0.35, 1] } }") +
                           "[[fill]]\nphase = \"air\"\nshape = { box = { min = [0.35, 0], max = [1, 1] } }\n";
  EXPECT_EQ(generate(parse_scene(text, "s.toml"))[0].position.size(), 100u);
}

TEST(Generate, ADomainThatIsNoWholeNumberOfSpacingsKeepsItsLastRowInside) {
  for (const double size : {0.96, 1.0, 1.04}) {
    const auto x =
        generate(parse_scene(square_text, "s.toml", {"domain.size=[" + std::to_string(size) + ", 1]"}))[0].position;
    EXPECT_EQ(x.size(), 100u);
    for (const Vec3& place : x) EXPECT_LE(place[0], size);
  }
}

TEST(Generate, GrainsInFlightStandBetweenParticlesOfCoarserAir) {
  std::ifstream file(BARCHAN_SOURCE_DIR "/scenes/wind_over_sand.toml");
  const std::string bed(std::istreambuf_iterator<char>(file), {});
  const std::string grain = "[[fill]]\nphase = \"sand\"\nshape = { points = [[0.05, 0.0201]] }\n";
  const auto count = [](const std::string& text) {
    return generate(parse_scene(text, "s.toml"))[1].position.size();  // air, sand
  };
  EXPECT_EQ(count(bed + grain), count(bed) + 1);
  EXPECT_NE(fault_of(parse_scene(bed + grain + grain, "s.toml")).find("overlaps fill.5 of phase \"sand\""),
            std::string::npos);
}

TEST(Generate, TellsOfOverlapsEmptyFillsAndParticlesOutside) {
  const std::string second = "[[fill]]\nphase = \"air\"\nshape = { points = [[0.47, 0.45]] }\n";
  EXPECT_EQ(
      fault_of(parse_scene(square_text + second, "s.toml")),
      "s.toml:15:1: fill.1: a particle of phase \"air\" at (0.47, 0.45) m overlaps fill.0 of phase \"air\"; expected "
      "at least half a spacing "
      "between particles of different fills, or leave-out = \"earlier-fills\" in the later one");
  EXPECT_EQ(
      fault_of(parse_scene(with(square_text, "\"the-rest\"", "{ formula = \"-1\" }"), "s.toml")),
      "s.toml:9:1: fill.0: no particle of phase \"air\"; expected a larger shape, a smaller spacing, or an earlier "
      "place in the file");
  EXPECT_EQ(fault_of(parse_scene(with(square_text, "\"the-rest\"", "{ points = [[0.5, 1.5]] }"), "s.toml")),
            "s.toml:9:1: fill.0: a particle of phase \"air\" at (0.5, 1.5) m lies outside the domain; expected a shape "
            "inside it");
  const std::string periodic = with(square_text, "size = [1, 1]", "size = [1, 1]\nperiodic = [\"x\"]");
  const std::string across = with(periodic, "\"the-rest\"", "{ points = [[0.01, 0.5]] }") +
                             "[[fill]]\nphase = \"air\"\nshape = { points = [[0.99, 0.5]] }\n";
  EXPECT_NE(fault_of(parse_scene(across, "s.toml")), "") << "overlap across the period";
}

// The rows of the ball begin at its centre, half a spacing from those of the water along each axis: 32 of the water's
// places lay in the middle of eight of the ball's.
TEST(Generate, TheRestLeavesOutTheInsideOfABall) {
  const Scene scene = parse_scene(small::drowned_ball, "s.toml");
  const auto blocks = generate(scene);  // of the water, of the ball
  for (const Vec3& x : blocks[0].position) EXPECT_GE(norm(x - Vec3{0.7, 0.7, 0.7}), 0.3 - 0.25 * 0.1);
}

TEST(Generate, IsTheSameEveryTime) {
  const Scene scene = parse_scene(dune_text, "dune.toml", {"fill.0.perturb=0.1"});
  const auto a = generate(scene), b = generate(scene);
  for (std::size_t p = 0; p < a.size(); ++p) {
    EXPECT_EQ(a[p].position, b[p].position);
    EXPECT_EQ(a[p].velocity, b[p].velocity);
  }
}

}  // namespace
}  // namespace barchan
