// Cells of a mesh that VTK has read: a part of them, and the border of those of three dimensions. Internal to
// src/scene.
#pragma once

#include <vtkDataSet.h>
#include <vtkIdList.h>

#include <vector>

#include "start/mesh_texts.hpp"

namespace barchan::mesh {

/// The cells with one number in the array that tells parts: "gmsh:physical" (meshio), "CellEntityIds" (Gmsh's own .vtk)
/// or "medit:ref". Refuses (scene/text_words.hpp) where there is no such array, or no cell has the number.
class Part {
 public:
  /// `number` 0: all cells.
  Part(vtkDataSet& data, int number);
  bool has(vtkIdType cell) const { return within_.empty() || within_[static_cast<std::size_t>(cell)]; }

 private:
  std::vector<bool> within_;
};

/// The places of a cell's corners in their order around it. Refuses numbers of points that are not there.
std::vector<Vec3> corners_of_cell(vtkDataSet& data, vtkIdType cell, vtkIdList& ids);

bool has_solid_cells(vtkDataSet& data, const Part& part);

/// The faces that one cell of three dimensions has, and no other: triangles, and polygons cut into fans. Points at one
/// place are one. Refuses curved cells, and a face of more than two.
void take_border(vtkDataSet& data, const Part& part, Mesh& mesh);

}  // namespace barchan::mesh
