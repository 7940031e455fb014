#include "models/coupling/solid_in_fluid.hpp"

#include "models/fluid/fluid_phase.hpp"
#include "scene/couplings.hpp"

namespace barchan {

void describe_coupling(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e) {
  e.law = "coupling";
  e.blows = layout.phases[e.other].separate();
  describe_extension(scene, pair, e);
}

/// In a gap of about a spacing a single fluid particle may be all that a solid particle meets, and as near to the plane
/// of its surface as round-off: the line of no slip through it is as steep as this share of a spacing allows. Rows of a
/// fluid stand half a spacing off and more.
static constexpr double nearest = 0.25;

SolidInFluid::SolidInFluid(const Scene& scene, const Layout& layout, std::size_t solid, bool by_borders)
    : scene_(scene),
      layout_(layout),
      solid_(solid),
      by_borders_(by_borders),
      separate_(layout.phases[solid].separate()),
      rule_{Slip::no_slip, !separate_, separate_} {
  if (separate_) return;
  rule_.rub = wall_rub(scene, layout, solid);
  rule_.one_sided = ends_at_border(scene, scene.phases[solid]);
  rule_.least_phi = nearest * layout.phases[solid].spacing;
  for (const PlanEntry& e : layout.entries)
    if (e.extends && e.other == solid && e.corrected && layout.phases[e.fluid].free_surface) rule_.lets_go = true;
}

void SolidInFluid::attach(Workspace& w) {
  w_ = &w;
  sources_ = extension_sources(w, solid_);
  for (const auto& e : layout_.entries) {
    if (!e.extends || e.other != solid_ || (by_borders_ && e.corrected)) continue;
    fluids_.push_back(e.fluid);
    felt_.push_back({&w.list(e.direction(solid_)), &w.records(e.fluid, Record::motion), e.kernel, e.radius,
                     viscosity_of_sums(scene_, layout_, e), false});
  }
}

void SolidInFluid::schedule(Schedule& s) {
  using enum Field;
  const std::string& name = layout_.phases[solid_].name;
  const FieldSet moving{position, velocity, acceleration},
      surface{wall_depth, wall_normal, surface_velocity, surface_acceleration};  // of a solid that has them
  s.add({stage::extend_solids, name, extension_touches(layout_, solid_, moving | surface), [this] { extend(); }});
  Touches felt{{name, {position, velocity, density}, {acceleration}, {{Record::extended}, {}, {}}}};
  for (const auto& e : layout_.entries)
    if (e.extends && e.other == solid_)
      felt.push_back({layout_.phases[e.fluid].name, {}, {}, {{}, {Record::motion, Record::eddies}, {}}});
  s.add({stage::reaction, name, felt, [this] { react(); }});
}

void SolidInFluid::extend() {
  // The acceleration of the last step: the one of this step is computed later.
  extend_into_solid(w_->particles(solid_), w_->to_write(solid_, Record::extended), sources_, scene_.domain.gravity,
                    rule_);
  w_->share_records(solid_, Record::extended);
  share_extended(*w_, solid_);
}

void SolidInFluid::react() {
  if (felt_.empty()) return;
  PhaseParticles& solid = w_->particles(solid_);
  const RecordArray& extended = w_->records(solid_, Record::extended);
  for (const auto& fluid : felt_) fluid_reaction(solid, extended, fluid, separate_);
  for (std::size_t c = 0; separate_ && c < felt_.size(); ++c)
    if (layout_.phases[fluids_[c]].eddies)
      eddy_reaction(solid, extended, felt_[c], w_->eddies(fluids_[c]), felt_[c].viscosity);
  w_->share_field(solid_, Field::acceleration);
}

}  // namespace barchan
