// Places that are taken: the search through grids against all pairs, and what it compares among unequal spacings.
#include "start/places.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "start/random.hpp"

namespace barchan {
namespace {

struct Particle {
  Vec3 x;
  double spacing;
};

PeriodicSpace unit_space(int dimensions, bool periodic) {
  Domain domain;
  domain.size = {1.0, 1.0, dimensions == 3 ? 1.0 : 0.0};
  domain.periodic = {periodic, false, periodic && dimensions == 3};
  return PeriodicSpace(domain);
}

/// Particles of one spacing in 100, 10 or 1 parts of `largest`, at random.
std::vector<Particle> mixed(int dimensions, double largest, int count) {
  Random random(7);
  std::vector<Particle> particles;
  for (int k = 0; k < count; ++k) {
    const double share = k % 40 == 0 ? 1.0 : k % 4 == 0 ? 0.1 : 0.01;
    const Vec3 x{random.uniform(0.0, 1.0), random.uniform(0.0, 1.0), dimensions == 3 ? random.uniform(0.0, 1.0) : 0.0};
    particles.push_back({x, share * largest * random.uniform(0.8, 1.0)});
  }
  return particles;
}

int naive_owner(const PeriodicSpace& space, const std::vector<Particle>& all, const Particle& of, double distance,
                int except) {
  int owner = -1;
  double nearest = 1e300;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double r = space.distance(of.x, all[k].x);
    if (static_cast<int>(k) == except || !(r < nearest) || !(r < distance * 0.5 * (of.spacing + all[k].spacing)))
      continue;
    nearest = r;
    owner = static_cast<int>(k);
  }
  return owner;
}

TEST(Places, FindTheNearestOfAllPairsAmongUnequalSpacings) {
  for (const int dimensions : {2, 3})
    for (const bool periodic : {false, true})
      for (const double largest : {0.1, 0.45}) {
        const PeriodicSpace space = unit_space(dimensions, periodic);
        const std::vector<Particle> all = mixed(dimensions, largest, 1200);
        Places places(space, largest);
        for (std::size_t k = 0; k < all.size(); ++k) places.add(all[k].x, all[k].spacing, static_cast<int>(k));
        int found = 0;
        for (std::size_t k = 0; k < all.size(); ++k)
          for (const double distance : {1.0, 0.5}) {
            const int self = static_cast<int>(k), naive = naive_owner(space, all, all[k], distance, self);
            ASSERT_EQ(places.owner_near(all[k].x, all[k].spacing, distance, self), naive) << dimensions << " " << k;
            found += naive >= 0 ? 1 : 0;
          }
        EXPECT_GT(found, 30);
      }
}

// Small ones are compared with a handful each, however large the one large particle is.
TEST(Places, AreComparedWithThoseWithinReachOnly) {
  const double small = 0.01;
  for (const double large : {0.01, 0.5}) {
    Places places(unit_space(2, false), large);
    std::size_t count = 0;
    for (double x = 0.005; x < 1.0; x += small)
      for (double y = 0.005; y < 0.5; y += small, ++count) {
        EXPECT_EQ(places.owner_near({x, y, 0.0}, small, 0.9), -1);
        places.add({x, y, 0.0}, small, 0);
      }
    EXPECT_LT(places.compared(), 12 * count) << large;
    EXPECT_EQ(places.owner_near({0.5, 0.76, 0.0}, large, 0.9), -1);
    EXPECT_EQ(places.owner_near({0.5, 0.6, 0.0}, large, 0.9), large > 0.1 ? 0 : -1);
    EXPECT_LT(places.compared(), 13 * count) << large;
  }
}

}  // namespace
}  // namespace barchan
