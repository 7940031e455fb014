// Short vectors: every operation gives, lane by lane, what numbers give, for every width from one to two registers of
// doubles and floats; compressing, transposing and summing are compared with plain loops.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "simd/vec.hpp"

namespace barchan::simd {
namespace {

template <class T, int W>
struct Of {
  using value = T;
  using V = Vec<T, W>;
  using M = Mask<T, W>;
  static constexpr int width = W;
};

template <class Type>
class Vectors : public ::testing::Test {};

using Types = ::testing::Types<Of<double, 1>, Of<double, 2>, Of<double, 4>, Of<double, 8>, Of<double, 16>, Of<float, 1>,
                               Of<float, 2>, Of<float, 4>, Of<float, 8>, Of<float, 16>>;
TYPED_TEST_SUITE(Vectors, Types);

#define IN_TYPED_TEST                                   \
  using T [[maybe_unused]] = typename TypeParam::value; \
  using V [[maybe_unused]] = typename TypeParam::V;     \
  [[maybe_unused]] constexpr int W = TypeParam::width

/// Numbers of every size and sign; not inlined, so that no compiler works them out in two ways.
template <class T, int W>
[[gnu::noinline]] std::array<T, W> numbers(int seed) {
  std::array<T, W> a;
  for (int k = 0; k < W; ++k) {
    const int q = (k + 3 * seed) * 37 % 101 - 50;
    a[static_cast<std::size_t>(k)] = static_cast<T>(q * 0.37 + 0.011 * seed);
  }
  return a;
}

/// What the vectors' operation gives is, in every lane, what the numbers' operation gives.
template <class T, int W, class Op, class Expected>
void expect_lanes(Op&& op, Expected&& expected) {
  for (int seed = 0; seed < 40; ++seed) {
    const auto a = numbers<T, W>(seed), b = numbers<T, W>(seed + 7);
    const Vec<T, W> r = op(Vec<T, W>::load(a.data()), Vec<T, W>::load(b.data()));
    for (int k = 0; k < W; ++k) {
      const auto q = static_cast<std::size_t>(k);
      EXPECT_EQ(r[k], expected(a[q], b[q])) << "lane " << k << " of " << a[q] << ", " << b[q];
    }
  }
}

TYPED_TEST(Vectors, LoadStoreAndBroadcast) {
  IN_TYPED_TEST;
  alignas(64) std::array<T, W + 2> from{}, to{};
  std::iota(from.begin(), from.end(), T(1));
  const V v = V::load(from.data() + 1);
  v.store(to.data() + 1);
  EXPECT_EQ(to[0], T(0));
  EXPECT_EQ(to[W + 1], T(0));
  for (int k = 0; k < W; ++k) {
    EXPECT_EQ(v[k], T(k + 2));
    EXPECT_EQ(to[static_cast<std::size_t>(k + 1)], T(k + 2));
    EXPECT_EQ(V(T(3.5))[k], T(3.5));
    EXPECT_TRUE(std::signbit(V(-T(0))[k])) << "minus zero is kept";
    EXPECT_EQ(V::iota()[k], T(k));
  }
  V::load_aligned(from.data()).store_aligned(to.data());
  for (std::size_t k = 0; k < W; ++k) EXPECT_EQ(to[k], from[k]);
}

TYPED_TEST(Vectors, Arithmetic) {
  IN_TYPED_TEST;
  expect_lanes<T, W>([](V a, V b) { return a + b; }, [](T a, T b) { return a + b; });
  expect_lanes<T, W>([](V a, V b) { return a - b; }, [](T a, T b) { return a - b; });
  expect_lanes<T, W>([](V a, V b) { return a * b; }, [](T a, T b) { return a * b; });
  expect_lanes<T, W>([](V a, V b) { return a / b; }, [](T a, T b) { return a / b; });
  expect_lanes<T, W>([](V a, V) { return -a; }, [](T a, T) { return -a; });
  expect_lanes<T, W>(
      [](V a, V b) {
        a += b;
        a -= V(T(2));
        a *= b;
        return a;
      },
      [](T a, T b) {
        a += b;
        a -= T(2);
        return a * b;
      });
  expect_lanes<T, W>([](V a, V b) { return min(a, b); }, [](T a, T b) { return std::min(a, b); });
  expect_lanes<T, W>([](V a, V b) { return max(a, b); }, [](T a, T b) { return std::max(a, b); });
  expect_lanes<T, W>([](V a, V) { return simd::sqrt(max(a, -a)); }, [](T a, T) { return std::sqrt(std::abs(a)); });
}

TYPED_TEST(Vectors, FusedMultiplyAdd) {
  IN_TYPED_TEST;
  const T one(1), tiny = std::numeric_limits<T>::epsilon();
#if defined(__FMA__)
  // (1 + e)(1 - e) - 1 = -e^2: only a single rounding sees it.
  for (int k = 0; k < W; ++k) EXPECT_EQ(fma(V(one + tiny), V(one - tiny), V(-one))[k], -tiny * tiny);
  expect_lanes<T, W>([](V a, V b) { return fma(a, b, V(T(0.7))); }, [](T a, T b) { return std::fma(a, b, T(0.7)); });
#endif
  for (int k = 0; k < W; ++k) {
    EXPECT_NEAR(fma(V(T(3)), V(T(5)), V(T(2)))[k], 17 * one, 20 * tiny);
    EXPECT_NEAR(fnma(V(T(3)), V(T(5)), V(T(2)))[k], -13, 20 * tiny);
  }
}

TYPED_TEST(Vectors, InverseRootsAreGoodToTwoUnits) {
  IN_TYPED_TEST;
  for (int power = -100; power <= 100; power += 3) {
    std::array<T, W> a;
    for (int k = 0; k < W; ++k)
      a[static_cast<std::size_t>(k)] = static_cast<T>(std::ldexp(1.0 + 0.999 * k / W + 0.001 * (power & 7), power));
    const V v = V::load(a.data());
    for (int k = 0; k < W; ++k) {
      const auto exact = static_cast<T>(1.0L / std::sqrt(static_cast<long double>(a[static_cast<std::size_t>(k)])));
      const auto inverted = static_cast<T>(1.0L / static_cast<long double>(a[static_cast<std::size_t>(k)]));
      const T unit = std::numeric_limits<T>::epsilon();
      EXPECT_NEAR(inverse_sqrt(v)[k] / exact, 1, 3 * unit);
      EXPECT_NEAR(root(v)[k] * exact, 1, 4 * unit);
      EXPECT_NEAR(inverse(v)[k] / inverted, 1, 3 * unit);
    }
  }
}

// The least squared distance that pair loops make (least_square in engine/pair_loop.hpp) is in the range, on estimates
// and on the divider.
TYPED_TEST(Vectors, InverseRootsReachTheEndsOfTheirRange) {
  IN_TYPED_TEST;
  for (const double a : {1.0e-37, 8.0e37}) {
    const T exact = static_cast<T>(1.0 / std::sqrt(a)), unit = std::numeric_limits<T>::epsilon();
    for (int k = 0; k < W; ++k) {
      EXPECT_NEAR(inverse_sqrt(V(static_cast<T>(a)))[k] / exact, 1, 4 * unit) << a;
      EXPECT_NEAR(root(V(static_cast<T>(a)))[k] * exact, 1, 5 * unit) << a;
    }
  }
}

TYPED_TEST(Vectors, ComparisonsAndMasks) {
  IN_TYPED_TEST;
  using M = typename TypeParam::M;
  for (int seed = 0; seed < 40; ++seed) {
    auto a = numbers<T, W>(seed), b = numbers<T, W>(seed + 11);
    for (std::size_t k = 0; k < W; k += 3) b[k] = a[k];
    if (seed % 4 == 0) a[W / 2] = std::numeric_limits<T>::quiet_NaN();
    const V v = V::load(a.data()), w = V::load(b.data());
    std::uint32_t less = 0, less_equal = 0, equal = 0, greater = 0, greater_equal = 0;
    for (std::size_t k = 0; k < W; ++k) {
      less |= std::uint32_t(a[k] < b[k]) << k;
      less_equal |= std::uint32_t(a[k] <= b[k]) << k;
      equal |= std::uint32_t(a[k] == b[k]) << k;
      greater |= std::uint32_t(a[k] > b[k]) << k;
      greater_equal |= std::uint32_t(a[k] >= b[k]) << k;
    }
    const auto every = static_cast<std::uint32_t>((std::uint64_t{1} << W) - 1);
    EXPECT_EQ(to_bits(v < w), less);
    EXPECT_EQ(to_bits(v <= w), less_equal);
    EXPECT_EQ(to_bits(v == w), equal);
    EXPECT_EQ(to_bits(v > w), greater);
    EXPECT_EQ(to_bits(v >= w), greater_equal);
    EXPECT_EQ(to_bits(v != w), every & ~equal);
    EXPECT_EQ(to_bits((v <= w) & (v >= w)), equal);
    EXPECT_EQ(to_bits((v < w) | (v > w)), less | greater);
    EXPECT_EQ(to_bits(!(v < w)), every & ~less);
    EXPECT_EQ(count(v < w), std::popcount(less));
    EXPECT_EQ(any(v < w), less != 0);
    EXPECT_EQ(all(v < w), less == every);
    for (int k = 0; k < W; ++k) {
      const auto q = static_cast<std::size_t>(k);
      EXPECT_EQ(select(v < w, V(T(2)), w)[k], less >> k & 1 ? T(2) : b[q]);
      EXPECT_EQ(mask_zero(v < w, v)[k], less >> k & 1 ? a[q] : T(0));
    }
  }
  for (int n = -1; n <= W + 1; ++n) {
    const int kept = std::clamp(n, 0, W);
    EXPECT_EQ(to_bits(M::first(n)), (std::uint64_t{1} << kept) - 1) << n;
  }
}

TYPED_TEST(Vectors, HalvesJoinAgain) {
  IN_TYPED_TEST;
  if constexpr (W > 1) {
    const auto a = numbers<T, W>(5);
    const V v = V::load(a.data());
    for (int k = 0; k < W / 2; ++k) {
      EXPECT_EQ(lower(v)[k], a[static_cast<std::size_t>(k)]);
      EXPECT_EQ(upper(v)[k], a[static_cast<std::size_t>(k + W / 2)]);
    }
    const V swapped = join(upper(v), lower(v));
    for (int k = 0; k < W; ++k) EXPECT_EQ(swapped[k], v[(k + W / 2) % W]);
  }
}

TYPED_TEST(Vectors, ConvertAndKeepBits) {
  IN_TYPED_TEST;
  const auto a = numbers<T, W>(9);
  const V v = V::load(a.data());
  const auto integers = convert<std::int32_t>(v);
  const auto other = convert<std::conditional_t<sizeof(T) == 8, float, double>>(v);
  for (int k = 0; k < W; ++k) {
    EXPECT_EQ(integers[k], static_cast<std::int32_t>(a[static_cast<std::size_t>(k)]));
    EXPECT_EQ(other[k], static_cast<decltype(other[k])>(a[static_cast<std::size_t>(k)]));
    EXPECT_EQ(convert<T>(integers)[k], static_cast<T>(integers[k]));
  }
  if constexpr (sizeof(T) == 4) {
    for (int k = 0; k < W; ++k) {
      EXPECT_EQ(bit_cast<std::int32_t>(v)[k], std::bit_cast<std::int32_t>(a[static_cast<std::size_t>(k)]));
    }
  }
}

/// Upper half onto lower half, again and again: the order that sum() promises.
template <class T>
T folded(std::vector<T> a) {
  for (std::size_t n = a.size() / 2; n >= 1; n /= 2)
    for (std::size_t k = 0; k < n; ++k) a[k] += a[k + n];
  return a[0];
}

TYPED_TEST(Vectors, SumsHaveAFixedOrder) {
  IN_TYPED_TEST;
  for (int seed = 0; seed < 20; ++seed) {
    std::array<V, 4> v;
    std::array<T, 4> expected;
    for (std::size_t q = 0; q < 4; ++q) {
      auto a = numbers<T, W>(seed + static_cast<int>(q));
      for (std::size_t k = 0; k < W; ++k) a[k] *= static_cast<T>(std::pow(10.0, double(k % 7)));  // order matters
      v[q] = V::load(a.data());
      expected[q] = folded(std::vector<T>(a.begin(), a.end()));
      EXPECT_EQ(sum(v[q]), expected[q]);
    }
    const auto four = sum(v[0], v[1], v[2], v[3]);
    for (std::size_t q = 0; q < 4; ++q) EXPECT_EQ(four[static_cast<int>(q)], expected[q]);
  }
}

TYPED_TEST(Vectors, CompressKeepsTheChosenInOrder) {
  IN_TYPED_TEST;
  using I = Vec<std::int32_t, W>;
  const std::uint32_t step = W == 16 ? 7 : 1;
  for (std::uint64_t bits = 0; bits < (std::uint64_t{1} << W); bits += step) {
    std::array<T, W> chosen{};
    for (std::size_t k = 0; k < W; ++k) chosen[k] = bits >> k & 1 ? T(1) : T(0);
    std::array<std::uint32_t, 2 * W> out;
    out.fill(99);
    const I index = I::iota() + I(1000);
    const int n = compress_store(out.data(), V::load(chosen.data()) > V(T(0)), index);
    ASSERT_EQ(n, std::popcount(bits));
    std::size_t place = 0;
    for (std::uint32_t k = 0; k < W; ++k)
      if (bits >> k & 1) { ASSERT_EQ(out[place++], 1000 + k) << "mask " << bits; }
    for (std::size_t k = W; k < 2 * W; ++k) ASSERT_EQ(out[k], 99u) << "wrote beyond its room";
  }
}

template <int Fields, class T, int W>
void expect_transposed(std::size_t stride) {
  std::vector<T> records(50 * stride);
  std::iota(records.begin(), records.end(), T(0));
  std::array<std::uint32_t, W> index;
  for (std::size_t k = 0; k < W; ++k) index[k] = static_cast<std::uint32_t>((k * 29 + 3) % 50);
  std::array<Vec<T, W>, Fields> out;
  load_transposed<Fields>(records.data(), stride, index.data(), out.data());
  const auto gathered = gather<T, W>(records.data(), index.data());
  for (int k = 0; k < W; ++k) {
    const std::uint32_t at = index[static_cast<std::size_t>(k)];
    for (std::size_t f = 0; f < Fields; ++f)
      ASSERT_EQ(out[f][k], records[at * stride + f]) << "field " << f << " lane " << k;
    ASSERT_EQ(gathered[k], records[at]);
  }
}

TYPED_TEST(Vectors, RecordsAreTransposed) {
  IN_TYPED_TEST;
  expect_transposed<4, T, W>(4);
  expect_transposed<8, T, W>(8);
  expect_transposed<8, T, W>(12);
  expect_transposed<16, T, W>(16);
}

TEST(FourDoubles, AreTransposed) {
  std::array<double, 16> rows;
  for (std::size_t k = 0; k < 16; ++k) rows[k] = static_cast<double>(k);
  using Four = Vec<double, 4>;
  std::array<Four, 4> v;
  for (std::size_t j = 0; j < 4; ++j) v[j] = Four::load(rows.data() + 4 * j);
  transpose(v[0], v[1], v[2], v[3]);
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(v[j][static_cast<int>(k)], rows[4 * k + j]) << j << " " << k;
}

TEST(FourDoubles, SwapTheLastTwo) {
  const double x[4] = {1, 2, 3, 4};
  const auto swapped = swap_last(Vec<double, 4>::load(x));
  for (int k = 0; k < 4; ++k) EXPECT_EQ(swapped[k], (std::array{1.0, 2.0, 4.0, 3.0}[static_cast<std::size_t>(k)]));
}

TEST(IntegerVectors, WrapAround) {
  const Vec<std::int32_t, 8> big(std::numeric_limits<std::int32_t>::max()), two(2);
  EXPECT_EQ((big + two)[3], std::numeric_limits<std::int32_t>::min() + 1);
  EXPECT_EQ((big * two)[5], -2);
  EXPECT_EQ((-two)[0], -2);
  EXPECT_EQ(to_bits(two < big), 0xffu);
}

}  // namespace
}  // namespace barchan::simd
