#include "models/fluid/ground_distance.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "models/walls/sides.hpp"

namespace barchan {

GroundDistance::GroundDistance(const Bounds& bounds, const Sides& sides, double spacing, bool has_particles)
    : bounds_(bounds), sides_(sides) {
  std::size_t cells = 1;
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds.dimensions); ++d) {
    const double size = bounds.high[d] - bounds.low[d];
    diagonal_ += size * size;
    count_[d] = std::max(1, static_cast<int>(std::floor(size / spacing + 1e-9)));
    side_[d] = size / count_[d];
    halo_[d] = count_[d] > 1 ? 1 : 0;
    stride_[d] = static_cast<std::ptrdiff_t>(cells);
    cells *= static_cast<std::size_t>(count_[d] + 2 * halo_[d]);
  }
  diagonal_ = std::sqrt(diagonal_);
  if (!has_particles) return;
  nearest_.assign(cells, -1);
  crowd_.assign(cells, 0);
  stale_.assign(cells + 2 * margin(), 0);
  // Particles above each other come one after another: most of them have the same ground.
  for (int x = -halo_[0]; x <= halo_[0]; ++x)
    for (int y = -halo_[1]; y <= halo_[1]; ++y)
      for (int z = -halo_[2]; z <= halo_[2]; ++z) around_.push_back(x * stride_[0] + y * stride_[1] + z * stride_[2]);
}

template <int Dim>
std::size_t GroundDistance::cell_of(const Vec3& x, Place& at) const {
  at = {0, 0, 0};
  for (std::size_t d = 0; d < Dim; ++d)
    at[d] = std::clamp(static_cast<int>(std::floor((x[d] - bounds_.low[d]) / side_[d])), 0, count_[d] - 1);
  return number(at);
}

std::size_t GroundDistance::number(const Place& at) const {
  std::ptrdiff_t cell = 0;
  for (std::size_t d = 0; d < 3; ++d) cell += (at[d] + halo_[d]) * stride_[d];
  return static_cast<std::size_t>(cell);
}

template <int Dim>
double GroundDistance::squared(const Vec3& x, std::int32_t seed) const {
  const Vec3& s = seeds_[static_cast<std::size_t>(seed)];
  double sum = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    double r = x[d] - s[d];
    const double period = bounds_.high[d] - bounds_.low[d];
    if (bounds_.periodic[d] && std::abs(r) > 0.5 * period) r -= period * std::round(r / period);
    sum += r * r;
  }
  return sum;
}

/// Calls f(number) for the cells of the halo that repeat the cell `at` of the grid, over periodic sides.
template <class F>
void GroundDistance::images(const Place& at, F&& f) const {
  std::array<std::array<int, 3>, 3> places;
  std::array<std::size_t, 3> n{1, 1, 1};
  for (std::size_t d = 0; d < 3; ++d) {
    places[d][0] = at[d];
    if (halo_[d] == 0 || !bounds_.periodic[d]) continue;
    if (at[d] == 0) places[d][n[d]++] = count_[d];
    if (at[d] == count_[d] - 1) places[d][n[d]++] = -1;
  }
  for (std::size_t z = 0; z < n[2]; ++z)
    for (std::size_t y = 0; y < n[1]; ++y)
      for (std::size_t x = 0; x < n[0]; ++x)
        if (x + y + z > 0) f(number({places[0][x], places[1][y], places[2][z]}));
}

void GroundDistance::refresh(std::span<const Ground> phases) {
  if (nearest_.empty()) return;
  bounds_.dimensions == 2 ? refresh<2>(phases) : refresh<3>(phases);
}

/// Calls f with the particles of a phase that may be ground.
template <class F>
void GroundDistance::each_piece(const Ground& phase, F&& f) const {
  const PhaseParticles& p = *phase.particles;
  const bool wall = p.has(Field::wall_depth),
             loose = !wall && !p.has(Field::stress);  // grains: neither walls nor bodies
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (wall && behind_a_side(p, k, bounds_, phase.spacing)) continue;
    const double depth = wall ? p.column(Field::wall_depth)[k] : 0.0;
    if (depth > 0.8 * phase.spacing) continue;  // the first row has the surface
    Vec3 x{}, normal{};
    for (int d = 0; d < p.dimensions(); ++d) {
      const auto c = static_cast<std::size_t>(d);
      x[c] = p.column(Field::position, d)[k];
      if (depth > 0.0) normal[c] = p.column(Field::wall_normal, d)[k];
      x[c] += depth * normal[c];
    }
    f(Piece{x, normal, 0.5 * phase.spacing, loose});
  }
}

/// On several ranks: whether the pieces are those of before, since nothing moves; else takes those of all ranks.
bool GroundDistance::are_known(std::span<const Ground> phases) {
  const bool still = std::none_of(phases.begin(), phases.end(), [](const Ground& phase) { return phase.moves; });
  if (still && !seeds_.empty()) return true;
  of_ranks_.clear();
  for (const Ground& phase : phases) {
    std::vector<Piece> pieces;
    each_piece(phase, [&](const Piece& piece) { pieces.push_back(piece); });
    const Exchange among(*phase.particles);
    among.join(pieces);
    of_ranks_.insert(of_ranks_.end(), pieces.begin(), pieces.end());
  }
  return false;
}

template <int Dim>
void GroundDistance::refresh(std::span<const Ground> phases) {
  if (Exchange().is_shared() && are_known(phases)) return;
  const bool known = !seeds_.empty();
  std::swap(seeds_, last_.seeds);
  std::swap(normals_, last_.normals);
  std::swap(half_, last_.half);
  std::fill(crowd_.begin(), crowd_.end(), std::uint8_t{0});
  seeds_.clear();
  surfaces_ = false;
  normals_.clear();
  half_.clear();
  Place at{};
  const auto each = [&](auto&& f) {
    if (Exchange().is_shared()) std::for_each(of_ranks_.begin(), of_ranks_.end(), f);
    else
      for (const Ground& phase : phases) each_piece(phase, f);
  };
  each([&](const Piece& piece) {
    auto& n = crowd_[cell_of<Dim>(piece.x, at)];
    n = static_cast<std::uint8_t>(std::min(n + 1, 255));
    images(at, [&](std::size_t image) { crowd_[image] = n; });
  });
  each([&](const Piece& piece) {
    const std::size_t cell = cell_of<Dim>(piece.x, at);
    if (piece.loose) {
      int crowd = 0;
      for (const std::ptrdiff_t step : around_) crowd += crowd_[cell + static_cast<std::size_t>(step)];
      if (crowd < 4) return;
    }
    seeds_.push_back(piece.x);
    normals_.push_back(piece.normal);
    half_.push_back(piece.half);
    surfaces_ = surfaces_ || dot(piece.normal, piece.normal) > 0.0;
  });
  alike_ = half_.empty() || std::all_of(half_.begin(), half_.end(), [&](double h) { return h == half_[0]; });
  if (known && seeds_ == last_.seeds && normals_ == last_.normals && half_ == last_.half) return;  // the same nearest
  std::fill(nearest_.begin(), nearest_.end(), -1);
  for (std::size_t seed = 0; seed < seeds_.size(); ++seed)
    if (const std::size_t cell = cell_of<Dim>(seeds_[seed], at); nearest_[cell] < 0)
      give(cell, at, static_cast<std::int32_t>(seed));
  propagate<Dim>();
}

/// Writes the seed into a cell and its images; the cells about them must be visited again.
void GroundDistance::give(std::size_t cell, const Place& at, std::int32_t seed) {
  const auto write = [&](std::size_t c) {
    nearest_[c] = seed;
    std::uint8_t* stale = stale_.data() + c + margin();
    for (const std::ptrdiff_t step : around_) stale[step] = 1;
  };
  write(cell);
  images(at, write);
}

/// The nearest of the cell's own seed and those of the cells about it, by the distance to its centre.
template <int Dim>
bool GroundDistance::visit(std::size_t cell, const Place& at) {
  Vec3 centre{};
  for (std::size_t d = 0; d < Dim; ++d) centre[d] = bounds_.low[d] + (at[d] + 0.5) * side_[d];
  const std::int32_t before = nearest_[cell];
  std::int32_t mine = before, last = before;
  double least = mine < 0 ? 1e300 : squared<Dim>(centre, mine);
  for (const std::ptrdiff_t step : around_) {
    const std::int32_t theirs = nearest_[cell + static_cast<std::size_t>(step)];
    if (theirs < 0 || theirs == mine || theirs == last) continue;
    last = theirs;
    const double s = squared<Dim>(centre, theirs);
    if (s < least) {
      least = s;
      mine = theirs;
    }
  }
  if (mine == before) return false;
  give(cell, at, mine);
  return true;
}

/// Sweeps to and fro until nothing changes (a few times; once more for each period crossed). A cell about which nothing
/// has changed since its last visit would not change: it is passed over.
template <int Dim>
void GroundDistance::propagate() {
  const auto sweep = [&](bool back) {
    bool changed = false;
    for (int k = 0; k < count_[2]; ++k)
      for (int j = 0; j < count_[1]; ++j) {
        Place at{0, back ? count_[1] - 1 - j : j, back ? count_[2] - 1 - k : k};
        const std::size_t row = number(at);
        for (int i = 0; i < count_[0]; ++i) {
          at[0] = back ? count_[0] - 1 - i : i;
          const std::size_t cell = row + static_cast<std::size_t>(at[0]);
          std::uint8_t& stale = stale_[cell + margin()];
          if (stale == 0) continue;
          stale = 0;
          changed = visit<Dim>(cell, at) || changed;
        }
      }
    return changed;
  };
  for (int round = 0; round < 8; ++round) {
    const bool there = sweep(false), back = sweep(true);
    if (!there && !back) return;
  }
}

void GroundDistance::archive(Archive& a) {
  a.array("ground: nearest seed", nearest_);
  a.array("ground: seeds", seeds_);
  a.array("ground: normals", normals_);
  a.array("ground: half spacings", half_);
  a.number("ground: alike", alike_);
  a.number("ground: surfaces", surfaces_);
}

/// From a particle: less half a spacing. From a piece of a surface: the height over its plane, half a spacing (and what
/// a slope stretches it by) to either side. Or `least`, if that is less: most seeds are farther, and that is soon seen.
double GroundDistance::nearer(const Vec3& x, std::size_t seed, double least) const {
  Vec3 r{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d) {
    r[d] = x[d] - seeds_[seed][d];
    const double period = bounds_.high[d] - bounds_.low[d];
    if (bounds_.periodic[d] && std::abs(r[d]) >= 0.5 * period) r[d] -= period * std::round(r[d] / period);
  }
  const double over = dot(normals_[seed], r);
  if (!(dot(normals_[seed], normals_[seed]) > 0.0)) return std::min(least, norm(r) - half_[seed]);
  if (over >= least) return least;
  const double beside = std::max(std::sqrt(std::max(dot(r, r) - over * over, 0.0)) - 1.5 * half_[seed], 0.0);
  if (beside >= least) return least;
  return std::min(least, over > 0.0 && beside > 0.0 ? std::hypot(over, beside) : std::max({over, beside, 0.0}));
}

double GroundDistance::distance(const Vec3& x) const {
  return bounds_.dimensions == 2 ? distance<2>(x) : distance<3>(x);
}

template <int Dim>
double GroundDistance::distance(const Vec3& x) const {
  double least = diagonal_;
  for (std::size_t d = 0; d < Dim; ++d) {
    if (sides_.low[d] > -Sides::far) least = std::min(least, x[d] - sides_.low[d]);
    if (sides_.high[d] < Sides::far) least = std::min(least, sides_.high[d] - x[d]);
  }
  if (seeds_.empty()) return std::max(least, 0.0);
  Place at{};
  const std::int32_t* nearest = nearest_.data() + cell_of<Dim>(x, at);
  if (surfaces_) {
    std::int32_t last = -1;
    for (const std::ptrdiff_t step : around_) {
      if (nearest[step] == last) continue;  // neighbours often have the same
      last = nearest[step];
      if (last >= 0) least = nearer(x, static_cast<std::size_t>(last), least);
    }
  } else {
    double squared_least = 1e300;
    std::int32_t last = -1;
    for (const std::ptrdiff_t step : around_) {
      if (nearest[step] == last) continue;  // neighbours often have the same
      last = nearest[step];
      if (last < 0) continue;
      const double squared_here = squared<Dim>(x, last);
      if (alike_) squared_least = std::min(squared_least, squared_here);
      else least = std::min(least, std::sqrt(squared_here) - half_[static_cast<std::size_t>(last)]);
    }
    if (alike_) least = std::min(least, std::sqrt(squared_least) - half_[0]);
  }
  return std::max(least, 0.0);
}

}  // namespace barchan
