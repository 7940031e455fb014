#include "models/force_meter.hpp"

#include <algorithm>
#include <cmath>

#include "engine/phase_sums.hpp"
#include "engine/reproducible_sum.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

const char* const axes[] = {"x", "y", "z"};

}  // namespace

namespace {

/// A wall goes on beyond sides through which a fluid flows: what is measured is the part beside the domain.
ForceMeter in_the_domain(ForceMeter meter, const Layout& layout) {
  const bool stays = std::any_of(layout.phases.begin(), layout.phases.end(),
                                 [&](const PlanPhase& p) { return p.name == meter.phase && !p.moves(); });
  if (!stays || meter.box || !layout.flows_through()) return meter;
  BoxShape box{{-1e300, -1e300, -1e300}, {1e300, 1e300, 1e300}};
  for (const PlanPhase& phase : layout.phases)
    for (const FlowEnd& end : phase.flow_ends) (end.upper() ? box.max : box.min)[end.axis()] = end.place;
  meter.box = box;
  return meter;
}

}  // namespace

ForceOn::ForceOn(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene),
      layout_(layout),
      meter_(in_the_domain(scene.force_meters[number], layout)),
      number_(number),
      set_(layout, meter_),
      stays_(!layout.phases[set_.phase()].moves()) {
  phase_ = set_.phase();
}

void ForceOn::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  set_.find(blocks);
  make_volume(state);
  make_border(blocks);
}

void ForceOn::attach(Workspace& w) {
  w_ = &w;
  set_.attach(w, "force." + std::to_string(number_));
  for (const auto& e : layout_.entries) {
    if (!stays_ || !e.has(phase_) || !(meter_.by.empty() || layout_.phases[e.partner(phase_)].name == meter_.by))
      continue;
    if (e.own_steps()) {
      pushes_.push_back(w.sphere_pushes.size());
      w.sphere_pushes.push_back({phase_, e.partner(phase_), meter_.about});
    }
    if (!e.extends || e.other != phase_) continue;
    w.need(e.fluid, Record::motion);
    fluids_.push_back({{&w.list(e.direction(phase_)), &w.records(e.fluid, Record::motion), e.kernel, e.radius,
                        viscosity_of_sums(scene_, layout_, e), false},
                       e.corrected ? 1.0 / e.consistency.gradient_sum : 1.0,
                       e.fluid,
                       Forces(scene_, layout_.phases[e.fluid].name)});
  }
  balance_ = !meter_.box && !fluids_.empty() && std::all_of(fluids_.begin(), fluids_.end(), [&](const Felt& felt) {
    return touches_nothing_else(felt.phase);
  });
  by_volume_ = !balance_ && volume_.there() && fluids_.size() == 1 && stands_alone(fluids_.front().phase);
  if (!by_volume_) volume_ = {};
  if (fluids_.empty()) border_ = {};
  if (border_.there()) w.particles(phase_).keep_places();
}

/// A control volume about a wall that stays, if it lies inside the domain and reaches no other wall.
void ForceOn::make_volume(const State& state) {
  if (!stays_ || layout_.phases[phase_].travels() || scene_.force_meters[number_].box || !pushes_.empty()) return;
  volume_ = ControlVolume(state.phases[phase_], layout_.phases[phase_].spacing, layout_);
  for (std::size_t other = 0; other < state.phases.size() && volume_.there(); ++other) {
    const PhaseParticles& p = state.phases[other];
    if (other == phase_ || layout_.phases[other].flows()) continue;
    for (std::size_t k = 0; k < p.size(); ++k) {
      Vec3 x{};
      for (int d = 0; d < layout_.dimensions; ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
      if (layout_.phases[other].moves() || volume_.near(x)) {
        volume_ = {};
        break;
      }
    }
  }
}

/// Beside an elastic body at whose border a fluid ends.
void ForceOn::make_border(const std::vector<ParticleBlock>& blocks) {
  if (!stays_ || layout_.phases[phase_].travels() || scene_.force_meters[number_].box || volume_.there()) return;
  const PlanEntry* only = nullptr;
  for (const PlanEntry& e : layout_.entries) {
    if (!e.extends || e.other != phase_) continue;
    if (only || !e.corrected || layout_.phases[e.fluid].eddies) return;
    only = &e;
  }
  if (only && bends_a_body(only->fluid)) border_ = WallBorder(scene_, layout_, *only, blocks[phase_]);
}

/// Whether the fluid ends at the border of an elastic body.
bool ForceOn::bends_a_body(std::size_t fluid) const {
  return std::any_of(layout_.entries.begin(), layout_.entries.end(), [&](const PlanEntry& e) {
    return e.extends && e.fluid == fluid && ends_at_border(scene_, scene_.phases[e.other]);
  });
}

/// The fluid is laminar, consistent, without a free surface, free of a [[forcing]], and touches nothing that could come
/// into the volume.
bool ForceOn::stands_alone(std::size_t number) const {
  const PlanPhase& fluid = layout_.phases[number];
  const bool forced = std::any_of(scene_.forcings.begin(), scene_.forcings.end(),
                                  [&](const Forcing& f) { return f.phase == fluid.name; });
  return scene_.phases[number].fluid().scheme == FluidScheme::consistent && !fluid.eddies && !fluid.free_surface &&
         !forced && std::all_of(layout_.entries.begin(), layout_.entries.end(), [&](const PlanEntry& e) {
           if (!e.has(number) || e.partner(number) == number) return true;
           const PlanPhase& other = layout_.phases[e.partner(number)];
           return !other.flows() && !other.moves() && !other.travels();
         });
}

/// A fluid of the consistent scheme whose entries are those with itself and with this wall.
bool ForceOn::touches_nothing_else(std::size_t fluid) const {
  return scene_.phases[fluid].fluid().scheme == FluidScheme::consistent &&
         std::all_of(layout_.entries.begin(), layout_.entries.end(), [&](const PlanEntry& e) {
           return !e.has(fluid) || e.partner(fluid) == fluid || e.partner(fluid) == phase_;
         });
}

void ForceOn::schedule(Schedule& s) {
  using enum Field;
  const FieldSet reads = FieldSet{position, velocity, acceleration};
  const FieldSet by_volume{position, velocity, acceleration, density, pressure, wholeness};
  const FieldSet writes = stays_ ? FieldSet{acceleration} : FieldSet{};
  const std::string& name = layout_.phases[phase_].name;
  Touches touches{{name, reads, writes, {stays_ ? RecordSet{Record::extended} : RecordSet{}, {}, {}}}};
  for (const auto& e : layout_.entries)  // fluids, where it takes what the wall gives from their momentum
    if (stays_ && e.extends && e.other == phase_)
      touches.push_back({layout_.phases[e.fluid].name,
                         stands_alone(e.fluid) || bends_a_body(e.fluid) ? by_volume : reads,
                         {},
                         {{}, {Record::motion}, {}}});
  s.add({stays_ ? stage::reaction : stage::motion, name + ", force", touches, [this] { measure(); }});
}

void ForceOn::measure() {
  force_ = torque_ = {};
  stays_ ? measure_wall() : add_sums(1.0, scene_.domain.gravity);
  sum_up();
}

/// The impulse of the step. Before the first step there is none.
void ForceOn::sum_up() {
  if (w_->state.steps == 0) {
    smooth_ = force_;
    mean_force_.start(force_);
    return mean_torque_.start(torque_);
  }
  const double dt = w_->state.dt;
  Vec3 push{}, turn{};  // N s, N m s, of spheres
  for (const std::size_t k : pushes_) {
    push = push + 1.0 / layout_.slab * w_->sphere_pushes[k].impulse;
    turn = turn + 1.0 / layout_.slab * w_->sphere_pushes[k].turn;
  }
  impulse_ = impulse_ + 0.5 * dt * (smooth_ + force_) + push;
  smooth_ = force_;
  mean_force_.add(force_, dt, push);
  mean_torque_.add(torque_, dt, turn);
}

/// By fluids.
void ForceOn::measure_wall() {
  PhaseParticles& wall = w_->particles(phase_);
  for (const Felt& felt : fluids_) {
    for (int d = 0; d < layout_.dimensions; ++d) std::fill_n(wall.column(Field::acceleration, d), wall.size(), 0.0);
    fluid_reaction(wall, w_->records(phase_, Record::extended), felt.fluid, false);
    add_sums(felt.share, {0, 0, 0});
  }
  if (by_volume_) return measure_volume();
  if (border_.there()) {
    const WallBorder::Load load = border_.load(*w_, meter_.about);
    force_ = load.force;
    torque_ = load.torque;
    return;
  }
  if (!balance_) return;
  force_ = {};
  for (const Felt& felt : fluids_) {
    const PhaseParticles& fluid = w_->particles(felt.phase);
    const Vec3 given = felt.forces.sum(fluid, w_->state.time, w_->state.dt);
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
      const double* a = fluid.column(Field::acceleration, static_cast<int>(d));
      const double weight = scene_.domain.gravity[d];
      force_[d] -=
          fluid.mass() * (reproducible_sum(fluid.size(), [&](std::size_t k) { return a[k] - weight; }) - given[d]);
    }
  }
}

/// By what the fluid in the control volume loses.
void ForceOn::measure_volume() {
  const Felt& felt = fluids_.front();
  const PhaseParticles& fluid = w_->particles(felt.phase);
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  shares_.clear();
  for (std::size_t k = 0; k < fluid.size(); ++k) {
    const auto at = [&](Field field) {
      Vec3 value{};
      for (std::size_t d = 0; d < dimensions; ++d) value[d] = fluid.column(field, static_cast<int>(d))[k];
      return value;
    };
    const Vec3 x = at(Field::position);
    if (!volume_.near(x)) continue;
    shares_.push_back(volume_.share(x, at(Field::velocity), at(Field::acceleration) - scene_.domain.gravity,
                                    fluid.mass(), fluid.column(Field::density)[k], fluid.column(Field::pressure)[k],
                                    pair_viscosity(scene_, layout_, phase_, felt.phase)));
  }
  force_ = ControlVolume::force(shares_);
}

/// Adds `share` of mass times (acceleration - less), and its moment.
void ForceOn::add_sums(double share, const Vec3& less) {
  const PhaseParticles& p = set_.particles();
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  std::array<const double*, 3> x{}, a{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    x[d] = p.column(Field::position, static_cast<int>(d));
    a[d] = p.column(Field::acceleration, static_cast<int>(d));
  }
  const double mass = share * p.mass();
  const auto push = [&](std::size_t d, std::size_t k) { return d < dimensions ? a[d][k] - less[d] : 0.0; };
  const auto lever = [&](std::size_t d, std::size_t k) {
    if (d >= dimensions) return 0.0;
    double r = x[d][k] - meter_.about[d];
    if (const double size = layout_.bounds.high[d] - layout_.bounds.low[d]; layout_.bounds.periodic[d])
      r -= size * std::round(r / size);
    return r;
  };
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
    force_[d] += mass * sum_of(p, set_.size(), [&](std::size_t q) { return push(d, set_.place(q)); });
    torque_[d] += mass * sum_of(p, set_.size(), [&](std::size_t q) {
                    const std::size_t k = set_.place(q);
                    return lever(e, k) * push(f, k) - lever(f, k) * push(e, k);
                  });
  }
}

void ForceOn::history(HistoryRow& row) const {
  const Vec3 force = mean_force_.value(), torque = mean_torque_.value();
  for (std::size_t d = 0; d < 3 && d < static_cast<std::size_t>(layout_.dimensions); ++d)
    row.add(meter_.name + "_force_" + axes[d] + " [N]", force[d]);
  for (std::size_t d = layout_.dimensions == 2 ? 2 : 0; d < 3; ++d)
    row.add(meter_.name + "_torque_" + axes[d] + " [N m]", torque[d]);
  for (std::size_t d = 0; d < 3 && d < static_cast<std::size_t>(layout_.dimensions); ++d)
    row.add(meter_.name + "_impulse_" + axes[d] + " [N s]", impulse_[d]);
}

void ForceOn::begin_row() {
  mean_force_.begin_row();
  mean_torque_.begin_row();
}

void ForceOn::archive(Archive& a) {
  mean_force_.archive(a, "force on " + meter_.name);
  mean_torque_.archive(a, "torque on " + meter_.name);
  a.number("impulse on " + meter_.name, impulse_);
  a.number("force on " + meter_.name + " without spheres", smooth_);
}

}  // namespace barchan
