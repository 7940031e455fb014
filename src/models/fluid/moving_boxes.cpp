#include "models/fluid/moving_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

/// The box at the start and the box now: places in it, along its own axes from its centre.
class BoxFrame {
 public:
  BoxFrame(const MovingBox& box, const Bounds& bounds)
      : bounds_(bounds),
        axes_(box.motion->now()),
        half_(0.5 * (box.high - box.low)),
        arm_(axes_.to_space(box.motion->arm(0.5 * (box.low + box.high)))),
        centre_(box.motion->now().now.place + arm_) {}

  std::size_t dimensions() const { return static_cast<std::size_t>(bounds_.dimensions); }
  const Vec3& half() const { return half_; }
  Vec3 own(const Vec3& x) const {
    Vec3 r = x - centre_;
    for (std::size_t d = 0; d < dimensions(); ++d)
      if (const double period = bounds_.high[d] - bounds_.low[d]; bounds_.periodic[d])
        r[d] -= period * std::round(r[d] / period);
    return axes_.to_own(r);
  }
  Vec3 to_space(const Vec3& own) const { return axes_.to_space(own); }
  /// m, from the place about which the wall turns.
  Vec3 arm_of(const Vec3& own) const { return arm_ + to_space(own); }
  bool holds(const Vec3& own) const {
    for (std::size_t d = 0; d < dimensions(); ++d)
      if (!(std::abs(own[d]) < half_[d])) return false;
    return true;
  }
  bool in_domain(const Vec3& own) const {
    const Vec3 x = centre_ + to_space(own);
    for (std::size_t d = 0; d < dimensions(); ++d)
      if (!bounds_.periodic[d] && (x[d] <= bounds_.low[d] || x[d] >= bounds_.high[d])) return false;
    return true;
  }

 private:
  const Bounds& bounds_;
  OwnAxes axes_;
  Vec3 half_, arm_, centre_;  // m
};

Vec3 vector_of(const PhaseParticles& p, Field field, std::size_t k) {
  Vec3 x{};
  for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(field, d)[k];
  return x;
}

/// The nearest face beyond which the domain goes on: along which own axis, and to which side; 0: there is none.
struct Way {
  std::size_t axis = 0;
  double side = 0.0;
};
Way nearest_way(const BoxFrame& frame, const Vec3& own) {
  Way way;
  double least = 1e300;
  for (std::size_t d = 0; d < frame.dimensions(); ++d)
    for (const double side : {-1.0, 1.0}) {
      Vec3 to = own;
      to[d] = side * frame.half()[d];
      if (std::abs(to[d] - own[d]) >= least || !frame.in_domain(to)) continue;
      least = std::abs(to[d] - own[d]);
      way = {d, side};
    }
  return way;
}

}  // namespace

std::vector<MovingBox> moving_boxes(const Workspace& w, std::size_t fluid, const PhaseParticles& particles) {
  std::vector<MovingBox> boxes;
  for (const Fill& fill : w.scene.fills) {
    const auto* shape = std::get_if<BoxShape>(&fill.shape);
    const Phase* wall = find_phase(w.scene, fill.phase);
    const WallMotion* motion = wall ? w.wall_motions[static_cast<std::size_t>(wall - w.scene.phases.data())] : nullptr;
    if (!shape || !motion || !entry_between(w.scene, w.scene.phases[fluid], *wall)) continue;
    const MovingBox box{shape->min, shape->max, motion};
    const BoxFrame frame(box, w.layout.bounds);
    bool empty = true;
    for (std::size_t k = 0; k < particles.size(); ++k)
      empty = empty && !frame.holds(frame.own(vector_of(particles, Field::position, k)));
    if (!Exchange().any(!empty)) boxes.push_back(box);
  }
  return boxes;
}

void hold_outside(PhaseParticles& phase, const MovingBox& box, const Bounds& bounds, double time) {
  const BoxFrame frame(box, bounds);
  const Vec3 velocity = box.motion->velocity(time), rate = box.motion->rate(time);
  const auto n = static_cast<std::int64_t>(phase.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 own = frame.own(vector_of(phase, Field::position, k));
    if (!frame.holds(own)) continue;
    const Way way = nearest_way(frame, own);
    if (way.side == 0.0) continue;  // nowhere is room: the watch tells
    Vec3 out{}, to = own;
    out[way.axis] = way.side;
    to[way.axis] = way.side * frame.half()[way.axis];
    const Vec3 move = frame.to_space(to - own), normal = frame.to_space(out),
               speed = velocity + cross(rate, frame.arm_of(to));
    const double into = std::min(0.0, dot(vector_of(phase, Field::velocity, k) - speed, normal));
    for (std::size_t d = 0; d < frame.dimensions(); ++d) {
      phase.column(Field::position, static_cast<int>(d))[k] += move[d];
      phase.column(Field::velocity, static_cast<int>(d))[k] -= into * normal[d];
    }
  }
}

}  // namespace barchan
