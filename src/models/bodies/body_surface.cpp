#include "models/bodies/body_surface.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "kernels/kernel.hpp"
#include "models/bodies/self_contact.hpp"

namespace barchan {

namespace {

/// Of a unit normal: how near to its direction no neighbour stands (60 degrees); what of another surface counts as the
/// same one (the back of a thin plate does not); how deep in spacings.
constexpr double open = 0.5, same_side = 0.1, same_height = 0.75;

/// x less whole periods, the shortest.
Vec3 shortest(Vec3 x, const Vec3& period) {
  for (std::size_t d = 0; d < 3; ++d)
    if (period[d] > 0.0) x[d] -= period[d] * std::nearbyint(x[d] / period[d]);
  return x;
}

double sixteenth_power(double x) {
  for (int k = 0; k < 4; ++k) x *= x;
  return x;
}

}  // namespace

BodySurface::BodySurface(const std::vector<Vec3>& places, const Bounds& bounds, double spacing, double radius,
                         const SmoothContactLaw& law)
    : dimensions_(bounds.dimensions) {
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions_); ++d)
    if (bounds.periodic[d]) period_[d] = bounds.high[d] - bounds.low[d];
  const auto near = first_neighbours(places, bounds, spacing, std::max(radius, law.width));
  std::vector<Vec3> normals(places.size());  // of unit length; zero inside
  with_kernel<double>(KernelKind::wendland_c2, radius, dimensions_, [&](const auto& kernel) {
    for (std::size_t a = 0; a < places.size(); ++a) add_point(places, near[a], a, radius, kernel, normals);
  });
  for (Point& p : points_) {
    Vec3 mean{};
    double weights = 0.0, sum = law.weight(0.0);
    const Vec3 n = normals[p.id];
    mean = sum * n;
    weights = sum;
    for (const std::uint32_t b : near[p.id]) {
      if (b == p.id || dot(normals[b], n) < same_side) continue;
      const Vec3 x = shortest(places[p.id] - places[b], period_);
      const double weight = law.weight(dot(x, x));
      mean = mean + weight * normals[b];
      weights += weight;
      if (std::abs(dot(x, n)) < same_height * spacing) sum += weight;
    }
    p.normal = sixteenth_power(norm(mean) / weights) * n;
    p.share = 1.0 / std::sqrt(sum);
  }
}

template <class Kernel>
void BodySurface::add_point(const std::vector<Vec3>& places, const std::vector<std::uint32_t>& near, std::size_t a,
                            double radius, const Kernel& kernel, std::vector<Vec3>& normals) {
  Vec3 sum{};
  double size = 0.0;
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  std::vector<std::pair<std::uint32_t, Vec3>> weighed;
  for (const std::uint32_t b : near) {
    const Vec3 x = shortest(places[a] - places[b], period_);
    const double r = norm(x);
    if (b == a || r >= radius) continue;
    const Vec3 wx = std::abs(kernel.derivative(r)) / r * x;
    sum = sum + wx;
    size += norm(wx);
    m += Eigen::Vector3d(wx[0], wx[1], wx[2]) * Eigen::RowVector3d(x[0], x[1], x[2]);
    weighed.emplace_back(b, wx);
  }
  if (dimensions_ == 2) m(2, 2) = 0.5 * m.trace();
  const double determinant = m.determinant(), trace = m.trace();
  if (!(determinant > 1e-4 * trace * trace * trace)) alone_ = static_cast<std::int64_t>(a);
  if (!(norm(sum) > 1e-3 * size)) return;
  const Vec3 n = 1.0 / norm(sum) * sum;
  for (const auto& [b, wx] : weighed)
    if (-dot(wx, n) > open * norm(wx)) return;
  normals[a] = n;
  const Eigen::Matrix3d inverse = m.inverse();
  Point p{static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(neighbours_.size()), 0, {}, 0.0};
  for (const auto& [b, wx] : weighed) {
    const Eigen::Vector3d reach = inverse * Eigen::Vector3d(wx[0], wx[1], wx[2]);
    neighbours_.push_back({b, {reach[0], reach[1], reach[2]}});
  }
  p.end = static_cast<std::uint32_t>(neighbours_.size());
  points_.push_back(p);
}

Vec3 BodySurface::turned(const std::array<const double*, 3>& at, const std::uint32_t* places, const Point& p) const {
  const auto dimensions = static_cast<std::size_t>(dimensions_);
  std::array<Vec3, 3> f{};  // columns of F
  if (dimensions_ == 2) f[2][2] = 1.0;
  const std::size_t a = places[p.id];
  for (std::uint32_t k = p.begin; k < p.end; ++k) {
    const Neighbour& n = neighbours_[k];
    Vec3 x{};
    for (std::size_t d = 0; d < dimensions; ++d) x[d] = at[d][a] - at[d][places[n.id]];
    x = shortest(x, period_);
    for (std::size_t e = 0; e < dimensions; ++e) f[e] = f[e] + n.reach[e] * x;
  }
  const Vec3 n = p.normal[0] * cross(f[1], f[2]) + p.normal[1] * cross(f[2], f[0]) + p.normal[2] * cross(f[0], f[1]);
  return norm(p.normal) / std::max(norm(n), 1e-300) * n;
}

template <int Dim>
void BodySurface::pack_as(const PhaseParticles& body, RecordArray& records) const {
  using R = SurfaceRecord<Dim>;
  std::array<const double*, 3> x{};
  std::array<const double*, Dim> v;
  for (int d = 0; d < Dim; ++d) {
    x[static_cast<std::size_t>(d)] = body.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = body.column(Field::velocity, d);
  }
  const auto n = static_cast<std::int64_t>(body.size()), points = static_cast<std::int64_t>(points_.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    double* to = records[k];
    for (std::size_t d = 0; d < Dim; ++d) {
      to[R::position + d] = x[d][k];
      to[R::velocity + d] = v[d][k];
    }
    for (std::size_t f = R::normal; f < R::size; ++f) to[f] = 0.0;
  }
  const std::uint32_t* places = body.places();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < points; ++i) {
    const Point& p = points_[static_cast<std::size_t>(i)];
    const Vec3 normal = turned(x, places, p);
    double* to = records[places[p.id]];
    for (std::size_t d = 0; d < Dim; ++d) to[R::normal + d] = normal[d];
    to[R::share] = p.share;
  }
}

void BodySurface::pack(const PhaseParticles& body, RecordArray& records) const {
  dimensions_ == 2 ? pack_as<2>(body, records) : pack_as<3>(body, records);
}

}  // namespace barchan
