// Voids in a fluid that fills its space: which of its particles stand beside one.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/cell_grid.hpp"
#include "engine/pair_list.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "start/flow_ends.hpp"
#include "state/particles.hpp"

namespace barchan {

/// Finds voids and keeps `near_void`: the steps for which a particle still counts as beside one.
///
/// A particle whose wholeness is low stands beside a void if a ball wider than one lost particle leaves holds none of
/// its neighbours, on the side to which its neighbourhood is lopsided. The largest empty ball of a square lattice has a
/// radius of 0.71 spacings, of a cubic one 0.87, without one particle 1. In a strained, coarse flow gaps of 1.13 open
/// and close by themselves (Taylor-Green vortices at Re 10000, 25 a side; to treat them as voids made the error 1.24
/// times as large): neither is a void. A particle whose neighbourhood is broken (fluid_finish.hpp) needs no such ball.
/// It and all of its fluid within the kernel radius are then beside the void for `memory` steps. A flow in which one
/// particle in a hundred is broken beside no void, in `unresolved_steps` steps more than not, is resolved nowhere: all
/// of its particles are for `unresolved_memory` steps. A start that is disturbed by 0.3 spacings has one broken
/// particle in a hundred, and is rid of them in 10 to 20 steps; to treat them made the errors of viscous vortices 1.4
/// to 2.2 times, of an inviscid one 1.3 times as large. So broken neighbourhoods do not count in the first `settling`
/// steps of a run.
///
/// Costs the rows of the few particles that the pass over the rates noted; nothing is read or written in a whole fluid.
/// Which particles are marked depends on places alone, so that threads change nothing. Allocates nothing.
class VoidFinder {
 public:
  static constexpr double ball = 1.3, outside = 1.2;  // radius and distance of the ball, in spacings
  static constexpr double memory = 16.0;              // steps
  static constexpr double unresolved_share = 0.01, unresolved_memory = 4096.0;  // of the particles; steps
  static constexpr std::int64_t unresolved_steps = 16, settling = 64;

  /// What a fluid sees of one phase. `width`: radius of the ball that none of its particles may enter (m).
  struct Seen {
    const PairList* list;
    const PhaseParticles* particles;
    const CellGrid* grid;
    double width;
  };

  /// Of one phase on several ranks: places of the ghosts (m), by axis.
  using Ghosts = std::array<std::vector<double>, 3>;

  /// Places beyond an end of a zone with a flow are not looked at: the last rows of the zone have nothing behind them.
  void leave_out(const FlowEnd& end) { ends_.push_back(end); }
  /// So many phases are seen, at most: then the first find() allocates nothing either.
  void look_at(std::size_t phases) { ghosts_.resize(phases); }

  /// `seen`: the fluid's own entry first. `radius`: of that (m). `spacing`: of the fluid (m). `loose`: what the pass
  /// over the rates noted; emptied. Returns whether any particle is beside a void.
  bool find(PhaseParticles& fluid, std::span<const Seen> seen, double radius, double spacing, LooseParticles& loose);

  bool any() const { return near_ != 0; }  ///< what find() returned last
  void archive(Archive& a) {
    a.number("void near", near_);
    a.number("unresolved steps", unresolved_);
    a.number("steps until broken ones count", until_);
  }

 private:
  template <int Dim>
  bool find_in(PhaseParticles& fluid, std::span<const Seen> seen, double radius, double spacing, LooseParticles& loose);
  bool is_left_out(const PhaseParticles& fluid, std::size_t k) const;
  void take_ghosts(std::span<const Seen> seen);
  void return_marks(const CellGrid& grid, double* left) const;
  std::vector<Ghosts> ghosts_;  // by what is seen
  std::vector<char> marked_;    // of the fluid's ghosts: beside a void
  std::vector<FlowEnd> ends_;
  std::int64_t near_ = 0;  // 1: some particle is beside a void
  std::int64_t unresolved_ = 0;
  std::int64_t until_ = settling + 1;  // steps until a broken neighbourhood counts
};

}  // namespace barchan
