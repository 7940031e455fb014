// How much a shape holds, where its centre is, and how it is spread about that.
#pragma once

#include <array>
#include <cstddef>

#include "base/vec3.hpp"

namespace barchan {

/// Second moments: the integrals of x x, y y, z z, x y, x z, y z.
using SecondMoments = std::array<double, 6>;

inline SecondMoments squares(const Vec3& x) {
  return {x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[0] * x[2], x[1] * x[2]};
}
inline SecondMoments scaled(double factor, SecondMoments m) {
  for (double& moment : m) moment *= factor;
  return m;
}

struct Content {
  double content = 0.0;    // m2 in 2D, m3 in 3D
  Vec3 centre{};           // m
  SecondMoments second{};  // m4, m5: about the centre

  /// While it is summed up: `centre` is the first moment (m3, m4) and `second` the second one, both about one place.
  void add(double more, const Vec3& first, const SecondMoments& squared) {
    content += more;
    centre = centre + first;
    for (std::size_t k = 0; k < 6; ++k) second[k] += squared[k];
  }
  /// The sum about this place is complete.
  void refer_to_centre(const Vec3& about) {
    if (!(content > 0.0)) return;
    const Vec3 from_place = 1.0 / content * centre;
    const SecondMoments shift = scaled(content, squares(from_place));
    for (std::size_t k = 0; k < 6; ++k) second[k] -= shift[k];
    centre = about + from_place;
  }
};

}  // namespace barchan
