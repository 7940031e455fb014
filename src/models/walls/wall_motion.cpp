#include "models/walls/wall_motion.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

WallMotion::WallMotion(const Motion& motion, int dimensions, const Vec3& centre)
    : velocity_(compile(motion.velocity)),
      rate_(compile(motion.angular_velocity.value_or(AxialExpression{}).about)),
      about_(motion.about.value_or(centre)),
      turns_(motion.angular_velocity.has_value()) {
  now_.dimensions = dimensions;
  now_.now.place = about_;
  before_ = now_;
}

void WallMotion::carry(RigidBody& pose, double time, double step) const {
  const double apart = 0.5 * step / std::sqrt(3.0), first = time + 0.5 * step - apart, second = first + 2.0 * apart;
  pose.now.place = pose.now.place + 0.5 * step * (velocity(first) + velocity(second));
  if (!turns_) return;
  const Vec3 w1 = rate(first), w2 = rate(second);
  turn_by(pose, 0.5 * (w1 + w2) + std::sqrt(3.0) / 12.0 * step * cross(w2, w1), step);
}

void WallMotion::advance(double time, double step) {
  before_ = now_;
  began_ = time;
  step_ = step;
  carry(now_, time, step);
}

RigidBody WallMotion::within_step(double elapsed) const {
  if (!(elapsed < step_ * (1.0 - 1e-9))) return now_;
  RigidBody pose = before_;
  carry(pose, began_, elapsed);
  return pose;
}

std::array<Vec3, 2> WallMotion::gain(double time, double span) const {
  const double from = std::max(0.0, time - 0.5 * span), to = time + 0.5 * span;
  if (!(to > from)) return {};
  return {1.0 / (to - from) * (velocity(to) - velocity(from)), 1.0 / (to - from) * (rate(to) - rate(from))};
}

void WallMotion::archive(Archive& a, const std::string& name) {
  a.number("place of " + name, now_.now.place);
  a.number("angle of " + name, now_.now.angle);
  a.number("turn of " + name, now_.now.turn);
}

}  // namespace barchan
