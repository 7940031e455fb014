#include "models/walls/wall.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/kernel.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "models/walls/wall_faces.hpp"
#include "models/walls/wall_normals.hpp"
#include "scene/couplings.hpp"
#include "scene/side_names.hpp"

namespace barchan {

namespace {

/// Of a spacing: nearer to the outline of a wall than this, a fluid's particle counts as this far from it. Boxes hold
/// particles at the outline itself, where the line through the wall's velocity has no slope; sides hold them here.
constexpr double held_off = 0.02;

/// The same beside bodies that move: they press particles to the outline, one alone in a gap (SolidInFluid).
constexpr double held_off_by_bodies = 0.25;

/// Whether a fluid touches bodies that move.
bool carries_bodies(const Layout& layout, std::size_t fluid) {
  return std::any_of(layout.entries.begin(), layout.entries.end(), [&](const PlanEntry& e) {
    return e.extends && e.fluid == fluid && layout.phases[e.other].moves() && !layout.phases[e.other].separate();
  });
}

/// The largest size (m/s) of the velocity that a wall says, at 17 times of the run.
double largest_in_time(const Scene& scene, const VectorExpression& velocity) {
  const Formula u(velocity[0]), v(velocity[1]), w(velocity[2]);
  double speed = 0.0;
  for (int k = 0; k <= 16; ++k) {
    const double t = scene.time.end * k / 16.0;
    speed = std::max(speed, norm({u({0, 0, 0}, t), v({0, 0, 0}, t), w({0, 0, 0}, t)}));
  }
  return speed;
}

}  // namespace

void declare_wall(const Scene& scene, std::size_t number, Layout& layout) {
  const WallKeys& keys = scene.phases[number].wall();
  layout.phases[number].surface.speed = largest_in_time(scene, keys.velocity);
  layout.phases[number].sphere_records = keys.diameter.has_value();
  if (keys.diameter) layout.phases[number].largest_size = keys.diameter->largest();
  if (motion_of(scene, scene.phases[number])) layout.phases[number].mover = Mover::motion;
}

void describe_wall(const Scene& scene, const std::vector<ParticleBlock>&, std::size_t number, Layout& layout,
                   std::vector<std::string>&) {
  using enum Field;
  const WallKeys& keys = scene.phases[number].wall();
  PlanPhase& p = layout.phases[number];
  p.surface.friction = keys.shear_stress              ? Friction::driven
                       : keys.slip == Slip::free_slip ? Friction::slip
                       : keys.roughness               ? Friction::rough
                                                      : Friction::smooth;
  p.surface.roughness = keys.roughness.value_or(0.0);
  p.surface.stress = keys.shear_stress.value_or(Vec3{});
  p.fields = {position, velocity, wall_normal, wall_depth};
  if (keys.diameter && keys.diameter->differ()) p.fields.push_back(radius);
  if (std::any_of(scene.force_meters.begin(), scene.force_meters.end(),
                  [&](const ForceMeter& meter) { return meter.phase == scene.phases[number].name; }))
    p.fields.push_back(acceleration);
}

void describe_extension(const Scene& scene, const Interaction& pair, PlanEntry& e) {
  e.continues_fluid = e.extends = true;
  describe_approximation(pair, scene.dimensions, correction_of(scene, e.fluid), e);
}

void describe_boundary(const Scene& scene, const Interaction& pair, const Layout&, PlanEntry& e) {
  e.law = "boundary";
  describe_extension(scene, pair, e);
}

Wall::Wall(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene),
      layout_(layout),
      phase_(scene.phases[number]),
      plan_(layout.phases[number]),
      number_(number),
      velocity_(compile(phase_.wall().velocity)) {
  extended_ = layout.is_extended(number);
  // A wall whose stress is given leaves the fluid's velocity along it alone.
  const WallKeys& keys = phase_.wall();
  rule_.slip = keys.roughness || keys.shear_stress ? Slip::free_slip : keys.slip;
  rule_.accelerates = plan_.travels();
  rule_.rub = wall_rub(scene, layout, number);
  for (const auto& e : layout.entries)
    if (e.extends && e.other == number && layout.phases[e.fluid].free_surface) {
      rule_.lets_go = plan_.travels();
      rule_.least_phi = (carries_bodies(layout, e.fluid) ? held_off_by_bodies : held_off) * plan_.spacing;
    }
}

namespace {

bool is_walled(const Scene& scene, std::size_t axis, bool above) {
  const SideNames& names = side_names(scene.domain);
  return std::any_of(scene.fills.begin(), scene.fills.end(), [&](const Fill& fill) {
    const auto* shape = std::get_if<SidesShape>(&fill.shape);
    return shape &&
           std::find(shape->sides.begin(), shape->sides.end(), names[axis][above ? 1 : 0]) != shape->sides.end();
  });
}

/// How far a place is outside the domain, by axis (m). A wall goes on past the end of its side where no wall closes the
/// next one: what is behind a walled side counts as outside of that one only.
Vec3 out_of_walled_sides(const Scene& scene, const Bounds& bounds, const Vec3& x) {
  Vec3 all{}, walled{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(bounds.dimensions); ++d) {
    if (bounds.periodic[d]) continue;
    all[d] = x[d] < bounds.low[d] ? x[d] - bounds.low[d] : x[d] > bounds.high[d] ? x[d] - bounds.high[d] : 0.0;
    if (all[d] != 0.0 && is_walled(scene, d, all[d] > 0.0)) walled[d] = all[d];
  }
  return norm(walled) > 0.0 ? walled : all;
}

}  // namespace

/// Of a box that a free surface may meet, whose edges water leaves: those of the outline. Else none: between slanted
/// faces the smoothed normals hold; with those of the outline a dam over a ridge broke up.
std::vector<WallFace> Wall::faces_in_the_domain(const std::vector<Vec3>& places) const {
  const bool boxes = std::all_of(scene_.fills.begin(), scene_.fills.end(), [&](const Fill& fill) {
    return fill.phase != plan_.name || std::holds_alternative<BoxShape>(fill.shape);
  });
  if (!boxes || !is_ventilated(layout_, number_)) return {};
  double reach = 0.0;
  for (const auto& e : layout_.entries)
    if (e.extends && e.other == number_) reach = std::max(reach, e.radius);
  return outline_faces(scene_, layout_, number_, places, reach);
}

/// Distance to the surface and the direction to it: given for fitted walls; behind the domain's sides for a wall
/// particle outside the domain; from the outline inside it. Of a wall that travels DrivenWall knows them.
void Wall::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  if (plan_.travels()) return;
  PhaseParticles& wall = state.phases[number_];
  const ParticleBlock& block = blocks[number_];
  const Bounds& bounds = layout_.bounds;
  const std::vector<WallFace> faces = faces_in_the_domain(block.position);
  for (std::size_t k = 0; k < wall.size(); ++k) {
    if (k < block.depth.size() && block.depth[k] > 0.0) {
      wall.column(Field::wall_depth)[k] = block.depth[k];
      for (int d = 0; d < wall.dimensions(); ++d)
        wall.column(Field::wall_normal, d)[k] = block.normal[k][static_cast<std::size_t>(d)];
      continue;
    }
    Vec3 x{};
    for (int d = 0; d < wall.dimensions(); ++d) x[static_cast<std::size_t>(d)] = wall.column(Field::position, d)[k];
    const Vec3 out = out_of_walled_sides(scene_, bounds, x);
    const double depth = norm(out);
    WallFace face{{}, depth};
    if (depth > 0.0)
      for (std::size_t d = 0; d < 3; ++d) face.normal[d] = -out[d] / depth;
    else if (!faces.empty()) face = faces[k];
    wall.column(Field::wall_depth)[k] = face.depth;
    if (!(face.depth > 0.0)) continue;
    for (int d = 0; d < wall.dimensions(); ++d)
      wall.column(Field::wall_normal, d)[k] = face.normal[static_cast<std::size_t>(d)];
  }
  if (block.bend.empty()) return;
  bend_.first = wall.id().empty() ? 0 : wall.id()[0];
  for (const auto& b : block.bend)
    if (layout_.dimensions == 2) bend_.values.push_back(b[0]);
    else bend_.values.insert(bend_.values.end(), b.begin(), b.end());
}

/// The fluids that feel a wall.
static std::vector<std::size_t> fluids_at(const Layout& layout, std::size_t wall) {
  std::vector<std::size_t> fluids;
  for (const auto& e : layout.entries)
    if (e.extends && e.other == wall) fluids.push_back(e.fluid);
  return fluids;
}

void Wall::attach(Workspace& w) {
  w_ = &w;
  if (!extended_) return;
  sources_ = extension_sources(w, number_);
  contact_.emplace(w, number_, sources_, rule_);
  ventilation_.emplace(w, number_, sources_);
  const auto fluids = fluids_at(layout_, number_);
  if (fluids.size() != 1 || !calmed(scene_, layout_, fluids[0])) return;
  if (Forces forces(scene_, scene_.phases[fluids[0]].name); forces.any()) forces_.emplace(std::move(forces));
}

void Wall::schedule(Schedule& s) {
  using enum Field;
  if (!plan_.travels()) s.add({stage::walls, plan_.name, {{plan_.name, {}, {velocity}}}, [this] { slide(); }});
  FieldSet reads{position, velocity, wall_depth, wall_normal};
  if (plan_.travels()) reads = reads | FieldSet{surface_velocity, surface_acceleration};
  if (!extended_) return;
  Touches touches = extension_touches(layout_, number_, reads);
  add_contact_touches(scene_, layout_, number_, touches);
  add_ventilation_touches(layout_, number_, touches);
  s.add({stage::extend_walls, plan_.name, touches, [this] { extend(); }});
}

void Wall::slide() {
  PhaseParticles& wall = w_->particles(number_);
  for (int d = 0; d < layout_.dimensions; ++d) {
    const Formula& u = velocity_[static_cast<std::size_t>(d)];
    if (u.is_constant() && w_->state.steps > 0) continue;
    const double value = u({0, 0, 0}, w_->state.time);
    double* v = wall.column(Field::velocity, d);
    std::fill(v, v + wall.size(), value);
  }
}

/// What [[forcing]] gives to a fluid across the wall makes a gradient of the pressure there, as weight does: what it
/// gives in front of the wall, as far from the surface as the particle is behind it (a box may end at the wall).
void Wall::force() {
  const PhaseParticles& wall = w_->particles(number_);
  const auto dim = static_cast<std::size_t>(layout_.dimensions);
  const double* depth = wall.column(Field::wall_depth);
  forced_.assign(wall.size() * dim, 0.0);
  for (std::size_t k = 0; k < wall.size(); ++k) {
    Vec3 x{}, normal{};
    for (std::size_t d = 0; d < dim; ++d) {
      normal[d] = wall.column(Field::wall_normal, static_cast<int>(d))[k];
      x[d] = wall.column(Field::position, static_cast<int>(d))[k] + 2.0 * depth[k] * normal[d];
    }
    const double across = dot(forces_->at(x, w_->state.time, layout_.dimensions), normal);
    for (std::size_t d = 0; d < dim; ++d) forced_[k * dim + d] = across * normal[d];
  }
}

void Wall::extend() {
  const PhaseParticles& wall = w_->particles(number_);
  RecordArray& records = w_->to_write(number_, Record::extended);
  if (forces_) force();
  extend_into_solid(wall, records, sources_, scene_.domain.gravity, rule_, bend_, forced_);
  ventilation_->let_go(wall, records);
  contact_->end(wall, forced_, records);
  share_extended(*w_, number_);
}

/// Of a calm heavy fluid, whose rest a column of water of one density disturbs; of others none.
static Compression compression_of(const Workspace& w, std::size_t fluid) {
  if (!calmed(w.scene, w.layout, fluid)) return {};
  const PressureLaw law = pressure_law(w.scene, w.layout, fluid);
  return {law(law.reference_density), 1.0 / (law.sound_speed * law.sound_speed)};
}

std::vector<ExtensionSource> extension_sources(Workspace& w, std::size_t solid) {
  /// sum V W of a full neighbourhood less the particle itself.
  const auto weight_about_a_lone_particle = [&](const PlanEntry& e) {
    double own = 0.0;
    with_kernel<double>(e.kernel, e.radius, w.layout.dimensions, [&](const auto& kernel) {
      own = kernel.value(0.0) * std::pow(w.layout.phases[solid].spacing, w.layout.dimensions);
    });
    return e.consistency.volume_sum - own;
  };
  std::vector<ExtensionSource> sources;
  for (const auto& e : w.layout.entries)
    if (e.extends && e.other == solid)
      sources.push_back({&w.list(e.direction(solid)), &w.records(e.fluid, Record::motion), e.kernel, e.radius,
                         w.scene.phases[e.fluid].density, e.given.drag > 0 ? weight_about_a_lone_particle(e) : 0.0,
                         compression_of(w, e.fluid)});
  return sources;
}

Touches extension_touches(const Layout& layout, std::size_t solid, const FieldSet& reads) {
  Touches touches{{layout.phases[solid].name, reads, {}, {{}, {}, {Record::extended, Record::compact}}}};
  for (const auto& e : layout.entries)
    if (e.extends && e.other == solid)
      touches.push_back({layout.phases[e.fluid].name, {}, {}, {{}, {Record::motion}, {}}});
  return touches;
}

void share_extended(Workspace& w, std::size_t solid) {
  CompactRecords* const compact = w.compact_to_write(solid);
  if (!compact) return;
  const RecordArray& extended = w.records(solid, Record::extended);
  const std::size_t count = w.particles(solid).size();
  w.layout.dimensions == 2 ? compact->copy<2>(extended, count) : compact->copy<3>(extended, count);
}

/// A wall is faced away from itself and from those that the same fluids feel: grains that are fixed are nothing to air.
void face_walls(const Layout& layout, State& state) {
  std::vector<std::size_t> walls;
  bool needed = false;
  for (std::size_t k = 0; k < state.phases.size(); ++k) {
    const PlanPhase& p = layout.phases[k];
    if (p.moves() || p.travels() || !state.phases[k].has(Field::wall_normal)) continue;
    walls.push_back(k);
    needed = needed || p.surface.friction != Friction::smooth || is_ventilated(layout, k);
  }
  if (!needed) return;
  for (const std::size_t wall : walls) {
    const auto fluids = fluids_at(layout, wall);
    std::vector<WallPart> parts;
    for (const std::size_t other : walls) {
      const auto about = fluids_at(layout, other);
      if (other != wall && std::find_first_of(fluids.begin(), fluids.end(), about.begin(), about.end()) == fluids.end())
        continue;
      parts.push_back({&state.phases[other],
                       std::pow(layout.phases[other].spacing / layout.phases[wall].spacing, layout.dimensions)});
    }
    find_wall_normals(state.phases[wall], parts, layout.bounds, layout.phases[wall].spacing);
  }
}

}  // namespace barchan
