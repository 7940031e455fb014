#include "models/bodies/reference_body.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "engine/exchange.hpp"
#include "engine/neighbours.hpp"
#include "kernels/kernel.hpp"

namespace barchan {

namespace {

/// A neighbour of a particle: its number, X_ab (m), w.
struct Near {
  std::int64_t b;
  Vec3 x;
  double w;
};

/// The neighbours of all particles in the order of their ids; of each in the order of theirs.
std::vector<std::vector<Near>> find_near(const std::vector<Vec3>& places, const Bounds& bounds, double spacing,
                                         KernelKind kind, double radius) {
  const std::size_t n = places.size();
  std::vector<PhaseParticles> all;
  all.emplace_back("body", bounds.dimensions, n, 1.0, 0);
  PhaseParticles& p = all[0];
  p.add(Field::position);
  const auto dimensions = static_cast<std::size_t>(bounds.dimensions);
  for (std::size_t d = 0; d < dimensions; ++d)
    for (std::size_t k = 0; k < n; ++k) p.column(Field::position, static_cast<int>(d))[k] = places[k][d];
  const ComputedByAll alone;  // every rank makes the whole body
  Neighbours search(bounds, {{0, 0, radius}}, 1e-3, {spacing}, simd::width_in_use<double>(), n);
  search.update(all, true);
  const auto& images = search.grid(0).image_list();
  const auto& period = search.grid(0).period();
  std::vector<std::vector<Near>> near(n);
  const double volume = std::pow(spacing, bounds.dimensions);
  with_kernel<double>(kind, radius, bounds.dimensions, [&](const auto& kernel) {
    for (std::size_t k = 0; k < n; ++k) {
      const auto a = static_cast<std::size_t>(p.id()[k]);
      const auto row = search.list(0).row(k);
      for (const std::uint32_t* q = row.begin; q != row.end; ++q) {
        std::size_t at = *q / PairList::stride;
        if (at >= n + images.size()) continue;  // pads the row
        Vec3 shift{};
        if (at >= n) {
          const Image& image = images[at - n];
          for (std::size_t d = 0; d < dimensions; ++d) shift[d] = image.shift[d] * period[d];
          at = image.source;
        }
        const std::int64_t b = p.id()[at];
        const Vec3 x = places[a] - (places[static_cast<std::size_t>(b)] + shift);
        const double r = norm(x), w = volume * std::abs(kernel.derivative(r)) / r;
        if (r < radius && w > 0.0) near[a].push_back({b, x, w});
      }
      std::sort(near[a].begin(), near[a].end(), [](const Near& l, const Near& r) { return l.b < r.b; });
    }
  });
  return near;
}

template <class T>
PairWeights<T> weights_of(const Near& n) {
  return {static_cast<T>(n.w),
          {static_cast<T>(n.w * n.x[0]), static_cast<T>(n.w * n.x[1]), static_cast<T>(n.w * n.x[2])}};
}

/// The slots of one group.
template <class T>
class GroupMaker {
 public:
  GroupMaker(ReferenceBody<T>& body, double spacing) : body_(body), spacing_(spacing) {}

  void add(std::size_t first, const std::vector<std::vector<Near>>& near) {
    entries_.clear();
    const std::size_t lanes = std::min(body_.width, body_.size - first);
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (const Near& n : near[first + lane]) {
        Entry e{n.b - static_cast<std::int64_t>(first + lane), {}, lane, &n};
        for (std::size_t d = 0; d < 3; ++d) e.offset[d] = std::llround(1e6 * n.x[d] / spacing_);
        entries_.push_back(e);
      }
    std::sort(entries_.begin(), entries_.end());
    std::vector<std::pair<std::size_t, std::size_t>> parts;
    std::vector<std::size_t> left(body_.width, 0);
    for (std::size_t begin = 0, end = 0; begin < entries_.size(); begin = end) {
      while (end < entries_.size() && entries_[end].same_slot(entries_[begin])) ++end;
      if (end - begin == body_.width) {
        body_.wholes.push_back(
            {static_cast<std::int32_t>(entries_[begin].delta), weights_of<T>(*entries_[begin].near)});
        continue;
      }
      parts.emplace_back(begin, end);
      for (std::size_t k = begin; k < end; ++k) ++left[entries_[k].lane];
    }
    const std::size_t longest = *std::max_element(left.begin(), left.end());
    // Loads by index cost about four times as much as loads side by side.
    if (parts.size() <= 4 * longest) add_parts(parts);
    else scatter(parts, longest, first);
    body_.groups.push_back({static_cast<std::uint32_t>(body_.wholes.size()),
                            static_cast<std::uint32_t>(body_.part_delta.size()),
                            static_cast<std::uint32_t>(body_.index.size() / body_.width)});
  }

 private:
  struct Entry {
    std::int64_t delta;
    std::array<long long, 3> offset;
    std::size_t lane;
    const Near* near;
    bool same_slot(const Entry& o) const { return delta == o.delta && offset == o.offset; }
    bool operator<(const Entry& o) const { return std::tie(delta, offset, lane) < std::tie(o.delta, o.offset, o.lane); }
  };
  std::size_t stride() const { return body_.width * static_cast<std::size_t>(1 + body_.dimensions); }
  void put(AlignedVector<T>& to, std::size_t slot, std::size_t lane, const Near& n) const {
    T* at = to.data() + slot * stride() + lane;
    const PairWeights<T> w = weights_of<T>(n);
    at[0] = w.w;
    for (std::size_t d = 0; d < static_cast<std::size_t>(body_.dimensions); ++d) at[(1 + d) * body_.width] = w.wx[d];
  }
  void add_parts(const std::vector<std::pair<std::size_t, std::size_t>>& parts) {
    for (const auto& [begin, end] : parts) {
      const std::size_t slot = body_.part_delta.size();
      body_.part_delta.push_back(static_cast<std::int32_t>(entries_[begin].delta));
      body_.part_weights.resize((slot + 1) * stride(), T(0));
      for (std::size_t k = begin; k < end; ++k) put(body_.part_weights, slot, entries_[k].lane, *entries_[k].near);
    }
  }
  /// Lanes without a neighbour in a slot get their own particle with weight zero.
  void scatter(const std::vector<std::pair<std::size_t, std::size_t>>& parts, std::size_t slots, std::size_t first) {
    const std::size_t from = body_.index.size() / body_.width;
    body_.index.resize((from + slots) * body_.width);
    body_.scattered_weights.resize((from + slots) * stride(), T(0));
    for (std::size_t k = 0; k < slots * body_.width; ++k)
      body_.index[from * body_.width + k] =
          static_cast<std::uint32_t>(std::min(first + k % body_.width, body_.size - 1));
    std::vector<std::size_t> next(body_.width, from);
    for (const auto& [begin, end] : parts)
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t lane = entries_[k].lane, slot = next[lane]++;
        body_.index[slot * body_.width + lane] = static_cast<std::uint32_t>(entries_[k].near->b);
        put(body_.scattered_weights, slot, lane, *entries_[k].near);
      }
  }

  ReferenceBody<T>& body_;
  double spacing_;
  std::vector<Entry> entries_;
};

/// M^-1 and sum w X. A particle without neighbours has none; one whose neighbours lie in one line or plane is noted.
template <class T>
void correct(ReferenceBody<T>& body, const std::vector<std::vector<Near>>& near) {
  const std::size_t room = body.groups.size() * body.width, dim = static_cast<std::size_t>(body.dimensions);
  const std::size_t numbers = dim == 2 ? 3 : 6;
  for (std::size_t c = 0; c < numbers; ++c) body.inverse[c].assign(room, T(0));
  for (std::size_t d = 0; d < dim; ++d) body.sum[d].assign(room, T(0));
  for (std::size_t k = 0; k < body.size; ++k) {
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Near& n : near[k]) {
      const Eigen::Vector3d x(n.x[0], n.x[1], n.x[2]);
      m += n.w * x * x.transpose();
      sum += n.w * x;
    }
    if (near[k].empty()) continue;
    if (dim == 2) m(2, 2) = 0.5 * m.trace();
    const auto values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m, Eigen::EigenvaluesOnly).eigenvalues();
    if (!(values[0] > 1e-3 * values[2])) {
      if (body.flat < 0) body.flat = static_cast<std::int64_t>(k);
      continue;
    }
    const Eigen::Matrix3d l = m.inverse();
    std::size_t c = 0;
    for (std::size_t d = 0; d < dim; ++d) {
      body.sum[d][k] = static_cast<T>(sum[static_cast<int>(d)]);
      for (std::size_t e = d; e < dim; ++e, ++c)
        body.inverse[c][k] = static_cast<T>(l(static_cast<int>(d), static_cast<int>(e)));
    }
  }
}

/// The connected parts, as pieces of at most 4096 ids.
template <class T>
void find_pieces(ReferenceBody<T>& body, const std::vector<std::vector<Near>>& near) {
  std::vector<std::size_t> root(body.size);
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  for (std::size_t k = 0; k < body.size; ++k)
    for (const Near& n : near[k]) {
      const std::size_t a = find(k), b = find(static_cast<std::size_t>(n.b));
      root[std::max(a, b)] = std::min(a, b);
    }
  std::vector<Vec3> low(body.size, Vec3{1e300, 1e300, 1e300}), high(body.size, Vec3{-1e300, -1e300, -1e300});
  for (std::size_t k = 0; k < body.size; ++k) {
    const std::size_t a = find(k);
    for (std::size_t d = 0; d < static_cast<std::size_t>(body.dimensions); ++d) {
      low[a][d] = std::min(low[a][d], body.place[d][k]);
      high[a][d] = std::max(high[a][d], body.place[d][k]);
    }
    constexpr std::size_t most = 4096;
    if (body.pieces.empty() || body.pieces.back().anchor != a || k - body.pieces.back().begin >= most)
      body.pieces.push_back({k, k, a});
    body.pieces.back().end = k + 1;
  }
  for (std::size_t k = 0; k < body.size; ++k) {
    if (find(k) != k) continue;
    double square = 0.0;
    for (std::size_t d = 0; d < static_cast<std::size_t>(body.dimensions); ++d)
      square += std::pow(high[k][d] - low[k][d], 2);
    body.diameter = std::max(body.diameter, std::sqrt(square));
  }
}

}  // namespace

template <class T>
ReferenceBody<T> make_reference_body(const std::vector<Vec3>& places, const Bounds& bounds, double spacing,
                                     KernelKind kernel, double radius, std::size_t width) {
  ReferenceBody<T> body;
  body.size = places.size();
  body.width = width;
  body.dimensions = bounds.dimensions;
  body.volume = std::pow(spacing, bounds.dimensions);
  body.diameter = spacing;
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds.dimensions); ++d) {
    body.place[d].resize(body.size);
    for (std::size_t k = 0; k < body.size; ++k) body.place[d][k] = places[k][d];
  }
  if (body.size == 0) return body;
  std::vector<std::vector<Near>> near(body.size);
  if (radius > 0.0) near = find_near(places, bounds, spacing, kernel, radius);
  for (const auto& row : near) body.pairs += row.size();
  GroupMaker<T> maker(body, spacing);
  for (std::size_t first = 0; first < body.size; first += width) maker.add(first, near);
  correct(body, near);
  find_pieces(body, near);
  return body;
}

template ReferenceBody<float> make_reference_body(const std::vector<Vec3>&, const Bounds&, double, KernelKind, double,
                                                  std::size_t);
template ReferenceBody<double> make_reference_body(const std::vector<Vec3>&, const Bounds&, double, KernelKind, double,
                                                   std::size_t);

}  // namespace barchan
