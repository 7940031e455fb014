#include "scene/surface_file.hpp"

#include <vtkCell.h>
#include <vtkDataSet.h>
#include <vtkGenericDataObjectReader.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

namespace barchan {
namespace {

constexpr std::uintmax_t most_of_a_surface = std::uintmax_t{1} << 30;  // bytes

/// Keeps VTK's complaints off the terminal: the scene's message tells what is wrong.
class Silence {
 public:
  Silence() : before_(vtkObject::GetGlobalWarningDisplay()) { vtkObject::SetGlobalWarningDisplay(0); }
  ~Silence() { vtkObject::SetGlobalWarningDisplay(before_); }

 private:
  int before_;
};

void take_cells(vtkDataSet& data, std::vector<Facet>& triangles, std::vector<Facet>& segments) {
  const auto point = [&](vtkCell& cell, int i) {
    Vec3 x;
    data.GetPoint(cell.GetPointId(i), x.data());
    return x;
  };
  for (vtkIdType k = 0; k < data.GetNumberOfCells(); ++k) {
    vtkCell& cell = *data.GetCell(k);
    const int count = static_cast<int>(cell.GetNumberOfPoints());
    if (cell.GetCellDimension() == 1)
      for (int i = 0; i + 1 < count; ++i) {
        const Vec3 a = point(cell, i), b = point(cell, i + 1);
        segments.push_back({a, b, b});
      }
    else if (cell.GetCellType() == VTK_TRIANGLE_STRIP)
      for (int i = 0; i + 2 < count; ++i) triangles.push_back({point(cell, i), point(cell, i + 1), point(cell, i + 2)});
    else if (cell.GetCellDimension() == 2)
      for (int i = 1; i + 1 < count; ++i)  // a fan: convex polygons
        triangles.push_back({point(cell, 0), point(cell, i), point(cell, i + 1)});
  }
}

template <class Reader>
void read_with(const std::string& path, SurfaceFile& file, std::vector<Facet>& segments) {
  vtkNew<Reader> reader;
  const Silence silence;
  reader->SetFileName(path.c_str());
  reader->Update();
  auto* data = vtkDataSet::SafeDownCast(reader->GetOutputDataObject(0));
  if (data) take_cells(*data, file.facets, segments);
  if (!data || reader->GetErrorCode() != 0) file.problem = "cannot be read as what its name says it is";
}

void read_corners(const std::string& path, SurfaceFile& file, std::vector<Facet>& segments) {
  std::ifstream stream(path);
  std::vector<Vec3> corners;
  const auto close = [&] {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
      segments.push_back({a, b, b});
    }
    corners.clear();
  };
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) close();
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    Vec3 x{};
    char more = 0;
    if (std::sscanf(line.c_str(), "%lf %lf %c", &x[0], &x[1], &more) == 2) corners.push_back(x);
    else if (number > 1 || !std::isalpha(static_cast<unsigned char>(line[line.find_first_not_of(" \t\"")]))) {
      file.problem = "line " + std::to_string(number) + " is not a corner x, y";
      return;
    }
  }
  close();
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

}  // namespace

SurfaceFile read_surface(const std::string& path) {
  SurfaceFile file;
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) file.problem = "there is no such file";
  else if (!std::filesystem::is_regular_file(status)) file.problem = "is not a file";
  else if (std::filesystem::file_size(path, error) > most_of_a_surface || error) file.problem = "is larger than 1 GB";
  if (!file.problem.empty()) return file;
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  std::vector<Facet> segments;
  if (suffix == ".stl") read_with<vtkSTLReader>(path, file, segments);
  else if (suffix == ".obj") read_with<vtkOBJReader>(path, file, segments);
  else if (suffix == ".ply") read_with<vtkPLYReader>(path, file, segments);
  else if (suffix == ".vtp") read_with<vtkXMLPolyDataReader>(path, file, segments);
  else if (suffix == ".vtu") read_with<vtkXMLUnstructuredGridReader>(path, file, segments);
  else if (suffix == ".vtk") read_with<vtkGenericDataObjectReader>(path, file, segments);
  else if (suffix == ".csv") read_corners(path, file, segments);
  else file.problem = "a file of an unknown kind";
  if (!file.problem.empty()) return file;
  file.triangles = !file.facets.empty();
  if (!file.triangles) {
    file.facets = std::move(segments);
    for (Facet& f : file.facets)
      for (Vec3& x : f) x[2] = 0.0;
  }
  for (const Facet& f : file.facets)
    for (const Vec3& x : f)
      if (!std::isfinite(norm(x))) file.problem = "has a point that is not finite";
  if (file.facets.empty()) file.problem = "has neither triangles nor lines";
  if (file.problem.empty()) merge_points(file.facets);
  return file;
}

}  // namespace barchan
