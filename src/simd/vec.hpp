// Short vectors of W lanes with one source for AVX-512, AVX2, SSE2 and plain scalar code.
//
// Vec<T, W> holds W values of T (double, float or std::int32_t; W a power of two). It is stored
//   * as a plain T when W == 1 (the scalar twin),
//   * as one machine register when W * sizeof(T) <= max_bytes,
//   * as two halves, recursively, when it is wider than a register.
// The same kernel can therefore be compiled for any W on any machine; native_width<T> is the W of one register.
// Lane k is the k-th value in memory. Nothing here allocates, throws or depends on the rounding mode.
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "base/instructions.hpp"

#if defined(__SSE2__)
#pragma GCC diagnostic push
#if !defined(__clang__)  // GCC 12 warns about its own _mm512_undefined_pd()
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#pragma GCC diagnostic pop
#endif

#if !defined(BARCHAN_SIMD_INLINE)  // the build defines it as plain inline for the sanitizers
#define BARCHAN_SIMD_INLINE inline __attribute__((always_inline))
#endif

// One namespace for each instruction set: see base/instructions.hpp.
namespace barchan::simd {
inline namespace BARCHAN_TARGET {

// Bytes in the widest register the compiler may use.
inline constexpr int max_bytes = static_cast<int>(register_bytes(compiled_instructions));

// Lanes of T in one register.
template <class T>
inline constexpr int native_width = max_bytes / static_cast<int>(sizeof(T));

// The same of the registers that the hot files use (instructions()), which may be wider than those of this file.
template <class T>
constexpr std::size_t width_in_use() {
  return register_bytes(instructions()) / sizeof(T);
}

template <class T, int W>
struct Vec;
template <class T, int W>
struct Mask;

namespace detail {

enum class Kind { scalar, native, halves };

template <class T, int W>
inline constexpr int bytes = W* static_cast<int>(sizeof(T));

template <class T, int W>
inline constexpr Kind kind = W == 1                     ? Kind::scalar
                             : bytes<T, W> <= max_bytes ? Kind::native
                                                        : Kind::halves;

#if defined(__AVX512F__)
inline constexpr bool has_avx512 = true;
#else
inline constexpr bool has_avx512 = false;
#endif

// True where comparisons produce an AVX-512 bit mask instead of a vector of all-ones lanes.
template <class T, int W>
inline constexpr bool bit_mask = has_avx512&& kind<T, W> == Kind::native&& bytes<T, W> == 64;

// The signed integer with the size of T.
template <class T>
using Lane = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;

template <class T, int W>
struct Register {
  typedef T type __attribute__((vector_size(sizeof(T) * static_cast<std::size_t>(W))));
};

template <class Part>
struct Halves {
  Part lo, hi;
};

template <class T, int W, Kind K = kind<T, W>>
struct VecStorage;
template <class T, int W>
struct VecStorage<T, W, Kind::scalar> {
  using type = T;
};
template <class T, int W>
struct VecStorage<T, W, Kind::native> {
  using type = typename Register<T, W>::type;
};
template <class T, int W>
struct VecStorage<T, W, Kind::halves> {
  using type = Halves<Vec<T, W / 2>>;
};

template <class T, int W, Kind K = kind<T, W>, bool Bits = bit_mask<T, W>>
struct MaskStorage;
template <class T, int W>
struct MaskStorage<T, W, Kind::scalar, false> {
  using type = bool;
};
template <class T, int W>
struct MaskStorage<T, W, Kind::native, false> {
  using type = typename Register<Lane<T>, W>::type;
};
template <class T, int W>
struct MaskStorage<T, W, Kind::native, true> {
  using type = std::conditional_t<W == 8, std::uint8_t, std::uint16_t>;
};
template <class T, int W>
struct MaskStorage<T, W, Kind::halves, false> {
  using type = Halves<Mask<T, W / 2>>;
};

// Applies a lane-wise operator to the storage; integers wrap around. An operator cannot stand in parentheses:
// NOLINTBEGIN(bugprone-macro-parentheses)
#define BARCHAN_SIMD_ARITHMETIC(op)                                                                                  \
  if constexpr (kind<T, W> == Kind::halves) {                                                                        \
    return {{a.v.lo op b.v.lo, a.v.hi op b.v.hi}};                                                                   \
  } else if constexpr (std::is_integral_v<T> && W == 1) {                                                            \
    return {static_cast<T>(static_cast<std::make_unsigned_t<T>>(a.v) op static_cast<std::make_unsigned_t<T>>(b.v))}; \
  } else if constexpr (std::is_integral_v<T>) {                                                                      \
    using U = typename Register<std::make_unsigned_t<T>, W>::type;                                                   \
    using S = typename Vec<T, W>::Storage;                                                                           \
    return {reinterpret_cast<S>(reinterpret_cast<U>(a.v) op reinterpret_cast<U>(b.v))};                              \
  } else {                                                                                                           \
    return {a.v op b.v};                                                                                             \
  }

template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> add(Vec<T, W> a, Vec<T, W> b) {
  BARCHAN_SIMD_ARITHMETIC(+)
}
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> subtract(Vec<T, W> a, Vec<T, W> b) {
  BARCHAN_SIMD_ARITHMETIC(-)
}
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> multiply(Vec<T, W> a, Vec<T, W> b) {
  BARCHAN_SIMD_ARITHMETIC(*)
}
#undef BARCHAN_SIMD_ARITHMETIC
// NOLINTEND(bugprone-macro-parentheses)

template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> divide(Vec<T, W> a, Vec<T, W> b) {
  if constexpr (kind<T, W> == Kind::halves) return {{a.v.lo / b.v.lo, a.v.hi / b.v.hi}};
  else return {a.v / b.v};
}

enum class Relation { less, less_equal, equal };

template <Relation R, class T, int W>
BARCHAN_SIMD_INLINE Mask<T, W> compare(Vec<T, W> a, Vec<T, W> b) {
  using M = typename Mask<T, W>::Storage;
  if constexpr (kind<T, W> == Kind::halves) {
    return {{compare<R>(a.v.lo, b.v.lo), compare<R>(a.v.hi, b.v.hi)}};
  } else if constexpr (bit_mask<T, W>) {
#if defined(__AVX512F__)
    if constexpr (std::is_same_v<T, double>) {
      constexpr int p = R == Relation::less ? _CMP_LT_OQ : R == Relation::less_equal ? _CMP_LE_OQ : _CMP_EQ_OQ;
      return {_mm512_cmp_pd_mask(a.v, b.v, p)};
    } else if constexpr (std::is_same_v<T, float>) {
      constexpr int p = R == Relation::less ? _CMP_LT_OQ : R == Relation::less_equal ? _CMP_LE_OQ : _CMP_EQ_OQ;
      return {_mm512_cmp_ps_mask(a.v, b.v, p)};
    } else {
      constexpr auto p = R == Relation::less         ? _MM_CMPINT_LT
                         : R == Relation::less_equal ? _MM_CMPINT_LE
                                                     : _MM_CMPINT_EQ;
      return {_mm512_cmp_epi32_mask(reinterpret_cast<__m512i>(a.v), reinterpret_cast<__m512i>(b.v), p)};
    }
#endif
  } else if constexpr (W == 1) {
    if constexpr (R == Relation::less) return {a.v < b.v};
    else if constexpr (R == Relation::less_equal) return {a.v <= b.v};
    else return {!(a.v < b.v) && !(b.v < a.v) && a.v <= b.v};
  } else {
    if constexpr (R == Relation::less) return {reinterpret_cast<M>(a.v < b.v)};
    else if constexpr (R == Relation::less_equal) return {reinterpret_cast<M>(a.v <= b.v)};
    else return {reinterpret_cast<M>(a.v <= b.v) & reinterpret_cast<M>(b.v <= a.v)};
  }
}

}  // namespace detail

// W true/false lanes, the result of comparing two Vec<T, W>.
template <class T, int W>
struct Mask {
  using Storage = typename detail::MaskStorage<T, W>::type;
  static constexpr int width = W;
  Storage v;

  // Lanes 0 .. n-1 true, the others false (n may exceed W).
  static BARCHAN_SIMD_INLINE Mask first(int n);

  friend BARCHAN_SIMD_INLINE Mask operator&(Mask a, Mask b) {
    if constexpr (detail::kind<T, W> == detail::Kind::halves) return {{a.v.lo & b.v.lo, a.v.hi & b.v.hi}};
    else return {static_cast<Storage>(a.v & b.v)};
  }
  friend BARCHAN_SIMD_INLINE Mask operator|(Mask a, Mask b) {
    if constexpr (detail::kind<T, W> == detail::Kind::halves) return {{a.v.lo | b.v.lo, a.v.hi | b.v.hi}};
    else return {static_cast<Storage>(a.v | b.v)};
  }
  friend BARCHAN_SIMD_INLINE Mask operator!(Mask a) {
    if constexpr (detail::kind<T, W> == detail::Kind::halves) return {{!a.v.lo, !a.v.hi}};
    else if constexpr (W == 1) return {!a.v};
    else return {static_cast<Storage>(~a.v)};
  }
};

// W values of T with lane-wise arithmetic. A T converts to a Vec with that value in every lane.
template <class T, int W>
struct Vec {
  static_assert(W >= 1 && (W & (W - 1)) == 0, "the width must be a power of two");
  using Storage = typename detail::VecStorage<T, W>::type;
  using value_type = T;
  static constexpr int width = W;
  Storage v;

  // Uninitialised.
  Vec() = default;
  // Wraps a register.
  BARCHAN_SIMD_INLINE Vec(Storage s) requires(W > 1) : v(s) {}
  // The same value in every lane.
  BARCHAN_SIMD_INLINE Vec(T s) {
    if constexpr (detail::kind<T, W> == detail::Kind::halves) v = {Vec<T, W / 2>(s), Vec<T, W / 2>(s)};
    else if constexpr (W == 1) v = s;
    else v = s - Storage{};  // x - 0 keeps every x, even -0.0
  }
  // 0, 1, .. W-1.
  static BARCHAN_SIMD_INLINE Vec iota() {
    alignas(64) T a[W];
    for (int k = 0; k < W; ++k) a[k] = static_cast<T>(k);
    return load(a);
  }
  // W consecutive values from any address.
  static BARCHAN_SIMD_INLINE Vec load(const T* p) {
    Vec r;
    if constexpr (detail::kind<T, W> == detail::Kind::halves)
      r.v = {Vec<T, W / 2>::load(p), Vec<T, W / 2>::load(p + W / 2)};
    else std::memcpy(&r.v, p, sizeof(r.v));
    return r;
  }
  // W consecutive values from an address that is a multiple of W * sizeof(T).
  static BARCHAN_SIMD_INLINE Vec load_aligned(const T* p) {
    return load(static_cast<const T*>(__builtin_assume_aligned(p, sizeof(T) * static_cast<std::size_t>(W))));
  }
  // Stores W consecutive values to any address.
  BARCHAN_SIMD_INLINE void store(T* p) const {
    if constexpr (detail::kind<T, W> == detail::Kind::halves) {
      v.lo.store(p);
      v.hi.store(p + W / 2);
    } else {
      std::memcpy(p, &v, sizeof(v));
    }
  }
  // Stores W consecutive values to an address that is a multiple of W * sizeof(T).
  BARCHAN_SIMD_INLINE void store_aligned(T* p) const {
    store(static_cast<T*>(__builtin_assume_aligned(p, sizeof(T) * static_cast<std::size_t>(W))));
  }
  // The value of lane k (slow: for tests and set-up).
  BARCHAN_SIMD_INLINE T operator[](int k) const {
    if constexpr (detail::kind<T, W> == detail::Kind::halves) return k < W / 2 ? v.lo[k] : v.hi[k - W / 2];
    else if constexpr (W == 1) return v;
    else return v[k];
  }

  friend BARCHAN_SIMD_INLINE Vec operator+(Vec a, Vec b) { return detail::add(a, b); }
  friend BARCHAN_SIMD_INLINE Vec operator-(Vec a, Vec b) { return detail::subtract(a, b); }
  friend BARCHAN_SIMD_INLINE Vec operator*(Vec a, Vec b) { return detail::multiply(a, b); }
  friend BARCHAN_SIMD_INLINE Vec operator/(Vec a, Vec b) requires std::is_floating_point_v<T> {
    return detail::divide(a, b);
  }
  friend BARCHAN_SIMD_INLINE Vec operator-(Vec a) {
    if constexpr (detail::kind<T, W> == detail::Kind::halves) return Storage{-a.v.lo, -a.v.hi};
    else if constexpr (std::is_integral_v<T>) return Vec(T(0)) - a;
    else return Vec(-a.v);
  }
  friend BARCHAN_SIMD_INLINE Vec& operator+=(Vec& a, Vec b) { return a = a + b; }
  friend BARCHAN_SIMD_INLINE Vec& operator-=(Vec& a, Vec b) { return a = a - b; }
  friend BARCHAN_SIMD_INLINE Vec& operator*=(Vec& a, Vec b) { return a = a * b; }

  // Comparisons are false for unordered lanes (NaN).
  friend BARCHAN_SIMD_INLINE Mask<T, W> operator<(Vec a, Vec b) {
    return detail::compare<detail::Relation::less>(a, b);
  }
  friend BARCHAN_SIMD_INLINE Mask<T, W> operator<=(Vec a, Vec b) {
    return detail::compare<detail::Relation::less_equal>(a, b);
  }
  friend BARCHAN_SIMD_INLINE Mask<T, W> operator>(Vec a, Vec b) { return b < a; }
  friend BARCHAN_SIMD_INLINE Mask<T, W> operator>=(Vec a, Vec b) { return b <= a; }
  friend BARCHAN_SIMD_INLINE Mask<T, W> operator==(Vec a, Vec b) {
    return detail::compare<detail::Relation::equal>(a, b);
  }
  friend BARCHAN_SIMD_INLINE Mask<T, W> operator!=(Vec a, Vec b) { return !(a == b); }
};

// A double in every lane, rounded to the lanes' type.
template <class V>
BARCHAN_SIMD_INLINE V broadcast(double x) {
  if constexpr (std::is_floating_point_v<V>) return static_cast<V>(x);
  else return V(static_cast<typename V::value_type>(x));
}

namespace detail {

// Lanes First .. First + Count - 1 of a register.
template <int First, class T, int W, std::size_t... K>
BARCHAN_SIMD_INLINE auto extract(Vec<T, W> a, std::index_sequence<K...>) {
  return __builtin_shufflevector(a.v, a.v, (First + static_cast<int>(K))...);
}

template <int First, class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W / 2> half(Vec<T, W> a) {
  if constexpr (kind<T, W> == Kind::halves) {
    if constexpr (First == 0) return a.v.lo;
    else return a.v.hi;
  } else if constexpr (W == 2) {
    return Vec<T, 1>(a.v[First]);
  } else {
    return {extract<First>(a, std::make_index_sequence<static_cast<std::size_t>(W / 2)>{})};
  }
}

template <class T, int W, std::size_t... K>
BARCHAN_SIMD_INLINE auto concatenate(Vec<T, W> a, Vec<T, W> b, std::index_sequence<K...>) {
  return __builtin_shufflevector(a.v, b.v, static_cast<int>(K)...);
}

}  // namespace detail

// The first W/2 lanes.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W / 2> lower(Vec<T, W> a) {
  return detail::half<0>(a);
}

// The last W/2 lanes.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W / 2> upper(Vec<T, W> a) {
  return detail::half<W / 2>(a);
}

// The lanes of a followed by those of b.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, 2 * W> join(Vec<T, W> a, Vec<T, W> b) {
  using S = typename Vec<T, 2 * W>::Storage;
  if constexpr (detail::kind<T, 2 * W> == detail::Kind::halves) return S{a, b};
  else if constexpr (W == 1) return S{a.v, b.v};
  else return {detail::concatenate(a, b, std::make_index_sequence<static_cast<std::size_t>(2 * W)>{})};
}

// Converts lanes between double, float and std::int32_t (towards integers: truncation).
template <class U, class T, int W>
BARCHAN_SIMD_INLINE Vec<U, W> convert(Vec<T, W> a) {
  if constexpr (std::is_same_v<U, T>) return a;
  else if constexpr (W == 1) return Vec<U, 1>(static_cast<U>(a.v));
  else if constexpr (detail::kind<T, W> == detail::Kind::halves || detail::kind<U, W> == detail::Kind::halves)
    return join(convert<U>(lower(a)), convert<U>(upper(a)));
  else return {__builtin_convertvector(a.v, typename Vec<U, W>::Storage)};
}

// The same bits as lanes of another type of the same size.
template <class U, class T, int W>
BARCHAN_SIMD_INLINE Vec<U, W> bit_cast(Vec<T, W> a) {
  static_assert(sizeof(U) == sizeof(T));
  if constexpr (detail::kind<T, W> == detail::Kind::halves) return join(bit_cast<U>(a.v.lo), bit_cast<U>(a.v.hi));
  else return Vec<U, W>(std::bit_cast<typename Vec<U, W>::Storage>(a.v));
}

// The same truth of lanes of another type of the same size.
template <class U, class T, int W>
BARCHAN_SIMD_INLINE Mask<U, W> bit_cast_mask(Mask<T, W> m) {
  static_assert(sizeof(U) == sizeof(T));
  if constexpr (detail::kind<T, W> == detail::Kind::halves)
    return {{bit_cast_mask<U>(m.v.lo), bit_cast_mask<U>(m.v.hi)}};
  else return {std::bit_cast<typename Mask<U, W>::Storage>(m.v)};
}

// One bit a lane, lane 0 in bit 0.
template <class T, int W>
BARCHAN_SIMD_INLINE std::uint32_t to_bits(Mask<T, W> m) {
  static_assert(W <= 32);
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return to_bits(m.v.lo) | (to_bits(m.v.hi) << (W / 2));
  } else if constexpr (W == 1 || detail::bit_mask<T, W>) {
    return static_cast<std::uint32_t>(m.v);
  } else {
#if defined(__AVX2__)
    if constexpr (detail::bytes<T, W> == 32 && sizeof(T) == 8)
      return static_cast<std::uint32_t>(_mm256_movemask_pd(reinterpret_cast<__m256d>(m.v)));
    else if constexpr (detail::bytes<T, W> == 32)
      return static_cast<std::uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(m.v)));
#endif
#if defined(__SSE2__)
    if constexpr (detail::bytes<T, W> == 16 && sizeof(T) == 8)
      return static_cast<std::uint32_t>(_mm_movemask_pd(reinterpret_cast<__m128d>(m.v)));
    else if constexpr (detail::bytes<T, W> == 16)
      return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(m.v)));
#endif
    {
      std::uint32_t r = 0;
      for (int k = 0; k < W; ++k) r |= static_cast<std::uint32_t>(m.v[k] & 1) << k;
      return r;
    }
  }
}

// The number of true lanes.
template <class T, int W>
BARCHAN_SIMD_INLINE int count(Mask<T, W> m) {
  return std::popcount(to_bits(m));
}

// True if at least one lane is true.
template <class T, int W>
BARCHAN_SIMD_INLINE bool any(Mask<T, W> m) {
  return to_bits(m) != 0;
}

// True if every lane is true.
template <class T, int W>
BARCHAN_SIMD_INLINE bool all(Mask<T, W> m) {
  return to_bits(m) == static_cast<std::uint32_t>((std::uint64_t{1} << W) - 1);
}

template <class T, int W>
BARCHAN_SIMD_INLINE Mask<T, W> Mask<T, W>::first(int n) {
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return {{Mask<T, W / 2>::first(n), Mask<T, W / 2>::first(n - W / 2)}};
  } else if constexpr (detail::bit_mask<T, W>) {
    return {n >= W ? static_cast<Storage>(~Storage{0}) : n <= 0 ? Storage{0} : static_cast<Storage>((1u << n) - 1u)};
  } else if constexpr (W == 1) {
    return {n > 0};
  } else {
    alignas(64) detail::Lane<T> index[W];
    for (int k = 0; k < W; ++k) index[k] = k;
    Storage s;
    std::memcpy(&s, index, sizeof(s));
    return {reinterpret_cast<Storage>(s < (static_cast<detail::Lane<T>>(n) - Storage{}))};
  }
}

// a where m is true, b elsewhere.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> select(Mask<T, W> m, Vec<T, W> a, Vec<T, W> b) {
  using S = typename Vec<T, W>::Storage;
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return S{select(m.v.lo, a.v.lo, b.v.lo), select(m.v.hi, a.v.hi, b.v.hi)};
  } else if constexpr (W == 1) {
    return m.v ? a : b;
  } else if constexpr (detail::bit_mask<T, W>) {
#if defined(__AVX512F__)
    if constexpr (std::is_same_v<T, double>) return {_mm512_mask_blend_pd(m.v, b.v, a.v)};
    else if constexpr (std::is_same_v<T, float>) return {_mm512_mask_blend_ps(m.v, b.v, a.v)};
    else
      return {reinterpret_cast<S>(
          _mm512_mask_blend_epi32(m.v, reinterpret_cast<__m512i>(b.v), reinterpret_cast<__m512i>(a.v)))};
#endif
  } else {
#if defined(__AVX2__)
    if constexpr (detail::bytes<T, W> == 32 && sizeof(T) == 8)
      return {reinterpret_cast<S>(_mm256_blendv_pd(reinterpret_cast<__m256d>(b.v), reinterpret_cast<__m256d>(a.v),
                                                   reinterpret_cast<__m256d>(m.v)))};
    else if constexpr (detail::bytes<T, W> == 32)
      return {reinterpret_cast<S>(_mm256_blendv_ps(reinterpret_cast<__m256>(b.v), reinterpret_cast<__m256>(a.v),
                                                   reinterpret_cast<__m256>(m.v)))};
#endif
    {
      using M = typename Mask<T, W>::Storage;
      return {reinterpret_cast<S>((m.v & reinterpret_cast<M>(a.v)) | (~m.v & reinterpret_cast<M>(b.v)))};
    }
  }
}

// a where m is true, zero elsewhere (also where a is NaN or infinite).
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> mask_zero(Mask<T, W> m, Vec<T, W> a) {
  using S = typename Vec<T, W>::Storage;
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return S{mask_zero(m.v.lo, a.v.lo), mask_zero(m.v.hi, a.v.hi)};
  } else if constexpr (W == 1) {
    return m.v ? a : Vec<T, W>(T(0));
  } else if constexpr (detail::bit_mask<T, W>) {
#if defined(__AVX512F__)
    if constexpr (std::is_same_v<T, double>) return {_mm512_maskz_mov_pd(m.v, a.v)};
    else if constexpr (std::is_same_v<T, float>) return {_mm512_maskz_mov_ps(m.v, a.v)};
    else return {reinterpret_cast<S>(_mm512_maskz_mov_epi32(m.v, reinterpret_cast<__m512i>(a.v)))};
#endif
  } else {
    return {reinterpret_cast<S>(m.v & reinterpret_cast<typename Mask<T, W>::Storage>(a.v))};
  }
}

// Calls the intrinsic for the register at hand, or f on every lane.
#if defined(__AVX512F__)
#define BARCHAN_SIMD_512(name, ...)                                                                    \
  if constexpr (detail::bytes<T, W> == 64 && sizeof(T) == 8) return {_mm512_##name##_pd(__VA_ARGS__)}; \
  else if constexpr (detail::bytes<T, W> == 64) return {_mm512_##name##_ps(__VA_ARGS__)};              \
  else
#else
#define BARCHAN_SIMD_512(name, ...)
#endif
#if defined(__AVX2__)
#define BARCHAN_SIMD_256(name, ...)                                                                    \
  if constexpr (detail::bytes<T, W> == 32 && sizeof(T) == 8) return {_mm256_##name##_pd(__VA_ARGS__)}; \
  else if constexpr (detail::bytes<T, W> == 32) return {_mm256_##name##_ps(__VA_ARGS__)};              \
  else
#else
#define BARCHAN_SIMD_256(name, ...)
#endif
#if defined(__SSE2__)
#define BARCHAN_SIMD_128(name, ...)                                                                 \
  if constexpr (detail::bytes<T, W> == 16 && sizeof(T) == 8) return {_mm_##name##_pd(__VA_ARGS__)}; \
  else if constexpr (detail::bytes<T, W> == 16) return {_mm_##name##_ps(__VA_ARGS__)};              \
  else
#else
#define BARCHAN_SIMD_128(name, ...)
#endif

// a * b + c, rounded once where the machine has FMA.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> fma(Vec<T, W> a, Vec<T, W> b, Vec<T, W> c) {
  static_assert(std::is_floating_point_v<T>);
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return typename Vec<T, W>::Storage{fma(a.v.lo, b.v.lo, c.v.lo), fma(a.v.hi, b.v.hi, c.v.hi)};
  }
#if defined(__FMA__)
  else if constexpr (W == 1) {
    return Vec<T, W>(std::fma(a.v, b.v, c.v));
  }
#endif
  else {
#if defined(__FMA__)
    BARCHAN_SIMD_512(fmadd, a.v, b.v, c.v)
    BARCHAN_SIMD_256(fmadd, a.v, b.v, c.v)
    BARCHAN_SIMD_128(fmadd, a.v, b.v, c.v) {
      Vec<T, W> r;
      for (int k = 0; k < W; ++k) r.v[k] = std::fma(a.v[k], b.v[k], c.v[k]);
      return r;
    }
#else
    return Vec<T, W>(a.v * b.v + c.v);
#endif
  }
}

// c - a * b, rounded once where the machine has FMA.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> fnma(Vec<T, W> a, Vec<T, W> b, Vec<T, W> c) {
  return fma(-a, b, c);
}

// The smaller of a and b, lane by lane; b where either is NaN.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> min(Vec<T, W> a, Vec<T, W> b) {
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return typename Vec<T, W>::Storage{min(a.v.lo, b.v.lo), min(a.v.hi, b.v.hi)};
  } else if constexpr (std::is_integral_v<T> || W == 1) {
    return select(a < b, a, b);
  } else {
    BARCHAN_SIMD_512(min, a.v, b.v)
    BARCHAN_SIMD_256(min, a.v, b.v)
    BARCHAN_SIMD_128(min, a.v, b.v)
    return select(a < b, a, b);
  }
}

// The larger of a and b, lane by lane; b where either is NaN.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> max(Vec<T, W> a, Vec<T, W> b) {
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return typename Vec<T, W>::Storage{max(a.v.lo, b.v.lo), max(a.v.hi, b.v.hi)};
  } else if constexpr (std::is_integral_v<T> || W == 1) {
    return select(a > b, a, b);
  } else {
    BARCHAN_SIMD_512(max, a.v, b.v)
    BARCHAN_SIMD_256(max, a.v, b.v)
    BARCHAN_SIMD_128(max, a.v, b.v)
    return select(a > b, a, b);
  }
}

// The correctly rounded square root.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> sqrt(Vec<T, W> a) {
  static_assert(std::is_floating_point_v<T>);
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return typename Vec<T, W>::Storage{sqrt(a.v.lo), sqrt(a.v.hi)};
  } else if constexpr (W == 1) {
    return Vec<T, W>(std::sqrt(a.v));
  } else {
    BARCHAN_SIMD_512(sqrt, a.v)
    BARCHAN_SIMD_256(sqrt, a.v)
    BARCHAN_SIMD_128(sqrt, a.v) {
      Vec<T, W> r;
      for (int k = 0; k < W; ++k) r.v[k] = std::sqrt(a.v[k]);
      return r;
    }
  }
}

// The same of numbers: a law takes T = double as well as a vector.
template <std::floating_point T>
BARCHAN_SIMD_INLINE T fma(T a, T b, T c) {
#if defined(__FMA__)
  return std::fma(a, b, c);
#else
  return a * b + c;
#endif
}
template <std::floating_point T>
BARCHAN_SIMD_INLINE T fnma(T a, T b, T c) {
  return fma(-a, b, c);
}
template <std::floating_point T>
BARCHAN_SIMD_INLINE T min(T a, T b) {
  return a < b ? a : b;
}
template <std::floating_point T>
BARCHAN_SIMD_INLINE T max(T a, T b) {
  return a > b ? a : b;
}
template <std::floating_point T>
BARCHAN_SIMD_INLINE T sqrt(T a) {
  return std::sqrt(a);
}
template <std::floating_point T>
BARCHAN_SIMD_INLINE T inverse_sqrt(T a) {
  return T(1) / std::sqrt(a);
}
template <std::floating_point T>
BARCHAN_SIMD_INLINE T select(bool condition, T a, T b) {
  return condition ? a : b;
}
template <std::floating_point T>
BARCHAN_SIMD_INLINE T sum(T a) {
  return a;
}
template <std::same_as<bool> M>  // of no other type: a number is no mask
BARCHAN_SIMD_INLINE std::uint32_t to_bits(M condition) {
  return condition ? 1u : 0u;
}

#undef BARCHAN_SIMD_512
#undef BARCHAN_SIMD_256
#undef BARCHAN_SIMD_128

namespace detail {

// Improves y ~ 1/sqrt(a): y (1 + e/2 + 3/8 e^2 + ..) with e = 1 - a y^2, up to the power Order - 1 of e.
template <int Order, class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> refine_inverse_sqrt(Vec<T, W> a, Vec<T, W> y) {
  using V = Vec<T, W>;
  const V e = fnma(a * y, y, V(T(1)));
  V series(T(0.5));
  if constexpr (Order == 3) series = fma(e, V(T(0.375)), V(T(0.5)));
  if constexpr (Order == 4) series = fma(e, fma(e, V(T(0.3125)), V(T(0.375))), V(T(0.5)));
  if constexpr (Order == 5) series = fma(e, fma(e, fma(e, V(T(0.2734375)), V(T(0.3125))), V(T(0.375))), V(T(0.5)));
  return fma(y * e, series, y);
}

}  // namespace detail

// 1/sqrt(a) to about two units in the last place. Needs 2^-126 < a < 2^126 (the range of float) in both precisions.
// AVX-512: 14-bit estimate + one step of fourth (double) or second (float) order; AVX2: 11.4-bit single estimate +
// one step of fifth (double) or second (float) order; elsewhere 1/sqrt(a).
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> inverse_sqrt(Vec<T, W> a) {
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return typename Vec<T, W>::Storage{inverse_sqrt(a.v.lo), inverse_sqrt(a.v.hi)};
  } else {
#if defined(__AVX512F__)
    if constexpr (detail::bytes<T, W> == 64 && sizeof(T) == 8)
      return detail::refine_inverse_sqrt<4>(a, Vec<T, W>(_mm512_rsqrt14_pd(a.v)));
    else if constexpr (detail::bytes<T, W> == 64)
      return detail::refine_inverse_sqrt<2>(a, Vec<T, W>(_mm512_rsqrt14_ps(a.v)));
#endif
#if defined(__AVX2__) && defined(__FMA__)
    if constexpr (detail::bytes<T, W> == 32 && sizeof(T) == 8)
      return detail::refine_inverse_sqrt<5>(a, Vec<T, W>(_mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps(a.v)))));
    else if constexpr (detail::bytes<T, W> == 32)
      return detail::refine_inverse_sqrt<2>(a, Vec<T, W>(_mm256_rsqrt_ps(a.v)));
#endif
    return Vec<T, W>(T(1)) / sqrt(a);
  }
}

// True where the divider beats estimates with Newton steps: fewer instructions in flight and a shorter chain. Measured
// on Zen 3 (AVX2) only; define BARCHAN_SIMD_USE_DIVIDER as 0 or 1 to choose otherwise.
#if defined(BARCHAN_SIMD_USE_DIVIDER)
inline constexpr bool use_divider = BARCHAN_SIMD_USE_DIVIDER != 0;
#else
inline constexpr bool use_divider = !detail::has_avx512;
#endif

// sqrt(a) for kernels, by the divider or as a * inverse_sqrt(a), whichever is faster; 2^-126 < a < 2^126.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> root(Vec<T, W> a) {
  if constexpr (use_divider || W == 1) return sqrt(a);
  else return a * inverse_sqrt(a);
}

// 1/a for kernels: the correctly rounded quotient, or for float registers of AVX-512 an estimate and one Newton step
// (about one unit in the last place; 2^-126 < |a| < 2^126).
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> inverse(Vec<T, W> a) {
#if defined(__AVX512F__)
  if constexpr (!use_divider && detail::kind<T, W> == detail::Kind::native && detail::bytes<T, W> == 64 &&
                sizeof(T) == 4) {
    const Vec<T, W> y(_mm512_rcp14_ps(a.v));
    return fma(y, fnma(a, y, Vec<T, W>(T(1))), y);
  }
#endif
  if constexpr (detail::kind<T, W> == detail::Kind::halves)
    return typename Vec<T, W>::Storage{inverse(a.v.lo), inverse(a.v.hi)};
  else return Vec<T, W>(T(1)) / a;
}

// The sum of all lanes in a fixed order: upper half + lower half, recursively (the same on every machine for one W).
template <class T, int W>
BARCHAN_SIMD_INLINE T sum(Vec<T, W> a) {
  if constexpr (W == 1) return a.v;
  else return sum(lower(a) + upper(a));
}

// The sums of four vectors, {sum(a), sum(b), sum(c), sum(d)}, each in the order of sum() but cheaper together.
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, 4> sum(Vec<T, W> a, Vec<T, W> b, Vec<T, W> c, Vec<T, W> d) {
#if defined(__AVX2__)
  if constexpr (W == 4 && sizeof(T) == 8) {
    const __m256d ab = _mm256_add_pd(_mm256_permute2f128_pd(a.v, b.v, 0x20), _mm256_permute2f128_pd(a.v, b.v, 0x31));
    const __m256d cd = _mm256_add_pd(_mm256_permute2f128_pd(c.v, d.v, 0x20), _mm256_permute2f128_pd(c.v, d.v, 0x31));
    const __m256d acbd = _mm256_hadd_pd(ab, cd);
    return {_mm256_permute4x64_pd(acbd, 0xd8)};
  }
#endif
#if defined(__SSE2__)
  if constexpr (W == 4 && sizeof(T) == 4) {
    const __m128 ab = _mm_add_ps(_mm_movelh_ps(a.v, b.v), _mm_movehl_ps(b.v, a.v));  // a0+a2 a1+a3 b0+b2 b1+b3
    const __m128 cd = _mm_add_ps(_mm_movelh_ps(c.v, d.v), _mm_movehl_ps(d.v, c.v));
    return {_mm_add_ps(_mm_shuffle_ps(ab, cd, 0x88), _mm_shuffle_ps(ab, cd, 0xdd))};
  }
#endif
  if constexpr (W > 4) {
    return sum(lower(a) + upper(a), lower(b) + upper(b), lower(c) + upper(c), lower(d) + upper(d));
  } else {
    const T s[4] = {sum(a), sum(b), sum(c), sum(d)};
    return Vec<T, 4>::load(s);
  }
}

namespace detail {

// For every 8-bit mask the positions of its set bits, then zeros.
struct CompressTable {
  alignas(64) std::uint8_t position[256][8];
  constexpr CompressTable() : position{} {
    for (int m = 0; m < 256; ++m)
      for (int k = 0, n = 0; k < 8; ++k)
        if (m >> k & 1) position[m][n++] = static_cast<std::uint8_t>(k);
  }
};
inline constexpr CompressTable compress_table{};

}  // namespace detail

// Stores the lanes of `index` whose lane in m is true, in order, and returns their number. May write any values to the
// rest of the W places from `out`: leave room for W.
template <class T, int W>
BARCHAN_SIMD_INLINE int compress_store(std::uint32_t* out, Mask<T, W> m, Vec<std::int32_t, W> index) {
#if defined(__AVX512F__)
  if constexpr (W == 16) {
    const std::uint32_t bits = to_bits(m);
    const __m512i packed =
        _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), reinterpret_cast<__m512i>(index.v));
    std::memcpy(out, &packed, sizeof(packed));
    return std::popcount(bits);
  }
#endif
#if defined(__AVX512VL__)
  if constexpr (W == 8) {
    const std::uint32_t bits = to_bits(m);
    const __m256i packed = _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits), reinterpret_cast<__m256i>(index.v));
    std::memcpy(out, &packed, sizeof(packed));
    return std::popcount(bits);
  }
#endif
#if defined(__AVX2__)
  if constexpr (W == 8) {
    const std::uint32_t bits = to_bits(m);
    const __m128i position = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(detail::compress_table.position[bits]));
    const __m256i packed =
        _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(index.v), _mm256_cvtepu8_epi32(position));
    std::memcpy(out, &packed, sizeof(packed));
    return std::popcount(bits);
  } else if constexpr (W == 4) {
    const std::uint32_t bits = to_bits(m);
    std::int32_t position;
    std::memcpy(&position, detail::compress_table.position[bits], sizeof(position));
    const __m128 packed =
        _mm_permutevar_ps(reinterpret_cast<__m128>(index.v), _mm_cvtepu8_epi32(_mm_cvtsi32_si128(position)));
    std::memcpy(out, &packed, sizeof(packed));
    return std::popcount(bits);
  }
#endif
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    const int n = compress_store(out, m.v.lo, lower(index));
    return n + compress_store(out + n, m.v.hi, upper(index));
  } else {
    const std::uint32_t bits = to_bits(m);
    int n = 0;
    for (int k = 0; k < W; ++k) {
      out[n] = static_cast<std::uint32_t>(index[k]);
      n += static_cast<int>(bits >> k & 1);
    }
    return n;
  }
}

// Lane k = base[index[k]].
template <class T, int W>
BARCHAN_SIMD_INLINE Vec<T, W> gather(const T* base, const std::uint32_t* index) {
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    return join(gather<T, W / 2>(base, index), gather<T, W / 2>(base, index + W / 2));
  } else if constexpr (W == 1) {
    return Vec<T, W>(base[index[0]]);
  } else {
    Vec<T, W> r;
    for (int k = 0; k < W; ++k) r.v[k] = base[index[k]];
    return r;
  }
}

// Loads the first Fields values of W records and transposes them: lane k of out[f] = records[index[k] * stride + f].
// Fields must be a multiple of 4 (8 or 16 in use); outputs that are never read cost nothing after optimisation.
template <int Fields, class T, int W>
BARCHAN_SIMD_INLINE void load_transposed(const T* records, std::size_t stride, const std::uint32_t* index,
                                         Vec<T, W>* out) {
  static_assert(Fields % 4 == 0);
  if constexpr (detail::kind<T, W> == detail::Kind::halves) {
    Vec<T, W / 2> lo[Fields], hi[Fields];
    load_transposed<Fields>(records, stride, index, lo);
    load_transposed<Fields>(records, stride, index + W / 2, hi);
    for (int f = 0; f < Fields; ++f) out[f] = join(lo[f], hi[f]);
  } else {
    [[maybe_unused]] const auto record = [=](int k) __attribute__((always_inline)) {
      return records + static_cast<std::size_t>(index[k]) * stride;
    };
#if defined(__AVX512F__)
    if constexpr (W == 8 && sizeof(T) == 8) {
      // Two quarter records side by side: a = {record(i)[f..f+3], record(j)[f..f+3]}.
      const auto pair = [=](int i, int j, int f) __attribute__((always_inline)) {
        return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(record(i) + f)),
                                  _mm256_loadu_pd(record(j) + f), 1);
      };
      for (int f = 0; f < Fields; f += 4) {
        const __m512d a0 = pair(0, 2, f), a1 = pair(1, 3, f), a2 = pair(4, 6, f), a3 = pair(5, 7, f);
        const __m512d even_low = _mm512_unpacklo_pd(a0, a1), even_high = _mm512_unpacklo_pd(a2, a3);  // fields f, f+2
        const __m512d odd_low = _mm512_unpackhi_pd(a0, a1), odd_high = _mm512_unpackhi_pd(a2, a3);    // f+1, f+3
        out[f + 0].v = _mm512_shuffle_f64x2(even_low, even_high, 0x88);
        out[f + 1].v = _mm512_shuffle_f64x2(odd_low, odd_high, 0x88);
        out[f + 2].v = _mm512_shuffle_f64x2(even_low, even_high, 0xdd);
        out[f + 3].v = _mm512_shuffle_f64x2(odd_low, odd_high, 0xdd);
      }
      return;
    } else if constexpr (W == 16 && sizeof(T) == 4 && Fields % 8 == 0) {
      // a = {record(i)[f..f+7], record(j)[f..f+7]}; then 4 x 4 transposes inside the 128-bit lanes.
      const auto pair = [=](int i, int j, int f) __attribute__((always_inline)) {
        const __m512d low = _mm512_castpd256_pd512(_mm256_castps_pd(_mm256_loadu_ps(record(i) + f)));
        return _mm512_castpd_ps(_mm512_insertf64x4(low, _mm256_castps_pd(_mm256_loadu_ps(record(j) + f)), 1));
      };
      const auto transpose = [](__m512 a, __m512 b, __m512 c, __m512 d, __m512 * r) __attribute__((always_inline)) {
        const __m512 ab = _mm512_unpacklo_ps(a, b), cd = _mm512_unpacklo_ps(c, d);
        const __m512 AB = _mm512_unpackhi_ps(a, b), CD = _mm512_unpackhi_ps(c, d);
        r[0] = _mm512_shuffle_ps(ab, cd, 0x44);
        r[1] = _mm512_shuffle_ps(ab, cd, 0xee);
        r[2] = _mm512_shuffle_ps(AB, CD, 0x44);
        r[3] = _mm512_shuffle_ps(AB, CD, 0xee);
      };
      for (int f = 0; f < Fields; f += 8) {
        __m512 u[4], w[4];  // u[k] = {records 0-3 field k, 0-3 field k+4, 4-7 field k, 4-7 field k+4}; w: records 8-15
        transpose(pair(0, 4, f), pair(1, 5, f), pair(2, 6, f), pair(3, 7, f), u);
        transpose(pair(8, 12, f), pair(9, 13, f), pair(10, 14, f), pair(11, 15, f), w);
        for (int k = 0; k < 4; ++k) {
          out[f + k].v = _mm512_shuffle_f32x4(u[k], w[k], 0x88);
          out[f + k + 4].v = _mm512_shuffle_f32x4(u[k], w[k], 0xdd);
        }
      }
      return;
    }
#endif
#if defined(__AVX2__)
    if constexpr (W == 4 && sizeof(T) == 8) {
      // {record(i)[f], record(i)[f+1], record(j)[f], record(j)[f+1]}: the insertion rides on the load.
      const auto pair = [=](int i, int j, int f) __attribute__((always_inline)) {
        return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(record(i) + f)), _mm_loadu_pd(record(j) + f),
                                    1);
      };
      for (int f = 0; f < Fields; f += 2) {
        const __m256d a = pair(0, 2, f), b = pair(1, 3, f);
        out[f].v = _mm256_unpacklo_pd(a, b);
        out[f + 1].v = _mm256_unpackhi_pd(a, b);
      }
      return;
    } else if constexpr (W == 8 && sizeof(T) == 4) {
      const auto pair = [=](int i, int j, int f) __attribute__((always_inline)) {
        return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(record(i) + f)), _mm_loadu_ps(record(j) + f),
                                    1);
      };
      for (int f = 0; f < Fields; f += 4) {
        const __m256 a = pair(0, 4, f), b = pair(1, 5, f), c = pair(2, 6, f), d = pair(3, 7, f);
        const __m256 ab = _mm256_unpacklo_ps(a, b), cd = _mm256_unpacklo_ps(c, d);  // fields f, f+1
        const __m256 AB = _mm256_unpackhi_ps(a, b), CD = _mm256_unpackhi_ps(c, d);  // fields f+2, f+3
        out[f + 0].v = _mm256_shuffle_ps(ab, cd, 0x44);
        out[f + 1].v = _mm256_shuffle_ps(ab, cd, 0xee);
        out[f + 2].v = _mm256_shuffle_ps(AB, CD, 0x44);
        out[f + 3].v = _mm256_shuffle_ps(AB, CD, 0xee);
      }
      return;
    }
#endif
    for (int f = 0; f < Fields; ++f) {
      if constexpr (W == 1) out[f] = Vec<T, W>(record(0)[f]);
      else
        for (int k = 0; k < W; ++k) out[f].v[k] = record(k)[f];
    }
  }
}

// The last two lanes in each other's place.
template <class T>
BARCHAN_SIMD_INLINE Vec<T, 4> swap_last(Vec<T, 4> a) {
  if constexpr (detail::kind<T, 4> == detail::Kind::native) a.v = __builtin_shufflevector(a.v, a.v, 0, 1, 3, 2);
  else {
    T x[4];
    a.store(x);
    std::swap(x[2], x[3]);
    a = Vec<T, 4>::load(x);
  }
  return a;
}

// Rows become columns: lane k of the result's vector j is lane j of vector k.
template <class T>
BARCHAN_SIMD_INLINE void transpose(Vec<T, 4>& a, Vec<T, 4>& b, Vec<T, 4>& c, Vec<T, 4>& d) {
  if constexpr (detail::kind<T, 4> == detail::Kind::native) {
    const auto ab = __builtin_shufflevector(a.v, b.v, 0, 4, 2, 6), AB = __builtin_shufflevector(a.v, b.v, 1, 5, 3, 7);
    const auto cd = __builtin_shufflevector(c.v, d.v, 0, 4, 2, 6), CD = __builtin_shufflevector(c.v, d.v, 1, 5, 3, 7);
    a.v = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    b.v = __builtin_shufflevector(AB, CD, 0, 1, 4, 5);
    c.v = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    d.v = __builtin_shufflevector(AB, CD, 2, 3, 6, 7);
  } else {
    T x[4][4], y[4][4];
    a.store(x[0]);
    b.store(x[1]);
    c.store(x[2]);
    d.store(x[3]);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) y[k][j] = x[j][k];
    a = Vec<T, 4>::load(y[0]);
    b = Vec<T, 4>::load(y[1]);
    c = Vec<T, 4>::load(y[2]);
    d = Vec<T, 4>::load(y[3]);
  }
}

}  // namespace BARCHAN_TARGET
}  // namespace barchan::simd

// Laws call these without a namespace: of a number nothing else would name it.
namespace barchan {
using simd::fma;
using simd::fnma;
using simd::inverse_sqrt;
using simd::max;
using simd::min;
using simd::select;
using simd::sqrt;
using simd::to_bits;
}  // namespace barchan
