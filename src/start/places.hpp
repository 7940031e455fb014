// Which places are taken: a grid of cells over periodic space. Internal to src/start.
#pragma once

#include <cstddef>
#include <unordered_map>
#include <vector>

#include "scene/scene.hpp"

namespace barchan {

/// Periodic space of a scene: wraps points into the domain and measures the shortest way between two of them.
class PeriodicSpace {
 public:
  explicit PeriodicSpace(const Domain& domain) : domain_(domain) {}
  Vec3 wrapped(Vec3 x) const;
  double distance(const Vec3& a, const Vec3& b) const;
  const Domain& domain() const { return domain_; }

 private:
  Domain domain_;
};

/// Particles that can be asked for neighbours. Distances count in the mean of the spacings of the two.
/// Particles of unequal spacings are in grids of their own, each half as wide as the one before it: a search compares
/// a particle with those that its distance can reach, not with all small ones that a large one would cover.
class Places {
 public:
  /// `widest`: the largest spacing (m) of any particle.
  Places(const PeriodicSpace& space, double widest);
  void add(const Vec3& x, double spacing, int owner);

  /// The nearest particle to one at x of this spacing (m) that is nearer than `distance`, in spacings and at most 1,
  /// and whose owner is not `except`; its owner, or -1.
  int owner_near(const Vec3& x, double spacing, double distance, int except = -1) const;
  /// The same; `except`: by owner, who does not count.
  int owner_near(const Vec3& x, double spacing, double distance, const std::vector<bool>& except) const;
  /// How many particles all searches so far were compared with.
  std::size_t compared() const { return compared_; }

 private:
  using Cell = std::array<long, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const;
  };
  struct Point {
    Vec3 x;
    double spacing;
    int owner;
  };
  struct Level {  // particles of spacings of more than half of `widest`
    double widest = 0.0;
    std::array<double, 3> width{};
    std::array<long, 3> cells{};  // along periodic axes; 0: unlimited
    std::unordered_map<Cell, std::vector<Point>, Hash> grid;
  };
  Level level_of(double widest) const;
  Cell cell_of(const Level& level, const Vec3& x) const;
  template <class Look>
  void each_cell_near(const Level& level, const Vec3& x, double steps, const Look& look) const;
  template <class Except>
  int nearest_owner(const Vec3& x, double spacing, double distance, const Except& except) const;

  PeriodicSpace space_;
  std::vector<Level> levels_;  // from wide to narrow; some may be empty
  mutable std::size_t compared_ = 0;
};

}  // namespace barchan
