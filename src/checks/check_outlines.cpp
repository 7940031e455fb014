// What is wrong with a closed outline or surface: open, crossing itself, thinner than the spacing.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "base/errors.hpp"
#include "checks/checks.hpp"
#include "scene/scene_files.hpp"
#include "start/outline.hpp"
#include "start/surface_file.hpp"

namespace barchan {
namespace {

std::string place_text(const Vec3& x, int dimensions) {
  char text[120];
  if (dimensions == 3) std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g)", x[0], x[1], x[2]);
  else std::snprintf(text, sizeof text, "(%.6g, %.6g)", x[0], x[1]);
  return text;
}

/// A point of a line or an edge of a surface with an odd number of facets is an end.
std::string open_end(const std::vector<Facet>& facets, int dimensions) {
  if (dimensions == 2) {
    std::map<Vec3, int> ends;
    for (const Facet& f : facets) {
      ++ends[f[0]];
      ++ends[f[1]];
    }
    for (const auto& [x, count] : ends)
      if (count % 2 != 0) return "the outline is open: it ends at " + place_text(x, 2) + " m; expected closed lines";
    return "";
  }
  std::map<std::pair<Vec3, Vec3>, int> edges;
  for (const Facet& f : facets)
    for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(f[i], f[(i + 1) % 3])];
  for (const auto& [edge, count] : edges)
    if (count % 2 != 0)
      return "the surface is open: " + std::to_string(count) + (count == 1 ? " triangle has" : " triangles have") +
             " the edge from " + place_text(edge.first, 3) + " m to " + place_text(edge.second, 3) +
             " m; expected a closed surface, in which two have it";
  return "";
}

double turn(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Two segments with a place in common that is not an end which both have.
bool cross(const Facet& f, const Facet& g) {
  const double d[4] = {turn(f[0], f[1], g[0]), turn(f[0], f[1], g[1]), turn(g[0], g[1], f[0]), turn(g[0], g[1], f[1])};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      if (f[i] == g[j]) {  // joined: they cross only if one folds back onto the other
        const Vec3 u = f[1 - i] - f[i], v = g[1 - j] - g[j];
        return turn(f[i], f[1 - i], g[1 - j]) == 0.0 && u[0] * v[0] + u[1] * v[1] > 0.0;
      }
  const auto within = [](const Facet& s, const Vec3& x) {
    return std::min(s[0][0], s[1][0]) <= x[0] && x[0] <= std::max(s[0][0], s[1][0]) &&
           std::min(s[0][1], s[1][1]) <= x[1] && x[1] <= std::max(s[0][1], s[1][1]);
  };
  if (d[0] * d[1] < 0.0 && d[2] * d[3] < 0.0) return true;
  return (d[0] == 0.0 && within(f, g[0])) || (d[1] == 0.0 && within(f, g[1])) || (d[2] == 0.0 && within(g, f[0])) ||
         (d[3] == 0.0 && within(g, f[1]));
}

std::string crossing(std::vector<Facet> segments) {
  const auto left = [](const Facet& f) { return std::min(f[0][0], f[1][0]); };
  std::sort(segments.begin(), segments.end(), [&](const Facet& f, const Facet& g) { return left(f) < left(g); });
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const double right = std::max(segments[i][0][0], segments[i][1][0]);
    for (std::size_t j = i + 1; j < segments.size() && left(segments[j]) <= right; ++j)
      if (cross(segments[i], segments[j]))
        return "the outline crosses itself: the side from " + place_text(segments[i][0], 2) + " to " +
               place_text(segments[i][1], 2) + " m meets that from " + place_text(segments[j][0], 2) + " to " +
               place_text(segments[j][1], 2) + " m; expected sides that meet at their ends only";
  }
  return "";
}

}  // namespace

std::string misfit_of_outline(const std::vector<Facet>& facets, int dimensions, double spacing) {
  const Outline outline(facets, dimensions);
  const std::string what = dimensions == 3 ? "surface" : "outline";
  const std::vector<Facet>& kept = outline.facets();
  if (kept.empty())
    return "the " + what + " has no " + (dimensions == 3 ? "triangle" : "side") + "; expected a closed " + what;
  if (std::string open = open_end(kept, dimensions); !open.empty()) return open;
  if (dimensions == 2)
    if (std::string crossed = crossing(kept); !crossed.empty()) return crossed;
  // A sheet of width w has 2 content/border = w, a disc or a ball of that value is twice or three times as wide.
  const double thickness = outline.border() > 0.0 ? 2.0 * outline.content() / outline.border() : 0.0;
  if (!(thickness >= 0.5 * spacing))
    return "the " + what + " holds " + number_text(outline.content()) + (dimensions == 3 ? " m3" : " m2") + " and is " +
           number_text(thickness) +
           " m thick in the mean (twice what it holds by its border); expected at least half a spacing, " +
           number_text(0.5 * spacing) + " m";
  return "";
}

void read_surfaces(Scene& scene, const Report& report) {
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    auto* surface = std::get_if<SurfaceShape>(&scene.fills[k].shape);
    const std::string dotted = "fill." + std::to_string(k) + ".shape.surface";
    if (!surface || report.touched(dotted)) continue;
    const std::string path = path_of_file(scene, surface->file);
    SurfaceFile file = read_surface(path, surface->part);
    if (!file.problem.empty())
      report(dotted, "\"" + shortened(path) + "\": " + file.problem +
                         "; expected .stl, .obj, .ply, .vtp, .vtu, .vtk or .csv, relative to the scene's file (meshio "
                         "converts others)");
    if (!file.unit.empty() && surface->placement.scale != 1.0)
      report("fill." + std::to_string(k) + ".shape.scale",
             "the heading of \"" + shortened(surface->file) + "\" says that its lengths are in " + file.unit +
                 ", and they are converted by that; expected no scale, or a heading without units");
    surface->facets = std::move(file.facets);
    surface->triangles = file.triangles;
  }
}

}  // namespace barchan
