// Spheres on walls and rigid bodies by the surfaces of their shapes, and where spheres have room at the start.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::report;

/// One sphere of 2 mm and what it falls on, with 0.5 m/s and a restitution of 0.8.
std::string falls(int dimensions, const std::string& kind, const std::vector<std::string>& shapes,
                  const std::string& points, double diameter = 2e-3, const std::string& more = "") {
  const bool rigid = kind == "rigid";
  std::string text =
      "dimensions = " + std::to_string(dimensions) +
      "\nspacing = 0.002\n[domain]\nsize = " + (dimensions == 2 ? "[0.08, 0.03]" : "[0.02, 0.02, 0.02]") +
      "\n[phases.ball]\nkind = \"grains\"\ndensity = 2500\ndiameter = " + std::to_string(diameter) +
      "\nrestitution = 0.8\n" + more + "[phases.plate]\nkind = \"" + kind + "\"\n" + (rigid ? "density = 2500\n" : "") +
      "[interactions]\nball-ball = { law = \"linear\" }\nball-plate = { law = \"linear\" }\n";
  for (const std::string& shape : shapes) text += "[[fill]]\nphase = \"plate\"\nshape = " + shape + "\n";
  text += "[[fill]]\nphase = \"ball\"\nshape = { points = [" + points +
          "] }\nvelocity = " + (dimensions == 2 ? "[0, -0.5]" : "[0, -0.5, 0]") + "\n";
  if (rigid) text += "[[motion]]\nphase = \"plate\"\n";
  return text + "[time]\nend = 1\nlargest-speed = 0.7\n[output]\nevery = 0\n";
}

class Fall {
 public:
  explicit Fall(const std::string& text) : scene_(parse_scene(text, "test.toml")) {
    const auto blocks = make_particles(scene_);
    simulation_ = std::make_unique<Simulation>(scene_, make_plan(scene_, blocks), blocks);
  }
  void to(double time) {
    while (simulation_->time() < time * (1.0 - 1e-12)) simulation_->step(time - simulation_->time());
  }
  Simulation& simulation() { return *simulation_; }
  PhaseParticles& spheres() { return simulation_->phases()[0]; }
  double at(Field field, int d, std::size_t k = 0) { return spheres().column(field, d)[k]; }

 private:
  Scene scene_;
  std::unique_ptr<Simulation> simulation_;
};

/// All spheres come back straight, with 0.8 of their speed.
void expect_straight(const std::string& what, Fall&& run, double time) {
  run.to(time);
  PhaseParticles& balls = run.spheres();
  double off = 0.0, sideways = 0.0;
  for (std::size_t k = 0; k < balls.size(); ++k) {
    off = std::max(off, std::abs(balls.column(Field::velocity, 1)[k] / 0.4 - 1.0));
    for (int d = 0; d < balls.dimensions(); d += 2)
      sideways = std::max(sideways, std::abs(balls.column(Field::velocity, d)[k]));
  }
  report(what + ": restitution/0.8, error", off, 0.001);
  EXPECT_LT(off, 0.001) << what;
  report(what + ": sideways, m/s", sideways, 1e-6);
  EXPECT_LT(sideways, 1e-6) << what;
}

/// Places over a plate, `gap` over y = 0.01, at odd places of its lattice.
std::string grid(double radius, double gap, int side, double apart) {
  std::string points;
  char text[96];
  for (int i = 0; i < side; ++i)
    for (int k = 0; k < side; ++k) {
      std::snprintf(text, sizeof text, "%s[%.9g, %.9g, %.9g]", points.empty() ? "" : ", ",
                    0.006 + apart * i + 1e-5 * k * k, 0.01 + radius + gap, 0.006 + apart * k + 1.3e-5 * i * i);
      points += text;
    }
  return points;
}

/// A closed surface as a binary .stl of its own name.
std::string file_of_triangles(const std::vector<Facet>& all) {
  const auto file = std::filesystem::temp_directory_path() / ("sphere_walls_" + std::to_string(getpid()) + ".stl");
  std::ofstream out(file, std::ios::binary);
  const std::string head(80, ' ');
  out.write(head.data(), 80);
  const auto count = static_cast<std::uint32_t>(all.size());
  out.write(reinterpret_cast<const char*>(&count), 4);
  for (const Facet& facet : all) {
    float numbers[12] = {};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t d = 0; d < 3; ++d) numbers[3 + 3 * c + d] = static_cast<float>(facet[c][d]);
    out.write(reinterpret_cast<const char*>(numbers), sizeof numbers);
    out.write("\0\0", 2);
  }
  return file.string();
}

/// A block under y = 0.01 whose upper face has 2 n^2 triangles.
std::string block_of_triangles(int n) {
  std::vector<Facet> all;
  const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    all.push_back({a, b, c});
    all.push_back({a, c, d});
  };
  const double low = 0.002, high = 0.018, top = 0.01, bottom = 0.004, step = (high - low) / n;
  const auto x = [&](int i) { return i == n ? high : low + step * i; };
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      quad({x(i), top, x(k)}, {x(i), top, x(k + 1)}, {x(i + 1), top, x(k + 1)}, {x(i + 1), top, x(k)});
      quad({x(i), bottom, x(k)}, {x(i + 1), bottom, x(k)}, {x(i + 1), bottom, x(k + 1)}, {x(i), bottom, x(k + 1)});
    }
    quad({x(i), bottom, low}, {x(i), top, low}, {x(i + 1), top, low}, {x(i + 1), bottom, low});
    quad({x(i), bottom, high}, {x(i + 1), bottom, high}, {x(i + 1), top, high}, {x(i), top, high});
    quad({low, bottom, x(i)}, {low, bottom, x(i + 1)}, {low, top, x(i + 1)}, {low, top, x(i)});
    quad({high, bottom, x(i)}, {high, top, x(i)}, {high, top, x(i + 1)}, {high, bottom, x(i + 1)});
  }
  return file_of_triangles(all);
}

const std::string box3 = "{ box = { min = [0, 0.004, 0], max = [0.02, 0.01, 0.02] } }",
                  prism = "{ polygon = [[0, 0.004], [0.02, 0.004], [0.02, 0.01], [0, 0.01]] }";

// Spheres finer than the wall's particles, coarser ones and middle ones: none passes, and each comes back straight.
TEST(SphereWalls, AreSmoothInThreeDimensions) {
  const std::string file = block_of_triangles(1), surface = "{ surface = \"" + file + "\" }";
  for (const auto& [diameter, apart] :
       {std::pair{2e-4, 1.1e-3}, {5e-4, 1.1e-3}, {1e-3, 1.1e-3}, {1.2e-3, 1.3e-3}, {2e-3, 2.1e-3}})
    for (const std::string spacing : {"0.0011", "0.003"}) {
      const int side = apart > 2e-3 ? 5 : 8;  // wider ones reach the rim of the surface
      const std::string places = grid(0.5 * diameter, 1e-5, side, apart);
      for (const auto& [name, shape] : {std::pair{"box", box3}, {"polygon", prism}, {"surface", surface}}) {
        std::string text = falls(3, "wall", {shape}, places, diameter);
        text.replace(text.find("[interactions]"), 0, "spacing = " + spacing + "\n");
        expect_straight(std::string(name) + " of " + spacing + ", grains of " + std::to_string(diameter), Fall(text),
                        1.5e-4 + 0.4 * diameter);
      }
    }
  std::filesystem::remove(file);
}

// Of another phase next to it: a wall and a body, or two walls, whose faces lie in one plane.
TEST(SphereWalls, HaveNoSeamsWithOthers) {
  for (const std::string kind : {"wall", "rigid"}) {
    std::string text = falls(2, kind, {"{ box = { min = [0, 0], max = [0.04, 0.004] } }"},
                             "[0.04, 0.00505], [0.0373, 0.00505], [0.0424, 0.00505], [0.045, 0.00505]");
    text.replace(text.find("[interactions]\n"), 15,
                 "[phases.post]\nkind = \"wall\"\n[interactions]\nball-post = { law = \"linear\" }\n");
    text.replace(text.find("[[fill]]"), 0,
                 "[[fill]]\nphase = \"post\"\nshape = { box = { min = [0.04, 0], max = [0.08, 0.004] } }\n");
    expect_straight(kind + " next to a wall", Fall(text), 1.2e-3);
  }
}

// A ridge and a tip that point up, of a prism and of a pyramid of triangles: a ball that falls on them comes straight
// back. The tip of the file is 2e-10 m off, by the rounding of its numbers.
TEST(SphereWalls, EdgesAndCornersAreTouchedByTheirPlaces) {
  const std::string roof = "{ polygon = [[0.005, 0.004], [0.015, 0.004], [0.01, 0.01]] }";
  expect_straight("ridge", Fall(falls(3, "wall", {roof}, "[0.01, 0.01051, 0.006], [0.01, 0.01051, 0.01003]", 1e-3)),
                  6e-4);
  const Vec3 tip{0.01, 0.01, 0.01}, a{0.004, 0.004, 0.004}, b{0.016, 0.004, 0.004}, c{0.016, 0.004, 0.016},
      d{0.004, 0.004, 0.016};
  const std::string file =
      file_of_triangles({{a, b, c}, {a, c, d}, {a, tip, b}, {b, tip, c}, {c, tip, d}, {d, tip, a}});
  expect_straight("tip", Fall(falls(3, "wall", {"{ surface = \"" + file + "\" }"}, "[0.01, 0.01051, 0.01]", 1e-3)),
                  6e-4);
  std::filesystem::remove(file);
}

TEST(SphereWalls, OfTriangles) {
  for (const int n : {1, 49}) {
    const std::string file = block_of_triangles(n), shape = "{ surface = \"" + file + "\" }",
                      what = "triangles, " + std::to_string(4 * n * n + 8 * n);
    expect_straight(what, Fall(falls(3, "wall", {shape}, grid(5e-4, 1e-5, 7, 1.2e-3), 1e-3)), 6e-4);
    std::filesystem::remove(file);
  }
}

// On and next to the seams and the corners of the parts of a wall, and of bodies.
TEST(SphereWalls, HaveNoSeams) {
  for (const std::string kind : {"wall", "rigid"}) {
    expect_straight(kind + ", two in 2D",
                    Fall(falls(2, kind,
                               {"{ box = { min = [0, 0], max = [0.04, 0.004] } }",
                                "{ box = { min = [0.04, 0], max = [0.08, 0.004] } }"},
                               "[0.04, 0.00505], [0.0373, 0.00505], [0.0424, 0.00505], [0.045, 0.00505]")),
                    1.2e-3);
    std::vector<std::string> four;
    for (const char* corners :
         {"min = [0, 0.004, 0], max = [0.01, 0.01, 0.01]", "min = [0.01, 0.004, 0], max = [0.02, 0.01, 0.01]",
          "min = [0, 0.004, 0.01], max = [0.01, 0.01, 0.02]", "min = [0.01, 0.004, 0.01], max = [0.02, 0.01, 0.02]"})
      four.push_back("{ box = { " + std::string(corners) + " } }");
    expect_straight(
        kind + ", four in 3D",
        Fall(falls(3, kind, four, "[0.01, 0.01105, 0.01], [0.0125, 0.01105, 0.01002], [0.01001, 0.01105, 0.0073]")),
        1.2e-3);
  }
}

// A ball in the middle of a notch has two contacts, of one polygon or of two boxes; together they give what one does:
// each has the half of the stiffness along y at 45 degrees.
TEST(SphereWalls, NotchesHaveTwoContacts) {
  const std::string notch = "{ polygon = [[0.03, 0.002], [0.05, 0.002], [0.05, 0.014], [0.04, 0.004], [0.03, 0.014]] }";
  char point[64];
  std::snprintf(point, sizeof point, "[0.04, %.12g]", 0.004 + 1e-3 * std::sqrt(2.0) + 5e-5);
  for (const std::string kind : {"wall", "rigid"}) {
    Fall run(falls(2, kind, {notch}, point));
    double most = 0.0;
    for (double t = 1e-4; t < 1.3e-3; t += 1e-4) {
      run.to(t);
      const auto names = run.simulation().history_columns();
      const auto at = std::find(names.begin(), names.end(), "contacts") - names.begin();
      most = std::max(most, run.simulation().history_row()[static_cast<std::size_t>(at)]);
    }
    EXPECT_EQ(most, 2.0) << kind;
    EXPECT_NEAR(run.at(Field::velocity, 1), 0.4, 0.0012) << kind;
    EXPECT_NEAR(run.at(Field::velocity, 0), 0.0, 1e-6) << kind;
  }
}

// Friction goes on over a seam: a ball that rolls over it is where a ball on one box is.
TEST(SphereWalls, BallsRollOverSeams) {
  std::array<std::array<double, 3>, 2> ends{};
  const std::vector<std::vector<std::string>> shapes{
      {"{ box = { min = [0, 0], max = [0.08, 0.004] } }"},
      {"{ box = { min = [0, 0], max = [0.041, 0.004] } }", "{ box = { min = [0.041, 0], max = [0.08, 0.004] } }"}};
  for (std::size_t k = 0; k < 2; ++k) {
    std::string text = falls(2, "wall", shapes[k], "[0.04, 0.00499]", 2e-3, "friction = 0.5\n");
    text.replace(text.find("velocity = [0, -0.5]"), 20, "velocity = [0.5, 0.0]");
    text.replace(text.find("[phases.ball]"), 0, "gravity = [0, -9.81]\n");
    Fall run(text);
    run.to(5e-3);
    ends[k] = {run.at(Field::position, 0), run.at(Field::velocity, 0), run.at(Field::angular_velocity, 0)};
    EXPECT_GT(ends[k][0], 0.0415);
    EXPECT_LT(ends[k][2], -10.0);
  }
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(ends[1][d], ends[0][d], 1e-9 * std::abs(ends[0][d]));
}

// A wall that a [[motion]] carries pushes what it meets: a lid that comes down with 1 m/s.
TEST(SphereWalls, MoveSmoothly) {
  std::string text = falls(2, "wall", {"{ box = { min = [0.03, 0.008], max = [0.05, 0.012] } }"},
                           "[0.0403, 0.00695], [0.0362, 0.00695]");
  text.replace(text.find("velocity = [0, -0.5]"), 20, "velocity = [0, 0.0]");
  Fall run(text + "[[motion]]\nphase = \"plate\"\nvelocity = [0, -0.5]\n");
  run.to(1.2e-3);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(run.at(Field::velocity, 1, k), -0.9, 0.0015);
    EXPECT_NEAR(run.at(Field::velocity, 0, k), 0.0, 1e-6);
  }
}

std::string why(const std::string& text) {
  try {
    Fall run(text);
    run.to(1e-5);
  } catch (const std::exception& e) { return e.what(); }
  return "nothing";
}

std::string with_y(double y) { return "[0.0405, " + std::to_string(y) + "]"; }

// A sphere of 2 mm that overlaps by 0.05 to 0.4 of its diameter.
TEST(SphereStart, RefusesOverlaps) {
  const std::string box = "{ box = { min = [0, 0], max = [0.08, 0.004] } }";
  for (const double share : {0.05, 0.15, 0.29, 0.4}) {
    for (const std::string kind : {"wall", "rigid"}) {
      const std::string said = why(falls(2, kind, {box}, with_y(0.005 - 2e-3 * share)));
      EXPECT_NE(said.find("\"ball\""), std::string::npos) << said;
      EXPECT_NE(said.find("overlaps fill.0 of phase \"plate\""), std::string::npos) << said;
    }
    EXPECT_NE(why(falls(2, "wall", {"{ sides = [\"bottom\"] }"}, with_y(0.001 - 2e-3 * share))).find("overlaps fill.0"),
              std::string::npos);
    const std::string pair = why(falls(2, "wall", {box}, with_y(0.01) + ", " + with_y(0.012 - 2e-3 * share)));
    EXPECT_NE(pair.find("overlaps another one of this fill"), std::string::npos) << pair;
  }
  EXPECT_EQ(why(falls(2, "wall", {box}, with_y(0.004995))), "nothing");
  EXPECT_EQ(why(falls(2, "wall", {"{ sides = [\"bottom\"] }"}, with_y(0.000995))), "nothing");
}

// Random places keep a radius off sides, boxes and bodies.
TEST(SphereStart, RandomPlacesHaveRoom) {
  for (const std::string kind : {"wall", "rigid"}) {
    std::string text = falls(2, kind, {"{ box = { min = [0.03, 0], max = [0.05, 0.012] } }"}, "[0.01, 0.01]");
    const std::size_t from = text.find("shape = { points");
    text.replace(from, text.find('\n', from) - from,
                 "shape = { box = { min = [0, 0], max = [0.08, 0.03] } }\npacking = \"random\"\nseed = 3");
    text.replace(text.find("[interactions]"), 0, "[phases.side]\nkind = \"wall\"\n");
    text.replace(text.find("[[fill]]"), 0, "ball-side = { law = \"linear\" }\n");
    text.replace(text.find("[[fill]]"), 0,
                 "[[fill]]\nphase = \"side\"\nshape = { sides = [\"bottom\", \"left\", \"right\"] }\n");
    Fall run(text);
    EXPECT_GT(run.spheres().size(), 100u);
    for (std::size_t k = 0; k < run.spheres().size(); ++k) {
      const double x = run.at(Field::position, 0, k), y = run.at(Field::position, 1, k);
      EXPECT_TRUE(x >= 0.000999 && x <= 0.079001 && y >= 0.000999);
      EXPECT_GE(std::hypot(std::max({0.03 - x, x - 0.05, 0.0}), std::max(y - 0.012, 0.0)), 0.000999);
    }
    run.to(1e-4);
  }
}

// Grains that enter find no place in a wall, a body or behind a side.
TEST(SphereStart, InfluxHasRoom) {
  const std::string base = R"toml(
spacing = 1e-3
[domain]
size = [0.05, 0.03]
gravity = [0, -9.81]
open = ["right"]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
stiffness = 500
[phases.stone]
kind = "KIND"
MORE
[phases.box]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-box = { law = "linear" }
sand-stone = { law = "linear" }
[[fill]]
phase = "box"
shape = { sides = ["bottom"] }
[[fill]]
phase = "stone"
shape = { box = { min = [0, 0.002], max = [0.006, 0.012] } }
[[fill]]
phase = "sand"
shape = { points = [[0.03, 0.0025]] }
[[influx]]
phase = "sand"
side = "left"
flux = 2
above = 0.0
decay-height = 0.02
speed = 1
[time]
end = 0.02
largest-speed = 2
)toml";
  for (const std::string kind : {"wall", "rigid"}) {
    std::string text = base;
    text.replace(text.find("KIND"), 4, kind);
    text.replace(text.find("MORE"), 4, kind == "rigid" ? "density = 2650" : "");
    if (kind == "rigid") text += "[[motion]]\nphase = \"stone\"\n";
    Fall run(text);
    run.to(0.008);
    EXPECT_GT(run.spheres().size(), 3u);
    for (std::size_t k = 0; k < run.spheres().size(); ++k) {
      const double x = run.at(Field::position, 0, k), y = run.at(Field::position, 1, k);
      EXPECT_GE(std::hypot(std::max(x - 0.006, 0.0), std::max({0.002 - y, y - 0.012, 0.0})), 0.47e-3) << kind;
    }
    for (const std::string& name : run.simulation().history_columns())
      if (name == "contacts_deepest") {
        const auto names = run.simulation().history_columns();
        const auto at = std::find(names.begin(), names.end(), name) - names.begin();
        EXPECT_LT(run.simulation().history_row()[static_cast<std::size_t>(at)], 0.05) << kind;
      }
  }
}

// A rough wall whose spheres are wider than their spacing: nothing is thrown up, and what is open is refused.
TEST(RoughWalls, HoldABed) {
  const std::string text = R"toml(
spacing = 1e-3
[domain]
size = [0.03, 0.03]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
stiffness = 500
friction = 0.5
[phases.floor]
kind = "wall"
spacing = 1e-3
diameter = 3e-3
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { box = { min = [0, 0], max = [0.03, 0.003] } }
[[fill]]
phase = "sand"
shape = { box = { min = [0.003, 0.006], max = [0.012, 0.012] } }
[time]
end = 0.3
largest-speed = 0.5
)toml";
  Fall run(text);
  run.to(0.04);
  for (std::size_t k = 0; k < run.spheres().size(); ++k) {
    EXPECT_LT(std::hypot(run.at(Field::velocity, 0, k), run.at(Field::velocity, 1, k)), 0.5);
    EXPECT_GT(run.at(Field::position, 1, k), 0.0043);
  }
}

TEST(RoughWalls, WithOpeningsAreRefused) {
  std::string text = falls(3, "wall", {box3}, "[0.006, 0.015, 0.006]", 5e-4);
  text.replace(text.find("[interactions]"), 0, "diameter = 0.002\n");
  const std::string said = why(text);
  EXPECT_NE(said.find("pass between the spheres of the wall"), std::string::npos) << said;
}

}  // namespace
}  // namespace barchan
