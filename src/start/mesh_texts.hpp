// Triangles and lines of .stl, .obj, .ply and .csv files. Internal to src/start. Every word of a file is read whole or
// the file is refused: a damaged file never becomes another shape.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"

namespace barchan {

/// What a file holds, in the file's unit of length; of a .csv whose heading names one, in m.
struct Mesh {
  std::vector<Facet> triangles;
  std::vector<Facet> segments;  // corners 1 and 2 of a segment are the same
  std::string problem;          // why the file is refused; empty when it is whole
  std::string unit{};           // that the heading of a .csv names, if not m: lengths are in m then
};

/// Stereolithography: text ("solid", facets of three vertices), or binary: a head of 80 bytes, the number of triangles,
/// 50 bytes a triangle and nothing behind them.
Mesh parse_stl(std::string_view bytes);
/// Wavefront: v, f and l; faces are cut into fans of triangles. Normals and textures are checked and left out; curves
/// and surfaces of free form are refused.
Mesh parse_obj(std::string_view text);
/// Polygons (Turk 1994), text or binary of either order of bytes: elements vertex (x, y, z), face and tristrips
/// (vertex_indices or vertex_index) and edge (vertex1, vertex2). Other elements and properties are passed over.
Mesh parse_ply(std::string_view bytes);
/// Corners of polygons: x, y a line; an empty line begins another polygon. The first line may name the columns, and
/// their units, as in "x [mm], y [mm]".
Mesh parse_corners(std::string_view text);

}  // namespace barchan
