#include "models/fluid/kept_momentum.hpp"

#include <algorithm>

#include "engine/means.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "models/workspace.hpp"

namespace barchan {

namespace {

/// Sides of the domain along which fluids slip: they take no momentum along periodic axes.
bool is_slippery_side(const Scene& scene, const Layout& layout, std::size_t wall) {
  const PlanPhase& p = layout.phases[wall];
  return p.takes_momentum() && p.surface.friction == Friction::slip && !p.gives_energy() &&
         std::all_of(scene.fills.begin(), scene.fills.end(), [&](const Fill& fill) {
           return fill.phase != p.name || std::holds_alternative<SidesShape>(fill.shape);
         });
}

/// The fluids that touch fluid `first`, through others too; none if something else acts on one of them.
std::vector<std::size_t> fluids_alone(const Scene& scene, const Layout& layout, std::size_t first) {
  std::vector<std::size_t> fluids{first};
  for (std::size_t k = 0; k < fluids.size(); ++k) {
    const PlanPhase& p = layout.phases[fluids[k]];
    const bool forced =
        std::any_of(scene.forcings.begin(), scene.forcings.end(), [&](const Forcing& f) { return f.phase == p.name; });
    if (forced || !p.flow_ends.empty() || layout.leaves(fluids[k])) return {};
    for (const PlanEntry& e : layout.entries) {
      if (!e.has(fluids[k]) || e.a == e.b) continue;
      const std::size_t other = e.partner(fluids[k]);
      if (!layout.phases[other].flows() && !is_slippery_side(scene, layout, other)) return {};
      if (layout.phases[other].flows() && std::find(fluids.begin(), fluids.end(), other) == fluids.end())
        fluids.push_back(other);
    }
  }
  return fluids;
}

class KeptMomentum : public Model {
 public:
  KeptMomentum(const Scene& scene, const Layout& layout, std::vector<std::size_t> fluids)
      : scene_(scene), layout_(layout), fluids_(std::move(fluids)) {}

  void attach(Workspace& w) override {
    for (const std::size_t k : fluids_) particles_.push_back(&w.particles(k));
  }
  void schedule(Schedule& s) override {
    Touches touches;
    for (const std::size_t k : fluids_) touches.push_back({layout_.phases[k].name, {}, {Field::acceleration}});
    s.add({stage::hold, layout_.phases[fluids_.front()].name, touches, [this] { keep(); }});
  }

 private:
  void keep() {
    for (int d = 0; d < layout_.dimensions; ++d)
      if (const auto axis = static_cast<std::size_t>(d); layout_.bounds.periodic[axis])
        keep_momentum(particles_, d, scene_.domain.gravity[axis]);
  }

  const Scene& scene_;
  const Layout& layout_;
  std::vector<std::size_t> fluids_;
  std::vector<PhaseParticles*> particles_;
};

}  // namespace

std::unique_ptr<Model> kept_momentum(const Scene& scene, const Layout& layout) {
  for (const PlanEntry& e : layout.entries)
    if (has_interface(scene, layout, e))
      if (auto fluids = fluids_alone(scene, layout, e.a); !fluids.empty())
        return std::make_unique<KeptMomentum>(scene, layout, std::move(fluids));
  return nullptr;
}

}  // namespace barchan
