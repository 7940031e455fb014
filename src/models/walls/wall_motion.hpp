// Where a wall is that a [[motion]] carries as a rigid whole: a place that moves, and turns about it.
#pragma once

#include <array>

#include "models/forces.hpp"
#include "state/archive.hpp"
#include "state/rigid_body.hpp"

namespace barchan {

/// The pose is the integral of the velocity and the angular velocity that the scene gives, of the fourth order in the
/// step: Gauss' two points, and in three dimensions the term of Magnus for an axis that turns (Iserles & Norsett 1999).
/// Places follow from the places at the start and from the pose alone: the wall keeps its shape for ever.
class WallMotion {
 public:
  /// `centre` (m): the place about which it turns where the scene says none.
  WallMotion(const Motion& motion, int dimensions, const Vec3& centre);

  /// m, of a place at the start: from the place about which it turns.
  Vec3 arm(const Vec3& start) const { return start - about_; }
  /// Carries it from a time (s) on by a step (s).
  void advance(double time, double step);
  /// Only `now.place` (m), `now.angle` (rad) and `now.turn` of the body mean something.
  const RigidBody& now() const { return now_; }
  /// A time (s) after the beginning of the last step; from its length on: now().
  RigidBody within_step(double elapsed) const;

  /// m/s of the place about which it turns, and 1/s, at a time (s).
  Vec3 velocity(double time) const { return at(velocity_, time); }
  Vec3 rate(double time) const { return at(rate_, time); }
  bool turns() const { return turns_; }
  /// m/s2 of that place and 1/s2: the mean gain over `span` (s) about a time, not from before the start.
  std::array<Vec3, 2> gain(double time, double span) const;

  void archive(Archive& a, const std::string& name);

 private:
  static Vec3 at(const std::array<Formula, 3>& f, double time) {
    return {f[0]({}, time), f[1]({}, time), f[2]({}, time)};
  }
  void carry(RigidBody& pose, double time, double step) const;

  std::array<Formula, 3> velocity_, rate_;
  Vec3 about_;  // m
  bool turns_;
  RigidBody now_, before_;           // before: at the beginning of the last step
  double began_ = 0.0, step_ = 0.0;  // s, of the last step
};

}  // namespace barchan
