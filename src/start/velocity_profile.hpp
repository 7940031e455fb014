// A velocity by height that an earlier run measured: profile_NAME.csv of a [[profile]], or a file of that form.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/vec3.hpp"

namespace barchan {

class VelocityProfile {
 public:
  /// A table with names of columns in its first line, separated by commas, semicolons or tabs: y, and velocity_mean_x
  /// or velocity_x; of y and z where they are there. The unit that a name is followed by, as in "y [mm]", counts; else
  /// they are m and m/s. Other columns are passed over. Throws SceneError (`what` is said first) where a line is not
  /// whole, a number is not finite, a unit is not known, or heights do not grow.
  VelocityProfile(std::string_view text, const std::string& what);

  /// m/s at a height (m): linear between two rows; below the first and above the last row that row's.
  Vec3 operator()(double y) const;

 private:
  struct Row {
    double y;
    Vec3 velocity;
  };
  std::vector<Row> rows_;
};

/// Reads it from a file. Throws SceneError, `what` first.
VelocityProfile read_velocity_profile(const std::string& path, const std::string& what);

}  // namespace barchan
