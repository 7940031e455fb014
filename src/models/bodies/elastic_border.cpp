#include "models/bodies/elastic_border.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "models/bodies/contact_surface.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

constexpr double fit_radius = 2.5;     // spacings of the body
constexpr double least_pivot = 1e-4;   // of the largest
constexpr double before_border = 0.1;  // of a piece's width, at which a piece looks for what stands on it

/// Surfaces of the walls and bodies of all fills but one, ready for distances.
std::vector<ContactSurface> others(const Scene& scene, std::size_t but, double spacing) {
  std::vector<ContactSurface> all;
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Phase* phase = find_phase(scene, scene.fills[k].phase);
    if (k == but || !phase || !is_wall_or_body(*phase)) continue;
    for (ContactSurface& surface : surfaces_of(scene.fills[k].shape, scene, spacing)) {
      surface.prepare(spacing, spacing);
      all.push_back(std::move(surface));
    }
  }
  return all;
}

bool inside(const std::vector<ContactSurface>& surfaces, const Vec3& x) {
  return std::any_of(surfaces.begin(), surfaces.end(), [&](const ContactSurface& surface) {
    const auto gap = surface.gap(x);
    return gap && gap->distance < 0.0;
  });
}

}  // namespace

std::vector<BorderPoint> free_border(const Scene& scene, std::size_t fill, double width) {
  const Phase* phase = find_phase(scene, scene.fills[fill].phase);
  const double spacing = phase->spacing;
  const auto beside = others(scene, fill, spacing);
  std::vector<BorderPoint> free;
  for (const BorderPoint& point : border_points(scene.fills[fill].shape, scene.dimensions, spacing, width))
    if (!inside(beside, point.at + before_border * width * point.normal)) free.push_back(point);
  return free;
}

ElasticBorder::ElasticBorder(const Scene& scene, const Layout& layout, std::size_t phase, const ParticleBlock& block,
                             double width, double reach)
    : dimensions_(static_cast<std::size_t>(layout.dimensions)), spacing_(layout.phases[phase].spacing), reach_(reach) {
  for (std::size_t d = 0; d < dimensions_; ++d)
    if (layout.bounds.periodic[d]) period_[d] = layout.bounds.high[d] - layout.bounds.low[d];
  for (std::size_t p = 0; p < block.parts.size(); ++p) {
    const ParticleBlock::Part& part = block.parts[p];
    const std::size_t end = p + 1 < block.parts.size() ? block.parts[p + 1].first : block.position.size();
    for (const BorderPoint& point : free_border(scene, part.fill, width))
      add_piece(scene, block, part, end, point.at, {point.normal, point.content});
  }
  std::size_t buckets = 1;
  while (buckets < 2 * pieces_.size()) buckets *= 2;
  bucket_end_.assign(buckets + 1, 0);
  in_bucket_.assign(pieces_.size(), 0);
}

/// Moving least squares about a place X of the border: weights w (1, y)^T M^-1, y = (X_k - X)/dx.
void ElasticBorder::add_piece(const Scene& scene, const ParticleBlock& block, const ParticleBlock::Part& part,
                              std::size_t end, const Vec3& at, const First& first) {
  const double radius = fit_radius * spacing_;
  const auto n = static_cast<Eigen::Index>(dimensions_ + 1);
  Eigen::MatrixXd moment = Eigen::MatrixXd::Zero(n, n);
  std::vector<std::pair<double, Eigen::VectorXd>> samples;
  std::size_t nearest = part.first;
  double least = 1e300;
  for (std::size_t k = part.first; k < end; ++k) {
    const Vec3 r = block.position[k] - at;
    const double distance2 = dot(r, r), share = 1.0 - distance2 / (radius * radius);
    if (distance2 < least) least = distance2, nearest = k;
    if (!(share > 0.0)) continue;
    Eigen::VectorXd basis(n);
    basis[0] = 1.0;
    for (std::size_t d = 0; d < dimensions_; ++d) basis[static_cast<Eigen::Index>(d + 1)] = r[d] / spacing_;
    moment += share * share * basis * basis.transpose();
    samples.emplace_back(share * share, basis);
    weights_.push_back({static_cast<std::uint32_t>(k), 0.0, {}});
  }
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(moment);
  if (samples.size() < dimensions_ + 1 || !(ldlt.vectorD().minCoeff() > least_pivot * ldlt.vectorD().maxCoeff()))
    throw SceneError(located(scene, "fill." + std::to_string(part.fill)) + ": too few particles stand about (" +
                     brief(at[0]) + ", " + brief(at[1]) + ", " + brief(at[2]) +
                     ") m, on the border that a fluid ends at, to carry it; expected two layers of particles or more");
  const std::size_t from = begin_.back();
  for (std::size_t q = 0; q < samples.size(); ++q) {
    const Eigen::VectorXd factors = samples[q].first * ldlt.solve(samples[q].second);
    weights_[from + q].value = factors[0];
    for (std::size_t d = 0; d < dimensions_; ++d)
      weights_[from + q].slope[d] = factors[static_cast<Eigen::Index>(d + 1)] / spacing_;
  }
  begin_.push_back(static_cast<std::uint32_t>(weights_.size()));
  Piece piece;
  piece.anchor = nearest;
  pieces_.push_back(piece);
  first_.push_back(first);
}

/// x less whole periods, the shortest.
Vec3 ElasticBorder::shortest(Vec3 x) const {
  for (std::size_t d = 0; d < dimensions_; ++d)
    if (period_[d] > 0.0) x[d] -= period_[d] * std::nearbyint(x[d] / period_[d]);
  return x;
}

void ElasticBorder::move(const PhaseParticles& body) {
  std::array<const double*, 3> x{}, v{};
  for (std::size_t d = 0; d < dimensions_; ++d) {
    x[d] = body.column(Field::position, static_cast<int>(d));
    v[d] = body.column(Field::velocity, static_cast<int>(d));
  }
  const std::uint32_t* const places = body.places();
  const auto at = [&](std::size_t id) {
    Vec3 place{};
    for (std::size_t d = 0; d < dimensions_; ++d) place[d] = x[d][places[id]];
    return place;
  };
  const auto count = static_cast<std::int64_t>(pieces_.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto q = static_cast<std::size_t>(i);
    Piece& piece = pieces_[q];
    const Vec3 anchor = at(piece.anchor);
    piece.beside = {};
    std::array<Vec3, 3> f{}, rate{};  // columns of F and of its rate
    if (dimensions_ == 2) f[2][2] = 1.0;
    for (std::uint32_t k = begin_[q]; k < begin_[q + 1]; ++k) {
      const Vec3 r = shortest(at(weights_[k].id) - anchor);
      piece.beside = piece.beside + weights_[k].value * r;
      for (std::size_t d = 0; d < dimensions_; ++d) {
        f[d] = f[d] + weights_[k].slope[d] * r;
        for (std::size_t e = 0; e < dimensions_; ++e) rate[d][e] += weights_[k].slope[d] * v[e][places[weights_[k].id]];
      }
    }
    piece.place = anchor + piece.beside;
    piece.velocity = mean(q, places, v);
    const std::array<Vec3, 3> cofactor{cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])};
    const double volume = dot(f[0], cofactor[0]);
    piece.spin = {};
    for (std::size_t d = 0; d < dimensions_ && volume > 0.0; ++d)
      piece.spin = piece.spin + 0.5 / volume * cross(cofactor[d], rate[d]);
    const Vec3& n = first_[q].normal;
    const Vec3 area = n[0] * cofactor[0] + n[1] * cofactor[1] + n[2] * cofactor[2];
    const double size = std::max(norm(area), 1e-300);
    piece.normal = 1.0 / size * area;
    piece.content = first_[q].content * size;
  }
  sort_into_cells();
}

std::size_t ElasticBorder::bucket_of(const std::array<std::int64_t, 3>& cell) const {
  std::uint64_t hash = 0;
  for (const std::int64_t c : cell) hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15ull;
  return static_cast<std::size_t>(hash >> 32) & (bucket_end_.size() - 2);
}

/// In the order of their numbers within a bucket.
void ElasticBorder::sort_into_cells() {
  low_ = {1e300, 1e300, 1e300};
  high_ = {-1e300, -1e300, -1e300};
  const auto bucket = [&](const Vec3& x) {
    std::array<std::int64_t, 3> cell{};
    for (std::size_t d = 0; d < dimensions_; ++d) cell[d] = static_cast<std::int64_t>(std::floor(x[d] / reach_));
    return bucket_of(cell);
  };
  std::fill(bucket_end_.begin(), bucket_end_.end(), 0u);
  for (const Piece& piece : pieces_) {
    ++bucket_end_[bucket(piece.place) + 1];
    for (std::size_t d = 0; d < 3; ++d) {
      low_[d] = std::min(low_[d], piece.place[d] - reach_);
      high_[d] = std::max(high_[d], piece.place[d] + reach_);
    }
  }
  for (std::size_t b = 1; b < bucket_end_.size(); ++b) bucket_end_[b] += bucket_end_[b - 1];
  for (std::size_t q = pieces_.size(); q-- > 0;)  // leaves the begin of bucket b in bucket_end_[b + 1]
    in_bucket_[--bucket_end_[bucket(pieces_[q].place) + 1]] = static_cast<std::uint32_t>(q);
}

bool ElasticBorder::may_reach(const Vec3& x) const {
  for (std::size_t d = 0; d < dimensions_; ++d)
    if (!(period_[d] > 0.0) && !(x[d] > low_[d] && x[d] < high_[d])) return false;
  return true;
}

std::optional<ElasticBorder::Near> ElasticBorder::nearest(const Vec3& x) const {
  std::optional<Near> found;
  double least = reach_ * reach_;
  std::array<std::int64_t, 3> ways{}, turn{};
  for (std::size_t d = 0; d < dimensions_; ++d) ways[d] = period_[d] > 0.0 ? 1 : 0;
  const auto look = [&](const Vec3& at) {
    for (std::size_t d = 0; d < dimensions_; ++d)
      if (!(at[d] > low_[d] && at[d] < high_[d])) return;
    std::array<std::int64_t, 3> middle{}, step{};
    for (std::size_t d = 0; d < dimensions_; ++d) middle[d] = static_cast<std::int64_t>(std::floor(at[d] / reach_));
    const std::int64_t deep = dimensions_ == 3 ? 1 : 0;
    for (step[2] = -deep; step[2] <= deep; ++step[2])
      for (step[1] = -1; step[1] <= 1; ++step[1])
        for (step[0] = -1; step[0] <= 1; ++step[0]) {
          const std::size_t b = bucket_of({middle[0] + step[0], middle[1] + step[1], middle[2] + step[2]});
          const std::uint32_t end =
              b + 2 < bucket_end_.size() ? bucket_end_[b + 2] : static_cast<std::uint32_t>(in_bucket_.size());
          for (std::uint32_t k = bucket_end_[b + 1]; k < end; ++k) {
            const std::size_t q = in_bucket_[k];
            const Vec3 r = at - pieces_[q].place;
            const double distance2 = dot(r, r);
            if (!(distance2 < least || (found && distance2 == least && q < found->piece))) continue;
            least = distance2;
            found = Near{q, r, dot(r, pieces_[q].normal)};
          }
        }
  };
  for (turn[2] = -ways[2]; turn[2] <= ways[2]; ++turn[2])
    for (turn[1] = -ways[1]; turn[1] <= ways[1]; ++turn[1])
      for (turn[0] = -ways[0]; turn[0] <= ways[0]; ++turn[0]) {
        Vec3 at = x;
        for (std::size_t d = 0; d < dimensions_; ++d) at[d] += static_cast<double>(turn[d]) * period_[d];
        look(at);
      }
  return found;
}

}  // namespace barchan
