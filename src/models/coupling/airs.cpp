#include "models/coupling/airs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace barchan {

std::vector<std::size_t> airs_about(const Layout& layout, std::size_t grains) {
  std::vector<std::size_t> airs;
  for (const PlanEntry& e : layout.entries)
    if (e.blows && !e.wind_by_height && e.given.drag_law != DragLaw::none && e.other == grains) airs.push_back(e.fluid);
  std::sort(airs.begin(), airs.end(),
            [&](std::size_t a, std::size_t b) { return layout.phases[a].spacing < layout.phases[b].spacing; });
  return airs;
}

Airs::Airs(const Layout& layout, std::vector<std::size_t> phases) : phases_(std::move(phases)) {
  for (const std::size_t k : phases_) {
    const PlanPhase& p = layout.phases[k];
    density_.push_back(p.mass / (layout.dimensions == 2 ? p.spacing * p.spacing : std::pow(p.spacing, 3)));
    grids_.emplace_back(layout.bounds, p.spacing);
  }
}

void Airs::gather(const State& state) {
  for (std::size_t k = 0; k < grids_.size(); ++k) grids_[k].gather(state.phases[phases_[k]]);
}

void Airs::keep_forces() {
  for (AirGrid& grid : grids_) grid.keep_forces();
}

void Airs::forget() {
  for (AirGrid& grid : grids_) grid.forget();
}

void Airs::archive(Archive& a) {
  for (AirGrid& grid : grids_) grid.archive(a);
}

Vec3 Airs::velocity(const Vec3& x) const {
  if (grids_.size() == 1) return grids_.front().velocity(x);
  Vec3 sum{};
  double all = 0.0;
  for (std::size_t k = 0; k < grids_.size(); ++k) {
    const double share = grids_[k].density(x) / density_[k];
    if (!(share > 0.0)) continue;
    const Vec3 u = grids_[k].velocity(x);
    all += share;
    for (std::size_t d = 0; d < 3; ++d) sum[d] += share * u[d];
  }
  return all > 0.0 ? Vec3{sum[0] / all, sum[1] / all, sum[2] / all} : Vec3{};
}

/// Calls f(grid, share) with each grid that has air about a place; the shares add up to 1.
template <class F>
void Airs::each_about(const Vec3& x, F&& f) {
  double all = 0.0;
  for (std::size_t k = 0; k < grids_.size() && grids_.size() > 1; ++k) all += grids_[k].density(x) / density_[k];
  if (!(all > 0.0)) return f(grids_.front(), 1.0);
  for (std::size_t k = 0; k < grids_.size(); ++k) {
    const double share = grids_[k].density(x) / density_[k] / all;
    if (share > 0.0) f(grids_[k], share);
  }
}

void Airs::push(const Vec3& x, const Vec3& force) {
  each_about(x, [&](AirGrid& grid, double share) { grid.push(x, share * force); });
}

void Airs::put(const Vec3& x, double mass, double rate) {
  each_about(x, [&](AirGrid& grid, double share) { grid.put(x, share * mass, rate); });
}

void Airs::give(State& state) const {
  for (std::size_t k = 0; k < grids_.size(); ++k) grids_[k].give(state.phases[phases_[k]]);
}

}  // namespace barchan
