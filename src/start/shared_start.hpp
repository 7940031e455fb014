// The start of a run on several ranks: no rank makes all particles of a fluid. A fill of rows is made in parts, each
// rank its own part of the rows. Of what is made in one piece each rank keeps its part. What all ranks have of a fluid
// then, one rank after another, are its particles in the order of their ids, so that numbers, sums in this order, and
// random numbers are those of one process. Internal to src/start, but for why_start_is_whole().
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/ranks.hpp"
#include "scene/scene.hpp"
#include "start/generate.hpp"
#include "start/places.hpp"

namespace barchan {

/// Why every rank must make all particles of the scene; empty: each makes a part of those of the fluids, and all of the
/// others.
std::string why_start_is_whole(const Scene& scene);

/// The fill is a lattice in a shape, whose places are asked for one by one.
bool comes_in_rows(const Fill& fill);

/// Places that earlier fills of fluids have taken. Each rank has a part of them.
class PlacesOfFluids {
 public:
  PlacesOfFluids(const PeriodicSpace& space, double widest) : space_(space), widest_(widest) {}
  bool empty() const { return fills_.empty(); }
  void add(std::size_t fill, double spacing, const std::vector<Vec3>& places) {
    fills_.push_back({static_cast<int>(fill), spacing, places});
  }
  /// Those of this rank.
  Places own() const;
  /// Those of all ranks that are no farther than `reach` (m) from the box about these places of this rank. All ranks
  /// call it.
  Places near(const std::vector<Vec3>& places, double reach) const;

 private:
  struct Filled {
    int fill;
    double spacing;  // m
    std::vector<Vec3> places;
  };
  PeriodicSpace space_;
  double widest_;  // m
  std::vector<Filled> fills_;
};

/// Leaves out the places for which `is_taken` is true. `by_all`: all ranks have the same places, and each knows of some
/// that they are taken; all of them call it.
void leave_out(std::vector<Vec3>& places, bool by_all, const std::function<bool(const Vec3&)>& is_taken);

/// Which of the particles of a phase are in a block, while its fills are made.
class ParticleNumbers {
 public:
  /// `count` more on this rank. Those of all ranks follow each other, and what was numbered before. Returns which of
  /// them they are. All ranks call it.
  ParticlePiece follow(std::size_t count);
  /// Brings each rank the particles of its share of all numbers, unless they are about there already.
  void deal(ParticleBlock& block) const;

 private:
  struct Run {
    std::size_t first, count;
  };
  std::vector<Run> runs_;
  std::size_t total_ = 0;
};

/// Calls check(at), which throws SceneError for the first wrong particle and leaves its number in `at`: all ranks throw
/// what is told of the first of all, as one process does. `first`: number of the first particle of this rank.
void check_together(std::size_t first, const std::function<void(std::size_t& at)>& check);

}  // namespace barchan
