// Fluid that leaves through a side of the domain which nothing closes.
#pragma once

#include <string>
#include <vector>

#include "models/model.hpp"

namespace barchan {

/// The sides through which a fluid may leave, by axis: {lower, upper}. As `domain.open` says; without that key, of a
/// fluid with a free surface, the side away from gravity where no wall that it feels stands behind it. Throws
/// SceneError when the scene opens a side behind which such a wall stands.
std::array<std::array<bool, 2>, 3> open_sides(const Scene& scene, std::size_t fluid, bool free_surface);

/// Takes particles of its fluid that passed an open side by more than half a spacing out of the run: before the
/// neighbours are searched, in the order of the particles, so that threads change nothing. What they had when they left
/// is kept in State::departed.
class OpenSides : public Model {
 public:
  static constexpr double beyond = 0.5;  // spacings: there the watch would stop the run (simulation/watch.hpp)

  OpenSides(const Scene& scene, const Layout& layout, std::size_t fluid);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  /// NAME_left [kg] (kg/m in 2D), where the scene opens a side by name.
  void history(HistoryRow& row) const override;
  std::optional<std::string> trouble() const override { return trouble_; }
  void report(Warnings& warnings) const override;

 private:
  void leave();
  /// Whether a particle is beyond one of the open sides.
  bool is_beyond(const PhaseParticles& p, std::size_t k) const;
  bool any_beyond(const PhaseParticles& p) const;
  void book(const PhaseParticles& p, std::size_t k, Departed& departed) const;
  std::string sides_text() const;

  const Scene& scene_;
  const PlanPhase& plan_;
  std::size_t fluid_, place_ = 0;  // of its row in State::departed
  Vec3 low_, high_;                // m
  double start_mass_ = 0.0;        // kg
  std::optional<std::string> trouble_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
