// The distance to a border between two spacings of a fluid.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/cell_grid.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// The distance to a border given by a formula, on a grid over the domain: the formula over the size of its gradient.
class BorderDistance {
 public:
  /// `spacing` (m): of the nodes. Throws SceneError with `where` where the formula has no number.
  BorderDistance(const Expression& formula, const Bounds& domain, double spacing, const std::string& where);
  /// m, at most `most` spacings; above zero on the coarse side. Linear between the nodes; beyond the domain as at its
  /// side.
  double operator()(const Vec3& x) const;

 private:
  static constexpr double most = 16.0;
  Bounds bounds_;
  std::array<std::size_t, 3> count_{1, 1, 1};  // nodes
  Vec3 step_{1, 1, 1};                         // m
  std::vector<double> value_;
};

}  // namespace barchan
