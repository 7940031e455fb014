#include "models/grains/sphere_forces.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "models/grains/solid_walls.hpp"
#include "models/grains/sphere_motion.hpp"
#include "models/grains/sphere_vectors.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

using namespace sphere_motion;
using namespace sphere_vectors;
using One = simd::Vec<double, 1>;

/// Adds the force of a touch to what a wall feels; the sphere's own is the opposite, at `place`.
template <int Dim>
void push_wall(const SphereStep& step, SphereChunk& chunk, std::size_t law, const std::array<double, Dim>& force,
               const std::array<double, Dim>& place) {
  for (std::size_t w = 0; w < step.watched.size(); ++w) {
    if (step.watched[w].law != law) continue;
    std::array<double, 3> f{}, r{};
    for (std::size_t d = 0; d < Dim; ++d) {
      f[d] = -force[d];
      r[d] = place[d] - step.watched[w].about[d];
      if (step.period[d] > 0.0) r[d] -= step.period[d] * std::round(r[d] / step.period[d]);
    }
    auto& to = chunk.pushed[w];
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t e = (d + 1) % 3, g = (d + 2) % 3;
      to[d] += f[d];
      to[3 + d] += r[e] * f[g] - r[g] * f[e];
    }
  }
}

/// What a chunk's pairs add up to, lane by lane.
struct Tally {
  V lost{0.0}, stored{0.0}, deepest{0.0};
  double contacts = 0.0;
};

/// Pairs of a vector whose spheres both sleep: the two far away take their places, and they keep their memory.
class Resting {
 public:
  BARCHAN_SIMD_INLINE Resting(const std::uint32_t*& a, const std::uint32_t*& b, std::uint32_t live, double* memory,
                              std::size_t numbers, std::uint32_t far)
      : live_(live), numbers_(numbers), memory_(memory) {
    if (live == lanes) return;
    for (std::size_t k = 0; k < width; ++k) {
      const bool evaluated = (live >> k & 1u) != 0;
      a_[k] = evaluated ? a[k] : far;
      b_[k] = evaluated ? b[k] : far + 1;
      for (std::size_t m = 0; m < numbers && !evaluated; ++m) {
        kept_[m][k] = memory[m * batch + k];
        memory[m * batch + k] = 0.0;
      }
    }
    a = a_;
    b = b_;
  }
  Resting(const Resting&) = delete;
  Resting& operator=(const Resting&) = delete;
  BARCHAN_SIMD_INLINE ~Resting() {
    if (live_ == lanes) return;
    for (std::size_t k = 0; k < width; ++k)
      for (std::size_t m = 0; m < numbers_ && (live_ >> k & 1u) == 0; ++m) memory_[m * batch + k] = kept_[m][k];
  }

 private:
  static constexpr std::uint32_t lanes = (1u << width) - 1u;
  std::uint32_t live_;
  std::size_t numbers_;
  double* memory_;
  std::uint32_t a_[width], b_[width];
  double kept_[ContactMemory::most_numbers][width];
};

/// The pairs of one law, a SphereContact (laws/sphere_contact.hpp).
template <int Dim, class Law>
void group_of(const Law& law, const SphereStep& step, SphereChunk& chunk, const SphereChunk::Group& group,
              Sums<Dim>& sums, Tally& tally) {
  using R = SphereRecord<Dim>;
  constexpr bool Rubs = Law::rubs;
  constexpr std::size_t spins = R::spins, numbers = Law::template numbers<Dim>, springs = Law::template springs<Dim>;
  const typename Law::template Constants<V> constants(law, step.contacts);
  const V of_a(step.inverse_densities[2 * group.law]), of_b(step.inverse_densities[2 * group.law + 1]);
  const V drop(law.left_behind());
  constexpr double magic = 6755399441055744.0;  // 1.5 2^52: added and taken off it rounds to the nearest whole number
  // The periods between two spheres: the nearest whole number, or that of the group's image.
  std::array<V, Dim> period, turns, start;
  for (std::size_t d = 0; d < Dim; ++d) {
    const bool nearest = group.image == pair_image::nearest, periodic = step.period[d] > 0.0;
    period[d] = V(step.period[d]);
    turns[d] = V(periodic && nearest ? 1.0 / step.period[d] : 0.0);
    start[d] = V(magic + (periodic && !nearest ? pair_image::periods(group.image, d) : 0));
  }
  const auto count = static_cast<std::uint32_t>(chunk.end - chunk.begin);
  const bool watched =
      std::any_of(step.watched.begin(), step.watched.end(), [&](const WatchedLaw& w) { return w.law == group.law; });
  // Pairs that may touch within a step.
  const V margin(step.dt * (chunk.fastest + (group.weight < 1.0 ? step.fastest : chunk.fastest) + step.fastest_wall));
  const double* records = step.records;
  const std::size_t stride = R::size, of_a_batch = step.numbers * batch;
  double* of_batch = chunk.of_pair(group.first * batch, step.numbers);
  constexpr std::uint32_t lanes = (1u << width) - 1u;
  for (std::size_t q = group.first; q < group.end; ++q, of_batch += of_a_batch)
    for (std::size_t half = 0; half < batch; half += width) {
      const std::uint32_t live = chunk.live_of(q) >> half & lanes;
      if (live == 0) continue;
      const std::uint32_t *a = chunk.a.data() + q * batch + half, *b = chunk.b.data() + q * batch + half;
      const std::uint32_t had = chunk.touches[q] >> half & live;
      if (q + 1 < group.end) fetch<Dim>(records, a + batch, b + batch);
      const Resting resting(a, b, live, of_batch + half, numbers, step.far);
      V x_a[4], x_b[4];
      simd::load_transposed<4>(records, stride, a, x_a);
      simd::load_transposed<4>(records, stride, b, x_b);
      TouchingSpheres<V, Dim> s;
      V r2(least_square);
      for (std::size_t d = 0; d < Dim; ++d) {
        V r = x_a[d] - x_b[d];
        const V away = fma(r, turns[d], start[d]) - V(magic);
        r = fnma(away, period[d], r);
        s.normal[d] = r;
        r2 = fma(r, r, r2);
      }
      const V r_a = x_a[R::radius], r_b = x_b[R::radius], reach = r_a + r_b;
      const auto near = r2 < (reach + margin) * (reach + margin);
      if ((to_bits(near) | had) == 0) continue;
      double* memory = of_batch + half;
      if (to_bits(near) == 0) {
        for (std::size_t k = 0; k < springs; ++k) {
          const V slip = V::load(memory + k * batch);
          tally.lost = fma(drop * V(group.weight), slip * slip, tally.lost);
        }
        for (std::size_t k = 0; k < numbers; ++k) V(0.0).store(memory + k * batch);
        chunk.touches[q] = static_cast<std::uint8_t>(chunk.touches[q] & ~(live << half));
        continue;
      }
      V v_a[4], v_b[4], w_a[4], w_b[4];
      simd::load_transposed<4>(records + R::velocity, stride, a, v_a);
      simd::load_transposed<4>(records + R::velocity, stride, b, v_b);
      if constexpr (Dim == 3 && Rubs) {
        simd::load_transposed<4>(records + R::spin, stride, a, w_a);
        simd::load_transposed<4>(records + R::spin, stride, b, w_b);
      }
      // One quotient for all: 1/distance, 1/reach, m* and its inverse.
      const V a3 = r_a * r_a * r_a, b3 = r_b * r_b * r_b, both = a3 * b3, mass = fma(of_a, b3, of_b * a3);
      const V distance = simd::sqrt(r2), lengths = distance * reach, masses = both * mass;
      const V quotient = V(1.0) / (lengths * masses), of_lengths = quotient * masses, of_masses = quotient * lengths;
      const V inverse = of_lengths * reach, inverse_reach = of_lengths * distance;
      s.overlap = reach - distance;
      V parts(0.0);
      for (std::size_t d = 0; d < Dim; ++d) {
        s.normal[d] *= inverse;
        s.velocity[d] = v_a[d] - v_b[d];
        parts = fma(s.velocity[d], s.normal[d], parts);
      }
      const auto touching = near & (s.overlap > V(-step.dt) * simd::max(parts, -parts));
      const std::uint32_t has = to_bits(touching);
      if ((has | had) == 0) continue;
      for (std::size_t d = 0; d < spins; ++d) {
        s.spin_a[d] = Rubs ? (Dim == 2 ? v_a[2] : w_a[d]) : V(0.0);
        s.spin_b[d] = Rubs ? (Dim == 2 ? v_b[2] : w_b[d]) : V(0.0);
      }
      const V share_a = r_a * inverse_reach;
      s.lever_a = share_a * distance;
      s.lever_b = distance - s.lever_a;
      s.reduced_radius = share_a * r_b;
      s.reduced_mass = both * both * of_masses;
      s.inverse_mass = mass * mass * of_masses;
      std::array<V, numbers> slip;  // and what else it remembers
      for (std::size_t k = 0; k < numbers; ++k) slip[k] = V::load(memory + k * batch);
      if constexpr (Rubs) {
        if (had & ~has) {
          const V gone = select(touching, V(0.0), drop * V(group.weight));
          for (std::size_t k = 0; k < springs; ++k) tally.lost = fma(gone, slip[k] * slip[k], tally.lost);
        }
      }
      ContactForces<V, Dim> f = Law::touch(constants, s, slip);
      for (std::size_t k = 0; k < numbers; ++k) mask_zero(touching, slip[k]).store(memory + k * batch);
      for (auto& x : f.force) x = mask_zero(touching, x);
      if constexpr (Rubs)
        for (std::size_t d = 0; d < spins; ++d) {
          f.torque_a[d] = mask_zero(touching, f.torque_a[d]);
          f.torque_b[d] = mask_zero(touching, f.torque_b[d]);
        }
      tally.lost = fma(V(group.weight), mask_zero(touching, f.lost), tally.lost);
      tally.stored = fma(V(group.weight), mask_zero(touching, f.stored), tally.stored);
      tally.deepest = simd::max(mask_zero(touching, s.overlap * inverse_reach), tally.deepest);
      chunk.touches[q] = static_cast<std::uint8_t>((chunk.touches[q] & ~(live << half)) | has << half);
      tally.contacts += group.weight * std::popcount(has);
      add_up<Dim, Rubs>(sums, f, a, b, chunk.begin, count);
      if (!watched) continue;
      for (int k = 0; k < static_cast<int>(width); ++k) {
        if ((has >> k & 1u) == 0) continue;
        std::array<double, Dim> force, place;
        for (std::size_t d = 0; d < Dim; ++d) {
          force[d] = f.force[d][k];
          place[d] = x_a[d][k] - s.lever_a[k] * s.normal[d][k];
        }
        push_wall<Dim>(step, chunk, group.law, force, place);
      }
    }
}

/// Where a sphere touches what does not yield: a side of the domain or a wall.
template <int Dim>
struct Surface {
  std::array<double, Dim> normal, velocity, place;  // m/s, of the wall there; m
  std::array<double, SphereRecord<Dim>::spins> rate;
  double distance;  // m, of the sphere's centre
  bool is_felt;     // by a sphere that sleeps too
};

/// The forces of a surface, which is a sphere without end, on a sphere of the chunk. `memory`: of the contact.
template <int Dim, class Law>
void press(const Law& law, const SphereStep& step, SphereChunk& chunk, std::size_t number, std::size_t sphere,
           const Surface<Dim>& of, double* memory, Sums<Dim>& sums) {
  using R = SphereRecord<Dim>;
  constexpr std::size_t spins = R::spins, numbers = Law::template numbers<Dim>;
  const double* r = step.records + sphere * R::size;
  const double radius = r[R::radius], overlap = radius - of.distance;
  TouchingSpheres<One, Dim> s;
  for (std::size_t d = 0; d < Dim; ++d) {
    s.normal[d] = One(of.normal[d]);
    s.velocity[d] = One(r[R::velocity + d] - of.velocity[d]);
  }
  for (std::size_t d = 0; d < spins; ++d) {
    s.spin_a[d] = One(r[R::spin + d]);
    s.spin_b[d] = One(of.rate[d]);
  }
  s.overlap = One(overlap);
  s.lever_a = One(of.distance);
  s.lever_b = One(0.0);
  s.reduced_radius = One(radius);
  s.inverse_mass = One(step.passive[sphere * passive_size + passive_mass]);
  s.reduced_mass = One(1.0) / s.inverse_mass;
  std::array<One, numbers> slip;
  for (std::size_t k = 0; k < numbers; ++k) slip[k] = One(memory[k]);
  const auto f = Law::touch(typename Law::template Constants<One>(law, step.contacts), s, slip);
  for (std::size_t k = 0; k < numbers; ++k) memory[k] = slip[k].v;
  const bool sleeps = step.sleep && step.sleep->asleep[sphere] && !of.is_felt;
  double* to = sums.of + (sleeps ? chunk.end - chunk.begin : sphere - chunk.begin) * Sums<Dim>::size;
  std::array<double, Dim> force;
  for (std::size_t d = 0; d < Dim; ++d) to[d] += force[d] = f.force[d].v;
  for (std::size_t d = 0; d < spins; ++d) to[(Dim == 2 ? 2 : 4) + d] += f.torque_a[d].v;
  push_wall<Dim>(step, chunk, number, force, of.place);
  chunk.lost += f.lost.v;
  chunk.stored += f.stored.v;
  chunk.deepest = std::max(chunk.deepest, 0.5 * overlap / radius);
  chunk.contacts += 1.0;
}

/// The chunk's spheres at the sides of the domain. Who sleeps feels no force of a side: it is as constant as those of
/// others that sleep.
template <int Dim, class Law>
void side_of(const Law& law, const SphereStep& step, SphereChunk& chunk, SphereChunk::AtSide& at, Sums<Dim>& sums) {
  using R = SphereRecord<Dim>;
  const double* r = step.records + at.sphere * R::size;
  const double radius = r[R::radius], distance = at.sign * (r[at.axis] - at.place), overlap = radius - distance;
  const double parts = at.sign * r[R::velocity + at.axis];
  if (!(overlap > -step.dt * std::abs(parts))) {
    for (std::size_t k = 0; at.touches != 0 && k < Law::template springs<Dim>; ++k)
      chunk.lost += law.left_behind() * at.memory[k] * at.memory[k];
    at.touches = 0;
    std::fill_n(at.memory, ContactMemory::most_numbers, 0.0);
    return;
  }
  at.touches = 1;
  Surface<Dim> of{{}, {}, {}, {}, distance, false};
  for (std::size_t d = 0; d < Dim; ++d) {
    of.normal[d] = d == at.axis ? at.sign : 0.0;
    of.place[d] = d == at.axis ? at.place : r[d];
  }
  press<Dim>(law, step, chunk, at.law, at.sphere, of, at.memory, sums);
}

template <class F>
void with_law(const SphereStep& step, std::size_t number, F&& f) {
  with_parts(step.laws[number], step.has, f);
}

/// The chunk's spheres at walls that have surfaces. A wall that travels is felt by those that sleep too.
template <int Dim>
void walls_of(const SphereStep& step, SphereChunk& chunk, const SphereChunk::AtWalls& at, Sums<Dim>& sums) {
  using R = SphereRecord<Dim>;
  const SphereColumns& columns = step.columns[chunk.phase];
  const double* r = step.records + at.sphere * R::size;
  const double radius = r[R::radius];
  std::array<double, 3> x{}, v{};
  for (std::size_t d = 0; d < Dim; ++d) {
    x[d] = r[d];
    v[d] = r[R::velocity + d];
  }
  const std::size_t k = at.sphere - columns.first;
  std::array<SolidWalls::Contact, SolidWalls::most> found;
  const std::size_t count =
      step.walls->touch(x, v, radius, step.dt, chunk.phase, at, columns.bodies ? columns.bodies + k : nullptr, found);
  SolidTouches& touches = columns.walls[k];
  if (count == 0 && touches.of[0].with == 0) return;
  const SolidTouches before = touches;
  touches = {};
  std::array<bool, SolidTouches::most> goes_on{};
  std::size_t n = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const SolidWalls::Contact& contact = found[c];
    if (std::isinf(contact.distance)) {
      chunk.deepest = std::max(chunk.deepest, 1.0);
      continue;
    }
    SolidTouch& touch = touches.of[n++];
    const std::size_t old = before.find(contact.normal, goes_on);
    if (old < SolidTouches::most) {
      goes_on[old] = true;
      touch = before.of[old];
    }
    touch.with = static_cast<std::int64_t>(contact.law) + 1;
    touch.distance = contact.distance;
    Surface<Dim> of{{}, {}, {}, {}, contact.distance, at.moves != 0};
    for (std::size_t d = 0; d < 3; ++d) touch.normal[d] = contact.normal[d];
    for (std::size_t d = 0; d < Dim; ++d) {
      of.normal[d] = contact.normal[d];
      of.velocity[d] = contact.velocity[d];
      of.place[d] = x[d] + contact.foot[d];
    }
    for (std::size_t d = 0; d < R::spins; ++d) of.rate[d] = contact.rate[Dim == 2 ? 2 : d];
    with_law(step, contact.law,
             [&](const auto& law) { press<Dim>(law, step, chunk, contact.law, at.sphere, of, touch.memory, sums); });
  }
  // What the springs across the normal of the others held is lost.
  for (std::size_t q = 0; q < SolidTouches::most && before.of[q].with != 0; ++q)
    if (!goes_on[q])
      with_law(step, static_cast<std::size_t>(before.of[q].with - 1), [&](const auto& law) {
        using Law = std::decay_t<decltype(law)>;
        for (std::size_t s = 0; s < Law::template springs<Dim>; ++s)
          chunk.lost += law.left_behind() * before.of[q].memory[s] * before.of[q].memory[s];
      });
}

/// What a contact of two that rest stores, a pair of the list.
template <int Dim, class Law>
double stored_at_rest(const Law& law, const SphereStep& step, const SphereChunk& chunk, const SphereChunk::Group& group,
                      std::size_t pair) {
  using R = SphereRecord<Dim>;
  constexpr std::size_t numbers = Law::template numbers<Dim>;
  const double *a = step.records + chunk.a[pair] * R::size, *b = step.records + chunk.b[pair] * R::size;
  const double of_a = step.inverse_densities[2 * group.law] / std::pow(a[R::radius], 3),
               of_b = step.inverse_densities[2 * group.law + 1] / std::pow(b[R::radius], 3);
  TouchingSpheres<One, Dim> s;
  double r2 = least_square;
  std::array<double, Dim> r{};
  for (std::size_t d = 0; d < Dim; ++d) {
    r[d] = pair_image::apart(a[d] - b[d], step.period[d], group.image, d);
    r2 += r[d] * r[d];
  }
  const double distance = std::sqrt(r2), reach = a[R::radius] + b[R::radius];
  for (std::size_t d = 0; d < Dim; ++d) {
    s.normal[d] = One(r[d] / distance);
    s.velocity[d] = One(0.0);
  }
  for (std::size_t d = 0; d < R::spins; ++d) s.spin_a[d] = s.spin_b[d] = One(0.0);
  s.overlap = One(reach - distance);
  s.lever_a = One(a[R::radius] / reach * distance);
  s.lever_b = One(b[R::radius] / reach * distance);
  s.reduced_radius = One(a[R::radius] * b[R::radius] / reach);
  s.inverse_mass = One(of_a + of_b);
  s.reduced_mass = One(1.0 / (of_a + of_b));
  std::array<One, numbers> slip;
  const double* memory = chunk.of_pair(pair, step.numbers);
  for (std::size_t k = 0; k < numbers; ++k) slip[k] = One(memory[k * batch]);
  return Law::touch(typename Law::template Constants<One>(law, step.contacts), s, slip).stored.v;
}

template <int Dim>
double rest_of_chunk(const SphereStep& step, const SphereChunk& chunk) {
  double sum = 0.0;
  for (const auto& group : chunk.groups)
    with_law(step, group.law, [&](const auto& law) {
      for (std::size_t pair = group.first * batch; pair < group.end * batch; ++pair)
        if (chunk.touching(pair) && (chunk.live_of(pair / batch) >> pair % batch & 1u) == 0)
          sum += group.weight * stored_at_rest<Dim>(law, step, chunk, group, pair);
    });
  return sum;
}

template <int Dim>
void step_chunk(const SphereStep& step, SphereChunk& chunk) {
  chunk.lost = chunk.stored = chunk.deepest = chunk.contacts = 0.0;
  chunk.wakes = false;
  std::fill(chunk.pushed.begin(), chunk.pushed.end(), std::array<double, 6>{});
  if (chunk.idle()) {
    chunk.farthest = chunk.fastest = 0.0;
    chunk.gone.clear();
    return;
  }
  Sums<Dim> sums;  // 16 or 32 kB
  sums.clear(chunk.end - chunk.begin);
  Tally tally;
  for (const auto& group : chunk.groups)
    with_law(step, group.law, [&](const auto& law) { group_of<Dim>(law, step, chunk, group, sums, tally); });
  for (auto& at : chunk.sides)
    with_law(step, at.law, [&](const auto& law) { side_of<Dim>(law, step, chunk, at, sums); });
  for (const auto& at : chunk.walls) walls_of<Dim>(step, chunk, at, sums);
  if (step.by_bodies)
    for (std::size_t k = 0; k < (chunk.end - chunk.begin) * Sums<Dim>::size; ++k)
      sums.of[k] += step.by_bodies[chunk.begin * Sums<Dim>::size + k];
  chunk.lost += simd::sum(tally.lost);
  chunk.stored += simd::sum(tally.stored);
  for (std::size_t k = 0; k < width; ++k) chunk.deepest = std::max(chunk.deepest, tally.deepest[static_cast<int>(k)]);
  chunk.contacts += tally.contacts;
  if (step.sleep) watch_border<Dim>(*step.sleep, step, chunk, sums);
  step.last ? leave<Dim>(step, chunk, sums) : move_on<Dim>(step, chunk, sums);
}

}  // namespace

void step_spheres(const SphereStep& step, SphereChunk& chunk) {
  if (step.dimensions == 2) step_chunk<2>(step, chunk);
  else step_chunk<3>(step, chunk);
}

double energy_at_rest(const SphereStep& step, const SphereChunk& chunk) {
  return step.dimensions == 2 ? rest_of_chunk<2>(step, chunk) : rest_of_chunk<3>(step, chunk);
}

}  // namespace barchan::BARCHAN_TARGET
