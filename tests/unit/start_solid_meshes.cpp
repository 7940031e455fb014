// Shapes from volume meshes: the border of their cells, parts of them, flat meshes, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "start/generate.hpp"
#include "start/outline.hpp"
#include "start/surface_file.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::square_text;
using testing::with;

struct Cell {
  int type;  // of VTK: 5 triangle, 9 quad, 10 tetrahedron, 11 voxel, 12 hexahedron, 13 wedge, 14 pyramid, 24 quadratic
  std::vector<int> points;
};

/// A legacy .vtk of these cells; `parts`: CellEntityIds, as Gmsh writes them.
std::string mesh_file(const std::string& name, const std::vector<Vec3>& points, const std::vector<Cell>& cells,
                      const std::vector<int>& parts = {}) {
  const auto path = std::filesystem::path(::testing::TempDir()) / ("barchan_" + name);
  std::ofstream file(path);
  file << "# vtk DataFile Version 2.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << points.size() << " double\n";
  for (const Vec3& x : points) file << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  std::size_t numbers = 0;
  for (const Cell& cell : cells) numbers += cell.points.size() + 1;
  file << "CELLS " << cells.size() << ' ' << numbers << '\n';
  for (const Cell& cell : cells) {
    file << cell.points.size();
    for (const int k : cell.points) file << ' ' << k;
    file << '\n';
  }
  file << "CELL_TYPES " << cells.size() << '\n';
  for (const Cell& cell : cells) file << cell.type << '\n';
  if (!parts.empty()) {
    file << "CELL_DATA " << cells.size() << "\nSCALARS CellEntityIds int 1\nLOOKUP_TABLE default\n";
    for (const int part : parts) file << part << '\n';
  }
  return path.string();
}

/// The corners of a cube of side 1 from (x, 0, 0), in the order of a hexahedron.
std::vector<Vec3> corners(double x) {
  return {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}, {x, 0, 1}, {x + 1, 0, 1}, {x + 1, 1, 1}, {x, 1, 1}};
}

/// The cube whose first corner has the number `first` in five tetrahedra.
std::vector<Cell> tetrahedra(int first) {
  std::vector<Cell> cells;
  for (const auto& [a, b, c, d] : {std::array{0, 1, 3, 4}, std::array{2, 1, 6, 3}, std::array{5, 1, 4, 6},
                                   std::array{7, 3, 6, 4}, std::array{1, 3, 4, 6}})
    cells.push_back({10, {first + a, first + b, first + c, first + d}});
  return cells;
}

double volume(const SurfaceFile& file) { return Outline(file.facets, 3).content(); }

std::string problem_of(const std::string& path, int part = 0) { return read_surface(path, part).problem; }

TEST(SolidMeshes, TheBorderOfTheCellsIsTheSurface) {
  const std::vector<Vec3> cube = corners(0);
  struct Case {
    std::string name;
    std::vector<Cell> cells;
    std::size_t triangles;
    double holds;
  };
  const Case cases[] = {
      {"tetrahedra", tetrahedra(0), 12, 1.0},
      {"hexahedron", {{12, {0, 1, 2, 3, 4, 5, 6, 7}}}, 12, 1.0},
      {"voxel", {{11, {0, 1, 3, 2, 4, 5, 7, 6}}}, 12, 1.0},
      {"wedges", {{13, {0, 1, 3, 4, 5, 7}}, {13, {1, 2, 3, 5, 6, 7}}}, 12, 1.0},
      {"pyramid", {{14, {0, 1, 2, 3, 4}}}, 6, 1.0 / 3.0},
      {"with its faces", {{12, {0, 1, 2, 3, 4, 5, 6, 7}}, {5, {0, 1, 2}}, {5, {0, 2, 3}}}, 12, 1.0},
  };
  for (const Case& c : cases) {
    const SurfaceFile file = read_surface(mesh_file("cells.vtk", cube, c.cells));
    EXPECT_EQ(file.problem, "") << c.name;
    EXPECT_TRUE(file.triangles) << c.name;
    EXPECT_EQ(file.facets.size(), c.triangles) << c.name;
    EXPECT_NEAR(volume(file), c.holds, 1e-12) << c.name;
  }
}

TEST(SolidMeshes, FillsWhatTheyHold) {
  const std::string path = mesh_file("cube.vtk", corners(0), tetrahedra(0));
  const Scene scene =
      parse_scene("dimensions = 3\n" + with(with(square_text, "size = [1, 1]", "size = [1, 1, 1]"), "\"the-rest\"",
                                            "{ surface = \"" + path + "\", scale = 0.5, move = [0.2, 0.2, 0.2] }"),
                  "s.toml");
  const auto x = generate(scene)[0].position;
  EXPECT_EQ(x.size(), 125u);
  for (const Vec3& place : x)
    for (const double c : place) EXPECT_TRUE(c > 0.2 && c < 0.7);
}

TEST(SolidMeshes, APartIsABodyOfItsOwn) {
  std::vector<Vec3> points = corners(0);
  const std::vector<Vec3> second = corners(1);
  points.insert(points.end(), second.begin(), second.end());
  std::vector<Cell> cells = tetrahedra(0);
  cells.push_back({12, {8, 9, 10, 11, 12, 13, 14, 15}});
  cells.push_back({5, {0, 1, 2}});
  const std::string path = mesh_file("parts.vtk", points, cells, {1, 1, 1, 1, 1, 4, 7});
  EXPECT_EQ(read_surface(path, 1).facets.size(), 12u);
  const SurfaceFile other = read_surface(path, 4);
  EXPECT_NEAR(volume(other), 1.0, 1e-12);
  for (const Facet& f : other.facets)
    for (const Vec3& x : f) EXPECT_GE(x[0], 1.0);
  EXPECT_NE(problem_of(path, 2).find("has no part 2: its cells are of 1, 4, 7"), std::string::npos)
      << problem_of(path, 2);
  EXPECT_NE(problem_of(mesh_file("none.vtk", points, cells), 1).find("has no parts"), std::string::npos);
}

TEST(SolidMeshes, PointsAtOnePlaceAreOne) {
  std::vector<Vec3> points = corners(0);
  const std::vector<Vec3> second = corners(1);
  points.insert(points.end(), second.begin(), second.end());
  const SurfaceFile file = read_surface(
      mesh_file("twice.vtk", points, {{12, {0, 1, 2, 3, 4, 5, 6, 7}}, {12, {8, 9, 10, 11, 12, 13, 14, 15}}}));
  EXPECT_EQ(file.facets.size(), 20u) << "the face between the two is inside";
  EXPECT_NEAR(volume(file), 2.0, 1e-12);
}

TEST(SolidMeshes, AFlatMeshIsTheOutlineOfItsBorder) {
  const std::vector<Vec3> points{{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}, {2, 0, 2}, {2, 1, 2}};
  const std::string path =
      mesh_file("flat.vtk", points, {{5, {0, 1, 2}}, {5, {0, 2, 3}}, {9, {1, 4, 5, 2}}}, {1, 1, 3});
  const SurfaceFile file = read_surface(path);
  EXPECT_EQ(file.problem, "");
  EXPECT_FALSE(file.triangles);
  EXPECT_EQ(file.facets.size(), 6u);
  EXPECT_NEAR(Outline(file.facets, 2).content(), 2.0, 1e-12);
  EXPECT_NEAR(Outline(read_surface(path, 3).facets, 2).content(), 1.0, 1e-12);
  const Scene scene =
      parse_scene(with(square_text, "\"the-rest\"", "{ surface = \"" + path + "\", part = 1, scale = 0.5 }"), "s.toml");
  EXPECT_EQ(generate(scene)[0].position.size(), 25u);
}

TEST(SolidMeshes, WhatIsNoBodyIsRefused) {
  const std::vector<Vec3> cube = corners(0);
  const auto refusal = [&](const std::string& of, const std::vector<Cell>& cells) {
    const std::string problem = problem_of(mesh_file("wrong.vtk", cube, cells));
    EXPECT_NE(problem.find(of), std::string::npos) << problem;
  };
  refusal("names point 11 of 8", {{10, {0, 1, 2, 11}}});
  refusal("has a face of 3 cells", {{10, {0, 1, 2, 4}}, {10, {0, 1, 2, 5}}, {10, {0, 1, 2, 6}}});
  refusal("curved cells", {{24, {0, 1, 2, 3, 4, 5, 6, 7, 0, 1}}});
  const auto said = [](const std::string& shape) {
    try {
      parse_scene(with(square_text, "\"the-rest\"", shape), "s.toml");
    } catch (const SceneError& error) { return std::string(error.what()); }
    return std::string();
  };
  const auto folder = std::filesystem::path(::testing::TempDir());
  std::ofstream(folder / "barchan_own.msh") << "$MeshFormat\n";
  EXPECT_NE(said("{ surface = \"" + (folder / "barchan_own.msh").string() + "\" }").find("meshio.write"),
            std::string::npos);
  std::ofstream(folder / "barchan_parts.csv") << "0,0\n1,0\n0,1\n";
  EXPECT_NE(said("{ surface = \"" + (folder / "barchan_parts.csv").string() + "\", part = 2 }").find("has no parts"),
            std::string::npos);
  EXPECT_NE(said("{ box = { min = [0, 0], max = [1, 1] }, part = 2 }"), "");
}

}  // namespace
}  // namespace barchan
