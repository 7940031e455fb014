// Shapes from polygons and files: what they hold, where they are, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "start/generate.hpp"
#include "start/mesh_texts.hpp"
#include "start/mesh_vtk.hpp"
#include "start/outline.hpp"
#include "start/surface_file.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::square_text;
using testing::with;

/// Writes a file for one test and says where it is.
std::string file_with(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(::testing::TempDir()) / ("barchan_" + name);
  std::ofstream(path) << text;
  return path.string();
}

/// A ball of radius 1 as OBJ, in `rows` rings of 2 `rows` quadrilaterals; without its first `missing` ones.
std::string ball_shape(int rows, int missing = 0) {
  std::ostringstream text;
  const double pi = std::numbers::pi;
  const int around = 2 * rows;
  text.precision(17);
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i < around; ++i)
      text << "v " << std::sin(pi * j / rows) * std::cos(2 * pi * i / around) << ' '
           << std::sin(pi * j / rows) * std::sin(2 * pi * i / around) << ' ' << std::cos(pi * j / rows) << '\n';
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < around; ++i) {
      if (missing-- > 0) continue;
      const int a = j * around + i + 1, b = j * around + (i + 1) % around + 1;
      text << "f " << a << ' ' << b << ' ' << b + around << ' ' << a + around << '\n';
    }
  return text.str();
}

Scene with_shape(const std::string& shape, int dimensions = 2) {
  if (dimensions == 2) return parse_scene(with(square_text, "\"the-rest\"", shape), "s.toml");
  return parse_scene(
      "dimensions = 3\n" + with(with(square_text, "size = [1, 1]", "size = [1, 1, 1]"), "\"the-rest\"", shape),
      "s.toml");
}

std::string surface_refusal(const std::string& shape, int dimensions = 2) {
  try {
    with_shape(shape, dimensions);
  } catch (const SceneError& error) { return error.what(); }
  return "";
}

TEST(Outline, MeasuresAreaAndDepth) {
  // A square of side 4 with a square hole of side 2, neither in order nor of one sense.
  std::vector<Facet> facets;
  const auto square = [&](double half, bool clockwise) {
    const Vec3 c[4] = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 &a = c[i], &b = c[(i + 1) % 4];
      facets.push_back(clockwise ? Facet{b, a, a} : Facet{a, b, b});
    }
  };
  square(2, false);
  square(1, false);
  std::swap(facets[1], facets[6]);
  const Outline outline(facets, 2, 1.0);
  EXPECT_NEAR(outline.content(), 12.0, 1e-12);
  EXPECT_NEAR(outline.border(), 24.0, 1e-12);
  EXPECT_FALSE(outline.inside({0.3, 0.2, 0}));
  EXPECT_TRUE(outline.inside({1.5, 0.2, 7})) << "through all of z";
  EXPECT_NEAR(outline.depth({1.25, 0.2, 0}), 0.25, 1e-12);
  EXPECT_NEAR(outline.depth({0.75, 0.2, 0}), -0.25, 1e-12);
  EXPECT_NEAR(outline.depth({2.3, 2.4, 0}), -0.5, 1e-12) << "from a corner";
  EXPECT_EQ(outline.depth({9, 0, 0}), -1.0) << "beyond the reach";
}

TEST(Outline, RaysThroughCornersAreCountedOnce) {
  // The rows of y through corners of a star are the hard ones.
  std::vector<Facet> star;
  std::vector<Vec3> corners;
  for (int i = 0; i < 16; ++i) {
    const double r = i % 2 ? 1.0 : 2.0, a = std::numbers::pi * i / 8;
    corners.push_back({r * std::cos(a), r * std::sin(a), 0});
  }
  for (std::size_t i = 0; i < 16; ++i) star.push_back({corners[i], corners[(i + 1) % 16], corners[(i + 1) % 16]});
  const Outline outline(star, 2);
  for (const Vec3& corner : corners) {
    EXPECT_FALSE(outline.inside({-3, corner[1], 0}));
    EXPECT_FALSE(outline.inside({3, corner[1], 0}));
    EXPECT_TRUE(outline.inside({0, 0.3 * corner[1], 0}));
  }
}

TEST(Surfaces, AFileFillsWhatItHolds) {
  const std::string path = file_with("ball.obj", ball_shape(24));
  const Scene scene = with_shape("{ surface = \"" + path + "\", scale = 0.4, move = [0.5, 0.5, 0.5] }", 3);
  const auto x = generate(scene)[0].position;
  const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(0.4, 3);
  EXPECT_NEAR(static_cast<double>(x.size()) * 1e-3, volume, 0.12 * volume) << "spacing 0.1: stairs";
  for (const Vec3& place : x) EXPECT_LE(norm(place - Vec3{0.5, 0.5, 0.5}), 0.4);
  const Outline outline(facets_of(scene.fills[0].shape), 3, 0.1);
  EXPECT_NEAR(outline.content(), volume, 0.01 * volume);
  EXPECT_NEAR(outline.depth({0.5, 0.5, 0.83}), 0.07, 2e-3);
  EXPECT_NEAR(outline.depth({0.5, 0.5, 0.96}), -0.06, 2e-3);
}

TEST(Surfaces, CornersOfAFileAreAPolygon) {
  const std::string path = file_with("l.csv", "x,y\n0,0\n100,0\n100,40\n50,40\n50,100\n0,100\n");
  const auto from_file =
      generate(with_shape("{ surface = \"" + path + "\", scale = 0.009, turn = 90, move = [0.98, 0.03] }"))[0].position;
  const auto written = generate(with_shape(
      "{ polygon = [[0.98, 0.03], [0.98, 0.93], [0.62, 0.93], [0.62, 0.48], [0.08, 0.48], [0.08, 0.03]] }"))[0]
                           .position;
  EXPECT_EQ(from_file, written);
  EXPECT_EQ(written.size(), 9u * 5u + 4u * 4u);
  const auto prism = generate(with_shape("{ surface = \"" + path + "\", scale = 0.01 }", 3))[0].position;
  EXPECT_EQ(prism.size(), 10u * (10u * 10u - 5u * 6u)) << "an outline goes through all of z";
}

TEST(Surfaces, TheFileBelongsToTheIdentityOfTheScene) {
  const std::string path = file_with("changed.csv", "0,0\n1,0\n0,1\n");
  const std::string shape = "{ surface = \"" + path + "\" }";
  const std::string before = with_shape(shape).identity;
  EXPECT_EQ(before, with_shape(shape).identity);
  file_with("changed.csv", "0,0\n1,0\n0,0.9\n");
  EXPECT_NE(before, with_shape(shape).identity);
}

TEST(Surfaces, WhatCannotBeFilledIsRefused) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "\"" << text << "\" lacks \"" << part << '"';
  };
  says(surface_refusal("{ polygon = [[0, 0], [1, 1], [1, 0], [0, 1]] }"),
       "fill.0.shape.polygon: the outline crosses itself");
  says(surface_refusal("{ polygon = [[0, 0], [1, 0], [1, 1], [0.5, 0], [0, 1]] }"), "crosses itself");
  says(surface_refusal("{ polygon = [[0, 0], [1, 0], [1, 0.04], [0, 0.04]] }"), "expected at least half a spacing");
  says(surface_refusal("{ polygon = [[0, 0], [0, 0], [0, 0]] }"), "the outline has no side");
  says(surface_refusal("{ surface = \"none.stl\" }"),
       "s.toml:11:21: fill.0.shape.surface: \"none.stl\": there is no such file");
  says(surface_refusal("{ surface = \"" + file_with("a.igs", "x") + "\" }"), "a file of an unknown kind");
  says(surface_refusal("{ surface = \"" + file_with("bad.vtp", "<VTKFile") + "\" }"),
       "cannot be read as what its name says");
  says(surface_refusal("{ surface = \"" + file_with("bad.csv", "0,0\n1,q\n") + "\" }"), "line 2 is not a corner x, y");
  says(surface_refusal("{ surface = \"" + file_with("empty.stl", "solid a\nendsolid a\n") + "\" }", 3),
       "neither triangles nor lines");
  says(surface_refusal(
           "{ surface = \"" + file_with("open.obj", ball_shape(8, 3)) + "\", scale = 0.4, move = [0.5, 0.5, 0.5] }", 3),
       "the surface is open: 1 triangle has the edge");
  says(surface_refusal("{ surface = \"" + file_with("flat.obj", ball_shape(8)) + "\" }"),
       "a surface of triangles in two dimensions");
  says(surface_refusal("{ disc = { centre = [0.5, 0.5], radius = 0.2 }, turn = 3 }"),
       "fill.0.shape.turn: this shape says itself");
  EXPECT_EQ(surface_refusal("{ polygon = [[0, 0], [1, 0], [1, 1], [0, 1]] }"), "");
}

std::string corpus(const std::string& name) {
  std::ifstream stream(BARCHAN_SOURCE_DIR "/tests/fuzz/corpus/mesh/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// One tetrahedron in every form that is read: the same triangles, in any order.
TEST(Meshes, AllFormsHoldTheSame) {
  const auto sorted = [](const std::vector<Facet>& facets) {
    std::vector<std::vector<Vec3>> all;
    for (const Facet& f : facets) {
      all.emplace_back(f.begin(), f.end());
      std::sort(all.back().begin(), all.back().end());
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  const Mesh text = parse_stl(corpus("text.stl"));
  EXPECT_EQ(text.problem, "");
  ASSERT_EQ(text.triangles.size(), 4u);
  for (const Mesh& other :
       {parse_stl(corpus("binary.stl")), parse_obj(corpus("a.obj")), parse_ply(corpus("text.ply")),
        parse_ply(corpus("binary_little_endian.ply")), parse_ply(corpus("binary_big_endian.ply"))}) {
    EXPECT_EQ(other.problem, "");
    EXPECT_EQ(sorted(other.triangles), sorted(text.triangles));
  }
  for (const char* name : {"text.vtk", "text.vtp"}) {
    const SurfaceFile file = read_surface(BARCHAN_SOURCE_DIR "/tests/fuzz/corpus/mesh/" + std::string(name));
    EXPECT_EQ(file.problem, "");
    EXPECT_EQ(sorted(file.facets), sorted(text.triangles));
  }
  EXPECT_EQ(parse_ply(corpus("strips.ply")).triangles.size(), 3u);
  EXPECT_EQ(parse_obj(corpus("a.obj")).segments.size(), 2u);
  EXPECT_EQ(parse_corners(corpus("corners.csv")).segments.size(), 6u);
}

// What was read as another shape, or ended the program, before (VTK's readers trust a file).
TEST(Meshes, DamageIsRefusedByName) {
  const auto refused = [](const Mesh& mesh, const std::string& why) {
    EXPECT_NE(mesh.problem.find(why), std::string::npos) << '"' << mesh.problem << "\" lacks " << why;
  };
  refused(parse_ply(with(corpus("text.ply"), "3 0 2 1", "3 0 2 4")), "line 19 names vertex 4 of 4, from 0");
  refused(parse_ply(with(corpus("text.ply"), "3 0 2 1", "3 0 2 -1")), "names vertex -1");
  refused(parse_ply(with(corpus("text.ply"), "3 0 2 1", "3 0 2 1e93")), "names vertex 1e+93 of 4");
  refused(parse_ply(with(corpus("text.ply"), "3 0 2 1", "1e93 0 2 1")), "has a list of 1e+93 values");
  refused(parse_ply(with(corpus("text.ply"), "3 0 2 1", "3 0 2")),
          "line 19 has a list of 3 values, more than the file holds");
  refused(parse_ply(with(corpus("text.ply"), "1 0 0 7", "1 zz 0 7")), "line 16 has \"zz\" where a number");
  refused(parse_ply(with(corpus("text.ply"), "1 0 0 7", "1 inf 0 7")), "where a number is expected");
  refused(parse_ply(with(corpus("text.ply"), "property float x", "property float q")), "has no number \"x\"");
  refused(parse_ply(with(corpus("text.ply"), "vertex_indices", "vertex_indicet")), "has no list");
  refused(parse_ply(with(corpus("text.ply"), "vertex 4", "vertex 5")), "line 23 has 2 values, and the head says 1");
  refused(parse_ply(with(corpus("text.ply"), "vertex 4", "vertex 99999999999999999999")), "a number of elements");
  refused(parse_ply(corpus("binary_little_endian.ply").substr(0, 330)), "the file ends before its last element");
  refused(parse_ply(corpus("binary_little_endian.ply") + "x"), "1 bytes follow the last element");
  refused(parse_obj(with(corpus("a.obj"), "f 1 2 4", "f 1 2 5")), "line 11 names vertex 5 of 4");
  refused(parse_obj(with(corpus("a.obj"), "f 1 2 4", "f 1 2 0")), "names vertex 0");
  refused(parse_obj(with(corpus("a.obj"), "v 1 0 0", "v 1 0,0 0")), "line 5 has \"0,0\"");
  refused(parse_obj(with(corpus("a.obj"), "v 1 0 0", "w 1 0 0")), "line 5 begins with \"w\"");
  refused(parse_stl(with(corpus("text.stl"), "vertex 1 0 0", "vertex 1 nan 0")), "line 6 has \"nan\"");
  refused(parse_stl(with(corpus("text.stl"), "endsolid a", "")), "ends before \"endsolid\"");
  refused(parse_stl(corpus("binary.stl").substr(0, 250)), "says that it has 4 triangles, 284 bytes, and has 250 bytes");
  refused(parse_corners("x,y0,0\n1,0\n1,1\n0,1\n"), "line 1 is not a corner x, y");
  refused(parse_corners("x,y\n0,0\n1,0x\n1,1\n"), "line 3 is not a corner");
  EXPECT_NE(wrong_number_of_vtk(with(corpus("text.vtk"), "1 0 0", "1 zz 0"), ".vtk"), "");
  EXPECT_NE(wrong_number_of_vtk(with(corpus("text.vtp"), "1 0 0", "1 inf 0"), ".vtp"), "");
  EXPECT_EQ(wrong_number_of_vtk(corpus("text.vtp"), ".vtp"), "");
}

// A first line that is damaged was taken for a heading, and its corner was lost.
TEST(Meshes, AHeadingOfCornersHasTwoNames) {
  const std::string rest = "1,-1\n1,1\n-1,1\n";
  for (const char* first : {"nan,-1", "-1,inf", "l,-1", "O,0", "x,,-1", "x -1", ",-1,-1", "x,y,z", "x"})
    EXPECT_EQ(parse_corners(std::string(first) + "\n" + rest).problem, "line 1 is not a corner x, y") << first;
  for (const char* head : {"x,y", "\"x [m]\",\"y [m]\"", "x y", "X ; Y"}) {
    const Mesh mesh = parse_corners(std::string(head) + "\n-1,-1\n" + rest);
    EXPECT_EQ(mesh.problem, "") << head;
    EXPECT_EQ(mesh.segments.size(), 4u) << head;
  }
  EXPECT_EQ(parse_corners("-1,-1\n\n" + rest).problem, "line 1 ends a polygon of 1 corner; expected 3 or more");
  EXPECT_EQ(parse_corners(rest + "\n0,0\n0,1").problem, "line 6 ends a polygon of 2 corners; expected 3 or more");
  EXPECT_EQ(parse_corners("-1,-1\n,1,-1\n1,1\n").problem, "line 2 is not a corner x, y");
}

// VTK asked for 6 GB, or went on for minutes.
TEST(Meshes, CountsThatAFileCannotHoldAreRefusedAtOnce) {
  const auto damaged = [](const std::string& name, const std::string& from, const std::string& to) {
    return read_surface(file_with("counts" + name.substr(name.rfind('.')), with(corpus(name), from, to))).problem;
  };
  EXPECT_NE(
      damaged("text.vtk", "POLYGONS 4 16", "POLYGONS 4 4294967295").find("states \"4294967295\" numbers in a file of"),
      std::string::npos);
  EXPECT_NE(damaged("text.vtp", "NumberOfComponents=\"3\"", "NumberOfComponents=\"99999999999999999999\"")
                .find("components; expected at most 1000"),
            std::string::npos);
}

TEST(Meshes, DamageOfVtkFilesIsRefused) {
  for (const auto& [from, to] : {std::pair{"0 2 1 0 1 3", "0 2 1 0 1 9999"}, std::pair{"3 6 9 12", "3 6 9 1200000"},
                                 std::pair{"NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000000000000\""}}) {
    const std::string path = file_with("damaged.vtp", with(corpus("text.vtp"), from, to));
    EXPECT_NE(read_surface(path).problem, "") << to;
  }
  const std::string path = file_with("damaged.vtk", with(corpus("text.vtk"), "3 0 1 3", "3 0 1 7"));
  EXPECT_NE(read_surface(path).problem, "");
}

TEST(Fills, LeaveOutWhatEarlierFillsHold) {
  const std::string two = with(
      with(with(square_text, "[interactions]", "[phases.post]\nkind = \"wall\"\n[interactions]\nair-post = 3.0"),
           "[[fill]]", "[[fill]]\nphase = \"post\"\nshape = { box = { min = [0.4, 0], max = [0.6, 0.5] } }\n[[fill]]"),
      "\"the-rest\"", "{ box = { min = [0, 0], max = [1, 0.7] } }\nleave-out = \"earlier-fills\"");
  const auto blocks = generate(parse_scene(two, "s.toml"));
  EXPECT_EQ(blocks[0].position.size(), 70u - 10u);
  EXPECT_EQ(blocks[1].position.size(), 10u);
  EXPECT_THROW(generate(parse_scene(with(two, "leave-out = \"earlier-fills\"\n", ""), "s.toml")), SceneError);
  EXPECT_THROW(parse_scene(with(square_text, "\"the-rest\"", "\"the-rest\"\nleave-out = \"earlier-fills\""), "s.toml"),
               SceneError);
}

}  // namespace
}  // namespace barchan
