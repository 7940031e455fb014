// Strays: spheres that went farther than the lists of pairs allow. Each is searched anew alone.
//
// A search of all spheres gives each of them half of the slack as its allowance: while nobody goes farther than that
// from its place, no two spheres can touch that the lists do not hold. Who goes farther gets a new place, an allowance
// that follows its speed, and pairs with all spheres that may touch it before one of the two uses up its own allowance.
// Its other pairs leave the lists. So a few grains that fly do not make the lists of a bed at rest anew.
#pragma once

#include <span>

#include "models/grains/sphere_search.hpp"
#include "models/grains/sphere_shares.hpp"
#include "state/archive.hpp"

namespace barchan {

class SphereStrays {
 public:
  /// `reach` (m): the largest sum of radii; `chunks`: those of all moving spheres; `numbers_of_a_pair`: of its memory;
  /// `narrowest` (m): the shortest periodic axis, where pairs say which images meet.
  void prepare(const SphereSet& spheres, double reach, const std::vector<SphereChunk>& chunks,
               std::size_t numbers_of_a_pair, double narrowest = 1e300);
  /// Before a search of all with a `slack` (m): all places are the present ones. They are s.places then.
  void begin(const SphereSet& spheres, double slack);
  /// After it, and after loading.
  void take_cells(const SphereCells& cells);

  /// Whether `strays` more are searched faster alone than with all others.
  bool few(std::size_t strays) const { return strays + slow_ < least_strays + moving_ / 64; }
  /// Gives one a new place and its pairs. `step` (s): of the contacts. On several ranks each of them does so for all
  /// strays, and puts pairs into its own chunks.
  void renew(const SphereSet& spheres, std::uint32_t stray, double step, std::span<const SphereSearch::Side> sides,
             std::span<SphereChunk> chunks, SphereShares& shares);

  /// The chunk of a sphere that moves.
  std::uint32_t chunk_of(std::uint32_t sphere) const { return chunk_[sphere]; }
  const double* places() const { return places_.data(); }
  /// m, of everybody who is no stray, of walls too.
  double allowance() const { return least_; }
  double allowance_of(std::uint32_t sphere) const { return allowance_[sphere]; }  ///< m
  double slack() const { return 2.0 * least_; }
  /// One over the square of each allowance (1/m2).
  const float* tightness() const { return tightness_.data(); }

  void archive(Archive& a);

 private:
  /// Who may touch a stray: a sphere, and the image of it that does (pair_image).
  struct Partner {
    std::uint32_t sphere, image;
    bool operator==(const Partner&) const = default;
    bool operator<(const Partner& p) const { return std::pair(sphere, image) < std::pair(p.sphere, p.image); }
  };
  /// A pair to be listed.
  struct NewPair {
    std::uint32_t a, b, law, image;
    double weight;
  };

  template <std::size_t Dim>
  void look(const SphereSet& s, std::uint32_t stray);
  std::size_t cell_of(std::uint32_t sphere) const {
    return cells_.cell(cells_.of_level[cells_.level_of(sphere)], &places_[sphere * dimensions_], dimensions_);
  }
  void enter(std::uint32_t stray);
  void leave(std::uint32_t stray);
  void drop_others(std::uint32_t stray, std::span<SphereChunk> chunks, const SphereShares& shares);
  void add_new(const SphereSet& s, std::uint32_t stray, std::span<SphereChunk> chunks, SphereShares& shares) const;
  void drop(SphereChunk& chunk, std::size_t pair) const;
  void evaluate(SphereChunk& chunk, std::size_t pair) const;
  void add(SphereChunk& chunk, const NewPair& pair) const;
  void add_sides(const SphereSet& s, std::uint32_t stray, std::span<const SphereSearch::Side> sides,
                 SphereChunk& chunk) const;

  static constexpr std::size_t least_strays = 64;
  static constexpr double steps_ahead = 40.0;     // for which an allowance lasts at the present speed
  static constexpr double most_of_reach = 1.0;    // the largest allowance
  static constexpr std::size_t more_batches = 4;  // of pairs, where a chunk has no room

  SphereCells cells_;
  std::size_t dimensions_ = 2, moving_ = 0, all_ = 0, numbers_ = 0, stride_ = 0, radius_ = 0;
  double reach_ = 0.0, least_ = 0.0;
  bool sleep_ = false;                                     // some sphere may
  std::size_t slow_ = 0;                                   // strays since the search whose allowance is the least
  std::vector<std::uint32_t> chunk_;                       // by sphere that moves
  AlignedVector<double> places_;                           // by sphere
  AlignedVector<float> tightness_;                         // by sphere that moves
  std::vector<double> allowance_;                          // m, the same
  std::vector<std::uint8_t> is_stray_;                     // by sphere
  std::vector<std::uint32_t> head_, next_;                 // strays by cell
  std::array<double, SphereCells::most_levels> widest_{};  // m, by level: the largest allowance of its strays
  double most_ = 0.0;                                      // m, the largest allowance
  std::vector<Partner> near_;                              // of one
  std::vector<std::uint8_t> listed_;                       // whether the chunk has the pair with each of them
};

}  // namespace barchan
