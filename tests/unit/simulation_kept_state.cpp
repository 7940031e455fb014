// The last good state: what a frame of it shows after particles left, entered or went to another rank.
#include "simulation/kept_state.hpp"

#include <gtest/gtest.h>

namespace barchan {
namespace {

PhaseParticles water(std::size_t n) {
  PhaseParticles p("water", 2, n, 1.0, 0);
  for (const Field field : {Field::position, Field::velocity, Field::acceleration}) p.add(field);
  for (std::size_t k = 0; k < n; ++k) p.column(Field::position, 0)[k] = 10.0 + static_cast<double>(k);
  return p;
}

void expect_state(const PhaseParticles& p, std::size_t n, double first, std::int64_t first_id) {
  ASSERT_EQ(p.size(), n);
  for (std::size_t k = 0; k < n; ++k) {
    EXPECT_EQ(p.column(Field::position, 0)[k], first + static_cast<double>(k)) << k;
    EXPECT_EQ(p.id()[k], first_id + static_cast<std::int64_t>(k)) << k;
  }
}

TEST(KeptState, IsExchangedWithAStateOfAnotherNumberOfParticles) {
  for (const std::size_t now : {3u, 5u, 8u}) {  // fewer than are kept, as many, more
    std::vector<PhaseParticles> phases;
    phases.push_back(water(5));
    KeptState kept(phases, {Field::position});
    kept.keep(phases, 1.0, 10);
    phases[0].resize(now);
    std::vector<std::int64_t> ids(now);
    for (std::size_t k = 0; k < now; ++k) {
      phases[0].column(Field::position, 0)[k] = 100.0 + static_cast<double>(k);
      ids[k] = 50 + static_cast<std::int64_t>(k);
    }
    phases[0].set_ids(ids);
    for (int twice = 0; twice < 2; ++twice) {
      kept.exchange(phases);
      expect_state(phases[0], 5, 10.0, 0);
      kept.exchange(phases);
      expect_state(phases[0], now, 100.0, 50);
    }
  }
}

}  // namespace
}  // namespace barchan
