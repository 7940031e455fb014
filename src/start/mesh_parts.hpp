// What the readers of meshes make of words (start/mesh_texts.hpp): fans, strips and segments.
#pragma once

#include <vector>

#include "base/vec3.hpp"
#include "scene/text_words.hpp"
#include "start/mesh_texts.hpp"

namespace barchan::mesh {

inline void add_polygon(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::size_t>& corners) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)  // a fan
    mesh.triangles.push_back({points[corners[0]], points[corners[i]], points[corners[i + 1]]});
}

inline void add_strip(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<std::size_t>& corners) {
  for (std::size_t i = 0; i + 2 < corners.size(); ++i)
    mesh.triangles.push_back({points[corners[i]], points[corners[i + 1]], points[corners[i + 2]]});
}

inline void add_segment(Mesh& mesh, const Vec3& a, const Vec3& b) { mesh.segments.push_back({a, b, b}); }

template <class Read>
Mesh whole(const Read& read) {
  Mesh mesh;
  try {
    read(mesh);
  } catch (const Refused& refused) { mesh.problem = refused.why; }
  return mesh;
}

}  // namespace barchan::mesh
