#include "models/bodies/body_contact_entry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/errors.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"
#include "scene/side_names.hpp"

namespace barchan {

namespace {

/// The spring of two facing particles is a quarter of what continues the material, (lambda + 2 mu) dx^(D - 2) of the
/// softer body. A stiffer one sends waves into the bodies that are shorter than their lattice can carry: of two bars of
/// 40 particles a length A then keeps 1.7 % of its speed, in place of 0.6 % (docs/impacts.md).
constexpr double softness = 0.25;

/// By surfaces 0.4: of Hertz's spheres with 20 particles a radius a quarter gives 1.08 of the width and 0.91 of the
/// peak, a half 0.95 of the width (by the fit) and 1.05 of the peak (docs/impacts.md).
constexpr double softness_of_surfaces = 0.4;

/// With `wave-correction` each side gives 1.2 of the spring of one spacing, what a pressed body lacks of its length.
constexpr double exact_side = 1.2;

bool by_surfaces(const Scene& scene, const PlanEntry& e) {
  const Interaction* pair = entry_between(scene, scene.phases[e.a], scene.phases[e.b]);
  return pair && pair->surfaces && e.a != e.b;
}

/// Whether all bodies of an entry that yield carry short waves at their speed (`wave-correction`).
bool carry_short_waves(const Scene& scene, const Layout& layout, const PlanEntry& e) {
  return std::none_of(layout.phases.begin(), layout.phases.end(), [&](const PlanPhase& p) {
    const auto k = static_cast<std::size_t>(&p - layout.phases.data());
    return e.has(k) && p.yields() && !scene.phases[k].elastic().wave_correction;
  });
}

BodyContactLaw law_of(const Scene& scene, const Layout& layout, const PlanEntry& e) {
  const bool smooth = by_surfaces(scene, e);
  const double share = smooth ? softness_of_surfaces : softness, side = smooth ? exact_side : 1.0;
  double softest = 1e300, compliance = 0.0, inverse_mass = 0.0;
  for (const std::size_t k : {e.a, e.b}) {  // of a body with itself twice
    const PlanPhase& p = layout.phases[k];
    if (!p.yields()) continue;
    const double modulus = scene.phases[k].density * p.sound_speed * p.sound_speed;
    const double continued = modulus * std::pow(p.spacing, layout.dimensions - 2);
    softest = std::min(softest, share * continued);
    compliance += 1.0 / continued;
    inverse_mass += 1.0 / p.mass;
  }
  const double distance = 0.5 * (layout.phases[e.a].spacing + layout.phases[e.b].spacing);
  const double stiffness = carry_short_waves(scene, layout, e) ? side / compliance : softest;
  return BodyContactLaw::of(distance, stiffness, 1.0 / inverse_mass, e.given.restitution.value_or(1.0),
                            e.given.friction.value_or(0.0));
}

}  // namespace

namespace {

std::vector<BodySide> sides_of(const Scene& scene, const Layout& layout, const Phase& wall) {
  std::vector<BodySide> sides;
  const SideNames& names = side_names(scene.domain);
  for (const Fill& fill : scene.fills)
    for (std::size_t axis = 0; fill.phase == wall.name && axis < static_cast<std::size_t>(layout.dimensions); ++axis)
      for (const bool high : {false, true}) {
        const auto* planes = std::get_if<SidesShape>(&fill.shape);
        if (planes && std::find(planes->sides.begin(), planes->sides.end(), names[axis][high]) != planes->sides.end())
          sides.push_back({axis, high ? -1.0 : 1.0, high ? layout.bounds.high[axis] : layout.bounds.low[axis]});
      }
  return sides;
}

}  // namespace

void describe_body_contact(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e) {
  const PlanPhase &a = layout.phases[e.a], &b = layout.phases[e.b];
  e.law = "contact";
  e.meaning = "bodies: touching decides";
  const bool many = (a.deforms() && a.count > 1) || (b.deforms() && b.count > 1);
  if (const double restitution = pair.restitution.value_or(1.0); restitution < 1.0 && many) {
    char number[32];
    std::snprintf(number, sizeof number, "%.3g", restitution);
    e.meaning += "; restitution " + std::string(number) +
                 " is of two particles, bodies of many keep more (0.91 to 0.93 measured)";
  }
  if (pair.surfaces) e.meaning += "; by their surfaces";
  e.radius = layout.touching_distance(e) * (pair.surfaces ? SmoothContactLaw::reach : 1.0);
  e.keeps_apart = true;
  const bool surfaces = has_surfaces(scene, scene.phases[e.a]) || has_surfaces(scene, scene.phases[e.b]);
  e.pairs = surfaces ? Pairs::own : Pairs::searched;
  e.feels_lattice = !surfaces && !(a.moves() && b.moves());
}

PlanEntry self_contact_of(const Scene& scene, const Interaction& pair, const Layout& layout, const PlanEntry& held) {
  PlanEntry e = held;
  e.name += " contact";
  e.corrected = e.reads_stress = false;
  e.self_contact = true;
  e.consistency = {};
  describe_body_contact(scene, pair, layout, e);
  // Lists of another radius would be sorted at other moments, which changes the order of all sums.
  e.forward = e.backward = -1;
  if (held.reads_stress) e.pairs = Pairs::own;
  return e;
}

BodyContact::BodyContact(const Scene& scene, const Layout& layout, const PlanEntry& entry)
    : scene_(scene), layout_(layout), entry_(entry), law_(law_of(scene, layout, entry)) {
  for (const std::size_t k : {entry.a, entry.b})
    if (const Phase& wall = scene.phases[k]; has_surfaces(scene, wall)) {
      sides_ = sides_of(scene, layout, wall);
      surfaces_.emplace(scene, layout, wall);
    }
  if (by_surfaces(scene, entry)) smooth_ = SmoothContactLaw::of(law_, layout.dimensions);
}

/// m, the radius in which a particle of a body finds those that it was made with.
double BodyContact::held_within(std::size_t phase) const {
  for (const PlanEntry& e : layout_.entries)
    if ((e.pairs == Pairs::first_shape || e.reads_stress) && e.a == phase && e.b == phase) return e.radius;
  return 2.0 * layout_.phases[phase].spacing;
}

void BodyContact::begin(State&, const std::vector<ParticleBlock>& blocks) {
  if (smooth_)
    for (const std::size_t side : {0u, 1u}) {
      const std::size_t phase = side == 0 ? entry_.a : entry_.b;
      const std::vector<Vec3>& places = blocks[phase].position;
      skins_[side] = BodySurface(places, layout_.bounds, layout_.phases[phase].spacing, held_within(phase), *smooth_);
      if (const std::int64_t alone = skins_[side].alone(); alone >= 0) {
        const Vec3& x = places[static_cast<std::size_t>(alone)];
        throw SceneError(located(scene_, "interactions." + entry_.name + ".surfaces") + ": the particle of \"" +
                         layout_.phases[phase].name + "\" at (" + brief(x[0]) + ", " + brief(x[1]) + ", " +
                         brief(x[2]) + ") m has no surface, since its neighbours lie in one line or plane or there " +
                         "are none; expected bodies of two layers of particles or more, or no such key");
      }
    }
  if (!itself()) return;
  const auto held = std::find_if(layout_.entries.begin(), layout_.entries.end(), [&](const PlanEntry& e) {
    return (e.pairs == Pairs::first_shape || e.reads_stress) && e.a == entry_.a && e.b == entry_.a;
  });
  list_ = held->reads_stress ? held->forward : entry_.forward;
  far_ = FarPairs(blocks[entry_.a].position, layout_.bounds, layout_.phases[entry_.a].spacing, held->radius);
}

void BodyContact::attach(Workspace& w) {
  w_ = &w;
  if (itself()) w.need(entry_.a, Record::motion);
  if (itself()) w.when_sorted.emplace_back([this] { must_choose_ = true; });
  for (const std::size_t phase : {entry_.a, entry_.b})
    if (smooth_) {
      w.need(phase, Record::surface);
      w.particles(phase).keep_places();
    }
}

void BodyContact::archive(Archive& a) {
  if (a.loads()) must_choose_ = true;
}

void BodyContact::schedule(Schedule& s) {
  using enum Field;
  const auto touched = [this](std::size_t phase) -> Touches {
    const RecordTouch motion{{}, {Record::motion}, {}};
    Touches touches{{layout_.phases[phase].name, {position, velocity}, {acceleration, contact_force}, motion}};
    if (!itself()) touches.push_back({layout_.phases[entry_.partner(phase)].name, {}, {}, motion});
    return touches;
  };
  if (itself()) {
    s.add({stage::contacts, entry_.name, touched(entry_.a), [this] { push_itself(); }});
    return;
  }
  if (smooth_) return schedule_surfaces(s);
  for (const std::size_t phase : {entry_.a, entry_.b}) {
    if (!layout_.phases[phase].moves()) continue;
    if (!sides_.empty())
      s.add({stage::contacts, entry_.name, touched(phase), [this, phase] { push_from_sides(phase); }});
    if (surfaces_ && !surfaces_->empty())
      s.add({stage::contacts, entry_.name, touched(phase), [this, phase] {
               surfaces_->push(w_->particles(phase), layout_.phases[phase].spacing, law_, w_->state.dt);
             }});
    if (entry_.direction(phase) < 0) continue;
    s.add({stage::contacts, entry_.name, touched(phase), [this, phase] { push(phase); }});
  }
}

/// First all records of surfaces, then what they give each other.
void BodyContact::schedule_surfaces(Schedule& s) {
  using enum Field;
  for (const std::size_t phase : {entry_.a, entry_.b}) {
    const std::string& name = layout_.phases[phase].name;
    s.add({stage::contacts,
           entry_.name + " surface of " + name,
           {{name, {position, velocity}, {}, {{}, {}, {Record::surface}}}},
           [this, phase] {
             skins_[phase == entry_.a ? 0 : 1].pack(w_->particles(phase), w_->to_write(phase, Record::surface));
           }});
  }
  const RecordTouch surface{{}, {Record::surface}, {}};
  for (const std::size_t phase : {entry_.a, entry_.b}) {
    Touches touches{{layout_.phases[phase].name, {}, {acceleration, contact_force}, surface},
                    {layout_.phases[entry_.partner(phase)].name, {}, {}, surface}};
    s.add({stage::contacts, entry_.name, touches, [this, phase] { push_surface(phase); }});
  }
}

void BodyContact::push_surface(std::size_t phase) {
  body_contact_forces(w_->particles(phase), w_->records(phase, Record::surface), w_->list(entry_.direction(phase)),
                      w_->records(entry_.partner(phase), Record::surface), *smooth_, w_->state.dt);
}

/// Whether a body of this entry is made of particles that nothing holds together.
bool BodyContact::of_single_particles() const {
  return std::any_of(layout_.phases.begin(), layout_.phases.end(), [&](const PlanPhase& p) {
    const auto k = static_cast<std::size_t>(&p - layout_.phases.data());
    if (!entry_.has(k) || !p.yields()) return false;
    return p.count == 1 || std::none_of(layout_.entries.begin(), layout_.entries.end(),
                                        [&](const PlanEntry& e) { return e.a == k && e.b == k; });
  });
}

void BodyContact::limits(std::vector<StepLimit>& limits) const {
  // The restitution of two particles needs a tenth; how bodies part is decided by their own waves.
  const bool single = of_single_particles();
  const double share = single ? StepConstants::restitution : StepConstants::body_contact;
  limits.push_back({itself() ? entry_.name : "contact " + entry_.name, scene_.time.safety * share * law_.time_scale(),
                    single ? "0.1 sqrt(m/K): keeps the restitution" : "0.35 sqrt(m/K): a contact of bodies"});
}

void BodyContact::push(std::size_t phase) {
  body_contact_forces(w_->particles(phase), w_->records(phase, Record::motion), w_->list(entry_.direction(phase)),
                      w_->records(entry_.partner(phase), Record::motion), law_, w_->state.dt);
  w_->share_field(phase, Field::acceleration);
  if (w_->particles(phase).has(Field::contact_force)) w_->share_field(phase, Field::contact_force);
}

void BodyContact::push_itself() {
  PhaseParticles& body = w_->particles(entry_.a);
  if (must_choose_) far_.choose(body, w_->list(list_), w_->neighbours.grid(entry_.a));
  must_choose_ = false;
  body_contact_forces(body, w_->records(entry_.a, Record::motion), far_, law_, w_->state.dt);
}

void BodyContact::push_from_sides(std::size_t phase) {
  const double half = 0.5 * layout_.phases[entry_.partner(phase)].spacing;
  for (const BodySide& side : sides_) body_side_forces(w_->particles(phase), side, half, law_, w_->state.dt);
}

}  // namespace barchan
