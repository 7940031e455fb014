// Who is near a point: a phase's particles in cells as wide as the search, made anew for each moment that is measured.
//
// The simulation's own grids know where particles were when they were last sorted; these know where they are, and
// leave the simulation as it is.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/cell_grid.hpp"
#include "state/particles.hpp"

namespace barchan {

class Lookup {
 public:
  /// `radius` (m) of all searches; a period of `bounds` must be longer than two.
  Lookup(const Bounds& bounds, double radius);

  /// Sorts the particles into cells. They are looked at until the next build and must neither go nor move.
  void build(const PhaseParticles& particles);

  /// Calls f(i, r, r2) for every particle i nearer than the radius, in an order that the arrays decide;
  /// r = x_i - x (m), the nearest image.
  template <class F>
  void neighbours(const Vec3& x, F&& f) const {
    std::array<std::array<std::size_t, 2>, 3> range{};  // cells first .. last; past the last one they begin anew
    for (std::size_t d = 0; d < 3; ++d) range[d] = cells_about(x[d], d);
    for (std::size_t z = range[2][0]; z <= range[2][1]; ++z)
      for (std::size_t y = range[1][0]; y <= range[1][1]; ++y)
        for (std::size_t c = range[0][0]; c <= range[0][1]; ++c) {
          const std::size_t cell = ((z % count_[2]) * count_[1] + y % count_[1]) * count_[0] + c % count_[0];
          for (std::size_t k = begin_[cell]; k < begin_[cell + 1]; ++k) {
            const std::uint32_t i = order_[k];
            Vec3 r{};
            for (std::size_t d = 0; d < dimensions_; ++d) {
              r[d] = column_[d][i] - x[d];
              if (bounds_.periodic[d]) r[d] -= period_[d] * std::round(r[d] / period_[d]);
            }
            const double r2 = dot(r, r);
            if (r2 < radius_ * radius_) f(i, r, r2);
          }
        }
  }

 private:
  std::size_t cell_coordinate(double x, std::size_t axis) const;
  std::array<std::size_t, 2> cells_about(double x, std::size_t axis) const;

  Bounds bounds_;
  std::size_t dimensions_;
  double radius_;
  Vec3 period_{};
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::vector<std::size_t> begin_;  // by cell
  std::vector<std::uint32_t> order_, cell_of_;
  std::array<const double*, 3> column_{};
};

}  // namespace barchan
