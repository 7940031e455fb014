// What a place gives the air's particles, they get: models/coupling/air_grid.hpp.
#include "models/coupling/air_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/particle_sets.hpp"

namespace barchan {
namespace {

Bounds flat_box() {
  Bounds bounds;
  bounds.dimensions = 2;
  bounds.low = {0.0, 0.0, 0.0};
  bounds.high = {8.0, 6.0, 0.0};
  bounds.periodic = {true, false, false};
  return bounds;
}

/// A disturbed square lattice of air whose velocity is (2 + y, 0).
PhaseParticles air_of() {
  PhaseParticles p("air", 2, 48, 0.7, 0);
  for (const Field f : {Field::position, Field::velocity, Field::drag_acceleration}) p.add(f);
  sets::Uniform random(5);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const std::size_t column = k % 8, row = k / 8;
    const double x = static_cast<double>(column) + 0.5 + random(-0.15, 0.15);
    const double y = static_cast<double>(row) + 0.5 + random(-0.15, 0.15);
    p.column(Field::position, 0)[k] = x;
    p.column(Field::position, 1)[k] = y;
    p.column(Field::velocity, 0)[k] = 2.0 + y;
  }
  return p;
}

TEST(AirGrid, GivesTheParticlesWhatItGot) {
  PhaseParticles p = air_of();
  AirGrid grid(flat_box(), 1.0);
  grid.gather(p);
  grid.push({7.9, 3.3}, {1.5, -0.25});  // about the periodic side
  grid.push({2.2, 0.1}, {-4.0, 0.5});   // beside a closed one
  grid.give(p);
  double fx = 0.0, fy = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    fx += p.mass() * p.column(Field::drag_acceleration, 0)[k];
    fy += p.mass() * p.column(Field::drag_acceleration, 1)[k];
  }
  EXPECT_NEAR(fx, -2.5, 1e-13);
  EXPECT_NEAR(fy, 0.25, 1e-13);
  EXPECT_EQ(grid.lost()[0], 0.0);
  grid.gather(p);
  grid.give(p);
  EXPECT_EQ(p.column(Field::drag_acceleration, 0)[5], 0.0) << "forces are those since the last gathering";
}

TEST(AirGrid, GivesWhatItGotInThreeDimensions) {
  Bounds bounds = flat_box();
  bounds.dimensions = 3;
  bounds.high[2] = 4.0;
  bounds.periodic = {true, false, true};
  PhaseParticles p("air", 3, 8 * 6 * 4, 0.7, 0);
  for (const Field f : {Field::position, Field::velocity, Field::drag_acceleration}) p.add(f);
  sets::Uniform random(5);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const std::array<std::size_t, 3> at{k % 8, k / 8 % 6, k / 48};
    for (int d = 0; d < 3; ++d)
      p.column(Field::position, d)[k] =
          static_cast<double>(at[static_cast<std::size_t>(d)]) + 0.5 + random(-0.15, 0.15);
    p.column(Field::velocity, 0)[k] = 2.0 + p.column(Field::position, 1)[k];
    p.column(Field::velocity, 2)[k] = -1.0;
  }
  AirGrid grid(bounds, 1.0);
  grid.gather(p);
  const Vec3 wind = grid.velocity({3.7, 3.0, 3.9});
  EXPECT_NEAR(wind[0], 5.0, 0.15);
  EXPECT_NEAR(wind[2], -1.0, 1e-12);
  EXPECT_NEAR(grid.density({3.7, 3.0, 3.9}), 0.7, 0.1);
  const Vec3 force{1.5, -0.25, 3.0};
  grid.push({7.9, 3.3, 3.9}, force);  // about both periodic sides
  grid.give(p);
  for (int d = 0; d < 3; ++d) {
    double sum = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k) sum += p.mass() * p.column(Field::drag_acceleration, d)[k];
    EXPECT_NEAR(sum, force[static_cast<std::size_t>(d)], 1e-12);
  }
}

/// Half of the nodes about the place have no air: those that have it take all of the force.
TEST(AirGrid, SharesAForceOutAsAWholeBesideNodesWithoutAir) {
  PhaseParticles p("air", 2, 1, 0.7, 0);
  for (const Field f : {Field::position, Field::velocity, Field::drag_acceleration}) p.add(f);
  p.column(Field::position, 0)[0] = 3.2;
  p.column(Field::position, 1)[0] = 3.3;
  AirGrid grid(flat_box(), 1.0);
  grid.gather(p);
  grid.push({4.6, 3.5}, {1.5, -0.25});
  grid.give(p);
  EXPECT_NEAR(0.7 * p.column(Field::drag_acceleration, 0)[0], 1.5, 1e-13);
  EXPECT_NEAR(0.7 * p.column(Field::drag_acceleration, 1)[0], -0.25, 1e-13);
}

/// What brakes the air's eddies is shared out as a force is: sum m_a s_a = sum m rate of the grains.
TEST(AirGrid, SharesGrainsOut) {
  PhaseParticles p = air_of();
  AirGrid grid(flat_box(), 1.0);
  std::vector<GrainsInEddies> of(p.size());
  grid.gather(p);
  grid.give_grains(p, of.data());
  for (const GrainsInEddies& one : of) EXPECT_EQ(one.rate, 0.0) << "none are there";
  grid.put({7.9, 3.3}, 0.3, 4.0);
  grid.put({2.2, 0.1}, 0.1, 7.0);
  grid.give_grains(p, of.data());
  double sum = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    sum += p.mass() * of[k].rate;
    if (of[k].rate > 0.0 && p.column(Field::position, 0)[k] > 4.0) { EXPECT_NEAR(of[k].response, 0.25, 1e-12); }
  }
  EXPECT_NEAR(sum, 0.3 * 4.0 + 0.1 * 7.0, 1e-12);
  grid.gather(p);
  grid.give_grains(p, of.data());
  EXPECT_EQ(of[30].rate, 0.0) << "they are those since the last gathering";
}

TEST(AirGrid, FindsTheMeanWindAboutAPlace) {
  PhaseParticles p = air_of();
  AirGrid grid(flat_box(), 1.0);
  grid.gather(p);
  for (const double y : {1.4, 3.0, 4.7}) EXPECT_NEAR(grid.velocity({3.7, y})[0], 2.0 + y, 0.15) << y;
  EXPECT_NEAR(grid.velocity({7.99, 3.0})[0], grid.velocity({-0.01, 3.0})[0], 1e-12) << "periodic";
  PhaseParticles none("air", 2, 0, 0.7, 0);
  for (const Field f : {Field::position, Field::velocity, Field::drag_acceleration}) none.add(f);
  grid.gather(none);
  EXPECT_EQ(grid.velocity({3.7, 3.0})[0], 0.0);
  grid.push({3.7, 3.0}, {1.0, 2.0});
  EXPECT_EQ(grid.lost()[1], 2.0) << "no air is there to take it";
}

}  // namespace
}  // namespace barchan
