// Of models/fluid/spacing_border.hpp: what a coarse particle becomes, and which fine ones become one.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "models/fluid/spacing_border.hpp"

namespace barchan {

/// Calls f(number, r, r^2) for the members within `radius` (m, at most a cell) of a place; r: from the place to them.
template <class F>
void SpacingBorder::around(const Vec3& x, double radius, F&& f) const {
  std::array<std::array<std::size_t, 3>, 3> near{};
  std::array<std::size_t, 3> count{1, 1, 1};
  for (std::size_t d = 0; d < 3; ++d) {
    if (cells_[d] == 1) continue;
    const double s = std::clamp((x[d] - layout_.domain.low[d]) / cell_[d], 0.0, static_cast<double>(cells_[d]) - 0.5);
    const auto n = static_cast<long>(cells_[d]), at = static_cast<long>(s);
    count[d] = 0;
    for (long k = at - 1; k <= at + 1; ++k) {
      if (!layout_.domain.periodic[d] && (k < 0 || k >= n)) continue;
      const auto cell = static_cast<std::size_t>(k < 0 ? k + n : k >= n ? k - n : k);
      bool there = false;  // of two cells both sides are one
      for (std::size_t c = 0; c < count[d]; ++c) there = there || near[d][c] == cell;
      if (!there) near[d][count[d]++] = cell;
    }
  }
  for (std::size_t c = 0; c < count[2]; ++c)
    for (std::size_t b = 0; b < count[1]; ++b)
      for (std::size_t a = 0; a < count[0]; ++a) {
        const std::size_t cell = (near[2][c] * cells_[1] + near[1][b]) * cells_[0] + near[0][a];
        for (std::size_t k = begin_[cell]; k < begin_[cell + 1]; ++k) {
          const Vec3 r = apart(members_[k].x, x);
          const double r2 = squared(r);
          if (r2 <= radius * radius) f(k, r, r2);
        }
      }
}

SpacingBorder::Values SpacingBorder::values_of(const Member& m) const {
  if (!details_.empty()) return details_[m.place].values;
  const PhaseParticles& p = w_->particles(m.coarse ? coarse_ : fine_);
  Values v{};
  for (int d = 0; d < p.dimensions(); ++d) v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d)[m.place];
  v[3] = p.column(Field::density)[m.place];
  if (p.has(Field::eddy_viscosity)) v[4] = p.column(Field::eddy_viscosity)[m.place];
  if (count_ > 5) {
    v[5] = p.column(Field::turbulent_kinetic_energy)[m.place];
    v[6] = std::log(std::max(p.column(Field::specific_dissipation_rate)[m.place], 1e-30));
  }
  return v;
}

/// What its parts, or the particle that its group becomes, take over.
SpacingBorder::Made SpacingBorder::kept_of(const Member& m) const {
  if (!details_.empty()) return details_[m.place].kept;
  const PhaseParticles& p = w_->particles(m.coarse ? coarse_ : fine_);
  Made kept;
  for (int c = 0; c < p.components(Field::anisotropy); ++c)
    kept.skew[static_cast<std::size_t>(c)] = p.column(Field::anisotropy, c)[m.place];
  if (p.has(Field::drag_acceleration))
    for (int d = 0; d < p.dimensions(); ++d)
      kept.drag[static_cast<std::size_t>(d)] = p.column(Field::drag_acceleration, d)[m.place];
  if (p.has(Field::near_void)) kept.near_void = p.column(Field::near_void)[m.place];
  return kept;
}

// ---- split ----------------------------------------------------------------------------------------------------------

/// By axis, of the values about a place: a linear least squares fit; zero where its neighbours do not tell.
std::array<SpacingBorder::Values, 3> SpacingBorder::gradient(const Vec3& x, const Values& own) const {
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  const double radius = 2.0 * coarse_spacing_, share = std::pow(0.5, layout_.dimensions);
  std::array<std::array<double, 3>, 3> moment{};
  std::array<Values, 3> sums{};
  around(x, radius, [&](std::size_t k, const Vec3& r, double r2) {
    if (r2 == 0.0) return;
    const double near = 1.0 - r2 / (radius * radius), weight = (members_[k].coarse ? 1.0 : share) * near * near;
    const Values values = values_of(members_[k]);
    for (std::size_t d = 0; d < dimensions; ++d) {
      for (std::size_t e = 0; e < dimensions; ++e) moment[d][e] += weight * r[d] * r[e];
      for (std::size_t c = 0; c < count_; ++c) sums[d][c] += weight * r[d] * (values[c] - own[c]);
    }
  });
  // Elimination without pivots: the matrix is symmetric and positive.
  double trace = 0.0;
  for (std::size_t d = 0; d < dimensions; ++d) trace += moment[d][d];
  for (std::size_t d = 0; d < dimensions; ++d) {
    if (!(moment[d][d] > 0.02 * trace)) return {};
    for (std::size_t e = d + 1; e < dimensions; ++e) {
      const double factor = moment[e][d] / moment[d][d];
      for (std::size_t f = d; f < dimensions; ++f) moment[e][f] -= factor * moment[d][f];
      for (std::size_t c = 0; c < count_; ++c) sums[e][c] -= factor * sums[d][c];
    }
  }
  for (std::size_t d = dimensions; d-- > 0;)
    for (std::size_t c = 0; c < count_; ++c) {
      for (std::size_t e = d + 1; e < dimensions; ++e) sums[d][c] -= moment[d][e] * sums[e][c];
      sums[d][c] /= moment[d][d];
    }
  return sums;
}

/// 1/(m s): k of v = v0 + g.r + k r^2 about a place, by component of the velocity.
Vec3 SpacingBorder::curvature(const Vec3& x, const Values& own, const std::array<Values, 3>& slope) const {
  const double radius = 2.0 * coarse_spacing_, share = std::pow(0.5, layout_.dimensions);
  double weights = 0.0, squares = 0.0, fourths = 0.0;
  Vec3 residuals{}, with_squares{};
  around(x, radius, [&](std::size_t k, const Vec3& r, double r2) {
    const double near = 1.0 - r2 / (radius * radius), weight = (members_[k].coarse ? 1.0 : share) * near * near;
    const Values values = values_of(members_[k]);
    weights += weight;
    squares += weight * r2;
    fourths += weight * r2 * r2;
    for (std::size_t c = 0; c < 3; ++c) {
      const double left = values[c] - own[c] - (slope[0][c] * r[0] + slope[1][c] * r[1] + slope[2][c] * r[2]);
      residuals[c] += weight * left;
      with_squares[c] += weight * r2 * left;
    }
  });
  const double spread = fourths - squares * squares / std::max(weights, 1e-300);
  if (!(spread > 0.01 * fourths)) return {};
  Vec3 k{};
  for (std::size_t c = 0; c < 3; ++c) k[c] = (with_squares[c] - squares * residuals[c] / weights) / spread;
  return k;
}

/// Adds to each what the curvature says, less the mean of all: the sum of the velocities stays.
void SpacingBorder::add_curvature(std::vector<Made>& made) {
  Vec3 mean{};
  for (const Made& one : made) mean = mean + one.sharper;
  for (Made& one : made)
    for (std::size_t c = 0; c < 3; ++c) one.values[c] += one.sharper[c] - mean[c] / static_cast<double>(made.size());
}

/// The places of the parts about a particle: pairs of opposite ones, so that their sum is zero to the bit.
std::array<Vec3, 8> SpacingBorder::corners(const Member& m) const {
  std::array<Vec3, 8> best{};
  const double half = 0.5 * fine_spacing_, radius = 2.0 * coarse_spacing_;
  if (layout_.dimensions == 3) {
    for (std::size_t k = 0; k < 8; ++k)
      for (std::size_t d = 0; d < 3; ++d) best[k][d] = (k >> d & 1u) ? half : -half;
    return best;
  }
  constexpr std::array<std::array<double, 2>, 4> turns{{{1.0, 0.0},
                                                        {0.92387953251128674, 0.38268343236508977},
                                                        {0.70710678118654752, 0.70710678118654752},
                                                        {0.38268343236508977, 0.92387953251128674}}};
  double widest = -1.0;
  for (const auto& turn : turns) {
    const Vec3 one{half * (turn[0] - turn[1]), half * (turn[0] + turn[1]), 0.0}, other{-one[1], one[0], 0.0};
    const std::array<Vec3, 4> places{one, other, Vec3{} - one, Vec3{} - other};
    double nearest = radius * radius;
    around(m.x, radius, [&](std::size_t k, const Vec3& r, double r2) {
      if (r2 == 0.0 && members_[k].id == m.id) return;
      for (const Vec3& place : places) nearest = std::min(nearest, squared(r - place));
    });
    if (!(nearest > widest * (1.0 + 1e-9))) continue;
    widest = nearest;
    std::copy(places.begin(), places.end(), best.begin());
  }
  return best;
}

void SpacingBorder::split() {
  seeds_.clear();
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (members_[k].coarse && members_[k].distance < -play * coarse_spacing_) seeds_.push_back(k);
  std::sort(seeds_.begin(), seeds_.end(),
            [&](std::size_t a, std::size_t b) { return members_[a].id < members_[b].id; });
  for (const std::size_t seed : seeds_) {
    Member& m = members_[seed];
    const Values own = values_of(m);
    const auto slope = gradient(m.x, own);
    const Vec3 k = curvature(m.x, own, slope);
    const auto places = corners(m);
    Made one = kept_of(m);
    for (std::size_t part = 0; part < parts(); ++part) {
      const Vec3& r = places[part];
      one.x = m.x + r;
      for (std::size_t c = 0; c < count_; ++c)
        one.values[c] = own[c] + (slope[0][c] * r[0] + slope[1][c] * r[1] + slope[2][c] * r[2]);
      one.values[4] = std::max(one.values[4], 0.0);
      one.values[5] = std::max(one.values[5], 0.1 * own[5]);
      for (std::size_t c = 0; c < 3; ++c) {
        double most = 0.0;  // a quarter of what the gradient makes across the square
        for (std::size_t d = 0; d < 3; ++d) most += 0.25 * fine_spacing_ * std::abs(slope[d][c]);
        one.sharper[c] = std::clamp(k[c] * squared(r), -most, most);
      }
      made_fine_.push_back(one);
    }
    m.taken = true;
  }
  add_curvature(made_fine_);
}

// ---- merge ----------------------------------------------------------------------------------------------------------

/// Fills group_ with the seed and those that stand most closely with it; false: there are too few.
bool SpacingBorder::gather_group(std::size_t seed, double radius) {
  near_.clear();
  group_.assign(1, seed);
  around(members_[seed].x, radius, [&](std::size_t k, const Vec3&, double) {
    const Member& m = members_[k];
    if (k != seed && !m.coarse && !m.taken && m.distance > 0.0) near_.push_back(k);
  });
  while (group_.size() < parts()) {
    std::size_t best = near_.size();
    double least = 0.0;
    for (std::size_t n = 0; n < near_.size(); ++n) {
      const Member& m = members_[near_[n]];
      double sum = 0.0;
      for (const std::size_t k : group_) sum += squared(apart(m.x, members_[k].x));
      const bool nearer = best == near_.size() || sum < least || (sum == least && m.id < members_[near_[best]].id);
      if (!nearer) continue;
      best = n;
      least = sum;
    }
    if (best == near_.size()) return false;
    group_.push_back(near_[best]);
    near_.erase(near_.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return true;
}

SpacingBorder::Made SpacingBorder::mean_of_group() const {
  const double share = 1.0 / static_cast<double>(parts());
  const Vec3& first = members_[group_.front()].x;
  Made one;
  Vec3 away{};
  for (const std::size_t k : group_) {
    const Member& m = members_[k];
    away = away + apart(m.x, first);
    const Values values = values_of(m);
    for (std::size_t c = 0; c < count_; ++c) one.values[c] += share * values[c];
    const Made kept = kept_of(m);
    for (std::size_t c = 0; c < one.skew.size(); ++c) one.skew[c] += share * kept.skew[c];
    for (std::size_t d = 0; d < 3; ++d) one.drag[d] += share * kept.drag[d];
    one.near_void = std::max(one.near_void, kept.near_void);
  }
  one.x = first + share * away;
  Values low = values_of(members_[group_.front()]), high = low;
  double squares = 0.0;
  for (const std::size_t k : group_) {
    const Values values = values_of(members_[k]);
    squares += share * squared(apart(members_[k].x, one.x));
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], values[c]);
      high[c] = std::max(high[c], values[c]);
    }
  }
  const Vec3 middle = wrapped(one.x), k = curvature(middle, one.values, gradient(middle, one.values));
  for (std::size_t c = 0; c < 3; ++c)
    one.sharper[c] = std::clamp(-k[c] * squares, -0.25 * (high[c] - low[c]), 0.25 * (high[c] - low[c]));
  return one;
}

void SpacingBorder::merge() {
  seeds_.clear();
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (!members_[k].coarse && members_[k].distance > play * coarse_spacing_) seeds_.push_back(k);
  std::sort(seeds_.begin(), seeds_.end(), [&](std::size_t a, std::size_t b) {
    const Member &m = members_[a], &n = members_[b];
    return std::tie(n.distance, m.id) < std::tie(m.distance, n.id);  // the farthest first
  });
  const double radius = wide * std::sqrt(static_cast<double>(layout_.dimensions)) * fine_spacing_;
  for (const std::size_t seed : seeds_) {
    if (members_[seed].taken) continue;
    const bool strays = members_[seed].distance > astray * coarse_spacing_;
    if (!gather_group(seed, radius) && !(strays && gather_group(seed, std::min(2.0 * radius, 2.0 * coarse_spacing_))))
      continue;
    made_coarse_.push_back(mean_of_group());
    for (const std::size_t k : group_) members_[k].taken = true;
  }
  add_curvature(made_coarse_);
}

}  // namespace barchan
