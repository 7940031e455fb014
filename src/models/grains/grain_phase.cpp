#include "models/grains/grain_phase.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "engine/integrate.hpp"
#include "models/grains/spheres.hpp"
#include "models/open_sides.hpp"
#include "output/numbers.hpp"
#include "scene/contact_words.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

PhaseRules rules_of(const PlanPhase& p, double spacing, bool fixed_step) {
  PhaseRules r;
  r.way = 0.25 * spacing;
  r.stops_at_sides = true;
  r.one = "grain";
  r.remedy = [key = "phases." + p.name + ".contact-speed", c = p.sound_speed, fixed_step](Fault fault, double speed,
                                                                                          double bound) {
    const std::string to = " (" + brief(c) + " m/s) to ";
    switch (fault) {
      case Fault::passed_wall: return "raise " + key;
      case Fault::too_fast:
        return "its contacts can stop (" + brief(bound) + " m/s): raise " + key + to + brief(2.0 * speed) + " or more";
      case Fault::too_far: return fixed_step ? "lower time.step" : "raise " + key + to + brief(speed) + " or more";
      default: return key;
    }
  };
  return r;
}

}  // namespace

namespace {

/// Of spheres: what their own contacts bear. Their way in a step needs no bound: what is slow enough for its contacts
/// goes an eighth of its radius at most in one of their steps.
/// `given`: the stiffness that the scene states; empty: it follows from the largest speed.
PhaseRules sphere_rules(const PlanPhase& p, double bound, const std::string& given) {
  PhaseRules r;
  r.way = 1e300;
  r.signal_speed = bound;
  r.stops_at_sides = true;
  r.one = "grain";
  r.remedy = [name = p.name, given](Fault fault, double speed, double most) {
    std::string key = "phases." + name + "." + sphere_stiffness_keys(" or .");
    switch (fault) {
      case Fault::passed_wall: return "raise " + (given.empty() ? "time.largest-speed, " + key : given);
      case Fault::too_fast:
        if (!given.empty()) return "its contacts can stop (" + brief(most) + " m/s): raise " + given;
        return "its contacts can stop (" + brief(most) + " m/s): raise time.largest-speed to " + brief(2.0 * speed) +
               ", or make the contacts of \"" + name + "\" stiffer";
      case Fault::too_far: return std::string("lower time.safety");
      default: return key;
    }
  };
  return r;
}

constexpr double soft = 1.0, stiff = 1e-4;  // diameters; above the first and below the second a scene is warned

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

/// Numbers beyond those of any material.
void warn_of_grains(const std::string& name, const GrainsKeys& keys, std::vector<std::string>& warnings) {
  constexpr double roughest = 1.5, least_spread = 1e-3;
  if (keys.friction > roughest)
    warnings.push_back("phases." + name + ".friction: " + brief(keys.friction) +
                       " is beyond all materials; between grains 0.1 to 0.9 are measured");
  if (const double spread = keys.diameter->spread; spread > 0.0 && spread < least_spread)
    warnings.push_back("phases." + name + ".diameter.spread: " + brief(spread) +
                       " is a share of the mean; where metres were meant, " + brief(spread / keys.diameter->mean));
}

/// Spheres: their fields, the speed of waves through their contacts (d sqrt(K/m), at the overlap of the largest speed),
/// and the speed at which two of them would overlap by half a diameter.
void describe_spheres(const Scene& scene, std::size_t number, Layout& layout, std::vector<std::string>& warnings) {
  using enum Field;
  PlanPhase& p = layout.phases[number];
  warn_of_grains(p.name, scene.phases[number].grains(), warnings);
  p.mass = scene.phases[number].density * std::numbers::pi / 6.0 * std::pow(p.diameter, 3) / layout.slab;
  p.physics = "spheres";
  p.smoothing_length = 0.5 * p.diameter;
  p.fields = {position, velocity, acceleration, contact_acceleration};
  if (p.largest_size > p.diameter) p.fields.push_back(radius);
  if (spheres_turn(scene, number)) p.fields.insert(p.fields.end(), {angular_velocity, angular_acceleration});
  const Phase& phase = scene.phases[number];
  const double mass = p.mass * layout.slab;
  double bound = 1e300;
  p.sound_speed = 1.0;
  each_sphere_law([&](auto row) {
    using Row = decltype(row);
    using Normal = typename Row::Law::Normal;
    if (!touches_by(scene, phase, Row::word)) return;
    const Normal spring = normal_spring<Row>(scene, layout, number);
    const SphereImpact impact = impact_of(layout, number, std::max(layout.largest_speed, 1e-3));
    const double overlap = spring.largest_overlap(impact);
    if (overlap > soft * p.diameter)
      warnings.push_back("phases." + p.name + "." + std::string(sphere_keys_of(Row::word)->stiffness) +
                         ": two grains that meet at " + number_text(impact.speed) +
                         " m/s, the largest speed of the scene, overlap by " + number_text(overlap / p.diameter) +
                         " diameters and pass through each other: raise it");
    if (overlap < stiff * p.diameter && Normal::of(scene.phases[number].grains()))
      warnings.push_back("phases." + p.name + "." + std::string(sphere_keys_of(Row::word)->stiffness) +
                         ": two grains that meet at " + number_text(impact.speed) +
                         " m/s, the largest speed of the scene, overlap by " + number_text(overlap / p.diameter) +
                         " diameters; 0.01 are small enough, and steps some " +
                         number_text(0.01 * p.diameter / overlap) + " times as long: lower it");
    bound = std::min(bound, impact.speed * std::pow(0.5 * p.diameter / overlap, Normal::speed_power));
    p.sound_speed = std::max(p.sound_speed, p.diameter * std::sqrt(spring.stiffness_at(impact.radius, overlap) / mass));
  });
  std::string given;
  for (const char* const key : {"stiffness", "young"})
    if (scene.places.contains("phases." + p.name + "." + key)) given = "phases." + p.name + "." + key;
  p.rules = sphere_rules(p, bound, given);
}

}  // namespace

void declare_grains(const Scene& scene, std::size_t number, Layout& layout) {
  PlanPhase& p = layout.phases[number];
  const Phase& phase = scene.phases[number];
  p.mover = phase.grains().diameter ? Mover::spheres : Mover::contacts;
  p.weight_share = weight_share(scene, phase);
  if (const std::optional<SphereSize>& size = phase.grains().diameter) {
    p.diameter = size->mean;
    p.largest_size = size->largest();
    p.sphere_records = true;
    p.open = open_sides_of_spheres(scene, number);
  }
}

void describe_grains(const Scene& scene, const std::vector<ParticleBlock>&, std::size_t number, Layout& layout,
                     std::vector<std::string>& warnings) {
  using enum Field;
  PlanPhase& p = layout.phases[number];
  p.surface.friction = Friction::grains;
  p.surface.roughness = scene.phases[number].grains().roughness.value_or(p.spacing / 30.0);
  if (p.own_steps()) return describe_spheres(scene, number, layout, warnings);
  p.physics = "grains";
  p.fields = {position, velocity, acceleration};
  // c^2 = 1000 g H: a bed as deep as the domain (H) is compressed by a thousandth at its bottom. At least 1 m/s. The
  // speed of the grains is not looked at: `contact-speed` is there for fast ones.
  double weight = 0;
  for (std::size_t d = 0; d < 3; ++d) weight += std::abs(scene.domain.gravity[d]) * scene.domain.size[d];
  p.sound_speed = scene.phases[number].grains().contact_speed.value_or(std::max(std::sqrt(1000.0 * weight), 1.0));
  p.rules = rules_of(p, p.spacing, scene.time.fixed_step.has_value());
}

GrainPhase::GrainPhase(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene),
      layout_(layout),
      plan_(layout.phases[number]),
      number_(number),
      forces_(scene, scene.phases[number].name) {}

void GrainPhase::schedule(Schedule& s) {
  using enum Field;
  if (!plan_.own_steps())  // else models/grains/spheres.hpp
    s.add({stage::kick_and_drift, plan_.name, {{plan_.name, {acceleration}, {position, velocity}}}, [this] {
             kick_and_drift();
           }});
  s.add({stage::weight, plan_.name, {{plan_.name, {position}, {acceleration}}}, [this] { weigh(); }});
}

void GrainPhase::limits(std::vector<StepLimit>& limits) const {
  if (plan_.count == 0 || plan_.own_steps()) return;
  limits.push_back({"contact " + plan_.name,
                    scene_.time.safety * (StepConstants::contact * plan_.spacing / plan_.sound_speed),
                    "0.1 sqrt(m/K): a contact lasts about thirty steps"});
}

void GrainPhase::kick_and_drift() {
  const double dt = w_->state.dt;
  barchan::kick_and_drift(w_->particles(number_), 0.5 * dt, dt, nullptr);
}

/// Begins the sum of accelerations.
void GrainPhase::weigh() {
  PhaseParticles& p = w_->particles(number_);
  for (int d = 0; d < layout_.dimensions; ++d)
    std::fill_n(p.column(Field::acceleration, d), p.size(),
                plan_.weight_share * scene_.domain.gravity[static_cast<std::size_t>(d)]);
  forces_.add(p, w_->state.time, true);
}

}  // namespace barchan
