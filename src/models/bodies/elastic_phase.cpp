#include "models/bodies/elastic_phase.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/errors.hpp"
#include "engine/integrate.hpp"
#include "engine/phase_sums.hpp"
#include "kernels/kernel.hpp"
#include "models/bodies/angular_momentum.hpp"
#include "models/bodies/body_forces.hpp"
#include "models/bodies/sets.hpp"
#include "models/bodies/stress_fields.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

/// Von Mises and principal stresses.
void write_from_stress(PhaseParticles& p) {
  const SolidFields fields(p);
  for (std::size_t k = 0; k < p.size(); ++k) fields.write_from_stress(k);
}

double compression_speed(const ElasticKeys& p, double density) {
  const double lame = p.young * p.poisson / ((1 + p.poisson) * (1 - 2 * p.poisson));
  const double shear = p.young / (2 * (1 + p.poisson));
  return std::sqrt((lame + 2 * shear) / density);
}

PhaseRules elastic_rules(const PlanPhase& p, bool can_turn, const std::string& step_key) {
  PhaseRules r;
  r.way = 0.5 * p.spacing;
  r.signal_speed = p.sound_speed;
  r.idle = 0.01;
  r.stops_at_sides = true;
  r.one = "particle of a body";
  r.remedy = [key = "phases." + p.name + ".", c = p.sound_speed, can_turn, step_key](Fault fault, double, double) {
    switch (fault) {
      case Fault::not_finite: return key + "artificial-viscosity";
      case Fault::passed_wall: return "raise " + key + "young, lower its speed, or lower " + step_key;
      case Fault::density:
        return "is impossible; the body was torn or pressed into nothing: lower " + step_key + ", or raise " + key +
               "artificial-viscosity";
      case Fault::too_fast:
        return "compression waves of its body (" + brief(c) + " m/s), so that no contact can stop it: raise " + key +
               "young, or lower its speed";
      case Fault::too_far: return "lower " + step_key;
      case Fault::too_near:
        return key + "young" + (can_turn ? "" : ", or let it turn: " + key + "formulation = \"total-lagrangian\"");
    }
    return std::string();
  };
  return r;
}

}  // namespace

/// An updated Lagrangian body cannot turn: at its border the velocity gradient, whose sums are not corrected, sees
/// strain in a rotation. A free square of 10 particles a side springs back after 13 degrees. Throws SceneError where a
/// fill begins with a spin that turns it by more than a hundredth of that way until the end.
void refuse_turning(const Scene& scene, const ParticleBlock& block) {
  constexpr double most = 0.02;  // rad
  for (std::size_t part = 0; part < block.parts.size(); ++part) {
    const std::size_t first = block.parts[part].first,
                      last = part + 1 < block.parts.size() ? block.parts[part + 1].first : block.position.size();
    if (last < first + 4) continue;
    const double share = 1.0 / static_cast<double>(last - first);
    Vec3 centre{}, velocity{}, momentum{};
    for (std::size_t k = first; k < last; ++k) {
      centre = centre + share * block.position[k];
      velocity = velocity + share * block.velocity[k];
    }
    double inertia = 0.0;  // about an axis through the centre, at most
    for (std::size_t k = first; k < last; ++k) {
      const Vec3 r = block.position[k] - centre;
      momentum = momentum + cross(r, block.velocity[k] - velocity);
      inertia += dot(r, r);
    }
    const double angle = inertia > 0.0 ? norm(momentum) / inertia * scene.time.end : 0.0;
    if (!(angle > most)) continue;
    throw SceneError(located(scene, "fill." + std::to_string(block.parts[part].fill) + ".velocity") +
                     ": the body turns, by " + brief(angle) +
                     " rad until the end, and an updated Lagrangian body cannot turn; expected formulation = "
                     "\"total-lagrangian\", or a velocity without rotation");
  }
}

void declare_elastic(const Scene&, std::size_t number, Layout& layout) { layout.phases[number].mover = Mover::elastic; }

void describe_elastic(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                      std::vector<std::string>&) {
  using enum Field;
  const Phase& phase = scene.phases[number];
  if (number < blocks.size()) {
    refuse_shared_motions(scene, number, blocks[number].position);
    if (!is_total(phase)) refuse_turning(scene, blocks[number]);
  }
  PlanPhase& p = layout.phases[number];
  const bool total = is_total(phase);
  if (!total) p.physics = "elastic";
  p.fields = {position, velocity, density, pressure, acceleration};
  if (!total || is_output(scene, stress)) p.fields.push_back(stress);
  if (!total && phase.elastic().energy) p.fields.insert(p.fields.end(), {energy, energy_rate});
  if (total) {  // TotalPhase::derive
    for (const Field field : {von_mises_stress, principal_stress, strain})
      if (is_output(scene, field)) p.fields.push_back(field);
  } else {
    p.derive_for_output(scene, {von_mises_stress, principal_stress}, write_from_stress);
  }
  if (is_output(scene, contact_force) && touches_as_body(scene, phase)) p.fields.push_back(contact_force);
  p.sound_speed = compression_speed(phase.elastic(), phase.density);
  p.rules = elastic_rules(p, total, scene.time.fixed_step ? "time.step" : "time.safety");
}

void describe_elastic_pairs(const Scene& scene, const Interaction& pair, const Layout&, PlanEntry& e) {
  e.law = "elastic";
  e.reads_stress = e.keeps_apart = true;
  describe_approximation(pair, scene.dimensions, "", e);
  if (e.a != e.b && !e.consistency.consistent()) e.meaning = "a contact law, not an approximation";
}

ElasticPhase::ElasticPhase(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene),
      layout_(layout),
      phase_(scene.phases[number]),
      plan_(layout.phases[number]),
      number_(number),
      forces_(scene, phase_.name) {
  const bool touches = std::any_of(layout.entries.begin(), layout.entries.end(),
                                   [&](const PlanEntry& e) { return e.self_contact && e.a == number; });
  for (const auto& e : layout.entries)
    if (touches && e.reads_stress && e.a == number && e.b == number) own_ = &e;
}

void ElasticPhase::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  PhaseParticles& p = state.phases[number_];
  std::fill_n(p.column(Field::density), p.size(), phase_.density);
  if (own_) held_ = FarPairs(blocks[number_].position, layout_.bounds, plan_.spacing, own_->radius);
}

void ElasticPhase::archive(Archive& a) {
  if (a.loads()) must_choose_ = true;
}

void ElasticPhase::choose_held() {
  if (!own_ || !must_choose_) return;
  held_.choose_near(w_->particles(number_), w_->list(own_->forward), w_->neighbours.grid(number_));
  must_choose_ = false;
}

void ElasticPhase::attach(Workspace& w) {
  w_ = &w;
  const ElasticKeys& keys = phase_.elastic();
  const double shear = keys.young / (2.0 * (1.0 + keys.poisson));
  const double bulk = keys.young / (3.0 * (1.0 - 2.0 * keys.poisson));
  parameters_ = {phase_.density,
                 shear,
                 bulk,
                 keys.artificial_viscosity,
                 keys.artificial_viscosity_beta,
                 std::sqrt(bulk / phase_.density),
                 scene_.domain.gravity};
  w.need(number_, Record::stress);
  const bool pulled = has_artificial_stress(scene_);
  if (pulled) w.need(number_, Record::artificial);
  for (const auto& e : layout_.entries) {
    if (!e.has(number_) || !e.reads_stress) continue;
    const std::size_t other = e.partner(number_);
    const double dx = 0.5 * (plan_.spacing + layout_.phases[other].spacing);
    const double weight = with_kernel<double>(e.kernel, e.radius, layout_.dimensions,
                                              [&](const auto& kernel) { return kernel.value(dx); });
    neighbours_.push_back({&w.list(e.direction(number_)), &w.records(other, Record::stress), e.kernel, e.radius,
                           layout_.phases[other].mass, pulled ? &w.records(other, Record::artificial) : nullptr,
                           weight > 0.0 ? 1.0 / weight : 0.0, &e == own_ ? &held_ : nullptr});
  }
  if (own_) w.when_sorted.emplace_back([this] { must_choose_ = true; });
}

void ElasticPhase::schedule(Schedule& s) {
  using enum Field;
  const FieldSet all{position, velocity, density, pressure, acceleration, Field::stress};
  const bool heats = phase_.elastic().energy;
  FieldSet moved{position, velocity}, loaded{acceleration, contact_force};
  if (heats) moved = moved | FieldSet{energy}, loaded = loaded | FieldSet{energy_rate};
  const auto own = [this](const FieldSet& reads, const FieldSet& writes) -> Touches {
    return {{plan_.name, reads, writes}};
  };
  s.add({stage::kick_and_drift, plan_.name, own({acceleration, energy_rate}, moved), [this] { kick_and_drift(); }});
  Touches middle = own({position, velocity, density, pressure, Field::stress}, {}), strained = own(all, all),
          pushed = own(all, loaded);
  middle.front().records.writes = {Record::stress};
  strained.front().records.ghosts = {Record::stress};
  pushed.front().records.ghosts = {Record::stress, Record::artificial};
  for (const auto& e : layout_.entries) {
    if (!e.has(number_) || !e.reads_stress || e.partner(number_) == number_) continue;
    const std::string& other = layout_.phases[e.partner(number_)].name;
    strained.push_back({other, {}, {}, strained.front().records});
    pushed.push_back({other, {}, {}, pushed.front().records});
  }
  s.add({stage::strain_records, plan_.name, middle, [this] { pack_middle(); }});
  s.add({stage::strain, plan_.name, strained, [this] { this->strain(); }});
  s.add({stage::elastic, plan_.name, pushed, [this] { load(); }});
  if (!heats) return;
  s.add({stage::energy, plan_.name, own({acceleration}, {energy_rate}), [this] { take_power(); }});
  s.add({stage::kick, plan_.name, own({energy_rate}, {energy}),
         [this] { advance_energy(w_->particles(number_), w_->kick_time); }});
}

void ElasticPhase::limits(std::vector<StepLimit>& limits) const {
  if (plan_.count == 0) return;
  double smallest = plan_.smoothing_length;
  for (const auto& e : layout_.entries)
    if (e.reads_stress && e.has(number_)) smallest = std::min(smallest, 0.5 * e.radius);
  limits.push_back({"elastic " + plan_.name,
                    scene_.time.safety * (StepConstants::elastic * smallest / plan_.sound_speed),
                    "0.25 h/c_P: compression waves"});
}

/// Bodies stop half-way: their strain is taken there.
void ElasticPhase::kick_and_drift() {
  const double half = 0.5 * w_->state.dt;
  barchan::kick_and_drift(w_->particles(number_), half, half, nullptr);
  if (phase_.elastic().energy) advance_energy(w_->particles(number_), half);
}

void ElasticPhase::pack_middle() { pack_stress(w_->particles(number_), w_->to_write(number_, Record::stress)); }

void ElasticPhase::strain() {
  PhaseParticles& p = w_->particles(number_);
  choose_held();
  elastic_strain(p, w_->records(number_, Record::stress), neighbours_, parameters_, w_->state.dt);
  drift(p, 0.5 * w_->state.dt);
}

void ElasticPhase::load() {
  PhaseParticles& p = w_->particles(number_);
  choose_held();
  const RecordArray& artificial = w_->records(number_, Record::artificial);
  elastic_forces(p, w_->records(number_, Record::stress), neighbours_, parameters_,
                 artificial.stride() > 0 ? &artificial : nullptr);
  if (phase_.elastic().energy)
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
      const double* a = std::as_const(p).column(Field::acceleration, static_cast<int>(d));
      pairs_[d].resize(p.size());
      for (std::size_t k = 0; k < p.size(); ++k) pairs_[d][k] = a[k] - parameters_.gravity[d];
    }
  clear_contact_forces(p);
  forces_.add(p, w_->state.time, true);
}

/// The forces of pairs were computed with velocities half a step old; their power is that with the velocities of now.
/// Half of f_ab . (a_a - a_b) dt/2 at each of a pair is in sum f_a . a_a dt/2 at a.
void ElasticPhase::take_power() {
  PhaseParticles& p = w_->particles(number_);
  double* rate = p.column(Field::energy_rate);
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    const double* a = std::as_const(p).column(Field::acceleration, static_cast<int>(d));
    for (std::size_t k = 0; k < p.size(); ++k) rate[k] -= w_->kick_time * a[k] * pairs_[d][k];
  }
}

/// That of the present stress: of the density (K/rho0)(ln(rho/rho0) + rho0/rho - 1) a kilogram, whose pressure is
/// p = (K/rho0)(rho - rho0), and s:s/(4 G) a cubic metre of the deviator.
double ElasticPhase::strain_energy() const {
  const PhaseParticles& p = w_->particles(number_);
  const double* rho = p.column(Field::density);
  std::array<const double*, 6> s{};
  for (int c = 0; c < 6; ++c) s[static_cast<std::size_t>(c)] = p.column(Field::stress, c);
  const double bulk = parameters_.bulk_modulus / parameters_.reference_density, shear = 4.0 * parameters_.shear_modulus;
  return p.mass() * sum_of(p, [&](std::size_t k) {
           const double x = rho[k] / parameters_.reference_density - 1.0;
           double squares = 0.0;
           for (std::size_t c = 0; c < 6; ++c) squares += (c < 3 ? 1.0 : 2.0) * s[c][k] * s[c][k];
           return bulk * (std::log1p(x) - x / (1.0 + x)) + squares / (shear * rho[k]);
         });
}

void ElasticPhase::history(HistoryRow& row) const {
  row.add(plan_.name + "_strain_energy [J]", strain_energy());
  add_angular_momentum(row, w_->particles(number_), layout_);
  if (!phase_.elastic().energy) return;
  const PhaseParticles& p = w_->particles(number_);
  const double* e = p.column(Field::energy);
  row.add(plan_.name + "_internal_energy [J]", p.mass() * sum_of(p, [&](std::size_t k) { return e[k]; }));
}

}  // namespace barchan
