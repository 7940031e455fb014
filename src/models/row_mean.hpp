// The mean of a force since the last row of history.csv.
#pragma once

#include <string>

#include "base/vec3.hpp"
#include "state/archive.hpp"

namespace barchan {

/// The impulse of a force over the time in which it acted. A force that alternates from step to step, as that of a
/// contact does, has the same mean at every distance of rows; its value in one step has not. Rows that follow one
/// another hold the whole impulse.
class RowMean {
 public:
  /// The force before the first step.
  void start(const Vec3& force) { force_ = mean_ = force; }
  /// A step of `dt` s, which kicks with half of the force at its beginning and half of that at its end; `impulse` is
  /// what acted besides (N s).
  void add(const Vec3& force, double dt, const Vec3& impulse = {}) {
    impulse_ = impulse_ + 0.5 * dt * (force_ + force) + impulse;
    time_ += dt;
    force_ = force;
  }
  /// N or N m, in the units of the force; where no step was made since begin_row(), the mean before it.
  Vec3 value() const { return time_ > 0.0 ? 1.0 / time_ * impulse_ : mean_; }
  /// A row was written.
  void begin_row() {
    mean_ = value();
    impulse_ = {};
    time_ = 0.0;
  }
  void archive(Archive& a, const std::string& what) {
    a.number(what + ", last step", force_);
    a.number(what + ", impulse since the last row", impulse_);
    a.number(what + ", mean of the last row", mean_);
    a.number(what + ", time since the last row", time_);
  }

 private:
  Vec3 force_{}, impulse_{}, mean_{};
  double time_ = 0.0;  // s
};

}  // namespace barchan
