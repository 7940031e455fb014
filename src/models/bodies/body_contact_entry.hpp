// An entry whose law is a contact of bodies: with another body, with a wall, or of parts of one body
// (laws/body_contact.hpp).
#pragma once

#include <optional>

#include "models/bodies/body_forces.hpp"
#include "models/bodies/body_surface.hpp"
#include "models/bodies/wall_surfaces.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// An entry of bodies that touch by their particles: with another body or with a wall.
void describe_body_contact(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);
/// The contact of a body with itself; `held`: its entry that holds it together.
PlanEntry self_contact_of(const Scene& scene, const Interaction& pair, const Layout& layout, const PlanEntry& held);

class BodyContact : public Model {
 public:
  BodyContact(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;
  void archive(Archive& a) override;

 private:
  void push(std::size_t phase);
  void push_itself();
  void push_from_sides(std::size_t phase);
  void push_surface(std::size_t phase);
  void schedule_surfaces(Schedule& s);
  bool of_single_particles() const;
  double held_within(std::size_t phase) const;

  const Scene& scene_;
  const Layout& layout_;
  const PlanEntry& entry_;
  BodyContactLaw law_;
  std::vector<BodySide> sides_;           // of a wall
  std::optional<WallSurfaces> surfaces_;  // of one whose shapes all have surfaces
  Workspace* w_ = nullptr;
  // Of bodies that touch by their surfaces:
  std::optional<SmoothContactLaw> smooth_;
  std::array<BodySurface, 2> skins_;  // of entry_.a, of entry_.b
  // Of a body with itself:
  bool itself() const { return entry_.a == entry_.b; }
  FarPairs far_;
  int list_ = -1;            // direction: of an updated Lagrangian body that of its kernel
  bool must_choose_ = true;  // the list is new
};

}  // namespace barchan
