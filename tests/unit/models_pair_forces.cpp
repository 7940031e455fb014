// The drag of grains in a fluid against its naive twin, from both sides, and action and reaction.
#include "models/pair_forces.hpp"

#include <gtest/gtest.h>

#include "unit/naive_fluid.hpp"

namespace barchan {
namespace {

using namespace sets;

class DragPass : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, DragPass, ::testing::Values(2, 3));

// -K V_f W |v_ab| v_ab, V_f the volume of the fluid particle, seen from the grains and from the fluid.
TEST_P(DragPass, EqualsTheNaiveSumsAndActsBack) {
  const int dimensions = GetParam();
  constexpr double radius = 2.5, strength = 0.8;
  Uniform random(51);
  const Bounds b = dimensions == 2 ? box(2, {8, 7, 0}, {true, false, false}) : box(3, {6, 5, 6}, {true, false, true});
  const std::vector<Field> fields{Field::velocity, Field::density, Field::acceleration};
  std::vector<PhaseParticles> two;
  two.push_back(phase(dimensions, lattice(b, 1.0, 0.2, random), 1.2, fields));
  two.push_back(phase(dimensions, scattered(b, 20, random), 2000.0, fields, 1000));
  for (auto& p : two) {
    randomise(p, Field::velocity, -2, 3, random);
    randomise(p, Field::density, 0.9, 1.1, random);
  }
  Cast cast(b, std::move(two), {{0, 1, radius}, {1, 0, radius}});
  constexpr double density = 1.2;
  const GrainBarrier barrier{0.6, 4.0, 0.04};
  int pushed = 0;
  Vec3 sum{}, size{};
  for (std::size_t a = 0; a < 2; ++a) {
    auto& p = cast.phases[a];
    const PhaseParticles& other = cast.phases[1 - a];
    std::array<std::vector<double>, 3> expected;
    for (std::size_t k = 0; k < p.size(); ++k) {
      Vec3 force{};
      for_all_pairs(b, p, k, other, false, radius, [&](std::size_t j, const Vec3& r, const std::array<int, 3>&) {
        const double fluid_volume = a == 0 ? naive::volume(p, k) : naive::volume(other, j);
        const Vec3 v = vector(p, Field::velocity, k) - vector(other, Field::velocity, j);
        force = force - strength * fluid_volume * naive::weight(KernelKind::wendland_c2, radius, dimensions, norm(r)) *
                            norm(v) * v;
        // The barrier: a spring below r0 and a dashpot on approach, for slow air alone.
        const double gap = barrier.distance - norm(r), slow = 1.0 - barrier.fast * dot(v, v);
        if (gap <= 0.0 || slow <= 0.0) return;
        ++pushed;
        const double approach = std::min(dot(v, r) / norm(r), 0.0);
        force = force + slow * density * fluid_volume * (barrier.rate * barrier.rate * gap - barrier.rate * approach) /
                            norm(r) * r;
      });
      for (std::size_t d = 0; d < 3; ++d) expected[d].push_back(force[d] / p.mass());
    }
    pair_forces(p, cast.motion[a],
                PairEntry<DragAndBarrier>{&cast.list(a), &cast.motion[1 - a], KernelKind::wendland_c2, radius,
                                          DragAndBarrier{{}, strength, density, barrier, a == 0}});
    for (int d = 0; d < dimensions; ++d)
      EXPECT_LT(difference(p.column(Field::acceleration, d), expected[static_cast<std::size_t>(d)]), 1e-12);
    for (std::size_t k = 0; k < p.size(); ++k)
      for (std::size_t d = 0; d < 3; ++d) {
        sum[d] += p.mass() * vector(p, Field::acceleration, k)[d];
        size[d] += std::abs(p.mass() * vector(p, Field::acceleration, k)[d]);
      }
  }
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) EXPECT_NEAR(sum[d] / size[d], 0.0, 1e-13);
  EXPECT_GT(pushed, 4);
}

}  // namespace
}  // namespace barchan
