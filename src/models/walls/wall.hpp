// A wall phase: particles that stay in place (driven_wall.hpp: or travel), a surface that may slide, the fluids
// continued into it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "models/forces.hpp"
#include "models/walls/contact_line.hpp"
#include "models/walls/ventilation.hpp"
#include "models/walls/wall_faces.hpp"
#include "models/walls/walls.hpp"
#include "models/workspace.hpp"

namespace barchan {

void declare_wall(const Scene& scene, std::size_t number, Layout& layout);
void describe_wall(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                   std::vector<std::string>& warnings);

/// An entry of a fluid with a wall into which its pressure and velocity are extended (Adami et al. 2012).
void describe_boundary(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);
/// The same without a name of the law: the fluid is extended into the other phase, whatever that does.
void describe_extension(const Scene& scene, const Interaction& pair, PlanEntry& e);

class Wall : public Model {
 public:
  Wall(const Scene& scene, const Layout& layout, std::size_t number);

  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  int phase() const override { return static_cast<int>(number_); }

 private:
  std::vector<WallFace> faces_in_the_domain(const std::vector<Vec3>& places) const;
  void slide();
  void extend();
  void force();

  const Scene& scene_;
  const Layout& layout_;
  const Phase& phase_;
  const PlanPhase& plan_;
  std::size_t number_;
  Workspace* w_ = nullptr;
  std::array<Formula, 3> velocity_;  // m/s
  bool extended_ = false;            // some fluid sees it
  std::vector<ExtensionSource> sources_;
  SurfaceBend bend_;
  ExtensionRule rule_;
  std::optional<Ventilation> ventilation_;  // of the same
  std::optional<ContactLine> contact_;      // of a wall that a fluid is extended into
  std::optional<Forces> forces_;  // of the only fluid that is extended into it, if that is calm and heavy (calmed())
  std::vector<double> forced_;    // m/s2, of forces_ across the wall, by particle and component
};

/// Normals of the walls inside the domain, where some wall's surface must know which way it faces (it slips, or a free
/// surface meets it): once all walls have begun.
void face_walls(const Layout& layout, State& state);

/// What a solid sees of the fluids that are extended into it.
std::vector<ExtensionSource> extension_sources(Workspace& w, std::size_t solid);
/// The same records for fluids in mixed precision, after extended records were made.
void share_extended(Workspace& w, std::size_t solid);
/// What a task touches that extends fluids into a solid, whose fields it reads.
Touches extension_touches(const Layout& layout, std::size_t solid, const FieldSet& reads);

}  // namespace barchan
