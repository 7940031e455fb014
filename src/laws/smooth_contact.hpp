// Contact of the surfaces of two elastic bodies. Each particle a of a surface feels a mean of those of the other
// surface that face it. Sign: r = x_a - x_b, v = v_a - v_b; forces are on a. n_a and n_b are the outward normals of the
// two surfaces; their lengths say how sure they are (near 1; little at an edge). The common normal
//
//   m = (n_b - n_a)/|n_b - n_a|,   height h = r.m,   t = r - h m
//
// is the same of both particles, but for its sign. What a pair gives stems from the energy of the spring of
// laws/body_contact.hpp over the height in place of the distance, times a weight of the distance along the surface,
//
//   E = g_a g_b f S(t) (1/2 K delta^2 + 1/2 8 K max(delta - 0.35 d, 0)^2),   delta = d - h
//   S(t) = s (1 - t^2/w^2)^2 for t < w = 1.5 d,   s = 15 d/(16 w) in 2D, 3 d^2/(pi w^2) in 3D
//
// The integral of S over a surface with a particle on every d^(D-1) is 1, so that all that face one particle are as
// stiff as one that faces it place for place. g makes the sum 1 at the edges of a surface and where its particles are
// nearer or further (models/bodies/body_surface.hpp). f = min(1, 2 cos) of the angle between n_b and -n_a: surfaces
// that look the same way do not touch. The force is that of E over r with the normals held: along m the spring of a
// pair times g_a g_b f S, and along t what the weight gives; dashpot, friction, and phi, psi of the steps in which a
// contact begins or ends are those of laws/body_contact.hpp, times the same weight. A pair of forces is equal and
// opposite to the last bit. It turns the pair where t is not zero; over a whole contact the turns cancel but for its
// edges.
//
// Means over the other surface stand in place of particle on particle as in the mortar methods of finite elements (Puso
// and Laursen 2004, Comput. Methods Appl. Mech. Eng. 193, 601); a potential of contact weighed by a kernel of
// particles: Vignjevic, De Vuyst and Campbell 2006, Comput. Model. Eng. Sci. 13, 35.
#pragma once

#include <numbers>

#include "laws/body_contact.hpp"

namespace barchan {

struct SmoothContactLaw {
  static constexpr double wide = 1.5;  // of d: w
  /// Of d: no pair that is further apart gives anything.
  static constexpr double reach = 1.8028;  // sqrt(1 + wide^2)

  BodyContactLaw pair;
  double width = 0, scale = 0;  // m, w; s

  static SmoothContactLaw of(const BodyContactLaw& pair, int dimensions) {
    const double share = dimensions == 2 ? 15.0 / (16.0 * wide) : 3.0 / (std::numbers::pi * wide * wide);
    return {pair, wide * pair.distance, share};
  }
  /// S(t).
  double weight(double t2) const {
    const double q = t2 < width * width ? 1.0 - t2 / (width * width) : 0.0;
    return scale * q * q;
  }

  template <class V>
  struct Constants {
    BodyContactLaw::Constants<V> pair;
    V over_square, scale;
    BARCHAN_SIMD_INLINE Constants(const SmoothContactLaw& law, double step)
        : pair(law.pair, step), over_square(1.0 / (law.width * law.width)), scale(law.scale) {}
  };

  /// Adds the force [N]. `n_a`, `n_b`: outward normals; `shares`: g_a g_b.
  template <bool Rubs, class V, std::size_t Dim>
  static BARCHAN_SIMD_INLINE void add(const Constants<V>& c, const std::array<V, Dim>& r, V r2,
                                      const std::array<V, Dim>& v, const std::array<V, Dim>& n_a, const V* n_b,
                                      V shares, std::array<V, Dim>& force) {
    const V zero(0.0), one(1.0), least(1e-300);
    V cosine(0.0), a2(0.0), b2(0.0), m2(0.0), height(0.0), normal_speed(0.0);
    std::array<V, Dim> m;
    for (std::size_t d = 0; d < Dim; ++d) {
      m[d] = n_b[d] - n_a[d];
      cosine = simd::fnma(n_a[d], n_b[d], cosine);
      a2 = simd::fma(n_a[d], n_a[d], a2);
      b2 = simd::fma(n_b[d], n_b[d], b2);
      m2 = simd::fma(m[d], m[d], m2);
    }
    const V facing = simd::min(simd::max(V(2.0) * cosine / simd::sqrt(simd::max(a2 * b2, least)), zero), one);
    const V length = one / simd::sqrt(simd::max(m2, least));
    for (std::size_t d = 0; d < Dim; ++d) {
      m[d] = m[d] * length;
      height = simd::fma(r[d], m[d], height);
      normal_speed = simd::fma(v[d], m[d], normal_speed);
    }
    const V overlap = c.pair.distance - height, along2 = simd::max(simd::fnma(height, height, r2), zero);
    const V q = simd::max(simd::fnma(along2, c.over_square, one), zero), part = shares * facing * c.scale * q;
    const V weight = part * q, normal = BodyContactLaw::normal_force(c.pair, overlap, normal_speed);
    const V deep = simd::max(overlap - c.pair.deep_distance, zero), open = simd::max(overlap, zero);
    const V energy = V(0.5) * simd::fma(c.pair.stiffness * open, open, c.pair.second_stiffness * deep * deep);
    const V aside = V(4.0) * part * c.over_square * energy;
    const V upwards = weight * normal;
    for (std::size_t d = 0; d < Dim; ++d)
      force[d] = force[d] + simd::fma(upwards, m[d], aside * simd::fnma(height, m[d], r[d]));
    if constexpr (Rubs) {
      std::array<V, Dim> slip;
      V square(1e-300);
      for (std::size_t d = 0; d < Dim; ++d) {
        slip[d] = simd::fnma(normal_speed, m[d], v[d]);
        square = simd::fma(slip[d], slip[d], square);
      }
      const V grip = weight * BodyContactLaw::grip(c.pair, normal, square);
      for (std::size_t d = 0; d < Dim; ++d) force[d] = simd::fnma(grip, slip[d], force[d]);
    }
  }
};

}  // namespace barchan
