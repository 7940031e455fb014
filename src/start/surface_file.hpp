// Files of outlines and surfaces. Internal to src/start.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace barchan {

struct SurfaceFile {
  std::vector<Facet> facets;  // in the file's unit of length
  bool triangles = false;     // else segments
  std::string problem;        // why nothing was read; empty when it was
  std::string unit;           // that the file names, if not m; facets are in m then
};

/// Reads the border of cells of three dimensions (.vtu, .vtk), or triangles and other flat cells (.stl, .obj, .ply,
/// .vtp, .vtu, .vtk), or, where a file has none, lines of x, y. Flat cells that lie in one plane z give the lines of
/// their border. A .csv has the corners of a polygon, x, y a line; an empty line begins another one. Points nearer than
/// 1e-7 of the file's size are one. `part`: of a VTK file, the cells of this number (mesh_solid.hpp); 0: all.
SurfaceFile read_surface(const std::string& path, int part = 0);

}  // namespace barchan
