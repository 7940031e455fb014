#include "start/mesh_solid.hpp"

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellTypes.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <tuple>

#include "start/mesh_parts.hpp"

namespace barchan::mesh {
namespace {

vtkDataArray* parts_of(vtkDataSet& data) {
  for (const char* name : {"gmsh:physical", "CellEntityIds", "medit:ref"})
    if (vtkDataArray* array = data.GetCellData()->GetArray(name)) return array;
  return nullptr;
}

/// The first few of the numbers that the cells have.
std::string some_of(vtkDataArray& array) {
  constexpr std::size_t most = 10;
  std::set<double> numbers;
  for (vtkIdType k = 0; k < array.GetNumberOfTuples() && numbers.size() <= most; ++k)
    numbers.insert(array.GetComponent(k, 0));
  std::string text;
  for (const double number : numbers) {
    if (!text.empty()) text += ", ";
    text += numbers.size() > most && number == *numbers.rbegin() ? "..." : std::to_string(std::lround(number));
  }
  return text;
}

/// Points at one place get the number of the first of them.
std::vector<vtkIdType> first_at_place(vtkDataSet& data) {
  const auto n = static_cast<std::size_t>(data.GetNumberOfPoints());
  std::vector<Vec3> places(n);
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) data.GetPoint(static_cast<vtkIdType>(i), places[i].data());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return places[a] != places[b] ? places[a] < places[b] : a < b; });
  std::vector<vtkIdType> first(n);
  for (std::size_t k = 0; k < n; ++k) {
    const bool again = k > 0 && places[order[k]] == places[order[k - 1]];
    first[order[k]] = again ? first[order[k - 1]] : static_cast<vtkIdType>(order[k]);
  }
  return first;
}

/// A face of a cell: the least four of its points in order, and how many it has, tell which one.
struct Face {
  std::array<vtkIdType, 4> points{-1, -1, -1, -1};
  vtkIdType count = 0, cell = 0;
  int number = 0;
  auto key() const { return std::tie(points, count); }
};

Face face_of(vtkCell& face, vtkIdType cell, int number, const std::vector<vtkIdType>& first) {
  std::vector<vtkIdType> ids;
  for (vtkIdType i = 0; i < face.GetNumberOfPoints(); ++i)
    ids.push_back(first[static_cast<std::size_t>(face.GetPointId(static_cast<int>(i)))]);
  std::sort(ids.begin(), ids.end());
  Face f;
  f.count = static_cast<vtkIdType>(ids.size());
  f.cell = cell;
  f.number = number;
  std::copy_n(ids.begin(), std::min<std::size_t>(4, ids.size()), f.points.begin());
  return f;
}

std::vector<Face> faces_of(vtkDataSet& data, const Part& part) {
  const std::vector<vtkIdType> first = first_at_place(data);
  std::vector<Face> faces;
  vtkNew<vtkIdList> ids;
  for (vtkIdType k = 0; k < data.GetNumberOfCells(); ++k) {
    if (!part.has(k)) continue;
    corners_of_cell(data, k, *ids);  // names of points that are not there
    vtkCell* cell = data.GetCell(k);
    if (cell->GetCellDimension() != 3) continue;
    if (!cell->IsLinear()) refuse("has curved cells; expected tetrahedra, hexahedra, wedges or pyramids of flat sides");
    for (int f = 0; f < cell->GetNumberOfFaces(); ++f) faces.push_back(face_of(*cell->GetFace(f), k, f, first));
  }
  return faces;
}

void add_face(vtkCell& face, Mesh& mesh) {
  std::vector<Vec3> corners(static_cast<std::size_t>(face.GetNumberOfPoints()));
  for (std::size_t i = 0; i < corners.size(); ++i)
    face.GetPoints()->GetPoint(static_cast<vtkIdType>(i), corners[i].data());
  std::vector<std::size_t> order(corners.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (face.GetCellType() == VTK_PIXEL) std::swap(order[2], order[3]);  // its corners go to and fro
  add_polygon(mesh, corners, order);
}

}  // namespace

Part::Part(vtkDataSet& data, int number) {
  if (number == 0) return;
  vtkDataArray* array = parts_of(data);
  if (!array || array->GetNumberOfTuples() != data.GetNumberOfCells())
    refuse("has no parts: no cell data \"gmsh:physical\", \"CellEntityIds\" or \"medit:ref\"");
  within_.resize(static_cast<std::size_t>(data.GetNumberOfCells()));
  for (std::size_t k = 0; k < within_.size(); ++k)
    within_[k] = array->GetComponent(static_cast<vtkIdType>(k), 0) == static_cast<double>(number);
  if (std::find(within_.begin(), within_.end(), true) == within_.end())
    refuse("has no part " + std::to_string(number) + ": its cells are of " + some_of(*array));
}

std::vector<Vec3> corners_of_cell(vtkDataSet& data, vtkIdType cell, vtkIdList& ids) {
  data.GetCellPoints(cell, &ids);
  std::vector<Vec3> corners(static_cast<std::size_t>(ids.GetNumberOfIds()));
  for (vtkIdType i = 0; i < ids.GetNumberOfIds(); ++i) {
    const vtkIdType id = ids.GetId(i);
    if (id < 0 || id >= data.GetNumberOfPoints())
      refuse("cell " + std::to_string(cell) + " names point " + std::to_string(id) + " of " +
             std::to_string(data.GetNumberOfPoints()));
    data.GetPoint(id, corners[static_cast<std::size_t>(i)].data());
  }
  return corners;
}

bool has_solid_cells(vtkDataSet& data, const Part& part) {
  for (vtkIdType k = 0; k < data.GetNumberOfCells(); ++k)
    if (part.has(k) && vtkCellTypes::GetDimension(static_cast<unsigned char>(data.GetCellType(k))) == 3) return true;
  return false;
}

void take_border(vtkDataSet& data, const Part& part, Mesh& mesh) {
  std::vector<Face> faces = faces_of(data, part);
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.key() != b.key() ? a.key() < b.key() : std::tie(a.cell, a.number) < std::tie(b.cell, b.number);
  });
  for (auto begin = faces.begin(); begin != faces.end();) {
    const auto end = std::find_if(begin, faces.end(), [&](const Face& f) { return f.key() != begin->key(); });
    if (end - begin > 2)
      refuse("has a face of " + std::to_string(end - begin) + " cells, the first is " + std::to_string(begin->cell));
    if (end - begin == 1) add_face(*data.GetCell(begin->cell)->GetFace(begin->number), mesh);
    begin = end;
  }
}

}  // namespace barchan::mesh
