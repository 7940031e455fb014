// What the steps of contacts work on: records of all spheres, and pairs that may touch.
//
// All spheres of a scene stand side by side: phase after phase in the present order of their particles, then walls
// whose particles are spheres, then two far away that pad the lists. A record holds
//   2D  x y r moved | vx vy w -            3D  x y z r | vx vy vz moved | wx wy wz moved
// `moved` (floats): the way since the last search. What a step does not change stands in another one, ax ay (az) 1/m:
// the acceleration by all but contacts, and the inverse mass (0 of walls). Walls have a velocity and a spin where they
// travel; no step of contacts changes their records.
//
// The records are there twice. A step reads one set and writes the other, so that one loop does all: a chunk of spheres
// that has its forces can move on while its neighbours still read where it was.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "base/aligned.hpp"
#include "laws/sphere_catalogue.hpp"
#include "models/grains/contact_memory.hpp"

namespace barchan {

template <int Dim>
struct SphereRecord {
  static constexpr std::size_t size = Dim == 2 ? 8 : 12, radius = Dim == 2 ? 2 : 3;
  static constexpr std::size_t velocity = 4, spin = Dim == 2 ? 6 : 8, spins = Dim == 2 ? 1 : 3;
  // Places of the floats among those of the record.
  static constexpr std::size_t moved(std::size_t d) { return Dim == 2 ? 6 + d : d < 2 ? 14 + d : 22; }
};
/// The way of a sphere since the last search, along an axis (m).
template <int Dim>
float way_of(const double* record, std::size_t axis) {
  float way;
  std::memcpy(&way, reinterpret_cast<const char*>(record) + sizeof(float) * SphereRecord<Dim>::moved(axis), sizeof way);
  return way;
}
template <int Dim>
void set_way(double* record, std::size_t axis, float way) {
  std::memcpy(reinterpret_cast<char*>(record) + sizeof(float) * SphereRecord<Dim>::moved(axis), &way, sizeof way);
}

/// Square of the way that a sphere has gone after another step with its present velocity (m2): a contact sets in up to
/// a step before the touch.
template <int Dim>
float next_way2(const double* record, double dt) {
  float way2 = 0.0f;
  for (std::size_t d = 0; d < Dim; ++d) {
    const float go = static_cast<float>(dt * record[SphereRecord<Dim>::velocity + d]), way = way_of<Dim>(record, d);
    way2 += (way + go) * (way + go);
  }
  return way2;
}

inline constexpr std::size_t passive_size = 4, passive_mass = 3;

/// Which images of two spheres a pair is of. Where each periodic axis has room for two spheres, the nearest images
/// alone can touch, and a pair says nothing: `nearest`. On a narrower axis two spheres may touch on both sides at once;
/// their pairs are then told apart by n, the periods that are taken off x_a - x_b: of the places that records have,
/// which no periodic side changes between two searches.
namespace pair_image {

inline constexpr std::uint32_t nearest = 0;
inline constexpr int most_periods = 100;

BARCHAN_SIMD_INLINE std::uint32_t of(const std::array<int, 3>& periods) {
  std::uint32_t code = 1u << 24;
  for (std::size_t d = 0; d < 3; ++d) code |= static_cast<std::uint32_t>(periods[d] + 128) << 8 * d;
  return code;
}
BARCHAN_SIMD_INLINE int periods(std::uint32_t image, std::size_t axis) {
  return static_cast<int>(image >> 8 * axis & 0xffu) - 128;
}
/// What is left of x_a - x_b (m) along an axis of that period (m; 0: not periodic).
BARCHAN_SIMD_INLINE double apart(double difference, double period, std::uint32_t image, std::size_t axis) {
  if (!(period > 0.0)) return difference;
  return difference - period * (image == nearest ? std::round(difference / period) : periods(image, axis));
}

}  // namespace pair_image

/// Calls f(image, square of the distance) for all images of two places (m) that are nearer than `reach` (m).
template <int Dim, class F>
void each_image(const double* a, const double* b, const std::array<double, 3>& period, double reach, F&& f) {
  std::array<int, 3> low{}, high{};
  for (std::size_t d = 0; d < Dim; ++d) {
    if (!(period[d] > 0.0)) continue;
    const double apart = a[d] - b[d], most = pair_image::most_periods;
    low[d] = static_cast<int>(std::clamp(std::ceil((apart - reach) / period[d]), -most, most));
    high[d] = static_cast<int>(std::clamp(std::floor((apart + reach) / period[d]), -most, most));
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const std::array<int, 3> n{x, y, z};
        double apart2 = 0.0;
        for (std::size_t d = 0; d < Dim; ++d)
          apart2 += (a[d] - b[d] - n[d] * period[d]) * (a[d] - b[d] - n[d] * period[d]);
        if (apart2 < reach * reach) f(pair_image::of(n), apart2);
      }
}

/// Spheres that move together in one share of a step, and the pairs in which they are. A pair stands in the chunk of
/// each of its spheres, once; the first of a pair is that with the lower id, so that both chunks compute the same bits.
/// What the pairs remember stands beside them, batch by batch.
struct SphereChunk : ContactBatches {
  static constexpr std::size_t most = 512;  // spheres
  /// A sphere whose way has this share of the square of its allowance (models/grains/sphere_strays.hpp) is searched
  /// anew; the rest is what single precision may hide.
  static constexpr double used_up = 0.96;

  /// Batches of one law and image (pair_image); `weight`: of their energies, 1/2 where another chunk has the pair too.
  struct Group {
    std::uint32_t law = 0, first = 0, end = 0;
    std::uint32_t image = pair_image::nearest;
    double weight = 1.0;
  };
  /// A sphere at a side of the domain: the side at `place` on `axis` holds what is above (`side` +1) or below (-1).
  struct AtSide {
    std::uint32_t sphere = 0, law = 0;
    std::uint16_t axis = 0;
    std::int16_t sign = 1;
    std::uint32_t touches = 0;  // 1: it does; no byte of these is without a value
    double place = 0.0;
    double memory[ContactMemory::most_numbers] = {};
  };

  /// A sphere near walls that it touches by their surfaces (models/grains/solid_walls.hpp).
  struct AtWalls {
    static constexpr std::uint16_t most = 8;
    std::uint32_t sphere = 0;
    std::uint16_t count = 0;  // of the surfaces; more than `most`: all that its phase touches
    std::uint16_t moves = 0;  // 1: one of them may
    std::uint16_t near[most] = {};
  };

  std::size_t begin = 0, end = 0;  // spheres
  std::size_t phase = 0;           // of the scene
  std::vector<Group> groups;
  AlignedVector<std::uint32_t> a, b;  // by pair; what pads them is the two far away
  std::vector<AtSide> sides;
  std::vector<AtWalls> walls;
  // Who sleeps decides which pairs are evaluated: those with one that is awake. Empty where no sphere may sleep.
  AlignedVector<std::uint8_t> live;  // by batch: a bit a pair
  bool any_live = true;              // of these bits
  bool all_awake = true;
  std::vector<std::uint32_t> awake;   // spheres, where some of the chunk sleep
  std::vector<std::uint32_t> border;  // spheres that sleep and have pairs with others that do not
  double resting = 0.0;               // contacts of two that sleep

  // of the last step
  double lost = 0.0, stored = 0.0;  // J
  double deepest = 0.0;             // overlap over the sum of radii
  double farthest = 0.0;            // square of the longest way since the search, one step ahead, over its allowance's
  double fastest = 0.0;             // m/s
  std::vector<std::uint32_t> gone;  // spheres that have used up their allowance, one step ahead
  double contacts = 0.0;
  bool wakes = false;                         // somebody of the border
  std::vector<std::array<double, 6>> pushed;  // by watched law: force on the wall (N) and its torque (N m)

  bool idle() const { return !all_awake && awake.empty() && !any_live && sides.empty() && walls.empty(); }
  /// Which of the pairs of a batch are evaluated, as bits.
  std::uint32_t live_of(std::size_t q) const { return live.empty() ? 0xffu : live[q]; }
  /// Calls f with each sphere that moves.
  template <class F>
  void each_moving(F&& f) const {
    if (all_awake)
      for (std::size_t k = begin; k < end; ++k) f(k);
    else
      for (const std::uint32_t k : awake) f(std::size_t{k});
  }
};

/// What a step needs to know of spheres that sleep (models/grains/sphere_sleep.hpp). Forces and torque of a sphere
/// stand side by side: three numbers in 2D, six in 3D.
struct SleepStep {
  const std::uint8_t* asleep = nullptr;         // by sphere
  const std::uint32_t* numbers = nullptr;       // by sphere, lasting
  double *offset = nullptr, *unrest = nullptr;  // N, N m; by number
  std::uint8_t* wakes = nullptr;                // by number
  std::uint8_t* fresh = nullptr;                // by number: a neighbour fell asleep or woke since the last step
  double tolerance = 0.0;                       // m/s2
  double lag = 0.0;                             // s, the mean of what is out of balance
};

/// Where the last step of a bundle leaves the spheres of a phase. Null: the phase has no such field.
struct SphereColumns {
  double *position[3]{}, *velocity[3]{}, *acceleration[3]{}, *spin[3]{}, *spin_rate[3]{};
  SolidTouches* walls = nullptr;         // what they remember of walls
  const SolidTouches* bodies = nullptr;  // and of rigid bodies
  std::size_t first = 0;                 // sphere at the columns' begin
};

class SolidWalls;

/// A law whose forces on its wall are summed, and the place of the torque (m).
struct WatchedLaw {
  std::uint32_t law;
  std::array<double, 3> about;
};

/// One step of contacts.
struct SphereStep {
  int dimensions = 2;
  const double* records = nullptr;
  double* next = nullptr;
  const double* passive = nullptr;
  const AnySphereContact* laws = nullptr;
  const double* inverse_densities =
      nullptr;                             // by law, of the first and of the second: inverse mass times r^3 (1/kg m3)
  const SphereColumns* columns = nullptr;  // by phase
  const float* tightness = nullptr;        // 1/m2, by sphere that moves (models/grains/sphere_strays.hpp)
  std::array<double, 3> period{};          // m, 0: not periodic
  double dt = 0.0;                         // s
  StepOfContacts contacts;                 // the same step, as contacts take it
  double fastest = 0.0;                    // m/s, of all chunks
  double fastest_wall = 0.0;               // m/s, of the spheres of walls that travel
  std::uint32_t far = 0;                   // the first of the two spheres far away
  bool last = false;                       // of its bundle: half a kick, and into the columns
  ContactParts has;                        // of the laws
  std::size_t numbers = 0;                 // of the memory of a pair
  const SleepStep* sleep = nullptr;        // null: nobody sleeps
  const SolidWalls* walls = nullptr;       // those that spheres touch by their surfaces
  std::span<const WatchedLaw> watched;
  const double* by_bodies =
      nullptr;  // by sphere, as the sums of a chunk: what rigid bodies do to it; null: none is there
};

}  // namespace barchan
