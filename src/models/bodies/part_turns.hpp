// The turns of a body's parts, which mixed precision takes out of the displacements of total Lagrangian bodies.
#pragma once

#include <array>
#include <vector>

#include "base/vec3.hpp"
#include "models/bodies/reference_body.hpp"
#include "state/archive.hpp"
#include "state/particles.hpp"

namespace barchan {

/// A part that has turned by R has the displacements u' = R^T (x - x_a) - (X - X_a), a its anchor, and F = R (I + H').
/// Without it the strain of a body that turns is the small difference of the large numbers of H, and single precision
/// rounds it by 6e-8 |H|. R is the rotation that fits some particles of the part best (Kabsch 1976), of every step. A
/// part counts as turned, from then on, when R halves a displacement of more than 0.02 diameters: a body that bends or
/// is pressed keeps R = I, and its results are those without turns, to the bit.
class PartTurns {
 public:
  using Rotation = std::array<Vec3, 3>;  // rows

  bool any() const { return !rotation_.empty(); }
  bool turned(std::size_t piece) const { return any() && turned_[piece]; }
  /// From the axes of the piece to those of space.
  const Rotation& rotation(std::size_t piece) const { return rotation_[piece]; }

  /// A body's particles, the place of each id in them, what they were at first, and, where the domain is periodic,
  /// their whole displacements (m) by axis and id.
  struct Places {
    const PhaseParticles& body;
    const std::uint32_t* at;
    const ReferenceBody<float>& reference;
    const std::array<std::vector<double>, 3>& displaced;
  };

  /// R of the parts that have turned, of now.
  void follow(const Places& places);
  /// Tries R for parts that have not turned and whose displacements have become large; true: displacements have to be
  /// made again, and `keep` to be called. `largest` (m): of each piece, the largest component of u'.
  bool choose(const Places& places, const std::vector<double>& largest);
  /// Takes back what has not halved the displacements; true: displacements have to be made again.
  bool keep(const ReferenceBody<float>& reference, const std::vector<double>& largest);

  /// Which parts have turned; the rotations follow from the places.
  void archive(Archive& a);

 private:
  void begin(const ReferenceBody<float>& reference);
  std::vector<double> by_part(const std::vector<double>& largest) const;
  template <class Wanted>
  void fit(const Places& places, Wanted&& wanted);

  // Of each piece; the pieces of a part have the same. Empty while no part has turned.
  std::vector<Rotation> rotation_;
  std::vector<unsigned char> turned_;

  std::vector<std::uint32_t> part_;  // of each piece: the first piece of its part
  std::vector<double> bound_;        // m, of each part: R is tried beyond this displacement
  struct Trial {
    std::uint32_t part;
    double largest;  // m, before
  };
  std::vector<Trial> trials_;
};

/// x' = R x, x' = R^T x.
inline Vec3 turn(const PartTurns::Rotation& r, const Vec3& x) { return {dot(r[0], x), dot(r[1], x), dot(r[2], x)}; }
inline Vec3 turn_back(const PartTurns::Rotation& r, const Vec3& x) { return x[0] * r[0] + x[1] * r[1] + x[2] * r[2]; }

}  // namespace barchan
