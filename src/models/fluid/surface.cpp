#include "models/fluid/surface.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "engine/entry_of_list.hpp"

namespace barchan {

namespace {

/// Square distance of a listed particle from particle `from`.
template <std::size_t Dim>
double distance2(const ListedParticle<Dim>& entry, const std::array<const double*, Dim>& x, std::size_t from) {
  double sum = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    const double r = x[d][from] - x[d][entry.source] - entry.shift[d];
    sum += r * r;
  }
  return sum;
}

}  // namespace

/// The particles whose wholeness is below the threshold; nobody is near them yet.
void SurfaceFinder::take_members(const double* chi, std::size_t n, std::size_t dimensions, double threshold) {
  if (near_.size() < n) {
    near_.resize(n);
    members_.reserve(n);
    inwards_.resize(n * dimensions);
  }
  std::fill_n(near_.begin(), n, std::uint8_t{0});
  members_.clear();
  for (std::size_t k = 0; k < n; ++k)
    if (chi[k] < threshold) members_.push_back(static_cast<std::uint32_t>(k));
}

template <int Dim>
void SurfaceFinder::find_in(PhaseParticles& fluid, const CellGrid& grid, const PairList& own, double radius,
                            double threshold) {
  constexpr std::size_t dim = Dim;
  const std::size_t n = fluid.size(), dummy = n + grid.images();
  const double* chi = fluid.column(Field::wholeness);
  std::array<const double*, dim> x{};
  std::array<double*, dim> normal{};
  for (std::size_t d = 0; d < dim; ++d) {
    x[d] = fluid.column(Field::position, static_cast<int>(d));
    normal[d] = fluid.column(Field::surface_normal, static_cast<int>(d));
  }
  const double within2 = reach * reach * radius * radius;
  take_members(chi, n, dim, threshold);
  const auto each_near = [&](std::size_t k, auto&& f) {
    const auto row = own.row(k);
    for (const std::uint32_t* q = row.begin; q != row.end; ++q) {
      const std::size_t index = *q / PairList::stride;
      if (index == dummy) continue;
      const auto entry = look_up<dim>(index, grid, n);
      if (distance2<dim>(entry, x, k) < within2) f(entry.source);
    }
  };
  const auto count = static_cast<std::int64_t>(members_.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t m = 0; m < count; ++m) {
    const std::size_t k = members_[static_cast<std::size_t>(m)];
    const auto mark = [&](std::size_t b) {
      std::atomic_ref<std::uint8_t>(near_[b]).store(1, std::memory_order_relaxed);
    };
    mark(k);
    each_near(k, mark);
  }
  const auto all = static_cast<std::int64_t>(n);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < all; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (near_[k] == 0) continue;
    std::array<double, dim> sum{};
    const auto add = [&](std::size_t b) {
      if (chi[b] < threshold)
        for (std::size_t d = 0; d < dim; ++d) sum[d] += normal[d][b];
    };
    add(k);
    each_near(k, add);
    for (std::size_t d = 0; d < dim; ++d) inwards_[k * dim + d] = sum[d];
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < all; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (std::size_t d = 0; d < dim; ++d) normal[d][k] = near_[k] != 0 ? inwards_[k * dim + d] : 0.0;
  }
}

void SurfaceFinder::find(PhaseParticles& fluid, const CellGrid& grid, const PairList& own, double radius,
                         double threshold) {
  if (fluid.dimensions() == 2) find_in<2>(fluid, grid, own, radius, threshold);
  else find_in<3>(fluid, grid, own, radius, threshold);
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
