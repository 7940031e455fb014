// Closed outlines and surfaces: what is inside, how far the border is, how much they hold. Internal to src/start.
#pragma once

#include <array>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include "base/vec3.hpp"
#include "scene/scene.hpp"
#include "start/content.hpp"

namespace barchan {

/// A closed border made of facets: segments in x, y (then it goes through all of z) or triangles. Several closed parts
/// may lie inside each other: what an odd number of them holds is inside, so a ring is two loops.
class Outline {
 public:
  /// `reach` (m): as far as depth() tells the distance. Facets without length or area are left out.
  Outline(const std::vector<Facet>& facets, int dimensions, double reach = 0.0);

  /// Facets cut by the ray from x along +x are counted. A facet's lower end belongs to it and its upper end does not,
  /// so that neighbours which share a corner are cut once.
  bool inside(const Vec3& x) const;

  /// Distance (m) to the border, positive inside; farther than the reach: the reach, with that sign.
  double depth(const Vec3& x) const;

  double content() const { return content_; }  ///< area (m2) or volume (m3) inside
  Content moments() const;                     ///< the same with its centre and its second moments; in 2D x, y alone
  double border() const { return border_; }    ///< length (m) or area (m2) of the border
  const Vec3& lower() const { return lower_; }
  const Vec3& upper() const { return upper_; }
  const std::vector<Facet>& facets() const { return facets_; }

 private:
  using Cell = std::array<long, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const;
  };
  bool cuts(const Facet& facet, const Vec3& x) const;
  void sort_into_cells();
  void measure();
  Vec3 outwards(const Facet& facet) const;
  Cell cell_of(const Vec3& x) const;
  /// The column along x in which the place lies; `rows_`^2 columns in three dimensions.
  std::size_t row_of(double y, double z) const;
  std::array<long, 2> row_indices(double y, double z) const;

  std::vector<Facet> facets_;
  int dimensions_;
  double reach_, width_ = 0.0;  // m; of a cell
  long rows_ = 1;
  Vec3 lower_{}, upper_{};
  double content_ = 0.0, border_ = 0.0;
  std::vector<std::vector<std::size_t>> rows_of_facets_;           // facets by what a ray along x can cut
  std::unordered_map<Cell, std::vector<std::size_t>, Hash> near_;  // facets within the reach of a cell
};

/// The facets of a polygon or of a file, scaled, turned and moved; none of other shapes.
std::vector<Facet> facets_of(const Shape& shape);

/// Why the facets bound nothing that particles can fill, with the place in question; empty when they do. `spacing` (m).
std::string misfit_of_outline(const std::vector<Facet>& facets, int dimensions, double spacing);

}  // namespace barchan
