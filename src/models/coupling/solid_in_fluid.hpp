// A solid that moves in a fluid: grains or bodies. The fluid sees it as a moving wall; it feels the reaction.
#pragma once

#include <vector>

#include "models/walls/wall.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// An entry of a fluid and grains or bodies: the solid is a moving wall and feels the reaction.
void describe_coupling(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);

class SolidInFluid : public Model {
 public:
  /// For the phase `solid` and all fluids that are extended into it. `by_borders`: what fluids of the consistent scheme
  /// do to it is BorderLoad's work.
  SolidInFluid(const Scene& scene, const Layout& layout, std::size_t solid, bool by_borders);
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;

 private:
  void extend();
  void react();

  const Scene& scene_;
  const Layout& layout_;
  std::size_t solid_;
  bool by_borders_;
  bool separate_;  // its particles move one by one (PlanPhase::separate)
  ExtensionRule rule_;
  Workspace* w_ = nullptr;
  std::vector<ExtensionSource> sources_;
  std::vector<FluidNeighbour> felt_;  // by fluid
  std::vector<std::size_t> fluids_;
};

}  // namespace barchan
