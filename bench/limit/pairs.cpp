// How fast can the pair loop of a weakly compressible SPH step be? The same pair law (continuity, pressure, artificial
// viscosity) in several loop forms, each checked against the scalar loop, next to the arithmetic roof of the machine.
//
//   pairs [--dim 2|3] [--n 200000] [--precision d|f] [--kernel wendland|cubic] [--threads 1] [--repeat 7]
//         [--skin 1.1] [--rebuild 5] [--cells 1] [--json]
//
// Particles sit on a jittered lattice, inserted in random order and sorted into cells. Pairs are counted from both
// sides, within the kernel radius only; rates are per second of CPU time (all threads), medians over the repetitions.
#include <time.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/wendland_c2.hpp"
#include "laws/plain_fluid.hpp"
#include "simd/vec.hpp"

namespace {

namespace simd = barchan::simd;
using simd::Mask;
using simd::Vec;
using Index = std::uint32_t;

#define ALWAYS_INLINE inline __attribute__((always_inline))

struct Options {
  int dim = 2, n = 200000, threads = 1, repeat = 7, rebuild = 5, cells = 1;
  bool single = false, cubic = false, json = false;
  double skin = 1.1;
};

template <class T>
struct Allocator {
  using value_type = T;
  Allocator() = default;
  template <class U>
  Allocator(const Allocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(64))); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(64)); }
  bool operator==(const Allocator&) const { return true; }
};
template <class T>
using Array = std::vector<T, Allocator<T>>;

constexpr std::size_t padding = 64;  // readable elements behind every particle array

// ---------------------------------------------------------------------------------------------------------- pair law

struct Fluid {
  double spacing, h, radius, mass, density = 1000, sound_speed = 20, alpha = 0.1;
  double stiffness() const { return density * sound_speed * sound_speed / 7; }
};

// The kernels return F = (dW/dr) / r for r2 = r^2, zero beyond the radius 2h, and set `inverse_b` to 1 / b.
template <class V, int D>
struct CubicSpline {
  V inverse_h, inner, outer;
  explicit CubicSpline(const Fluid& f, double unit = 1) {
    using T = typename V::value_type;
    const double norm = (D == 2 ? 10 / (7 * std::numbers::pi) : 1 / std::numbers::pi) / std::pow(f.h, D);
    inverse_h = V(T(unit / f.h));
    inner = V(T(norm / (f.h * f.h)));
    outer = V(T(-0.75 * norm / (f.h * unit)));
  }
  ALWAYS_INLINE V operator()(V r2, V b, V& inverse_b) const {
    using T = typename V::value_type;
    V r, inverse_r;
    if constexpr (simd::use_divider || V::width == 1) {  // one quotient for both inverses
      r = sqrt(r2);
      const V inverse_rb = inverse(r * b);
      inverse_r = inverse_rb * b;
      inverse_b = inverse_rb * r;
    } else {
      inverse_r = inverse_sqrt(r2);
      inverse_b = inverse(b);
      r = r2 * inverse_r;
    }
    const V q = r * inverse_h;
    const V t = max(V(T(2)) - q, V(T(0)));
    return select(q < V(T(1)), inner * fma(V(T(2.25)), q, V(T(-3))), (outer * inverse_r) * (t * t));
  }
};

template <class V, int D>
struct WendlandC2 {
  V half_inverse_h, factor;
  explicit WendlandC2(const Fluid& f, double unit = 1) {
    using T = typename V::value_type;
    const double norm = (D == 2 ? 7 / (4 * std::numbers::pi) : 21 / (16 * std::numbers::pi)) / std::pow(f.h, D);
    half_inverse_h = V(T(-0.5 / f.h * unit));
    factor = V(T(-5 * norm / (f.h * f.h)));
  }
  ALWAYS_INLINE V operator()(V r2, V b, V& inverse_b) const {
    using T = typename V::value_type;
    inverse_b = inverse(b);
    const V t = max(fma(root(r2), half_inverse_h, V(T(1))), V(T(0)));
    return (factor * t) * (t * t);
  }
};

// The sums over the neighbours j of one particle i, in volume form (F negative):
//   sums[0..D-1] = sum V_j F (p_i + p_j + q_ij) x_ij,   sums[D] = sum V_j F v_ij . x_ij,
//   q_ij = -alpha h c rho0 min(v_ij . x_ij, 0) / (r^2 + 0.01 h^2);
// then dv_i/dt = -sums / rho_i and drho_i/dt = rho_i sums[D].
// A pair at distance zero contributes exactly nothing: a particle itself is a valid filler of its list.
template <class V, int D, template <class, int> class Kernel>
struct PairLaw {
  V tiny, eta, viscosity;
  Kernel<V, D> kernel;
  // Distances may come in another unit of length; the sums are then to be multiplied by it.
  explicit PairLaw(const Fluid& f, double unit = 1) : kernel(f, unit) {
    using T = typename V::value_type;
    const double h = f.h / unit;
    tiny = V(T(1e-24 * h * h));
    eta = V(T(0.01 * h * h));
    viscosity = V(T(-f.alpha * h * f.sound_speed * f.density));
  }
  ALWAYS_INLINE void add(const V* dx, const V* dv, V pressure, V volume, V* sums) const {
    using T = typename V::value_type;
    V r2 = tiny, vr = dv[0] * dx[0];
    for (int d = 0; d < D; ++d) r2 = fma(dx[d], dx[d], r2);
    for (int d = 1; d < D; ++d) vr = fma(dv[d], dx[d], vr);
    V inverse_r2_eta;
    const V weight = volume * kernel(r2, r2 + eta, inverse_r2_eta);
    const V force = weight * fma(viscosity * min(vr, V(T(0))), inverse_r2_eta, pressure);
    for (int d = 0; d < D; ++d) sums[d] = fma(force, dx[d], sums[d]);
    sums[D] = fma(weight, vr, sums[D]);
  }
};

// --------------------------------------------------------------------------------------------------------- particles

// A record holds {x[D], v[D], p, V} and, in 2D, two spare fields.
constexpr int record_fields = 8;

template <class T, int D>
struct Particles {
  std::size_t n = 0;
  std::array<Array<T>, 2 * D + 2> field;  // x[D], v[D], pressure, volume
  std::array<Array<T>, D + 1> sums;
  Array<T> scratch;

  explicit Particles(std::size_t count) : n(count) {
    for (auto& a : field) a.assign(n + padding, T(0));
    for (auto& a : sums) a.assign(n + padding, T(0));
    scratch.assign(n + padding, T(0));
  }
  T* x(int d) { return field[static_cast<std::size_t>(d)].data(); }
  T* v(int d) { return field[static_cast<std::size_t>(D + d)].data(); }
  T* p() { return field[2 * D].data(); }
  T* volume() { return field[2 * D + 1].data(); }
};

struct Random {
  std::uint64_t state = 88172645463325252ull;
  std::uint64_t next() {
    state ^= state << 13;
    state ^= state >> 7;
    return state ^= state << 17;
  }
  double symmetric() { return static_cast<double>(next() >> 11) * 0x1p-53 - 0.5; }  // in [-0.5, 0.5)
};

template <class T>
ALWAYS_INLINE T equation_of_state(T stiffness, T compression) {
  const T c2 = compression * compression, c4 = c2 * c2;
  return stiffness * (c4 * c2 * compression - 1);
}

// A jittered lattice in the unit box, in random order.
template <class T, int D>
Particles<T, D> make_particles(int wanted, Fluid& fluid) {
  const int side = static_cast<int>(std::lround(std::pow(wanted, 1.0 / D)));
  const std::size_t n = static_cast<std::size_t>(std::lround(std::pow(side, D)));
  fluid.spacing = 1.0 / side;
  fluid.h = (D == 2 ? 1.5 : 1.45) * fluid.spacing;
  fluid.radius = 2 * fluid.h;
  fluid.mass = fluid.density * std::pow(fluid.spacing, D);
  Particles<T, D> s(n);
  Random random;
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  for (std::size_t i = n - 1; i > 0; --i) std::swap(order[i], order[random.next() % (i + 1)]);
  const double wave = 2 * std::numbers::pi;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = order[k];
    double x[3];
    for (std::size_t d = 0, q = k; d < D; ++d, q /= static_cast<std::size_t>(side))
      x[d] = (static_cast<double>(q % static_cast<std::size_t>(side)) + 0.5 + 0.4 * random.symmetric()) * fluid.spacing;
    for (int d = 0; d < D; ++d) {
      s.x(d)[i] = T(x[d]);
      s.v(d)[i] =
          T((d == 0 ? 1 : -1) * std::sin(wave * x[d]) * std::cos(wave * x[(d + 1) % D]) + 0.05 * random.symmetric());
    }
    const double density = fluid.density * (1 + 0.01 * random.symmetric());
    s.volume()[i] = T(fluid.mass / density);
    s.p()[i] = T(equation_of_state(fluid.stiffness(), density / fluid.density));
  }
  return s;
}

// -------------------------------------------------------------------------------------------------------- cell grid

// Square cells of edge reach / K with a border of K empty cells; x runs fastest, so the cells of one row within K of a
// cell hold one contiguous range of particles.
template <int D>
struct Grid {
  int K, side;
  double inverse_edge;
  std::vector<Index> start;
  std::vector<int> row_offset;  // of the (2K+1)^(D-1) neighbouring rows

  Grid(double reach, int cells) : K(cells) {
    const double edge = reach / K;
    inverse_edge = 1 / edge;
    side = static_cast<int>(std::ceil(inverse_edge)) + 1 + 2 * K;
    start.assign(static_cast<std::size_t>(std::pow(side, D)) + 1, 0);
    for (int a = D == 3 ? -K : 0; a <= (D == 3 ? K : 0); ++a)
      for (int b = -K; b <= K; ++b) row_offset.push_back((a * side + b) * side);
  }
  template <class T>
  std::size_t cell(Particles<T, D>& s, std::size_t i) const {
    int c = 0;
    for (int d = D - 1; d >= 0; --d) {
      const int k = static_cast<int>(s.x(d)[i] * T(inverse_edge));
      c = c * side + K + std::clamp(k, 0, side - 2 * K - 1);
    }
    return static_cast<std::size_t>(c);
  }
  // Calls f(cell, first particle, end) for every inner row cell that holds particles, rows shared among the threads.
  template <class F>
  void for_each_cell([[maybe_unused]] int threads, F f) const {
    const int rows = static_cast<int>(start.size() - 1) / side;
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int row = 0; row < rows; ++row)
      for (int k = K; k < side - K; ++k) {
        const int c = row * side + k;
        const Index b = start[static_cast<std::size_t>(c)], e = start[static_cast<std::size_t>(c) + 1];
        if (b < e) f(c, b, e);
      }
  }
  // The particles of the row at `offset` that may reach the cell c.
  std::pair<Index, Index> range(int c, int offset) const {
    return {start[static_cast<std::size_t>(c + offset - K)], start[static_cast<std::size_t>(c + offset + K + 1)]};
  }
};

template <class T, int D>
void counting_sort(Particles<T, D>& s, Grid<D>& g) {
  static thread_local std::vector<Index> cell, place;
  cell.resize(s.n);
  place.assign(g.start.size() + 1, 0);
  for (std::size_t i = 0; i < s.n; ++i) {
    cell[i] = static_cast<Index>(g.cell(s, i));
    ++place[cell[i] + 2];
  }
  for (std::size_t c = 2; c < place.size(); ++c) place[c] += place[c - 1];
  for (std::size_t i = 0; i < s.n; ++i) cell[i] = place[cell[i] + 1]++;  // now the new position
  std::copy(place.begin(), place.end() - 1, g.start.begin());
  for (auto& a : s.field) {
    for (std::size_t i = 0; i < s.n; ++i) s.scratch[cell[i]] = a[i];
    std::swap(s.scratch, a);
  }
}

// ------------------------------------------------------------------------------------------------------- loop forms

template <class T, int D, template <class, int> class Kernel>
struct Forms {
  using S = Vec<T, 1>;
  static constexpr int native = simd::native_width<T>;

  Options options;
  Fluid fluid;
  Particles<T, D>& s;

  template <class V>
  ALWAYS_INLINE void write(std::size_t i, const V* sums) const {
    if constexpr (V::width == 1) {
      for (std::size_t d = 0; d <= D; ++d) s.sums[d][i] = sums[d].v;
    } else {
      const auto total = sum(sums[0], sums[1], sums[2], sums[D]);
      for (std::size_t d = 0; d < D; ++d) s.sums[d][i] = T(total[static_cast<int>(d)]);
      s.sums[D][i] = T(total[3]);
    }
  }

  // Loads particle i into every lane.
  template <class V>
  struct Centre {
    V x[D], v[D], p;
    ALWAYS_INLINE Centre(Particles<T, D>& s, std::size_t i) : p(s.p()[i]) {
      for (int d = 0; d < D; ++d) {
        x[d] = V(s.x(d)[i]);
        v[d] = V(s.v(d)[i]);
      }
    }
    ALWAYS_INLINE explicit Centre(const T* record) : p(record[2 * D]) {
      for (int d = 0; d < D; ++d) {
        x[d] = V(record[d]);
        v[d] = V(record[D + d]);
      }
    }
  };

  // Particles j .. j + W - 1 of the arrays, or one record per lane.
  template <class V, bool Masked = false>
  ALWAYS_INLINE static void contiguous(const PairLaw<V, D, Kernel>& law, const Centre<V>& c, Particles<T, D>& s,
                                       std::size_t j, V* sums, int lanes = V::width) {
    V dx[D], dv[D];
    for (int d = 0; d < D; ++d) {
      dx[d] = c.x[d] - V::load(s.x(d) + j);
      dv[d] = c.v[d] - V::load(s.v(d) + j);
    }
    V volume = V::load(s.volume() + j);
    if constexpr (Masked) volume = mask_zero(Mask<T, V::width>::first(lanes), volume);
    law.add(dx, dv, c.p + V::load(s.p() + j), volume, sums);
  }
  template <class V>
  ALWAYS_INLINE static void records(const PairLaw<V, D, Kernel>& law, const Centre<V>& c, const T* base,
                                    const Index* list, V* sums) {
    V r[record_fields], dx[D], dv[D];
    simd::load_transposed<record_fields>(base, 1, list, r);
    for (int d = 0; d < D; ++d) {
      dx[d] = c.x[d] - r[d];
      dv[d] = c.v[d] - r[D + d];
    }
    law.add(dx, dv, c.p + r[2 * D], r[2 * D + 1], sums);
  }

  // Every candidate of the neighbouring cells, a branch on the distance.
  void scalar_branch(const Grid<D>& g) {
    const PairLaw<S, D, Kernel> law(fluid);
    const T radius2 = T(fluid.radius * fluid.radius);
    g.for_each_cell(options.threads, [&](int c, Index b, Index e) {
      for (Index i = b; i < e; ++i) {
        const Centre<S> centre(s, i);
        S sums[D + 1] = {};
        for (const int offset : g.row_offset) {
          const auto range = g.range(c, offset);
          const Index jb = range.first, je = range.second;
          for (Index j = jb; j < je; ++j) {
            T r2 = 0;
            for (int d = 0; d < D; ++d) r2 += (centre.x[d].v - s.x(d)[j]) * (centre.x[d].v - s.x(d)[j]);
            if (r2 < radius2) contiguous<S>(law, centre, s, j, sums);
          }
        }
        write(i, sums);
      }
    });
  }

  // Every candidate, no branch: the kernel is zero beyond its radius. Left to the compiler to vectorise.
  void omp_simd_masked(const Grid<D>& g) {
    const PairLaw<S, D, Kernel> law(fluid);
    const T tiny = law.tiny.v, eta = law.eta.v, viscosity = law.viscosity.v;
    const Kernel<S, D> kernel = law.kernel;
    g.for_each_cell(options.threads, [&](int c, Index b, Index e) {
      const T *x0 = s.x(0), *x1 = s.x(1), *x2 = s.x(D - 1), *v0 = s.v(0), *v1 = s.v(1), *v2 = s.v(D - 1);
      const T *p = s.p(), *volume = s.volume();
      for (Index i = b; i < e; ++i) {
        T a0 = 0, a1 = 0, a2 = 0, a3 = 0;
        for (const int offset : g.row_offset) {
          const auto range = g.range(c, offset);
          const Index jb = range.first, je = range.second;
#pragma omp simd reduction(+ : a0, a1, a2, a3)
          for (Index j = jb; j < je; ++j) {
            const T d0 = x0[i] - x0[j], d1 = x1[i] - x1[j], d2 = D == 3 ? x2[i] - x2[j] : T(0);
            const T w0 = v0[i] - v0[j], w1 = v1[i] - v1[j], w2 = D == 3 ? v2[i] - v2[j] : T(0);
            const T r2 = d0 * d0 + d1 * d1 + d2 * d2 + tiny, vr = w0 * d0 + w1 * d1 + w2 * d2;
            T F;
            if constexpr (std::is_same_v<Kernel<S, D>, WendlandC2<S, D>>) {
              T t = 1 + std::sqrt(r2) * kernel.half_inverse_h.v;
              t = t > 0 ? t : T(0);
              F = kernel.factor.v * t * t * t;
            } else {
              const T r = std::sqrt(r2), q = r * kernel.inverse_h.v, t = q < 2 ? 2 - q : T(0);
              const T inner = kernel.inner.v * (T(2.25) * q - 3), outer = kernel.outer.v * t * t / r;
              F = q < 1 ? inner : outer;
            }
            const T weight = volume[j] * F;
            const T force = weight * (p[i] + p[j] + viscosity * (vr < 0 ? vr : T(0)) / (r2 + eta));
            a0 += force * d0;
            a1 += force * d1;
            a2 += force * d2;
            a3 += weight * vr;
          }
        }
        S sums[D + 1];
        sums[0] = S(a0);
        sums[1] = S(a1);
        if constexpr (D == 3) sums[2] = S(a2);
        sums[D] = S(a3);
        write(i, sums);
      }
    });
  }

  // Every candidate, W at a time.
  template <int W>
  void vector_masked(const Grid<D>& g) {
    using V = Vec<T, W>;
    const PairLaw<V, D, Kernel> law(fluid);
    g.for_each_cell(options.threads, [&](int c, Index b, Index e) {
      for (Index i = b; i < e; ++i) {
        const Centre<V> centre(s, i);
        V sums[D + 1];
        std::fill(sums, sums + D + 1, V(T(0)));
        for (const int offset : g.row_offset) {
          const auto range = g.range(c, offset);
          const Index jb = range.first, je = range.second;
          Index j = jb;
          for (; j + W <= je; j += W) contiguous<V>(law, centre, s, j, sums);
          if (j < je) contiguous<V, true>(law, centre, s, j, sums, static_cast<int>(je - j));
        }
        write(i, sums);
      }
    });
  }

  // ---- stored full lists

  // Neighbours of i: index[start[i] .. start[i+1]), padded with i to a multiple of `multiple`. The entries are
  // multiplied by `Scale`: with the fields of a record they are offsets and need no address arithmetic.
  struct List {
    Array<Index> index;
    std::vector<std::size_t> start;
    std::size_t candidates = 0, entries = 0;
  };

  // Distances are tested in the precision B on copies of the positions; W candidates at a time.
  template <class B, int W, int Scale = record_fields>
  void build(const Grid<D>& g, double reach, int multiple, List& list) {
    using V = Vec<B, W>;
    static Array<B> position[D];
    const B* x[D];
    for (int d = 0; d < D; ++d) {
      if constexpr (std::is_same_v<B, T>) {
        x[d] = s.x(d);
      } else {
        position[d].assign(s.field[static_cast<std::size_t>(d)].begin(), s.field[static_cast<std::size_t>(d)].end());
        x[d] = position[d].data();
      }
    }
    if constexpr (!std::is_same_v<B, T>) reach += 4e-7;  // the rounding of two positions in the unit box
    const V reach2(B(reach * reach)), zero(B(0));
    const Vec<std::int32_t, W> lanes = Vec<std::int32_t, W>::iota() * Vec<std::int32_t, W>(Scale);
    list.start.resize(s.n + 1);
    // One chunk of cell rows per thread: lists are first written behind each other in a buffer of the chunk.
    const int rows = static_cast<int>(g.start.size() - 1) / g.side, chunks = options.threads;
    static std::vector<Array<Index>> buffer;
    buffer.resize(static_cast<std::size_t>(chunks));
    std::vector<std::size_t> total(static_cast<std::size_t>(chunks) + 1, 0);
    std::vector<Index> first(static_cast<std::size_t>(chunks) + 1, 0);
    std::size_t tested = 0, found = 0;
#pragma omp parallel for schedule(static, 1) num_threads(options.threads) reduction(+ : tested, found)
    for (int chunk = 0; chunk < chunks; ++chunk) {
      Array<Index>& out = chunks == 1 ? list.index : buffer[static_cast<std::size_t>(chunk)];
      std::size_t n = 0;
      const auto row_of = [&](int k) { return static_cast<int>(static_cast<long>(rows) * k / chunks); };
      first[static_cast<std::size_t>(chunk)] = g.start[static_cast<std::size_t>(row_of(chunk) * g.side)];
      for (int c = row_of(chunk) * g.side; c < row_of(chunk + 1) * g.side; ++c) {
        const Index b = g.start[static_cast<std::size_t>(c)], e = g.start[static_cast<std::size_t>(c) + 1];
        if (b == e) continue;
        std::size_t most = 0;
        for (const int offset : g.row_offset) {
          const auto range = g.range(c, offset);
          const Index jb = range.first, je = range.second;
          most += je - jb;
        }
        tested += most * (e - b);
        const std::size_t needed = n + (most + 64) * (e - b);
        if (out.size() < needed) out.resize(std::max(needed, 2 * out.size()));
        for (Index i = b; i < e; ++i) {
          list.start[i] = n;
          V xi[D];
          for (int d = 0; d < D; ++d) xi[d] = V(x[d][i]);
          const auto distance2 = [&](Index j) __attribute__((always_inline)) {
            V r2 = zero;
            for (int d = 0; d < D; ++d) {
              const V dx = xi[d] - V::load(x[d] + j);
              r2 = d == 0 ? dx * dx : fma(dx, dx, r2);
            }
            return r2;
          };
          for (const int offset : g.row_offset) {
            const auto range = g.range(c, offset);
            const Index jb = range.first, je = range.second;
            Index j = jb;
            Vec<std::int32_t, W> index = lanes + Vec<std::int32_t, W>(static_cast<std::int32_t>(j * Scale));
            for (; j + W <= je; j += W, index += Vec<std::int32_t, W>(W * Scale)) {
              const V r2 = distance2(j);
              n += static_cast<std::size_t>(compress_store(out.data() + n, (r2 < reach2) & (r2 > zero), index));
            }
            if (j < je) {
              const V r2 = distance2(j);
              const auto in = (r2 < reach2) & (r2 > zero) & Mask<B, W>::first(static_cast<int>(je - j));
              n += static_cast<std::size_t>(compress_store(out.data() + n, in, index));
            }
          }
          found += n - list.start[i];
          while ((n - list.start[i]) % static_cast<std::size_t>(multiple) != 0) out[n++] = i * Scale;
        }
      }
      total[static_cast<std::size_t>(chunk) + 1] = n;
    }
    first[static_cast<std::size_t>(chunks)] = static_cast<Index>(s.n);
    for (std::size_t k = 0; k < static_cast<std::size_t>(chunks); ++k) total[k + 1] += total[k];
    if (chunks > 1) {
      if (list.index.size() < total.back()) list.index.resize(total.back() + total.back() / 8);
#pragma omp parallel for schedule(static, 1) num_threads(options.threads)
      for (int chunk = 0; chunk < chunks; ++chunk) {
        const std::size_t k = static_cast<std::size_t>(chunk);
        std::copy_n(buffer[k].begin(), total[k + 1] - total[k], list.index.begin() + static_cast<long>(total[k]));
        for (Index i = first[k]; i < first[k + 1]; ++i) list.start[i] += total[k];
      }
    }
    list.start[s.n] = total.back();
    list.candidates = tested;
    list.entries = found;
  }

  void pack(Array<T>& record) {
    record.resize(s.n * record_fields + padding);
    T* out = record.data();
#pragma omp parallel for schedule(static) num_threads(options.threads)
    for (std::size_t i = 0; i < s.n; ++i) {
      for (std::size_t f = 0; f < 2 * D + 2; ++f) out[i * record_fields + f] = s.field[f][i];
      if constexpr (D == 2) out[i * record_fields + 6] = out[i * record_fields + 7] = T(0);
    }
  }

  // The list loop proper: hands the sums of each particle to `finish`.
  template <int W, class F>
  ALWAYS_INLINE void over_list(const List& list, const T* record, F finish) {
    using V = Vec<T, W>;
    const PairLaw<V, D, Kernel> law(fluid);
#pragma omp parallel for schedule(static) num_threads(options.threads)
    for (std::size_t i = 0; i < s.n; ++i) {
      const Centre<V> centre(record + i * record_fields);
      V sums[D + 1];
      std::fill(sums, sums + D + 1, V(T(0)));
      const Index *k = list.index.data() + list.start[i], *end = list.index.data() + list.start[i + 1];
      for (; k != end; k += W) records<V>(law, centre, record, k, sums);
      finish(i, sums);
    }
  }
  template <int W>
  void list_records(const List& list, const Array<T>& record) {
    over_list<W>(list, record.data(), [&](std::size_t i, const auto* sums) { write(i, sums); });
  }

  // Mixed precision: positions are integers in units of 2^-30 (differences are exact), the rest of the record and the
  // sums of one particle are single precision.
  static constexpr double unit = 0x1p-30;
  void pack_mixed(Array<float>& record) {
    record.resize(s.n * record_fields + padding);
    float* out = record.data();
#pragma omp parallel for schedule(static) num_threads(options.threads)
    for (std::size_t i = 0; i < s.n; ++i) {
      for (std::size_t f = 0; f < D; ++f)
        out[i * record_fields + f] = std::bit_cast<float>(static_cast<std::int32_t>(s.field[f][i] * T(1 / unit)));
      for (std::size_t f = D; f < 2 * D + 2; ++f) out[i * record_fields + f] = static_cast<float>(s.field[f][i]);
    }
  }
  void list_mixed(const List& list, const Array<float>& record) {
    constexpr int W = simd::native_width<float>;
    using V = Vec<float, W>;
    const PairLaw<V, D, Kernel> law(fluid, unit);
    const float* base = record.data();
#pragma omp parallel for schedule(static) num_threads(options.threads)
    for (std::size_t i = 0; i < s.n; ++i) {
      V c[2 * D + 1], sums[D + 1];
      for (std::size_t f = 0; f <= 2 * D; ++f) c[f] = V(base[i * record_fields + f]);
      std::fill(sums, sums + D + 1, V(0.0f));
      const Index *k = list.index.data() + list.start[i], *end = list.index.data() + list.start[i + 1];
      for (; k != end; k += W) {
        V r[record_fields], dx[D], dv[D];
        simd::load_transposed<record_fields>(base, 1, k, r);
        for (int d = 0; d < D; ++d) {
          dx[d] = simd::convert<float>(simd::bit_cast<std::int32_t>(c[d]) - simd::bit_cast<std::int32_t>(r[d]));
          dv[d] = c[D + d] - r[D + d];
        }
        law.add(dx, dv, c[2 * D] + r[2 * D], r[2 * D + 1], sums);
      }
      for (V& q : sums) q *= V(float(unit));
      write(i, sums);
    }
  }

  // The law of the program's plain air in the loop that is best here: eight sums (eleven in 3D) instead of three. R is
  // the precision of the records; positions are whole numbers of `unit` where it is single.
  static constexpr std::size_t air_sums = 3 * D + 2, air_fields = (air_sums + 3) / 4 * 4;
  template <class R, class F>
  ALWAYS_INLINE void over_list_air(const List& list, const R* base, F finish) {
    constexpr int W = simd::native_width<R>;
    using V = Vec<R, W>;
    using Law = barchan::PlainFluid<D>;
    const barchan::WendlandC2<R> kernel(fluid.radius, D);
#pragma omp parallel for schedule(static) num_threads(options.threads)
    for (std::size_t i = 0; i < s.n; ++i) {
      typename Law::template Own<V> own;
      for (std::size_t d = 0; d < D; ++d) {
        own.x[d] = V(base[i * record_fields + d]);
        own.v[d] = V(base[i * record_fields + D + d]);
      }
      own.p = V(base[i * record_fields + 2 * D]);
      typename Law::template Sums<V> sums{};
      const Index *k = list.index.data() + list.start[i], *end = list.index.data() + list.start[i + 1];
      for (; k != end; k += W) {
        V b[record_fields], r2(R(0));
        simd::load_transposed<record_fields>(base, 1, k, b);
        std::array<V, D> r;
        for (std::size_t d = 0; d < D; ++d) {
          if constexpr (sizeof(R) == 8) r[d] = own.x[d] - b[d];
          else
            r[d] = V(R(unit)) *
                   simd::convert<R>(simd::bit_cast<std::int32_t>(own.x[d]) - simd::bit_cast<std::int32_t>(b[d]));
          r2 = fma(r[d], r[d], r2);
        }
        Law::add(own, r, r2, kernel.slope(r2), b + D, b[2 * D], b[2 * D + 1], sums);
      }
      std::array<V, air_fields> all;
      all.fill(V(R(0)));
      std::memcpy(static_cast<void*>(all.data()), &sums, sizeof(sums));
      alignas(64) std::array<R, air_fields> total;
      for (std::size_t q = 0; q < air_fields; q += 4) sum(all[q], all[q + 1], all[q + 2], all[q + 3]).store(&total[q]);
      finish(i, total);
    }
  }
  template <class R>
  void list_air(const List& list, const Array<R>& record, Array<R>& out) {
    out.resize(s.n * air_fields);
    R* to = out.data();
    over_list_air<R>(
        list, record.data(), [=](std::size_t i, const auto& total) __attribute__((always_inline)) {
          std::memcpy(to + i * air_fields, total.data(), sizeof(total));
        });
  }
  // Whole steps of that air: momentum, continuity with density diffusion, shifts.
  template <class R, class B>
  void steps_air(Grid<D>& g, List& list, Array<R>& record, Array<R>& out, int count, T dt) {
    const T mass = T(fluid.mass), inverse_density = T(1 / fluid.density), stiffness = T(fluid.stiffness());
    for (int step = 0; step < count; ++step) {
      if (step % options.rebuild == 0) {
        counting_sort(s, g);
        build<B, simd::native_width<B>>(g, fluid.radius * options.skin, simd::native_width<R>, list);
      }
      if constexpr (std::is_same_v<R, T>) pack(record);
      else pack_mixed(record);
      list_air<R>(list, record, out);
      T *x[D], *v[D], *p = s.p(), *volume = s.volume();
      for (int d = 0; d < D; ++d) {
        x[d] = s.x(d);
        v[d] = s.v(d);
      }
      const R* sums = out.data();
#pragma omp parallel for simd schedule(static) num_threads(options.threads)
      for (std::size_t i = 0; i < s.n; ++i) {
        const R* q = sums + i * air_fields;
        const T specific = volume[i] / mass;
        for (int d = 0; d < D; ++d) {
          v[d][i] += dt * specific * (T(1e-3) * T(q[D + d]) - T(q[d]));
          x[d][i] += dt * (v[d][i] - T(1e-3) * T(q[2 * D + d]));
        }
        const T density = mass / volume[i] * (1 + dt * T(q[3 * D])) + dt * T(1e-3) * T(q[3 * D + 1]);
        volume[i] = mass / density;
        p[i] = equation_of_state(stiffness, density * inverse_density);
      }
    }
  }

  // The list loop without records: one gather per field.
  template <int W>
  void list_gather(const List& list) {
    using V = Vec<T, W>;
    const PairLaw<V, D, Kernel> law(fluid);
#pragma omp parallel for schedule(static) num_threads(options.threads)
    for (std::size_t i = 0; i < s.n; ++i) {
      const Centre<V> centre(s, i);
      V sums[D + 1];
      std::fill(sums, sums + D + 1, V(T(0)));
      for (std::size_t k = list.start[i]; k < list.start[i + 1]; k += W) {
        const Index* list_k = list.index.data() + k;
        V dx[D], dv[D];
        for (int d = 0; d < D; ++d) {
          dx[d] = centre.x[d] - simd::gather<T, W>(s.x(d), list_k);
          dv[d] = centre.v[d] - simd::gather<T, W>(s.v(d), list_k);
        }
        law.add(dx, dv, centre.p + simd::gather<T, W>(s.p(), list_k), simd::gather<T, W>(s.volume(), list_k), sums);
      }
      write(i, sums);
    }
  }

  // The arithmetic alone: `count` contiguous neighbours in the first-level cache, no tails.
  template <int W>
  void roof(std::size_t particles, std::size_t count) {
    using V = Vec<T, W>;
    const PairLaw<V, D, Kernel> law(fluid);
#pragma omp parallel for schedule(static) num_threads(options.threads)
    for (std::size_t k = 0; k < particles; ++k) {
      const Centre<V> centre(s, k & 255);
      V sums[D + 1];
      std::fill(sums, sums + D + 1, V(T(0)));
      for (std::size_t j = 0; j < count; j += W) contiguous<V>(law, centre, s, j, sums);
      write(256 + (k & 255), sums);
    }
  }

  // ---- whole steps

  // Symplectic Euler on the arrays.
  void integrate(T dt) {
    const T mass = T(fluid.mass), inverse_density = T(1 / fluid.density), stiffness = T(fluid.stiffness());
    T *x[D], *v[D], *sums[D + 1], *p = s.p(), *volume = s.volume();
    for (int d = 0; d < D; ++d) {
      x[d] = s.x(d);
      v[d] = s.v(d);
    }
    for (std::size_t d = 0; d <= D; ++d) sums[d] = s.sums[d].data();
#pragma omp parallel for simd schedule(static) num_threads(options.threads)
    for (std::size_t i = 0; i < s.n; ++i) {
      for (int d = 0; d < D; ++d) {
        v[d][i] -= dt * sums[d][i] * volume[i] / mass;
        x[d][i] += dt * v[d][i];
      }
      const T density = mass / volume[i] * (1 + dt * sums[D][i]);
      volume[i] = mass / density;
      p[i] = equation_of_state(stiffness, density * inverse_density);
    }
  }

  // Arrays as the state: sort and build every `rebuild` steps, pack, pairs, integrate.
  template <class B, int W>
  void steps_arrays(Grid<D>& g, List& list, Array<T>& record, int count, T dt) {
    for (int step = 0; step < count; ++step) {
      if (step % options.rebuild == 0) {
        counting_sort(s, g);
        build<B, simd::native_width<B>>(g, fluid.radius * options.skin, W, list);
      }
      pack(record);
      list_records<W>(list, record);
      integrate(dt);
    }
  }

  // Records as the state: the particle is advanced as soon as its sums are known, into a second array of records.
  template <class B, int W>
  void steps_fused(Grid<D>& g, List& list, Array<T>& record, Array<T>& next, int count, T dt) {
    const T mass = T(fluid.mass), inverse_density = T(1 / fluid.density), stiffness = T(fluid.stiffness());
    for (int step = 0; step < count; ++step) {
      if (step % options.rebuild == 0) {
        counting_sort(s, g);
        build<B, simd::native_width<B>>(g, fluid.radius * options.skin, W, list);
        pack(record);
        next.resize(record.size());
      }
      const T* in = record.data();
      T* out = next.data();
      over_list<W>(
          list, in, [=](std::size_t i, const auto* sums) __attribute__((always_inline)) {
            const T* old = in + i * record_fields;
            const Vec<T, 4> total = sum(sums[0], sums[1], sums[2], sums[D]);
            alignas(32) T r[4];
            total.store(r);
            alignas(64) T now[record_fields] = {};
            const T volume = old[2 * D + 1], factor = dt * volume / mass;
            for (int d = 0; d < D; ++d) {
              now[D + d] = old[D + d] - factor * r[d];
              now[d] = old[d] + dt * now[D + d];
            }
            const T density = mass / volume * (1 + dt * r[3]);
            now[2 * D] = equation_of_state(stiffness, density * inverse_density);
            now[2 * D + 1] = mass / density;
            std::memcpy(out + i * record_fields, now, sizeof(now));
          });
      std::swap(record, next);
      if ((step + 1) % options.rebuild == 0 || step + 1 == count) {  // back to arrays for the sort
        const T* r = record.data();
#pragma omp parallel for schedule(static) num_threads(options.threads)
        for (std::size_t i = 0; i < s.n; ++i)
          for (std::size_t f = 0; f < 2 * D + 2; ++f) s.field[f][i] = r[i * record_fields + f];
      }
    }
  }
};

// ------------------------------------------------------------------------------------------------------ measurement

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Row {
  std::string name;
  double pairs, steps, error;  // M pairs/s, M particle-steps/s, relative to the scalar loop (< 0: not applicable)
};

template <class T, int D, template <class, int> class Kernel>
void run(const Options& options) {
  using F = Forms<T, D, Kernel>;
  constexpr int W = F::native;
  Fluid fluid{};
  Particles<T, D> s = make_particles<T, D>(options.n, fluid);
  F forms{options, fluid, s};
  const double n = static_cast<double>(s.n);
  Grid<D> tight(fluid.radius, options.cells), wide(fluid.radius * options.skin, options.cells);
  std::vector<Row> rows;

  counting_sort(s, tight);
  typename F::List list;
  forms.template build<T, W>(tight, fluid.radius, 1, list);
  const double neighbours = static_cast<double>(list.entries) / n;

  std::array<Array<T>, D + 1> reference;
  const auto error = [&] {
    double worst = 0;
    for (std::size_t d = 0; d <= D; ++d) {
      double difference = 0, norm = 0;
      for (std::size_t i = 0; i < s.n; ++i) {
        const double r = reference[d][i], e = s.sums[d][i] - r;
        difference += e * e;
        norm += r * r;
      }
      worst = std::max(worst, std::sqrt(difference / norm));
    }
    return worst;
  };
  // particles: particle-steps per call of f; pairs: pairs (or candidates) per call.
  const auto measure = [&](const std::string& name, double particles, double pairs, bool check, auto f) {
    for (auto& a : s.sums)
      if (check) std::fill(a.begin(), a.end(), T(0));
    f();
    const double e = check && !reference[0].empty() ? error() : -1;
    std::vector<double> seconds;
    for (int k = 0; k < options.repeat; ++k) {
      const double t = cpu_seconds();
      f();
      seconds.push_back(cpu_seconds() - t);
    }
    std::nth_element(seconds.begin(), seconds.begin() + options.repeat / 2, seconds.end());
    const double t = seconds[static_cast<std::size_t>(options.repeat / 2)] * 1e6;
    rows.push_back({name, pairs / t, particles / t, e});
    if (!options.json) {
      std::printf("  %-44s %9.1f %9.2f", name.c_str(), rows.back().pairs, rows.back().steps);
      if (e >= 0) std::printf("   %.1e", e);
      std::printf("\n");
      std::fflush(stdout);
    }
  };
  if (!options.json)
    std::printf("%dD %s %s N = %zu, %.1f neighbours, skin %.2f, %d thread(s), %d lanes\n  %-44s %9s %9s   %s\n", D,
                sizeof(T) == 8 ? "fp64" : "fp32", options.cubic ? "cubic spline" : "Wendland C2", s.n, neighbours,
                options.skin, options.threads, W, "form", "M pairs/s", "M steps/s", "error");

  const double all = n * neighbours;
  measure("scalar, branch", n, all, true, [&] { forms.scalar_branch(tight); });
  reference = s.sums;
  measure("omp simd, all candidates", n, all, true, [&] { forms.omp_simd_masked(tight); });
  measure("vectors, all candidates", n, all, true, [&] { forms.template vector_masked<W>(tight); });

  counting_sort(s, wide);
  forms.scalar_branch(wide);
  reference = s.sums;
  Array<T> record, next;
  forms.pack(record);
  forms.template build<T, W>(wide, fluid.radius * options.skin, 1, list);
  const double candidates = static_cast<double>(list.candidates), entries = static_cast<double>(list.entries);
  const std::string per = " (" + std::to_string(entries / n).substr(0, 5) + " entries)";
  forms.template build<T, W, 1>(wide, fluid.radius * options.skin, W, list);
  measure("list, gather" + per, n, all, true, [&] { forms.template list_gather<W>(list); });
  forms.template build<T, W>(wide, fluid.radius * options.skin, W, list);
  measure("list, records, scalar", n, all, true, [&] { forms.template list_records<1>(list, record); });
  measure("list, records", n, all, true, [&] { forms.template list_records<W>(list, record); });
  measure("list, pack + records", n, all, true, [&] {
    forms.pack(record);
    forms.template list_records<W>(list, record);
  });
  forms.template build<T, W>(wide, fluid.radius * options.skin, 2 * W, list);
  measure("list, records, two vectors at once", n, all, true,
          [&] { forms.template list_records<2 * W>(list, record); });
  Array<float> mixed;
  forms.pack_mixed(mixed);
  forms.template build<T, W>(wide, fluid.radius * options.skin, simd::native_width<float>, list);
  measure("list, mixed precision records", n, all, true, [&] { forms.list_mixed(list, mixed); });
  if constexpr (sizeof(T) == 8) {
    Array<T> sums_of_air;
    Array<float> compact_sums;
    measure("list, mixed precision, law of the air", n, all, false,
            [&] { forms.template list_air<float>(list, mixed, compact_sums); });
    forms.template build<T, W>(wide, fluid.radius * options.skin, W, list);
    measure("list, records, law of the air", n, all, false,
            [&] { forms.template list_air<T>(list, record, sums_of_air); });
    double difference = 0, norm = 0;  // the two precisions against each other
    for (std::size_t i = 0; i < sums_of_air.size(); ++i) {
      difference += std::pow(sums_of_air[i] - static_cast<double>(compact_sums[i]), 2);
      norm += sums_of_air[i] * sums_of_air[i];
    }
    if (!options.json) std::printf("    mixed against double: %.1e\n", std::sqrt(difference / norm));
  }
  measure("roof, 32 contiguous", n, n * 32, false, [&] { forms.template roof<W>(s.n, 32); });
  measure("roof, 256 contiguous", n / 8, n * 32, false, [&] { forms.template roof<W>(s.n / 8, 256); });

  measure("list build (pairs: candidates)", n, candidates, false,
          [&] { forms.template build<T, W>(wide, fluid.radius * options.skin, W, list); });
  if constexpr (sizeof(T) == 8)
    measure("list build, single precision test", n, candidates, false, [&] {
      forms.template build<float, simd::native_width<float>>(wide, fluid.radius * options.skin, W, list);
    });
  measure("counting sort", n, 0, false, [&] { counting_sort(s, wide); });

  const std::string every = ", list every " + std::to_string(options.rebuild);
  const T dt = T(1e-9);
  const int count = options.rebuild < 5 ? 5 * options.rebuild : options.rebuild;
  measure("whole step, arrays" + every, n * count, all * count, false,
          [&] { forms.template steps_arrays<float, W>(wide, list, record, count, dt); });
  measure("whole step, fused records" + every, n * count, all * count, false,
          [&] { forms.template steps_fused<float, W>(wide, list, record, next, count, dt); });
  if constexpr (sizeof(T) == 8) {
    Array<T> sums_of_air;
    Array<float> compact_sums;
    measure("whole step, law of the air" + every, n * count, all * count, false,
            [&] { forms.template steps_air<T, float>(wide, list, record, sums_of_air, count, dt); });
    measure("whole step, law of the air, mixed" + every, n * count, all * count, false,
            [&] { forms.template steps_air<float, float>(wide, list, mixed, compact_sums, count, dt); });
  }
  counting_sort(s, wide);
  forms.scalar_branch(wide);
  reference = s.sums;
  forms.template build<float, simd::native_width<float>>(wide, fluid.radius * options.skin, W, list);
  forms.pack(record);
  forms.template list_records<W>(list, record);
  const double last = error();
  if (!options.json) std::printf("  list loop after the steps: error %.1e\n", last);

  if (options.json) {
    std::printf(
        "{\"dimension\": %d, \"precision\": \"%s\", \"kernel\": \"%s\", \"particles\": %zu, \"neighbours\": "
        "%.3f, \"entries\": %.3f, \"candidates\": %.3f, \"skin\": %g, \"rebuild\": %d, \"cells\": %d, "
        "\"threads\": %d, \"lanes\": %d, \"forms\": [",
        D, sizeof(T) == 8 ? "double" : "float", options.cubic ? "cubic" : "wendland", s.n, neighbours, entries / n,
        candidates / n, options.skin, options.rebuild, options.cells, options.threads, W);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      std::printf("%s\n  {\"form\": \"%s\", \"mega_pairs_per_second\": %.4g, \"mega_particle_steps_per_second\": %.4g",
                  k ? "," : "", rows[k].name.c_str(), rows[k].pairs, rows[k].steps);
      if (rows[k].error >= 0) std::printf(", \"error\": %.2e", rows[k].error);
      std::printf("}");
    }
    std::printf("\n]}\n");
  }
}

template <class T, int D>
void run_kernel(const Options& o) {
  o.cubic ? run<T, D, CubicSpline>(o) : run<T, D, WendlandC2>(o);
}

int usage() {
  std::fprintf(
      stderr,
      "usage: pairs [--dim 2|3] [--n N] [--precision d|f] [--kernel wendland|cubic] [--threads N] [--repeat N]\n"
      "             [--skin F] [--rebuild N] [--cells N] [--json]\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  for (int k = 1; k < argc; ++k) {
    const std::string_view name = argv[k];
    if (name == "--json") {
      o.json = true;
      continue;
    }
    if (k + 1 == argc) return usage();
    const char* value = argv[++k];
    if (name == "--dim") o.dim = std::atoi(value);
    else if (name == "--n") o.n = std::atoi(value);
    else if (name == "--precision") o.single = value[0] == 'f';
    else if (name == "--kernel") o.cubic = value[0] == 'c';
    else if (name == "--threads") o.threads = std::atoi(value);
    else if (name == "--repeat") o.repeat = std::atoi(value);
    else if (name == "--skin") o.skin = std::atof(value);
    else if (name == "--rebuild") o.rebuild = std::atoi(value);
    else if (name == "--cells") o.cells = std::atoi(value);
    else return usage();
  }
  if ((o.dim != 2 && o.dim != 3) || o.n < 1000 || o.threads < 1 || o.repeat < 1 || o.rebuild < 1 || o.cells < 1 ||
      !(o.skin >= 1))
    return usage();
  if (o.dim == 2) o.single ? run_kernel<float, 2>(o) : run_kernel<double, 2>(o);
  else o.single ? run_kernel<float, 3>(o) : run_kernel<double, 3>(o);
}
