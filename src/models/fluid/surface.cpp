#include "models/fluid/surface.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "models/fluid/fluid_stress.hpp"
#include "models/fluid/surface_neighbours.hpp"

namespace barchan {

/// The particles whose wholeness is below the threshold; nobody is near them yet.
void SurfaceFinder::take_members(const double* chi, std::size_t n, std::size_t ghosts, std::size_t dimensions,
                                 double threshold) {
  if (near_.size() < n + ghosts) {
    near_.resize(n + ghosts);
    members_.reserve(n);
    inwards_.resize((n + ghosts) * dimensions);
  }
  std::fill_n(near_.begin(), n + ghosts, std::uint8_t{0});
  members_.clear();
  for (std::size_t k = 0; k < n; ++k)
    if (chi[k] < threshold) members_.push_back(static_cast<std::uint32_t>(k));
}

/// Marked ghosts mark their sources.
void SurfaceFinder::return_marks(const CellGrid& grid, std::size_t n) {
  grid.return_ghosts(
      1, [&](std::size_t ghost, std::byte* item) { *item = static_cast<std::byte>(near_[n + ghost]); },
      [&](std::size_t source, const std::byte* item) {
        if (*item != std::byte{0}) near_[source] = 1;
      });
}

template <std::size_t Dim>
static void set_length(std::array<double, Dim>& v, double length) {
  double square = 0.0;
  for (const double c : v) square += c * c;
  if (!(square > 0.0)) return;
  for (double& c : v) c *= length / std::sqrt(square);
}

/// Sums over the row below a particle: depths z and ways l along the surface, in spacings.
template <std::size_t Dim>
struct RowBelow {
  double weight = 0.0, depth = 0.0;
  std::array<double, Dim> along{}, sloped{};       // l, z l
  std::array<double, Dim*(Dim + 1) / 2> square{};  // l l

  void add(double w, double z, const std::array<double, Dim>& l) {
    weight += w;
    depth += w * z;
    for (std::size_t d = 0; d < Dim; ++d) {
      along[d] += w * l[d];
      sloped[d] += w * z * l[d];
      for (std::size_t e = 0; e <= d; ++e) square[moment_index(d, e)] += w * l[d] * l[e];
    }
  }
  /// z at l = 0 on a line along the mean of l: one-sided neighbours (beside a wall) and a normal that leans change
  /// nothing.
  double distance() const {
    const double z = depth / weight;
    double way2 = 0.0, slope = 0.0, spread = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) {
      const double l = along[d] / weight;
      way2 += l * l;
      slope += l * (sloped[d] / weight - z * l);
      for (std::size_t e = 0; e <= d; ++e) {
        const double m = along[e] / weight;
        spread += (d == e ? 1.0 : 2.0) * l * m * (square[moment_index(d, e)] / weight - l * m);
      }
    }
    return way2 > 0.0 ? z - slope / std::max(spread / way2, least_spread) : z;
  }
  static constexpr double least_spread = 0.05;
};

/// Distance across the surface from particle k to the row below it, over the spacing: of the neighbours in depths z of
/// 0.4 to 1.6 spacings and nearer than 1.6 along the surface, with weights of [(z - 0.4)(1.6 - z)(1 - (l/1.6)^2)]^2, so
/// that neither the top row nor the third one counts. In [0.7, 1.3]; 1 without a row below. Fluid alone counts: a
/// wall's particles stay where they are.
template <std::size_t Dim>
static double row_below(const SurfaceNeighbours<Dim>& surface, PairList::Row row,
                        const std::array<const double*, Dim>& x, const std::array<double*, Dim>& inwards, std::size_t k,
                        double radius, double spacing) {
  constexpr double half = 0.6, reach = 1.6;
  std::array<double, Dim> at, n;
  for (std::size_t d = 0; d < Dim; ++d) {
    at[d] = x[d][k];
    n[d] = inwards[d][k];
  }
  set_length(n, 1.0);
  RowBelow<Dim> below;
  const auto all = [](std::size_t) { return true; };
  surface.each(row, at, radius * radius, all, [&](std::size_t, const std::array<double, Dim>& r) {
    double depth = 0.0, square = 0.0;
    std::array<double, Dim> along;
    for (std::size_t d = 0; d < Dim; ++d) depth -= r[d] * n[d] / spacing;
    for (std::size_t d = 0; d < Dim; ++d) {
      along[d] = -r[d] / spacing - depth * n[d];
      square += along[d] * along[d];
    }
    const double off = depth - 1.0, across = 1.0 - square / (reach * reach);
    if (std::abs(off) >= half || across <= 0.0) return;
    const double root = (half * half - off * off) * across;
    below.add(root * root, depth, along);
  });
  return below.weight > 0.01 ? std::clamp(below.distance(), 0.7, 1.3) : 1.0;
}

template <int Dim>
void SurfaceFinder::find_in(PhaseParticles& fluid, const CellGrid& grid, const PairList& own, double radius,
                            double threshold, double spacing) {
  constexpr std::size_t dim = Dim;
  const std::size_t n = fluid.size();
  const double* chi = fluid.column(Field::wholeness);
  std::array<const double*, dim> x{};
  std::array<double*, dim> normal{};
  for (std::size_t d = 0; d < dim; ++d) {
    x[d] = fluid.column(Field::position, static_cast<int>(d));
    normal[d] = fluid.column(Field::surface_normal, static_cast<int>(d));
  }
  const double within2 = reach * reach * radius * radius;
  const SurfaceNeighbours<dim> surface(fluid, grid, ghosts_);
  take_members(chi, n, surface.shared() ? grid.images() : 0, dim, threshold);
  const auto each_near = [&](std::size_t k, auto&& f) {
    std::array<double, dim> at;
    for (std::size_t d = 0; d < dim; ++d) at[d] = x[d][k];
    surface.each(
        own.row(k), at, within2, [](std::size_t) { return true; },
        [&](std::size_t b, const std::array<double, dim>&) { f(b); });
  };
  const auto count = static_cast<std::int64_t>(members_.size()), all = static_cast<std::int64_t>(n);
#pragma omp parallel for schedule(static)
  for (std::int64_t m = 0; m < count; ++m) {
    const std::size_t k = members_[static_cast<std::size_t>(m)];
    const auto mark = [&](std::size_t b) { std::atomic_ref(near_[b]).store(1, std::memory_order_relaxed); };
    each_near(k, mark);
    mark(k);
  }
  if (surface.shared()) return_marks(grid, n);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < all; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (near_[k] == 0) continue;
    std::array<double, dim> sum{};
    const auto add = [&](std::size_t b) {
      if (surface.wholeness(b) < threshold)
        for (std::size_t d = 0; d < dim; ++d) sum[d] += surface.normal(b, d);
    };
    add(k);
    each_near(k, add);
    if (spacing > 0.0) {
      const double below =
          chi[k] < threshold ? row_below<dim>(surface, own.row(k), x, normal, k, radius, spacing) : 1.0;
      set_length(sum, 1.0 / (below * spacing));
    }
    for (std::size_t d = 0; d < dim; ++d) inwards_[k * dim + d] = sum[d];
  }
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t d = 0; d < dim; ++d) normal[d][k] = near_[k] != 0 ? inwards_[k * dim + d] : 0.0;
}

void SurfaceFinder::find(PhaseParticles& fluid, const CellGrid& grid, const PairList& own, double radius,
                         double threshold, double spacing) {
  if (fluid.dimensions() == 2) find_in<2>(fluid, grid, own, radius, threshold, spacing);
  else find_in<3>(fluid, grid, own, radius, threshold, spacing);
}

void set_surface_stress(FluidParameters& q, double viscosity, double spacing, double row) {
  q.stressed = true;
  q.surface_viscosity = viscosity;
  q.per_top_row = row > 0.0 ? 0.5 / row : 1.0;
  const double rate = std::sqrt(norm(q.gravity) / (wave_of_layer * spacing));  // 1/s, of a wave of 2 pi 16 dx
  if (!(viscosity > 0.0 && rate > 0.0)) return;
  const double layer = std::sqrt(2.0 * viscosity / (q.reference_density * rate)) / (resolved_layer * spacing);
  q.layer_share = 1.0 / (1.0 + layer * layer * std::sqrt(layer));
}

void release_surface(PhaseParticles& fluid, double threshold, const PressureLaw& law) {
  const double* chi = fluid.column(Field::wholeness);
  double *rho = fluid.column(Field::density), *p = fluid.column(Field::pressure);
  const double at_rest = law(law.reference_density);
  const auto n = static_cast<std::int64_t>(fluid.size());
#pragma omp parallel for simd schedule(static)
  for (std::int64_t k = 0; k < n; ++k) {
    const bool pulls = chi[k] < threshold && p[k] < at_rest;
    rho[k] = pulls ? law.reference_density : rho[k];
    p[k] = pulls ? at_rest : p[k];
  }
}

}  // namespace barchan
