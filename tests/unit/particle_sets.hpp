// Sets of particles for tests, and the pairs among them found the slow way: every image of every particle is looked at.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "engine/neighbours.hpp"
#include "engine/records.hpp"
#include "state/particles.hpp"

namespace barchan::sets {

/// Numbers that are the same on every machine.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }

 private:
  std::mt19937_64 engine_;
};

inline Bounds box(int dimensions, Vec3 size, std::array<bool, 3> periodic, Vec3 low = {0, 0, 0}) {
  Bounds b;
  b.dimensions = dimensions;
  b.low = low;
  b.high = low + size;
  if (dimensions == 2) b.low[2] = b.high[2] = 0.0;
  b.periodic = periodic;
  return b;
}

/// A square lattice that fills the bounds, half a spacing from its sides; coordinates moved by at most `perturb`
/// spacings.
inline std::vector<Vec3> lattice(const Bounds& b, double spacing, double perturb, Uniform& random) {
  std::array<int, 3> n{1, 1, 1};
  for (std::size_t d = 0; d < static_cast<std::size_t>(b.dimensions); ++d)
    n[d] = static_cast<int>(std::lround((b.high[d] - b.low[d]) / spacing));
  std::vector<Vec3> x;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        Vec3 at{(i + 0.5) * spacing, (j + 0.5) * spacing, (k + 0.5) * spacing};
        for (double& c : at) c += spacing * random(-perturb, perturb);
        if (b.dimensions == 2) at[2] = 0.0;
        x.push_back(b.low + at);
      }
  return x;
}

/// `n` particles anywhere within the bounds.
inline std::vector<Vec3> scattered(const Bounds& b, int n, Uniform& random) {
  std::vector<Vec3> x(static_cast<std::size_t>(n));
  for (auto& at : x)
    for (std::size_t d = 0; d < static_cast<std::size_t>(b.dimensions); ++d) at[d] = random(b.low[d], b.high[d]);
  return x;
}

/// A phase with particles at x and these fields besides.
inline PhaseParticles phase(int dimensions, const std::vector<Vec3>& x, double mass,
                            const std::vector<Field>& fields = {}, std::int64_t first_id = 0) {
  PhaseParticles p("phase", dimensions, x.size(), mass, first_id);
  p.add(Field::position);
  for (const Field f : fields) p.add(f);
  for (int d = 0; d < dimensions; ++d)
    for (std::size_t k = 0; k < x.size(); ++k) p.column(Field::position, d)[k] = x[k][static_cast<std::size_t>(d)];
  return p;
}

/// Fills every component of a field with numbers in [low, high).
inline void randomise(PhaseParticles& p, Field field, double low, double high, Uniform& random) {
  for (int c = 0; c < p.components(field); ++c)
    for (std::size_t k = 0; k < p.size(); ++k) p.column(field, c)[k] = random(low, high);
}

inline Vec3 vector(const PhaseParticles& p, Field field, std::size_t k) {
  Vec3 v{};
  for (int d = 0; d < p.dimensions(); ++d) v[static_cast<std::size_t>(d)] = p.column(field, d)[k];
  return v;
}
inline Vec3 position(const PhaseParticles& p, std::size_t k) { return vector(p, Field::position, k); }

/// The all-pairs twin: calls f(j, r, shift) for every particle j of `b`, and every periodic image of it, closer to
/// particle i of `a` than the radius; r = x_i - x_j - shift * period. `same`: both are one phase, i itself is left out.
template <class F>
void for_all_pairs(const Bounds& bounds, const PhaseParticles& a, std::size_t i, const PhaseParticles& b, bool same,
                   double radius, F&& f) {
  std::array<int, 3> turns{0, 0, 0};
  Vec3 period{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds.dimensions); ++d)
    if (bounds.periodic[d]) {
      period[d] = bounds.high[d] - bounds.low[d];
      turns[d] = static_cast<int>((radius + 1.0) / period[d]) + 1;  // particles may have left the box by 1
    }
  const Vec3 x = position(a, i);
  for (std::size_t j = 0; j < b.size(); ++j) {
    const Vec3 y = position(b, j);
    std::array<int, 3> s{};
    for (s[2] = -turns[2]; s[2] <= turns[2]; ++s[2])
      for (s[1] = -turns[1]; s[1] <= turns[1]; ++s[1])
        for (s[0] = -turns[0]; s[0] <= turns[0]; ++s[0]) {
          if (same && i == j && s == std::array<int, 3>{0, 0, 0}) continue;
          const Vec3 r{x[0] - y[0] - s[0] * period[0], x[1] - y[1] - s[1] * period[1], x[2] - y[2] - s[2] * period[2]};
          if (dot(r, r) < radius * radius) f(j, r, s);
        }
  }
}

/// Phases that have found their neighbours, with packed motion records: what the passes take.
struct Cast {
  Bounds bounds;
  std::vector<PhaseParticles> phases;
  std::vector<Direction> directions;
  Neighbours neighbours;
  std::vector<RecordArray> motion;

  Cast(const Bounds& b, std::vector<PhaseParticles> p, std::vector<Direction> d, double skin = 0.1,
       std::size_t padding = simd::width_in_use<double>())
      : bounds(b),
        phases(std::move(p)),
        directions(std::move(d)),
        neighbours(bounds, directions, skin, std::vector(phases.size(), 1.0), padding) {
    neighbours.update(phases, true);
    for (const auto& q : phases)
      motion.emplace_back(q.dimensions() == 2 ? MotionRecord<2>::size : MotionRecord<3>::size);
    pack();
  }

  /// Motion records from the fields; a phase without density has its particles' volume from `volume`.
  void pack(double volume = 1.0) {
    for (std::size_t q = 0; q < phases.size(); ++q) {
      const PhaseParticles& p = phases[q];
      if (!neighbours.has_grid(q)) continue;
      const auto n = static_cast<std::size_t>(p.dimensions());
      motion[q].resize(p.size(), neighbours.grid(q).images());
      for (std::size_t k = 0; k < p.size(); ++k) {
        const Vec3 x = position(p, k), v = p.has(Field::velocity) ? vector(p, Field::velocity, k) : Vec3{};
        for (std::size_t d = 0; d < n; ++d) {
          motion[q][k][d] = x[d];
          motion[q][k][n + d] = v[d];
        }
        motion[q][k][2 * n] = p.has(Field::pressure) ? p.column(Field::pressure)[k] : 0.0;
        motion[q][k][2 * n + 1] = p.has(Field::density) ? p.mass() / p.column(Field::density)[k] : volume;
      }
      motion[q].fill_images(neighbours.grid(q), p.dimensions());
    }
  }
  const PairList& list(std::size_t direction) const { return neighbours.list(direction); }
};

/// The largest difference of two columns over the largest magnitude of the second.
inline double difference(const double* a, const std::vector<double>& b) {
  double worst = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    if (!(std::abs(a[k] - b[k]) <= worst)) worst = std::abs(a[k] - b[k]);
    scale = std::max(scale, std::abs(b[k]));
  }
  return scale > 0.0 ? worst / scale : std::numeric_limits<double>::infinity();  // a twin of zeros shows nothing
}

}  // namespace barchan::sets
