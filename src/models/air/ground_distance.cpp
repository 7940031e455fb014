#include "models/air/ground_distance.hpp"

#include <algorithm>
#include <cmath>

#include "models/walls/sides.hpp"

namespace barchan {

GroundDistance::GroundDistance(const Bounds& bounds, const Sides& sides, double spacing, bool has_particles)
    : bounds_(bounds), sides_(sides), spacing_(spacing) {
  std::size_t cells = 1;
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds.dimensions); ++d) {
    const double size = bounds.high[d] - bounds.low[d];
    diagonal_ += size * size;
    count_[d] = std::max(1, static_cast<int>(std::floor(size / spacing + 1e-9)));
    side_[d] = size / count_[d];
    cells *= static_cast<std::size_t>(count_[d]);
  }
  diagonal_ = std::sqrt(diagonal_);
  if (has_particles) {
    nearest_.assign(cells, -1);
    crowd_.assign(cells, 0);
  }
}

std::size_t GroundDistance::cell_of(const Vec3& x, std::array<int, 3>& at) const {
  std::size_t cell = 0;
  at = {0, 0, 0};
  for (std::size_t d = static_cast<std::size_t>(bounds_.dimensions); d-- > 0;) {
    at[d] = std::clamp(static_cast<int>(std::floor((x[d] - bounds_.low[d]) / side_[d])), 0, count_[d] - 1);
    cell = cell * static_cast<std::size_t>(count_[d]) + static_cast<std::size_t>(at[d]);
  }
  return cell;
}

double GroundDistance::squared(const Vec3& x, std::int32_t seed) const {
  if (seed < 0) return 1e300;
  const Vec3& s = seeds_[static_cast<std::size_t>(seed)];
  double sum = 0.0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d) {
    double r = x[d] - s[d];
    const double period = bounds_.high[d] - bounds_.low[d];
    if (bounds_.periodic[d] && std::abs(r) > 0.5 * period) r -= period * std::round(r / period);
    sum += r * r;
  }
  return sum;
}

namespace {

/// Calls f(cell) for the cells about `at`, periodic images taken back; those above each other one after another, as
/// they mostly have the same ground.
template <class F>
void around(const std::array<int, 3>& at, const std::array<int, 3>& count, const std::array<bool, 3>& periodic, F&& f) {
  std::array<std::array<int, 3>, 3> places;  // by axis: before, at, after; -1: none
  for (std::size_t d = 0; d < 3; ++d)
    for (int k = 0; k < 3; ++k) {
      int b = at[d] + k - 1;
      if (b < 0) b = periodic[d] ? count[d] - 1 : -1;
      else if (b >= count[d]) b = periodic[d] ? 0 : -1;
      places[d][static_cast<std::size_t>(k)] = b;
    }
  const std::size_t first = count[2] > 1 ? 0 : 1, last = count[2] > 1 ? 2 : 1;
  const auto row = static_cast<std::size_t>(count[0]), layer = row * static_cast<std::size_t>(count[1]);
  for (const int x : places[0])
    for (const int y : places[1])
      for (std::size_t k = first; k <= last; ++k)
        if (x >= 0 && y >= 0 && places[2][k] >= 0)
          f(static_cast<std::size_t>(places[2][k]) * layer + static_cast<std::size_t>(y) * row +
            static_cast<std::size_t>(x));
}

}  // namespace

void GroundDistance::refresh(std::span<const PhaseParticles* const> phases) {
  if (nearest_.empty()) return;
  std::fill(nearest_.begin(), nearest_.end(), -1);
  std::fill(crowd_.begin(), crowd_.end(), std::uint8_t{0});
  seeds_.clear();
  surfaces_ = false;
  normals_.clear();
  std::array<int, 3> at{};
  const auto each = [&](auto&& f) {
    for (const PhaseParticles* p : phases)
      for (std::size_t k = 0; k < p->size(); ++k) {
        const bool wall = p->has(Field::wall_depth);
        if (wall && behind_a_side(*p, k, bounds_, spacing_)) continue;
        const double depth = wall ? p->column(Field::wall_depth)[k] : 0.0;
        if (depth > 0.8 * spacing_) continue;  // the first row has the surface
        Vec3 x{}, normal{};
        for (int d = 0; d < p->dimensions(); ++d) {
          const auto c = static_cast<std::size_t>(d);
          x[c] = p->column(Field::position, d)[k];
          if (depth > 0.0) normal[c] = p->column(Field::wall_normal, d)[k];
          x[c] += depth * normal[c];
        }
        f(*p, x, normal);
      }
  };
  each([&](const PhaseParticles&, const Vec3& x, const Vec3&) {
    auto& n = crowd_[cell_of(x, at)];
    n = static_cast<std::uint8_t>(std::min(n + 1, 255));
  });
  each([&](const PhaseParticles& p, const Vec3& x, const Vec3& normal) {
    const std::size_t cell = cell_of(x, at);
    if (!p.has(Field::wall_depth) && !p.has(Field::stress)) {  // grains: neither walls nor bodies
      int crowd = 0;
      around(at, count_, bounds_.periodic, [&](std::size_t b) { crowd += crowd_[b]; });
      if (crowd < 4) return;
    }
    if (nearest_[cell] < 0) nearest_[cell] = static_cast<std::int32_t>(seeds_.size());
    seeds_.push_back(x);
    normals_.push_back(normal);
    surfaces_ = surfaces_ || dot(normal, normal) > 0.0;
  });
  propagate();
}

/// Sweeps to and fro until nothing changes (a few times; once more for each period crossed).
void GroundDistance::propagate() {
  const auto visit = [&](const std::array<int, 3>& at) {
    const auto c = static_cast<std::size_t>((static_cast<std::int64_t>(at[2]) * count_[1] + at[1]) * count_[0] + at[0]);
    Vec3 centre{};
    for (std::size_t d = 0; d < 3; ++d) centre[d] = bounds_.low[d] + (at[d] + 0.5) * side_[d];
    std::int32_t mine = nearest_[c], last = mine;
    double least = squared(centre, mine);
    around(at, count_, bounds_.periodic, [&](std::size_t b) {
      const std::int32_t theirs = nearest_[b];
      if (theirs < 0 || theirs == mine || theirs == last) return;
      last = theirs;
      const double s = squared(centre, theirs);
      if (s < least) {
        least = s;
        mine = theirs;
      }
    });
    const bool changed = mine != nearest_[c];
    nearest_[c] = mine;
    return changed;
  };
  const auto sweep = [&](bool back) {
    bool changed = false;
    for (int k = 0; k < count_[2]; ++k)
      for (int j = 0; j < count_[1]; ++j)
        for (int i = 0; i < count_[0]; ++i)
          changed = visit(back ? std::array<int, 3>{count_[0] - 1 - i, count_[1] - 1 - j, count_[2] - 1 - k}
                               : std::array<int, 3>{i, j, k}) ||
                    changed;
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
  a.number("ground: surfaces", surfaces_);
}

/// From a particle: less half a spacing. From a piece of a surface: the height over its plane, half a spacing (and what
/// a slope stretches it by) to either side.
double GroundDistance::from_seed(const Vec3& x, std::size_t seed) const {
  Vec3 r{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d) {
    r[d] = x[d] - seeds_[seed][d];
    const double period = bounds_.high[d] - bounds_.low[d];
    if (bounds_.periodic[d]) r[d] -= period * std::round(r[d] / period);
  }
  const double over = dot(normals_[seed], r);
  if (!(dot(normals_[seed], normals_[seed]) > 0.0)) return norm(r) - 0.5 * spacing_;
  const double beside = std::max(std::sqrt(std::max(dot(r, r) - over * over, 0.0)) - 0.75 * spacing_, 0.0);
  return std::hypot(std::max(over, 0.0), beside);
}

double GroundDistance::distance(const Vec3& x) const {
  double least = diagonal_;
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds_.dimensions); ++d) {
    if (sides_.low[d] > -Sides::far) least = std::min(least, x[d] - sides_.low[d]);
    if (sides_.high[d] < Sides::far) least = std::min(least, sides_.high[d] - x[d]);
  }
  if (!seeds_.empty()) {
    std::array<int, 3> at{};
    cell_of(x, at);
    if (surfaces_) {
      around(at, count_, bounds_.periodic, [&](std::size_t b) {
        if (nearest_[b] >= 0) least = std::min(least, from_seed(x, static_cast<std::size_t>(nearest_[b])));
      });
    } else {
      double squared_least = 1e300;
      std::int32_t last = -1;
      around(at, count_, bounds_.periodic, [&](std::size_t b) {
        if (nearest_[b] == last) return;  // neighbours often have the same
        last = nearest_[b];
        squared_least = std::min(squared_least, squared(x, last));
      });
      least = std::min(least, std::sqrt(squared_least) - 0.5 * spacing_);
    }
  }
  return std::max(least, 0.0);
}

}  // namespace barchan
