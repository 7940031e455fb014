// Grains that enter through a side of the domain, or are poured into a box: [[influx]].
//
// Their number follows from the flux: the times between two of them are exponentially distributed, with the mean that
// gives the flux (a Poisson process). A grain that enters is drawn by its number alone, from the distributions of the
// scene or from the grains in flight of a frame, each with a weight that is its speed through the side: so they are
// drawn as they pass a place (Rasmussen & Sorensen 2008, J. Geophys. Res. 113, F02S12: number densities and fluxes).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/grains/sphere_room.hpp"
#include "models/model.hpp"
#include "models/open_sides.hpp"

namespace barchan {

/// What enters, grain by grain.
class Arrivals {
 public:
  struct Grain {
    double height = 0.0;  // m, y of its centre
    Vec3 shares{};        // 0 to 1: along x of a box or across a side; in a box along y and z
    double radius = 0.0;  // m
    Vec3 velocity{};      // m/s
    double wait = 0.0;    // s, after the one before it
  };

  /// Reads the file of the influx. Throws SceneError where it cannot be read or holds no grain that could enter.
  Arrivals(const Scene& scene, std::size_t influx, double slab);
  /// The n-th grain, the same whenever it is asked for.
  Grain operator()(std::int64_t n) const;
  /// Where in the box the n-th grain begins when it is tried again.
  Vec3 again(std::int64_t n, std::int64_t attempt) const;
  double fastest() const { return fastest_; }      ///< m/s; of a distribution: the mean and four times the spread
  double mean_wait() const { return mean_wait_; }  ///< s
  double mass_of(double radius) const;             ///< kg; kg/m in 2D

 private:
  struct Pattern {                  // a grain in flight
    double height, radius, weight;  // m, m, the sum of the weights up to it
    Vec3 velocity;
  };
  void read_patterns(const Scene& scene, std::size_t influx);

  const Influx& influx_;
  SphereSize size_;
  double density_, slab_;  // kg/m3, m
  std::size_t up_;         // the axis of heights
  double ground_, top_;    // m, between which grains enter
  std::size_t axis_;
  double inwards_;  // 1 or -1; 0: into a box
  double mean_wait_ = 0.0, fastest_ = 0.0;
  std::vector<Pattern> patterns_;
};

class GrainSource : public Model {
 public:
  /// Passages of a diameter for which a grain waits for room before it is given up.
  static constexpr double patience = 10.0;

  GrainSource(const Scene& scene, const Layout& layout, std::size_t influx);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  /// NAME_SIDE_in: what entered (add_passed).
  void history(HistoryRow& row) const override;
  void report(Warnings& warnings) const override;
  void archive(Archive& a) override;

 private:
  struct Waiting {
    std::int64_t number = 0;          // of the arrival
    double since = 0.0, again = 0.0;  // s, when it was due; when it is tried again
    std::int64_t attempts = 0;
  };
  void enter();
  bool place(const Arrivals::Grain& grain, double age);
  Vec3 place_at_side(const Arrivals::Grain& grain, double age) const;
  Vec3 place_in_box(const Arrivals::Grain& grain) const;
  double passage(const Arrivals::Grain& grain) const;
  bool has_room(const Vec3& x, double radius);
  double across(double share, double radius) const;
  bool is_taken(const Vec3& x, double radius);
  bool overlaps(std::size_t phase, std::size_t k, const Vec3& x, double radius) const;
  void gather(double reach);
  bool is_behind_side(const std::array<const double*, 3>& at, std::size_t k) const;

  const Scene& scene_;
  const Layout& layout_;
  const Influx& influx_;
  std::size_t phase_, up_, axis_;
  double side_;  // m; of a box its middle
  Arrivals arrivals_;
  std::string name_;   // "sand_left", "sand_poured"
  std::string where_;  // "through left", "into the box of influx.0"
  double next_ = 0.0;  // s, when the next one is due
  std::int64_t drawn_ = 0, given_up_ = 0;
  std::vector<Waiting> waiting_;
  PassedSide entered_;
  std::size_t place_ = 0;  // of its row in State::departed
  Workspace* w_ = nullptr;
  std::optional<SphereRoom> room_;
  std::vector<char> by_particles_;  // by phase: a wall whose particles are spheres
  // Spheres that one within `gathered_` (m) of the side may overlap, gathered once a step, when the first grain asks.
  struct AtSide {
    std::vector<std::uint32_t> spheres;
    std::size_t looked_at = 0;  // of the phase; those after them have entered since
  };
  double gathered_ = 0.0;
  std::vector<AtSide> at_side_;  // by phase
};

}  // namespace barchan
