#include "models/bodies/rigid_start.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "engine/reproducible_sum.hpp"
#include "scene/formula.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

constexpr std::size_t nobody = static_cast<std::size_t>(-1);

/// A sum over the particles of a body.
template <class F>
Vec3 sum(std::size_t n, F&& f) {
  Vec3 total{};
  for (std::size_t d = 0; d < 3; ++d) total[d] = reproducible_sum(n, [&](std::size_t k) { return f(k)[d]; });
  return total;
}

bool in_box(const BodySet& set, const Vec3& x, const Layout& layout, double slack) {
  bool inside = true;
  for (std::size_t d = 0; set.box && d < static_cast<std::size_t>(layout.dimensions); ++d)
    inside = inside && x[d] >= set.box->min[d] - slack && x[d] <= set.box->max[d] + slack;
  return inside;
}

/// The [[motion]] that holds a body whose centre of mass stands at x; `nobody`: it is free.
std::size_t motion_of(const Scene& scene, const Layout& layout, std::size_t phase, std::size_t fill, const Vec3& x) {
  std::size_t found = nobody;
  for (std::size_t k = 0; k < scene.motions.size(); ++k) {
    const Motion& motion = scene.motions[k];
    if (motion.phase != layout.phases[phase].name || !in_box(motion, x, layout, 1e-6 * layout.phases[phase].spacing))
      continue;
    if (found != nobody)
      throw SceneError(located(scene, "motion." + std::to_string(k)) + ": holds the rigid body of fill." +
                       std::to_string(fill) + ", which motion." + std::to_string(found) +
                       " holds already; expected one motion a body");
    found = k;
  }
  return found;
}

/// Of a solid with these second moments, or as the fill says it (kg m2, about the centre of mass, along the axes of
/// space).
Eigen::Matrix3d inertia_about_centre(const Fill& fill, const Content& content, double mass) {
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
  if (fill.inertia) {
    for (int d = 0; d < 3; ++d) tensor(d, d) = Formula(fill.inertia->about[static_cast<std::size_t>(d)])({});
    return tensor;
  }
  const auto& [xx, yy, zz, xy, xz, yz] = content.second;
  tensor << yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy;
  return mass / content.content * tensor;
}

/// The same about a place from which the centre of mass is an arm (m) away (Steiner).
Eigen::Matrix3d moved(const Eigen::Matrix3d& tensor, double mass, const Vec3& arm) {
  const Eigen::Vector3d r(arm[0], arm[1], arm[2]);
  return tensor + mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

/// Principal moments and axes about the body's place.
void find_axes(RigidBody& body, const Eigen::Matrix3d& tensor) {
  if (body.dimensions == 2) {
    body.inertia[2] = tensor(2, 2);
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  const Eigen::Quaterniond turn(axes);
  body.now.turn = {turn.w(), turn.x(), turn.y(), turn.z()};
  for (int i = 0; i < 3; ++i) body.inertia[static_cast<std::size_t>(i)] = std::max(solver.eigenvalues()[i], 0.0);
}

/// The rigid motion that has the momentum and the angular momentum of the particles of a body, as equal points.
struct RigidFit {
  Vec3 middle, velocity;  // m, m/s, there
  Vec3 rate;              // 1/s
};
RigidFit fit_motion(std::size_t n, const Vec3* x, const Vec3* v, int dimensions) {
  const double share = 1.0 / static_cast<double>(n);
  RigidFit fit{
      share * sum(n, [&](std::size_t k) { return x[k]; }), share * sum(n, [&](std::size_t k) { return v[k]; }), {}};
  const Vec3 turning = sum(n, [&](std::size_t k) { return cross(x[k] - fit.middle, v[k] - fit.velocity); });
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j)
      tensor(static_cast<int>(i), static_cast<int>(j)) = tensor(static_cast<int>(j), static_cast<int>(i)) =
          reproducible_sum(n, [&](std::size_t k) {
            const Vec3 r = x[k] - fit.middle;
            return (i == j ? dot(r, r) : 0.0) - r[i] * r[j];
          });
  if (dimensions == 2) {
    if (tensor(2, 2) > 0.0) fit.rate[2] = turning[2] / tensor(2, 2);
    return fit;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
  Eigen::Vector3d about = solver.eigenvectors().transpose() * Eigen::Vector3d(turning[0], turning[1], turning[2]);
  for (int d = 0; d < 3; ++d) {  // points in one line do not turn about it
    const double moment = solver.eigenvalues()[d];
    about[d] = moment > 1e-9 * solver.eigenvalues()[2] ? about[d] / moment : 0.0;
  }
  const Eigen::Vector3d rate = solver.eigenvectors() * about;
  fit.rate = {rate[0], rate[1], rate[2]};
  return fit;
}

/// The first particle that stands more than half a period from the first one.
void refuse_across_sides(const Scene& scene, const Layout& layout, const RigidBody& body, const Vec3* x) {
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout.dimensions); ++d) {
    const double half = 0.5 * (layout.bounds.high[d] - layout.bounds.low[d]);
    if (layout.bounds.periodic[d] &&
        std::any_of(x, x + body.count, [&](const Vec3& other) { return std::abs(other[d] - x[0][d]) > half; }))
      throw SceneError(located(scene, "fill." + std::to_string(body.fill) + ".shape") +
                       ": the rigid body is wider than half of the periodic domain or stands across its side; expected "
                       "one that does not");
  }
}

RigidBody make_body(const Scene& scene, const ParticleBlock& block, const ParticleBlock::Part& part, std::size_t end,
                    std::size_t phase, const Layout& layout) {
  RigidBody body;
  body.phase = phase;
  body.fill = part.fill;
  body.first = part.first;
  body.count = end - part.first;
  body.dimensions = layout.dimensions;
  const Fill& fill = scene.fills[part.fill];
  const Vec3 *x = block.position.data() + part.first, *v = block.velocity.data() + part.first;
  refuse_across_sides(scene, layout, body, x);
  const Content content = part.body.value();
  const Vec3 middle = content.centre;
  body.mass = fill.mass.value_or(scene.phases[phase].density * content.content);
  body.motion = motion_of(scene, layout, phase, part.fill, middle);
  body.first_place = middle;
  if (body.motion != nobody) {
    const Motion& motion = scene.motions[body.motion];
    body.hold = motion.about && !motion.angular_velocity ? RigidBody::Hold::pinned : RigidBody::Hold::driven;
    if (motion.about) body.first_place = *motion.about;
  }
  body.now.place = body.first_place;
  const Vec3 arm = middle - body.first_place;
  const Eigen::Matrix3d about_centre = inertia_about_centre(fill, content, body.mass);
  find_axes(body, moved(about_centre, body.mass, arm));
  const double smallest =
      body.dimensions == 2 ? body.inertia[2] : *std::min_element(body.inertia.begin(), body.inertia.end());
  const double spacing = layout.phases[phase].spacing;
  if (!(smallest > 1e-9 * body.mass * spacing * spacing))
    throw SceneError(located(scene, "fill." + std::to_string(part.fill) + ".shape") +
                     ": the particles of the rigid body stand in one " + (body.dimensions == 2 ? "place" : "line") +
                     ", about which nothing has inertia; expected a larger shape, or inertia");
  const OwnAxes axes(body);
  body.centre = axes.to_own(arm);
  for (std::size_t k = 0; k < body.count; ++k) body.reach = std::max(body.reach, norm(x[k] - body.first_place));
  const RigidFit fit = fit_motion(body.count, x, v, body.dimensions);
  const Vec3 velocity = fit.velocity + cross(fit.rate, middle - fit.middle);
  if (body.hold == RigidBody::Hold::free) body.now.velocity = velocity;
  if (body.hold != RigidBody::Hold::driven) {
    const Eigen::Vector3d turning = about_centre * Eigen::Vector3d(fit.rate[0], fit.rate[1], fit.rate[2]);
    body.now.spin = axes.to_own(Vec3{turning[0], turning[1], turning[2]} + body.mass * cross(arm, velocity));
  }
  return body;
}

}  // namespace

std::vector<RigidBody> rigid_bodies(const Scene& scene, const ParticleBlock& block, std::size_t phase,
                                    const Layout& layout) {
  const ComputedByAll alone;  // every rank has the whole bodies
  std::vector<RigidBody> bodies;
  for (std::size_t k = 0; k < block.parts.size(); ++k) {
    const std::size_t end = k + 1 < block.parts.size() ? block.parts[k + 1].first : block.position.size();
    bodies.push_back(make_body(scene, block, block.parts[k], end, phase, layout));
  }
  for (std::size_t k = 0; k < scene.motions.size(); ++k)
    if (scene.motions[k].phase == layout.phases[phase].name &&
        std::none_of(bodies.begin(), bodies.end(), [&](const RigidBody& body) { return body.motion == k; }))
      throw SceneError(located(scene, "motion." + std::to_string(k)) + ": no rigid body of phase \"" +
                       layout.phases[phase].name +
                       "\" has its centre in the box at the start; expected a box that holds one");
  return bodies;
}

}  // namespace barchan
