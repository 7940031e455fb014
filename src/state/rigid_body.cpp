#include "state/rigid_body.hpp"

#include <cmath>

namespace barchan {

namespace {

using Quaternion = std::array<double, 4>;

Quaternion product(const Quaternion& p, const Quaternion& q) {
  return {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
          p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
}

void normalise(Quaternion& q) {
  const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& component : q) component /= size;
}

/// The flow of L_i^2/(2 I_i): a rotation about its own axis i, which that part of the angular momentum keeps.
void turn_about(RigidBody& body, std::size_t i, double time) {
  Vec3& l = body.now.spin;
  const double angle = time * l[i] / body.inertia[i];
  const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
  const double c = std::cos(angle), s = std::sin(angle), old = l[j];
  l[j] = c * old + s * l[k];
  l[k] = c * l[k] - s * old;
  Quaternion about{std::cos(0.5 * angle), 0.0, 0.0, 0.0};
  about[i + 1] = std::sin(0.5 * angle);
  body.now.turn = product(body.now.turn, about);
}

/// Of the second order.
void split(RigidBody& body, double time) {
  turn_about(body, 0, 0.5 * time);
  turn_about(body, 1, 0.5 * time);
  turn_about(body, 2, time);
  turn_about(body, 1, 0.5 * time);
  turn_about(body, 0, 0.5 * time);
}

}  // namespace

OwnAxes::OwnAxes(const RigidBody& body) : axes_{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}} {
  if (body.dimensions == 2) {
    const double c = std::cos(body.now.angle), s = std::sin(body.now.angle);
    axes_[0] = {c, s, 0};
    axes_[1] = {-s, c, 0};
    return;
  }
  const auto& [w, x, y, z] = body.now.turn;
  axes_[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
  axes_[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
  axes_[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
}

Vec3 own_angular_velocity(const RigidBody& body) {
  const Vec3& l = body.now.spin;
  if (body.dimensions == 2) return {0, 0, l[2] / body.inertia[2]};
  return {l[0] / body.inertia[0], l[1] / body.inertia[1], l[2] / body.inertia[2]};
}

Vec3 centre_of(const RigidBody& body) { return body.now.place + OwnAxes(body).to_space(body.centre); }

Vec3 centre_velocity(const RigidBody& body) {
  return body.now.velocity + OwnAxes(body).to_space(cross(own_angular_velocity(body), body.centre));
}

/// The spin of a body about its place is that of its parts as they move about the place.
Vec3 turning_about_centre(const RigidBody& body) {
  const Vec3 about_place = cross(own_angular_velocity(body), body.centre);
  return OwnAxes(body).to_space(body.now.spin - body.mass * cross(body.centre, about_place));
}

double kinetic_energy(const RigidBody& body) {
  const Vec3 v = centre_velocity(body), rate = OwnAxes(body).to_space(own_angular_velocity(body));
  return 0.5 * body.mass * dot(v, v) + 0.5 * dot(rate, turning_about_centre(body));
}

Vec3 spin_of(const RigidBody& body, const Vec3& rate) {
  return {rate[0] * body.inertia[0], rate[1] * body.inertia[1], rate[2] * body.inertia[2]};
}

void turn_freely(RigidBody& body, double time) {
  if (body.dimensions == 2) {
    body.now.angle += time * own_angular_velocity(body)[2];
    return;
  }
  const double outer = 1.0 / (4.0 - std::cbrt(4.0));  // Suzuki 1990: four steps forward, one back
  for (const double share : {outer, outer, 1.0 - 4.0 * outer, outer, outer}) split(body, share * time);
  normalise(body.now.turn);
}

void turn_by(RigidBody& body, const Vec3& rate, double time) {
  if (body.dimensions == 2) {
    body.now.angle += time * rate[2];
    return;
  }
  const double size = norm(rate), angle = size * time;
  if (!(size > 0.0)) return;
  const double s = std::sin(0.5 * angle) / size;
  body.now.turn = product({std::cos(0.5 * angle), s * rate[0], s * rate[1], s * rate[2]}, body.now.turn);
  normalise(body.now.turn);
}

}  // namespace barchan
