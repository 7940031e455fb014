#include "models/bodies/rigid_start.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>

#include "base/errors.hpp"
#include "base/ranks.hpp"
#include "engine/reproducible_sum.hpp"
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

/// Principal moments and axes about the body's place.
void find_inertia(RigidBody& body, const Vec3* x, double mass) {
  if (body.dimensions == 2) {
    body.inertia[2] = mass * reproducible_sum(body.count, [&](std::size_t k) {
                        const Vec3 r = x[k] - body.first_place;
                        return r[0] * r[0] + r[1] * r[1];
                      });
    return;
  }
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j) {
      const double entry = mass * reproducible_sum(body.count, [&](std::size_t k) {
                             const Vec3 r = x[k] - body.first_place;
                             return (i == j ? dot(r, r) : 0.0) - r[i] * r[j];
                           });
      tensor(static_cast<int>(i), static_cast<int>(j)) = tensor(static_cast<int>(j), static_cast<int>(i)) = entry;
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  const Eigen::Quaterniond turn(axes);
  body.now.turn = {turn.w(), turn.x(), turn.y(), turn.z()};
  for (int i = 0; i < 3; ++i) body.inertia[static_cast<std::size_t>(i)] = std::max(solver.eigenvalues()[i], 0.0);
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
  const double mass = layout.phases[phase].mass;
  body.mass = mass * static_cast<double>(body.count);
  const Vec3 *x = block.position.data() + part.first, *v = block.velocity.data() + part.first;
  refuse_across_sides(scene, layout, body, x);
  const Vec3 middle = 1.0 / static_cast<double>(body.count) * sum(body.count, [&](std::size_t k) { return x[k]; });
  body.motion = motion_of(scene, layout, phase, part.fill, middle);
  body.first_place = middle;
  if (body.motion != nobody) {
    const Motion& motion = scene.motions[body.motion];
    body.hold = motion.about && !motion.angular_velocity ? RigidBody::Hold::pinned : RigidBody::Hold::driven;
    if (motion.about) body.first_place = *motion.about;
  }
  body.now.place = body.first_place;
  find_inertia(body, x, mass);
  const double smallest =
      body.dimensions == 2 ? body.inertia[2] : *std::min_element(body.inertia.begin(), body.inertia.end());
  const double spacing = layout.phases[phase].spacing;
  if (!(smallest > 1e-9 * body.mass * spacing * spacing))
    throw SceneError(located(scene, "fill." + std::to_string(part.fill) + ".shape") +
                     ": the particles of the rigid body stand in one " + (body.dimensions == 2 ? "place" : "line") +
                     ", about which nothing has inertia; expected a larger shape or a smaller spacing");
  const OwnAxes axes(body);
  body.centre = axes.to_own(middle - body.first_place);
  for (std::size_t k = 0; k < body.count; ++k) body.reach = std::max(body.reach, norm(x[k] - body.first_place));
  if (body.hold == RigidBody::Hold::free)
    body.now.velocity = 1.0 / static_cast<double>(body.count) * sum(body.count, [&](std::size_t k) { return v[k]; });
  if (body.hold != RigidBody::Hold::driven)
    body.now.spin =
        axes.to_own(mass * sum(body.count, [&](std::size_t k) { return cross(x[k] - body.first_place, v[k]); }));
  return body;
}

}  // namespace

std::vector<RigidBody> rigid_bodies(const Scene& scene, const ParticleBlock& block, std::size_t phase,
                                    const Layout& layout) {
  const ranks::Alone alone;  // every rank has the whole bodies
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
