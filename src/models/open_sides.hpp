// Particles that leave through a side of the domain which nothing closes to them: of a fluid, and spheres.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "models/model.hpp"

namespace barchan {

/// The sides through which a fluid may leave, by axis: {lower, upper}. As `domain.open` says; without that key, of a
/// fluid with a free surface, the side away from gravity where no wall that it feels stands behind it. Not the sides
/// through which it flows. Throws SceneError when the scene opens a side behind which such a wall stands.
std::array<std::array<bool, 2>, 3> open_sides(const Scene& scene, std::size_t fluid, bool free_surface);
/// The same of spheres: those that `domain.open` names and behind which no wall stands that they touch.
std::array<std::array<bool, 2>, 3> open_sides_of_spheres(const Scene& scene, std::size_t grains);

/// What passed a side (SI; by metre of depth in 2D).
struct PassedSide {
  std::int64_t particles = 0;
  double mass = 0.0, energy = 0.0;  // kg; J, kinetic, without that of spin
  Vec3 momentum{};                  // kg m/s
};
/// Columns of history.csv: NAME_SIDE_WAY [kg], NAME_SIDE_WAY_number, ..._momentum_x [kg m/s], ..._energy [J].
void add_passed(HistoryRow& row, const std::string& name_side_way, int dimensions, const PassedSide& passed);

/// Takes particles of its phase that passed an open side by more than half a spacing out of the run: before the
/// neighbours are searched, in the order of the particles, so that threads change nothing. What they had when they left
/// is kept in State::departed, and by side.
class OpenSides : public Model {
 public:
  static constexpr double beyond = 0.5;  // spacings: there the watch would stop the run (simulation/watch.hpp)

  OpenSides(const Scene& scene, const Layout& layout, std::size_t phase);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  /// NAME_left [kg] (kg/m in 2D) and what left by side (NAME_SIDE_out), where the scene opens a side by name.
  void history(HistoryRow& row) const override;
  std::optional<std::string> trouble() const override { return trouble_; }
  void report(Warnings& warnings) const override;
  void archive(Archive& a) override;

 private:
  using BySide = std::array<std::array<PassedSide, 2>, 3>;

  void leave();
  /// Whether a particle is beyond one of the open sides.
  bool is_beyond(const PhaseParticles& p, std::size_t k) const;
  bool any_beyond(const PhaseParticles& p) const;
  PassedSide& side_of(const PhaseParticles& p, std::size_t k);
  void book(const PhaseParticles& p, std::size_t k, Departed& departed);
  std::string sides_text() const;
  std::string share_of_mass(double left) const;

  const Scene& scene_;
  const PlanPhase& plan_;
  std::size_t phase_, place_ = 0;  // of its row in State::departed
  Vec3 low_, high_;                // m
  double start_mass_ = 0.0;        // kg
  BySide passed_;
  std::optional<std::string> trouble_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
