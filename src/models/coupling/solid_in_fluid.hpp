// A solid that moves in a fluid: grains or bodies. The fluid sees it as a moving wall; it feels the reaction.
#pragma once

#include <vector>

#include "models/walls/wall.hpp"
#include "models/workspace.hpp"

namespace barchan {

class SolidInFluid : public Model {
 public:
  /// For the phase `solid` and all its coupling entries.
  SolidInFluid(const Scene& scene, const Layout& layout, std::size_t solid);
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;

 private:
  void extend();
  void react();

  const Scene& scene_;
  const Layout& layout_;
  std::size_t solid_;
  bool grains_;
  Workspace* w_ = nullptr;
  std::vector<ExtensionSource> sources_;
  std::vector<FluidNeighbour> felt_;  // by fluid
  std::vector<std::size_t> fluids_;
};

}  // namespace barchan
