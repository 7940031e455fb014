// Records of motion have the numbers of their columns, however many particles there are.
#include "models/packing.hpp"

#include <gtest/gtest.h>

namespace barchan {
namespace {

template <int Dim>
void expect_packed(std::size_t n, const MotionPacking& how) {
  using R = MotionRecord<Dim>;
  PhaseParticles p("air", Dim, n, 2.0, 0);
  for (const Field field : {Field::position, Field::velocity, Field::pressure, Field::density}) p.add(field);
  for (int d = 0; d < Dim; ++d)
    for (std::size_t k = 0; k < n; ++k) {
      p.column(Field::position, d)[k] = 10.0 * static_cast<double>(k) + d;
      p.column(Field::velocity, d)[k] = -10.0 * static_cast<double>(k) - d;
    }
  for (std::size_t k = 0; k < n; ++k) {
    p.column(Field::pressure)[k] = 0.5 + static_cast<double>(k);
    p.column(Field::density)[k] = 1.0 + 0.25 * static_cast<double>(k);
  }
  RecordArray records(R::size);
  records.resize(n, 0);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t f = 2 * Dim + 2; f < R::size; ++f) records[k][f] = 77.0;  // not its own
  pack_motion(p, records, how, 3.0);
  for (std::size_t k = 0; k < n; ++k) {
    const double* r = records[k];
    for (std::size_t d = 0; d < Dim; ++d) {
      EXPECT_EQ(r[R::position + d], p.column(Field::position, static_cast<int>(d))[k]) << k;
      EXPECT_EQ(r[R::velocity + d], p.column(Field::velocity, static_cast<int>(d))[k]) << k;
    }
    EXPECT_EQ(r[R::pressure], how.pressure ? 0.5 + static_cast<double>(k) : 0.0) << k;
    const bool own = how.pressure && !how.fixed_volume;
    EXPECT_EQ(r[R::volume], own ? 2.0 / p.column(Field::density)[k] : 3.0) << k;
    for (std::size_t f = 2 * Dim + 2; f < R::size; ++f) EXPECT_EQ(r[f], 77.0) << k;
  }
}

TEST(Packing, RecordsHaveTheNumbersOfTheColumns) {
  for (const std::size_t n : {1u, 3u, 4u, 5u, 11u})
    for (const MotionPacking how : {MotionPacking{}, MotionPacking{true, false}, MotionPacking{true, true}}) {
      expect_packed<2>(n, how);
      expect_packed<3>(n, how);
    }
}

}  // namespace
}  // namespace barchan
