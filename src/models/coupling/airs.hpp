// The air about spheres that feel it by a law of drag by name: one fluid, or several phases of one air with spacings of
// their own (models/fluid/spacing_border.hpp). Each has a grid of its own spacing (air_grid.hpp). Where two of them
// meet a place has the mean of both, weighted by the share of the volume that each fills there, and a force goes to
// both by the same shares: a grain feels the air once, and the air loses what the grain gets.
#pragma once

#include <vector>

#include "models/coupling/air_grid.hpp"
#include "models/layout.hpp"
#include "state/state.hpp"

namespace barchan {

/// The fluids that drag the grains of an entry by a law by name, the finest first.
std::vector<std::size_t> airs_about(const Layout& layout, std::size_t grains);

class Airs {
 public:
  Airs(const Layout& layout, std::vector<std::size_t> phases);
  const std::vector<std::size_t>& phases() const { return phases_; }

  /// Takes masses and velocities of the particles; forces are zero again, or those that are kept.
  void gather(const State& state);
  /// As those of AirGrid.
  void keep_forces();
  void forget();
  void archive(Archive& a);
  /// Mean velocity (m/s) about a place; zero where no air is.
  Vec3 velocity(const Vec3& x) const;
  /// A force (N; 2D: per metre of depth) on the air about a place.
  void push(const Vec3& x, const Vec3& force);
  /// A grain that acts on the turbulence, as AirGrid's; by the same shares.
  void put(const Vec3& x, double mass, double rate);
  /// Writes the grains about the particles of a phase, the `number`th of phases().
  void give_grains(const State& state, std::size_t number, GrainsInEddies* of) const {
    grids_[number].give_grains(state.phases[phases_[number]], of);
  }
  /// Writes the accelerations of the particles by these forces (m/s2) into their field drag_acceleration.
  void give(State& state) const;

 private:
  template <class F>
  void each_about(const Vec3& x, F&& f);

  std::vector<std::size_t> phases_;
  std::vector<double> density_;  // kg/m3
  std::vector<AirGrid> grids_;
};

}  // namespace barchan
