// What contacts of spheres remember from step to step: the numbers of the parts of their laws
// (laws/sphere_contact.hpp), and who touches.
//
// This is a column by pair of ids, the ids being the lasting numbers of two spheres, or of a sphere and a side of the
// domain. A checkpoint has it; it stays with its two ids, wherever sorting and searching put them; a pair that does not
// touch has none. Two places hold its values: between two searches the lists of pairs, batch by batch, where the loops
// over contacts read and write them (ContactBatches); in a search, when the lists are made anew, a table by pair
// (ContactMemory), from which the new lists take them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/aligned.hpp"
#include "laws/sphere_catalogue.hpp"
#include "models/bodies/solid_surfaces.hpp"
#include "state/archive.hpp"

namespace barchan {

struct SphereChunk;

/// Gives a vector a size, with more room than that where it must grow, so that it seldom allocates.
template <class Vector>
void fit(Vector& vector, std::size_t size) {
  if (vector.capacity() < size) vector.reserve(size + size / 2 + 64);
  vector.resize(size);
}

/// The values of the pairs of a list, eight pairs side by side: of each number eight, a pair's beside the next one's.
struct ContactBatches {
  static constexpr std::size_t batch = 8;  // pairs

  AlignedVector<double> memory;         // by batch
  AlignedVector<std::uint8_t> touches;  // by batch: a bit a pair

  /// Becomes so many batches of pairs that do not touch. Allocates only to grow.
  void clear(std::size_t batches, std::size_t numbers);
  void reserve(std::size_t batches, std::size_t numbers);
  /// Adds batches of pairs that do not touch.
  void grow(std::size_t batches, std::size_t numbers);
  /// The first number of the pair at that place of the list; the next one is `batch` further.
  double* of_pair(std::size_t place, std::size_t numbers) {
    return memory.data() + (place / batch * numbers) * batch + place % batch;
  }
  const double* of_pair(std::size_t place, std::size_t numbers) const {
    return const_cast<ContactBatches*>(this)->of_pair(place, numbers);
  }
  bool touching(std::size_t place) const { return (touches[place / batch] >> (place % batch) & 1u) != 0; }
  void set_touching(std::size_t place) {
    touches[place / batch] = static_cast<std::uint8_t>(touches[place / batch] | 1u << place % batch);
  }
  void archive(Archive& a) {
    a.array("memory of pairs", memory);
    a.array("pairs that touch", touches);
  }
};

/// What a sphere and a solid remember of their contact. The next step finds it by its normal: so it goes on over the
/// seam of two solids.
struct SolidTouch {
  std::int64_t with = 0;                  // number of the rigid body, or of the law of the wall, and 1; 0: none
  double normal[3] = {}, distance = 0.0;  // m
  double memory[most_remembered] = {};
};
/// Of all solids that a sphere touches, without gaps.
struct SolidTouches {
  static constexpr std::size_t most = SolidSurfaces::most;
  SolidTouch of[most];

  /// Where the contact with this normal stands; `most`: it is new. `taken`: those that have gone on already.
  std::size_t find(const Vec3& normal, const std::array<bool, most>& taken) const {
    constexpr double turned = 0.9;  // cosine of the angle by which it may turn in a step
    double best = turned;
    std::size_t found = most;
    for (std::size_t k = 0; k < most && of[k].with != 0; ++k) {
      const double same = dot({of[k].normal[0], of[k].normal[1], of[k].normal[2]}, normal);
      if (taken[k] || !(same > best)) continue;
      best = same;
      found = k;
    }
    return found;
  }
};

class ContactMemory {
 public:
  static constexpr std::size_t most_numbers = most_remembered;
  /// What a pair that touches has.
  struct Kept {
    std::uint32_t number, with;  // lasting numbers; with: or a side
    double values[most_numbers];
    /// m, x_a - x_b of the images that touch, where two spheres may touch twice (pair_image). It names the contact:
    /// periods are not the same any more when a sphere was put back into the domain.
    std::array<float, 3> apart;
  };

  /// `numbers` of a pair, at most most_numbers; `period` (m, 0: not periodic): of the domain, where pairs say which
  /// images meet.
  void prepare(std::size_t numbers, int dimensions = 2, const std::array<double, 3>& period = {}) {
    numbers_ = numbers;
    dimensions_ = static_cast<std::size_t>(dimensions);
    period_ = period;
  }
  /// Room for so many pairs that touch.
  void reserve(std::size_t pairs) { kept_.reserve(pairs); }
  std::size_t numbers() const { return numbers_; }

  /// Takes the values of all pairs that touch out of the lists. `before`: lasting numbers of the `all` spheres by their
  /// places when the lists were made. A pair whose first sphere has a place from `begin` to `end` is taken from the
  /// chunk of that sphere alone. `places` (m), of all spheres when the lists were made: pairs say which images meet.
  void keep(std::size_t begin, std::size_t end, std::size_t all, std::span<const SphereChunk> chunks,
            const std::uint32_t* before, const double* places = nullptr);
  /// On several ranks, which together have kept each pair once: what is kept goes to the ranks of its spheres.
  /// `ranks`: of those that move, by number.
  void share(const std::vector<std::uint32_t>& ranks);
  /// The same, where every rank has all spheres now.
  void join();
  /// Gives the spheres of what is kept other numbers: `to` by the number before, `gone` of those that are no longer
  /// there; of two that stay the order is the same. `all`: how many there are now. Adds those whose partner has gone to
  /// `left_alone`, by their new numbers.
  void renumber(const std::vector<std::uint32_t>& to, std::size_t all, std::vector<std::uint32_t>& left_alone);
  static constexpr std::uint32_t gone = 0xffffffffu;
  std::span<const Kept> kept() const { return kept_; }
  /// The values of a pair; null: it did not touch.
  const double* find(std::uint32_t number, std::uint32_t with, const std::array<float, 3>& apart = {}) const;
  /// Puts the values of a pair at its place in a list.
  void recall(ContactBatches& list, std::size_t place, std::uint32_t number, std::uint32_t with,
              const std::array<float, 3>& apart = {}) const;
  /// x_a - x_b of an image (m); 0 of the nearest one.
  std::array<float, 3> apart(const double* a, const double* b, std::uint32_t image) const;

  static constexpr std::uint32_t first_side = 0xfffffff0u;
  /// A side of the domain as the partner of a sphere.
  static constexpr std::uint32_t side(std::uint16_t axis, std::int16_t sign) {
    return first_side + 2u * axis + (sign > 0 ? 1u : 0u);
  }

 private:
  void count(std::size_t all);
  void order();
  void order_partners();

  std::size_t numbers_ = 0;           // of a pair
  std::vector<std::uint32_t> begin_;  // by number: its first place in kept_; one more
  std::vector<Kept> kept_;
  std::size_t dimensions_ = 2;
  std::array<double, 3> period_{};  // m
};

}  // namespace barchan
