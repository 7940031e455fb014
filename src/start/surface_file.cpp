#include "start/surface_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "base/input_file.hpp"
#include "start/mesh_texts.hpp"
#include "start/mesh_vtk.hpp"

namespace barchan {
namespace {

constexpr std::uint64_t most_of_a_surface = 1'000'000'000;  // bytes

Mesh mesh_of(const std::string& path, int part) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool vtk = suffix == ".vtp" || suffix == ".vtu" || suffix == ".vtk";
  if (!vtk && suffix != ".stl" && suffix != ".obj" && suffix != ".ply" && suffix != ".csv")
    return {{},
            {},
            suffix == ".msh"
                ? "is Gmsh's own; in Python meshio.write(\"a.vtu\", meshio.read(\"a.msh\")) makes one of VTK"
                : "a file of an unknown kind"};
  if (part != 0 && !vtk) return {{}, {}, "has no parts; only .vtu, .vtp and .vtk have"};
  std::string bytes;
  try {
    bytes = read_input(path, most_of_a_surface);
  } catch (const InputError& e) { return {{}, {}, e.what()}; }
  if (suffix == ".stl") return parse_stl(bytes);
  if (suffix == ".obj") return parse_obj(bytes);
  if (suffix == ".ply") return parse_ply(bytes);
  if (suffix == ".csv") return parse_corners(bytes);
  if (std::string problem = wrong_number_of_vtk(bytes, suffix); !problem.empty()) return {{}, {}, problem};
  return read_vtk_mesh(path, suffix, part);
}

/// Points nearer to each other than the tolerance become one: the first.
void merge_points(std::vector<Facet>& facets) {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const Facet& f : facets)
    for (const Vec3& x : f)
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], x[d]);
        high[d] = std::max(high[d], x[d]);
      }
  const double tolerance = 1e-7 * norm(high - low);
  if (!(tolerance > 0.0)) return;
  std::map<std::array<long, 3>, std::vector<Vec3>> cells;
  const auto first_near = [&](const Vec3& x) {
    std::array<long, 3> home{};
    for (std::size_t d = 0; d < 3; ++d) home[d] = std::lround((x[d] - low[d]) / (4.0 * tolerance));
    for (long k = 0; k < 27; ++k) {
      const auto cell = cells.find({home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1});
      if (cell == cells.end()) continue;
      for (const Vec3& y : cell->second)
        if (norm(x - y) <= tolerance) return y;
    }
    cells[home].push_back(x);
    return x;
  };
  for (Facet& f : facets)
    for (Vec3& x : f) x = first_near(x);
}

void flatten(std::vector<Facet>& facets) {
  for (Facet& f : facets)
    for (Vec3& x : f) x[2] = 0.0;
}

/// Whether all corners lie in one plane z.
bool flat(const std::vector<Facet>& facets) {
  for (const Facet& f : facets)
    for (const Vec3& x : f)
      if (x[2] != facets[0][0][2]) return false;
  return !facets.empty();
}

/// The sides that an odd number of flat triangles has: those of one border it.
std::vector<Facet> border_of(const std::vector<Facet>& triangles) {
  std::map<std::pair<Vec3, Vec3>, int> sides;
  for (const Facet& f : triangles)
    for (std::size_t i = 0; i < 3; ++i) ++sides[std::minmax(f[i], f[(i + 1) % 3])];
  std::vector<Facet> border;
  for (const auto& [side, count] : sides)
    if (count % 2 != 0) border.push_back({side.first, side.second, side.second});
  return border;
}

}  // namespace

SurfaceFile read_surface(const std::string& path, int part) {
  SurfaceFile file;
  std::error_code unseen;
  if (!std::filesystem::exists(path, unseen) && !unseen) file.problem = "there is no such file";
  else file.problem = why_no_input(path, most_of_a_surface);
  if (!file.problem.empty()) return file;
  Mesh mesh = mesh_of(path, part);
  file.problem = mesh.problem;
  file.unit = mesh.unit;
  if (!file.problem.empty()) return file;
  file.facets = std::move(mesh.triangles);
  file.triangles = !file.facets.empty();
  if (!file.triangles) {
    file.facets = std::move(mesh.segments);
    flatten(file.facets);
  }
  for (const Facet& f : file.facets)
    for (const Vec3& x : f)
      if (!std::isfinite(norm(x))) file.problem = "has a point that is not finite";
  if (file.facets.empty()) file.problem = "has neither triangles nor lines";
  if (!file.problem.empty()) return file;
  merge_points(file.facets);
  if (file.triangles && flat(file.facets)) {
    file.facets = border_of(file.facets);
    file.triangles = false;
    flatten(file.facets);
  }
  return file;
}

}  // namespace barchan
