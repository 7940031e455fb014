// Meshes of VTK's own files. Internal to src/start.
#pragma once

#include <string>
#include <string_view>

#include "start/mesh_texts.hpp"

namespace barchan {

/// Reads the flat cells and the lines of a .vtp, .vtu or .vtk file, or the outer faces of its cells of three dimensions
/// where it has such, with VTK, in a process of its own: VTK trusts what a file says of itself, and a damaged one may
/// end the process that reads it. `part`: of the cells, as SurfaceShape has it. Numbers of points beyond the last one,
/// and whatever VTK complains of, are refused.
Mesh read_vtk_mesh(const std::string& path, const std::string& suffix, int part = 0);

/// What is no number among the numbers that such a file has as text; empty when all are. VTK would stop there, or read
/// a part of the word.
std::string wrong_number_of_vtk(std::string_view text, const std::string& suffix);

}  // namespace barchan
