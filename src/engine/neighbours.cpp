#include "engine/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/rank_load.hpp"
#include "simd/vec.hpp"

namespace barchan {

Neighbours::Neighbours(const Bounds& bounds, std::vector<Direction> directions, double skin,
                       const std::vector<double>& spacings, std::size_t padding, std::size_t particles)
    : bounds_(bounds),
      directions_(std::move(directions)),
      grids_(spacings.size()),
      lists_(directions_.size()),
      owners_(spacings.size()),
      ranges_(spacings.size()),
      padding_(padding),
      skin_(skin),
      widest_skin_(skin),
      load_(std::make_unique<RankLoad>()) {
  for (const auto& d : directions_) widest_ = std::max(widest_, d.radius * (1.0 + skin_));
  const std::size_t few = std::min(particles, CellGrid::most_cells);
  const std::size_t most_blocks = std::max(blocks_a_particle * few, least_blocks);
  for (double width = block_width * widest_; widest_ > 0.0; width *= 1.25) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d) {
      const double size = bounds_.high[d] - bounds_.low[d];
      blocks_.count[d] = static_cast<std::size_t>(std::clamp(std::floor(size / width), 1.0, 4096.0));
      blocks_.side[d] = size / static_cast<double>(blocks_.count[d]);
    }
    if (blocks_.size() <= most_blocks) break;
  }
  for (std::size_t p = 0; p < spacings.size(); ++p) {
    double longest = 0.0;
    for (const auto& d : directions_)
      if (d.a == p || d.b == p) longest = std::max(longest, d.radius);
    if (longest == 0.0) continue;
    // Half a search a cell: a ball's cells then cover little more than the ball. Cells emptier than that are no gain.
    const double cell = std::max(0.5 * longest * (1.0 + skin_), 1.2 * spacings[p]);
    grids_[p] = std::make_unique<CellGrid>(bounds_, cell, longest * (1.0 + skin_) * 1.001, blocks_,
                                           std::max(cells_a_particle * few, least_cells));
    ranges_[p].resize(blocks_.size());
  }
}

Neighbours::~Neighbours() = default;
Neighbours::Neighbours(Neighbours&&) noexcept = default;
Neighbours& Neighbours::operator=(Neighbours&&) noexcept = default;

void Neighbours::Range::clear() {
  low.fill(std::numeric_limits<float>::max());
  high.fill(-std::numeric_limits<float>::max());
}

void Neighbours::Range::widen(const Range& other) {
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = std::min(low[d], other.low[d]);
    high[d] = std::max(high[d], other.high[d]);
  }
}

/// Square of the largest relative displacement of two particles, one from each box of displacements.
double Neighbours::apart(const Range& a, const Range& b) {
  double squared = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    const double most = std::max(static_cast<double>(a.high[d]) - static_cast<double>(b.low[d]),
                                 static_cast<double>(b.high[d]) - static_cast<double>(a.low[d]));
    squared += most * most;
  }
  return squared;
}

namespace {

/// Least and largest displacements along the axes, by lanes, of the particles that were given.
template <std::size_t Dim>
struct Displacements {
  static constexpr std::uint32_t width = 4;
  using Wide = simd::Vec<double, width>;
  using Short = simd::Vec<float, width>;

  /// x: positions (m), low: corner of the domain (m), old: the search positions that the lists are of.
  BARCHAN_SIMD_INLINE void add(const std::array<const double*, 3>& x, const std::array<const float*, 3>& old,
                               const Vec3& low, std::uint32_t begin, std::uint32_t end) {
    if (end - begin < width) {
      for (std::uint32_t k = begin; k < end; ++k)
        for (std::size_t d = 0; d < Dim; ++d) widen(d, Short(static_cast<float>(x[d][k] - low[d]) - old[d][k]));
      return;
    }
    for (std::uint32_t k = begin; k < end; k += width) {
      const std::uint32_t at = std::min(k, end - width);  // the last vector overlaps the one before
      for (std::size_t d = 0; d < Dim; ++d)
        widen(d, simd::convert<float>(Wide::load(x[d] + at) - Wide(low[d])) - Short::load(old[d] + at));
    }
  }
  float least(std::size_t d) const {
    float value = std::numeric_limits<float>::max();
    for (int lane = 0; lane < static_cast<int>(width); ++lane) value = std::min(value, lower_[d][lane]);
    return value;
  }
  float most(std::size_t d) const {
    float value = -std::numeric_limits<float>::max();
    for (int lane = 0; lane < static_cast<int>(width); ++lane) value = std::max(value, upper_[d][lane]);
    return value;
  }

 private:
  BARCHAN_SIMD_INLINE void widen(std::size_t d, const Short& moved) {
    lower_[d] = simd::min(moved, lower_[d]);
    upper_[d] = simd::max(moved, upper_[d]);
  }
  template <std::size_t... d>
  static constexpr std::array<Short, Dim> all(float value, std::index_sequence<d...>) {
    return {((void)d, Short(value))...};
  }
  std::array<Short, Dim> lower_ = all(std::numeric_limits<float>::max(), std::make_index_sequence<Dim>{});
  std::array<Short, Dim> upper_ = all(-std::numeric_limits<float>::max(), std::make_index_sequence<Dim>{});
};

/// What sorting and searching cost, in evaluations of all pairs of one step; measured.
double rebuild_cost(int dimensions) { return dimensions == 2 ? 1.5 : 1.0; }

}  // namespace

template <std::size_t Dim>
void Neighbours::measure(const PhaseParticles& particles, std::size_t phase) {
  const CellGrid& grid = *grids_[phase];
  std::array<const double*, 3> x{};
  std::array<const float*, 3> old{};
  for (std::size_t d = 0; d < Dim; ++d) {
    x[d] = particles.column(Field::position, static_cast<int>(d));
    old[d] = grid.search_position(static_cast<int>(d));
  }
  const auto n = static_cast<std::int64_t>(watched());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const std::size_t q = watched(static_cast<std::size_t>(i));
    Range& all = ranges_[phase][q];
    all.clear();
    const auto runs = grid.runs(q);
    if (runs.empty()) continue;
    Displacements<Dim> moved;
    for (const BlockRun& run : runs) moved.add(x, old, bounds_.low, run.begin, run.end);
    for (std::size_t d = 0; d < 3; ++d) {
      all.low[d] = d < Dim ? moved.least(d) : 0.0f;
      all.high[d] = d < Dim ? moved.most(d) : 0.0f;
    }
  }
}

/// Places along an axis of the block at a place and of those beside it, over periodic sides. Returns how many.
int Neighbours::places_beside(std::size_t axis, long at, std::array<long, 3>& out) const {
  const auto count = static_cast<long>(blocks_.count[axis]);
  int n = 0;
  for (long s = -1; s <= 1; ++s) {
    long b = at + s;
    if (bounds_.periodic[axis]) b += b < 0 ? count : b >= count ? -count : 0;
    if (b >= 0 && b < count) out[static_cast<std::size_t>(n++)] = b;
  }
  return n;
}

bool Neighbours::still_valid(const std::vector<PhaseParticles>& particles) {
  for (std::size_t p = 0; p < grids_.size(); ++p)
    if (grids_[p]) bounds_.dimensions == 2 ? measure<2>(particles[p], p) : measure<3>(particles[p], p);
  // A pair that no list holds stood more than radius + skin apart. In the same or adjacent blocks it comes within the
  // radius only by a relative displacement of a skin; elsewhere it stood a whole block apart.
  Range all;
  all.clear();
  for (std::size_t p = 0; p < grids_.size(); ++p)
    for (std::size_t i = 0; grids_[p] && i < watched(); ++i) all.widen(ranges_[p][watched(i)]);
  widen_by_ranks(all);
  double least_gap = std::numeric_limits<double>::max();
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d)
    least_gap = std::min(least_gap, blocks_.side[d] - widest_);
  if (!(apart(all, all) < least_gap * least_gap)) return false;
  bool valid = true;
  const auto blocks = static_cast<std::int64_t>(watched());
#pragma omp parallel for schedule(static) reduction(&& : valid)
  for (std::int64_t i = 0; i < blocks; ++i) {
    const auto q = static_cast<long>(watched(static_cast<std::size_t>(i)));
    const long nx = static_cast<long>(blocks_.count[0]), ny = static_cast<long>(blocks_.count[1]);
    std::array<long, 3> xs{}, ys{}, zs{};
    const int mx = places_beside(0, q % nx, xs), my = places_beside(1, q / nx % ny, ys),
              mz = places_beside(2, q / (nx * ny), zs);
    for (const auto& direction : directions_) {
      const Range& own = ranges_[direction.a][static_cast<std::size_t>(q)];
      if (own.low[0] > own.high[0]) continue;
      // A tenth of the skin is kept for the rounding of the search. NaN positions fail and are found by the check.
      const double most = 0.9 * skin_ * direction.radius;
      for (int z = 0; z < mz; ++z)
        for (int y = 0; y < my; ++y)
          for (int x = 0; x < mx; ++x) {
            const long near = (zs[static_cast<std::size_t>(z)] * ny + ys[static_cast<std::size_t>(y)]) * nx +
                              xs[static_cast<std::size_t>(x)];
            if (direction.a == direction.b && near < q) continue;  // compared when `near` was q
            const Range& other = ranges_[direction.b][static_cast<std::size_t>(near)];
            if (other.low[0] > other.high[0]) continue;
            valid = valid && apart(own, other) < most * most;
          }
    }
  }
  return !ranks::any(!valid);
}

/// A step costs (1 + s)^D pairs of the skin s and a rebuild every k s steps: least where D (1 + s)^(D-1) = cost/(k
/// s^2).
void Neighbours::choose_skin() {
  const double per_skin = static_cast<double>(kept_ + 1) / skin_;
  const double best = std::sqrt(rebuild_cost(bounds_.dimensions) / (bounds_.dimensions * std::max(per_skin, 1.0)));
  // The search rounds to single precision: nine tenths of the skin count (see still_valid), the rest must cover that.
  double extent = 0.0, shortest = widest_;
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d)
    extent = std::max(extent, bounds_.high[d] - bounds_.low[d]);
  for (const auto& d : directions_) shortest = std::min(shortest, d.radius);
  const double least = std::max(0.02, 5.0e-6 * extent / shortest);
  skin_ = std::min(std::clamp(best, least, std::max(least, 1.5 * skin_)), widest_skin_);
}

bool Neighbours::update(std::vector<PhaseParticles>& particles, bool force, const std::function<void()>& beside) {
  constexpr long patience = 64;  // steps after which lists that are still good are made anew with a thinner skin
  const bool first = rebuilds_ == 0 || force;
  if (!first && still_valid(particles)) {
    ++kept_;
    if (!adapts_ || kept_ < patience) return false;
    const double wide = skin_;
    choose_skin();
    if (skin_ > 0.8 * wide) {
      skin_ = wide;
      return false;
    }
  } else if (!first && adapts_) {
    choose_skin();
  }
  kept_ = 0;
  if (division_ == Division::time) divide_anew(particles);
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    const bool shared = ranks::active() && !particles[p].is_whole();  // then others may have gone elsewhere
    if (!grids_[p] || (!first && !has_moved(p) && !shared)) continue;
    PairList::dummy_index(particles[p].size(), 0);  // refuses before anything is counted in 32 bits
    const bool first_on_ranks = ranks::available() && !grids_[p]->is_shared() && !particles[p].is_whole();
    if (!first_on_ranks) grids_[p]->sort(particles[p], division_);
    else particles[p].is_part() ? grids_[p]->sort_pieces(particles[p]) : grids_[p]->sort_and_share(particles[p]);
  }
  if (ranks::available()) share(particles);
  search(particles, beside);
  ++rebuilds_;
  return true;
}

/// Whether a particle of the phase stands elsewhere than at the last sort, as far as measure() and the search see.
bool Neighbours::has_moved(std::size_t phase) const {
  return std::any_of(ranges_[phase].begin(), ranges_[phase].end(), [](const Range& range) {
    if (range.low[0] > range.high[0]) return false;  // no particle is there
    for (std::size_t d = 0; d < 3; ++d)
      if (!(range.low[d] == 0.0f && range.high[d] == 0.0f)) return true;
    return false;
  });
}

/// Builds all lists, chunks of all of them side by side.
void Neighbours::search(const std::vector<PhaseParticles>& particles, const std::function<void()>& beside) {
  searches_.clear();
  chunks_.clear();
  for (std::size_t q = 0; q < directions_.size(); ++q) {
    const auto& d = directions_[q];
    const std::uint32_t dummy = PairList::dummy_index(particles[d.b].size(), grids_[d.b]->images());
    searches_.push_back({grids_[d.a].get(), particles[d.a].size(), grids_[d.b].get(), d.a == d.b,
                         d.radius * (1.0 + skin_), dummy, bounds_.dimensions});
    if (!owners_[d.a].empty() && grids_[d.b]->is_shared()) {
      searches_.back().ranks = owners_[d.a].data();
      searches_.back().own_rank = ranks::active()->rank();
    }
    const std::size_t count = lists_[q].prepare(particles[d.a].size(), padding_);
    for (std::size_t number = 0; number < count; ++number) chunks_.push_back({q, number});
  }
  const auto n = static_cast<std::int64_t>(chunks_.size());
#pragma omp parallel
  {
    PairList::make_scratch(bounds_.dimensions);
#pragma omp single nowait
    if (beside) beside();
#pragma omp for schedule(dynamic, 1)
    for (std::int64_t i = 0; i < n; ++i) {
      const Chunk& c = chunks_[static_cast<std::size_t>(i)];
      lists_[c.list].build_chunk(searches_[c.list], c.number);
    }
  }
}

void Neighbours::archive(Archive& a, std::vector<PhaseParticles>& particles, bool whole) {
  a.number("skin", skin_);
  a.number("rebuilds", rebuilds_);
  a.number("steps of the lists", kept_);
  const bool shares = whole && a.loads() && ranks::active();
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    if (!grids_[p]) continue;
    if (shares && !particles[p].is_whole()) grids_[p]->load_share(a, particles[p]);
    else grids_[p]->archive(a);
  }
  if (shares) share(particles);
  else if (a.loads() && ranks::active()) {
    find_owners();
    find_watched();
  }
  if (a.loads()) search(particles, {});
}

std::size_t Neighbours::bytes() const {
  std::size_t total = 0;
  for (const auto& g : grids_)
    if (g) total += g->bytes();
  for (const auto& l : lists_) total += l.bytes();
  return total;
}

}  // namespace barchan
