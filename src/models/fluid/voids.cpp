#include "models/fluid/voids.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "engine/entry_of_list.hpp"
#include "engine/exchange.hpp"

namespace barchan {

namespace {

using Seen = VoidFinder::Seen;
using Ghosts = VoidFinder::Ghosts;

template <std::size_t Dim>
std::array<const double*, Dim> places(const PhaseParticles& particles) {
  std::array<const double*, Dim> x{};
  for (std::size_t d = 0; d < Dim; ++d) x[d] = particles.column(Field::position, static_cast<int>(d));
  return x;
}

/// Calls f(source, r) for every neighbour of a particle at x_a that is listed; r = x_a - x_b. On several ranks the
/// source of a ghost is its own place, behind the particles.
template <std::size_t Dim, class F>
void each_neighbour(const Seen& seen, const Ghosts& ghosts, std::size_t k, const std::array<double, Dim>& x_a, F&& f) {
  const auto x = places<Dim>(*seen.particles);
  const std::size_t n = seen.particles->size(), dummy = n + seen.grid->images();
  const auto row = seen.list->row(k);
  for (const std::uint32_t* q = row.begin; q != row.end; ++q) {
    const std::size_t index = *q / PairList::stride;
    if (index == dummy) continue;
    const auto entry = look_up<Dim>(index, *seen.grid, n);
    std::array<double, Dim> r;
    if (index >= n && seen.grid->is_shared()) {
      for (std::size_t d = 0; d < Dim; ++d) r[d] = x_a[d] - ghosts[d][index - n] - entry.shift[d];
      f(index, r);
      continue;
    }
    for (std::size_t d = 0; d < Dim; ++d) r[d] = x_a[d] - x[d][entry.source] - entry.shift[d];
    f(entry.source, r);
  }
}

template <std::size_t Dim>
double squared(const std::array<double, Dim>& r) {
  double sum = 0.0;
  for (const double x : r) sum += x * x;
  return sum;
}

/// Whether a ball without particles lies beside particle k.
template <std::size_t Dim>
bool beside_void(const PhaseParticles& fluid, std::span<const Seen> seen, std::span<const Ghosts> ghosts, double radius,
                 double spacing, std::size_t k) {
  std::array<double, Dim> x{}, out{};
  for (std::size_t d = 0; d < Dim; ++d) x[d] = fluid.column(Field::position, static_cast<int>(d))[k];
  for (std::size_t s = 0; s < seen.size(); ++s)
    each_neighbour<Dim>(seen[s], ghosts[s], k, x, [&](std::size_t, const std::array<double, Dim>& r) {
      const double distance = std::sqrt(squared<Dim>(r)), weight = radius / std::max(distance, 1e-3 * radius) - 1.0;
      if (weight > 0.0)
        for (std::size_t d = 0; d < Dim; ++d) out[d] += weight * r[d];
    });
  const double length = std::sqrt(squared<Dim>(out));
  if (!(length > 0.0)) return false;
  bool empty = true;
  for (std::size_t s = 0; s < seen.size(); ++s)
    each_neighbour<Dim>(seen[s], ghosts[s], k, x, [&](std::size_t, std::array<double, Dim> r) {
      for (std::size_t d = 0; d < Dim; ++d) r[d] += VoidFinder::outside * spacing / length * out[d];
      empty = empty && squared<Dim>(r) > seen[s].width * seen[s].width;
    });
  return empty;
}

}  // namespace

bool VoidFinder::is_left_out(const PhaseParticles& fluid, std::size_t k) const {
  return std::any_of(ends_.begin(), ends_.end(), [&](const FlowEnd& end) {
    return end.beyond(fluid.column(Field::position, static_cast<int>(end.axis()))[k]) > end.layer;
  });
}

template <int Dim>
bool VoidFinder::find_in(PhaseParticles& fluid, std::span<const Seen> seen, double radius, double spacing,
                         LooseParticles& loose) {
  constexpr std::size_t dim = Dim;
  double* left = fluid.column(Field::near_void);
  const auto n = static_cast<std::int64_t>(fluid.size());
  int any = 0;
  std::int64_t broken = 0;
  if (near_ != 0) {
#pragma omp parallel for schedule(static) reduction(| : any)
    for (std::int64_t k = 0; k < n; ++k) {
      left[k] = left[k] > 1.0 ? left[k] - 1.0 : 0.0;
      any |= left[k] > 0.0 ? 1 : 0;
    }
  }
  take_ghosts(seen);
  const auto count = static_cast<std::int64_t>(loose.count.load(std::memory_order_relaxed));
  loose.count.store(0, std::memory_order_relaxed);
#pragma omp parallel for schedule(dynamic, 64) reduction(| : any) reduction(+ : broken) if (count > 256)
  for (std::int64_t q = 0; q < count; ++q) {
    const std::uint32_t noted = loose.place[static_cast<std::size_t>(q)];
    const std::size_t k = noted & ~LooseParticles::broken;
    if (is_left_out(fluid, k)) continue;
    const bool beside = beside_void<dim>(fluid, seen, ghosts_, radius, spacing, k);
    if ((k == noted || until_ > 0) && !beside) continue;
    if (!beside) ++broken;
    any = 1;
    const auto mark = [&](std::size_t b) {
      if (b < fluid.size()) std::atomic_ref<double>(left[b]).store(memory, std::memory_order_relaxed);
      else std::atomic_ref<char>(marked_[b - fluid.size()]).store(1, std::memory_order_relaxed);
    };
    mark(k);
    std::array<double, dim> x{};
    for (std::size_t d = 0; d < dim; ++d) x[d] = fluid.column(Field::position, static_cast<int>(d))[k];
    each_neighbour<dim>(seen.front(), ghosts_.front(), k, x, [&](std::size_t b, const std::array<double, dim>& r) {
      if (squared<dim>(r) < radius * radius) mark(b);
    });
  }
  return_marks(*seen.front().grid, left);
  std::array<std::int64_t, 3> found{broken, any, n};  // of all ranks together
  Exchange().reduce(found.data(), found.size(), Exchange::Take::sum);
  any = found[1] > 0 ? 1 : 0;
  const bool many = found[0] > 0 && static_cast<double>(found[0]) >= unresolved_share * static_cast<double>(found[2]);
  unresolved_ = std::max<std::int64_t>(unresolved_ + (many ? 1 : -1), 0);
  if (unresolved_ >= unresolved_steps) {
    unresolved_ = unresolved_steps;
    std::fill(left, left + n, unresolved_memory);
  }
  near_ = any;
  return near_ != 0;
}

/// On several ranks: the places of the ghosts of each phase that is seen, none of which is marked yet.
void VoidFinder::take_ghosts(std::span<const Seen> seen) {
  if (ghosts_.size() < seen.size()) ghosts_.resize(seen.size());
  for (std::size_t s = 0; s < seen.size(); ++s) seen[s].grid->take_places(*seen[s].particles, ghosts_[s]);
  if (seen.front().grid->is_shared()) marked_.assign(seen.front().grid->images(), 0);
}

/// Marked ghosts mark their sources.
void VoidFinder::return_marks(const CellGrid& grid, double* left) const {
  if (!grid.is_shared()) return;
  grid.return_ghosts(
      1, [&](std::size_t ghost, std::byte* item) { *item = static_cast<std::byte>(marked_[ghost]); },
      [&](std::size_t source, const std::byte* item) {
        if (*item != std::byte{0}) left[source] = memory;
      });
}

bool VoidFinder::find(PhaseParticles& fluid, std::span<const Seen> seen, double radius, double spacing,
                      LooseParticles& loose) {
  if (until_ > 0) --until_;
  if (near_ == 0 && !Exchange().any(loose.count.load(std::memory_order_relaxed) != 0)) {
    unresolved_ = std::max<std::int64_t>(unresolved_ - 1, 0);
    return false;
  }
  if (fluid.dimensions() == 2) return find_in<2>(fluid, seen, radius, spacing, loose);
  return find_in<3>(fluid, seen, radius, spacing, loose);
}

}  // namespace barchan
