#include "models/bodies/sets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/errors.hpp"
#include "engine/phase_sums.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

const char* const axes[] = {"x", "y", "z"};

bool in_set(const BodySet& set, const Vec3& x, double slack, int dimensions) {
  bool inside = true;
  for (std::size_t d = 0; set.box && d < static_cast<std::size_t>(dimensions); ++d)
    inside = inside && x[d] >= set.box->min[d] - slack && x[d] <= set.box->max[d] + slack;
  return inside;
}

}  // namespace

void refuse_shared_motions(const Scene& scene, std::size_t phase, const std::vector<Vec3>& places) {
  const Phase& body = scene.phases[phase];
  std::vector<std::size_t> motions;
  for (std::size_t k = 0; k < scene.motions.size(); ++k)
    if (scene.motions[k].phase == body.name) motions.push_back(k);
  if (motions.size() < 2) return;
  for (const Vec3& x : places) {
    std::optional<std::size_t> first;
    for (const std::size_t k : motions) {
      if (!in_set(scene.motions[k], x, 1e-6 * body.spacing, scene.dimensions)) continue;
      if (first)
        throw SceneError(located(scene, "motion." + std::to_string(k)) + ": moves particles of \"" + body.name +
                         "\" that motion." + std::to_string(*first) + " moves too; expected sets apart, or one motion");
      first = k;
    }
  }
}

SetOfBody::SetOfBody(const Layout& layout, const BodySet& set) : layout_(layout), set_(set) {
  for (std::size_t k = 0; k < layout.phases.size(); ++k)
    if (layout.phases[k].name == set.phase) phase_ = k;
}

void SetOfBody::find(const std::vector<ParticleBlock>& blocks) {
  const std::vector<Vec3>& places = blocks[phase_].position;
  const double slack = 1e-6 * layout_.phases[phase_].spacing;
  ids_.clear();
  for (std::size_t k = 0; k < places.size(); ++k)
    if (in_set(set_, places[k], slack, layout_.dimensions)) ids_.push_back(static_cast<std::uint32_t>(k));
}

void SetOfBody::attach(Workspace& w, const std::string& section) {
  w_ = &w;
  if (ids_.empty())
    throw SceneError(located(w.scene, section) + ": no particle of phase \"" + set_.phase +
                     "\" stands in the box at the start; expected a box that holds some");
  particles().keep_places();
  here_.reserve(ids_.size());
}

const std::vector<std::uint32_t>& SetOfBody::here() const {
  const PhaseParticles& p = particles();
  if (arrangement_ == p.arrangements()) return here_;
  arrangement_ = p.arrangements();
  here_.clear();
  for (const std::uint32_t id : ids_)
    if (const std::uint32_t place = p.places()[id]; place != PhaseParticles::elsewhere) here_.push_back(place);
  return here_;
}

DrivenSet::DrivenSet(const Scene& scene, const Layout& layout, std::size_t number)
    : layout_(layout),
      number_(number),
      set_(layout, scene.motions[number]),
      velocity_(compile(scene.motions[number].velocity)) {}

void DrivenSet::begin(State&, const std::vector<ParticleBlock>& blocks) { set_.find(blocks); }

void DrivenSet::attach(Workspace& w) {
  w_ = &w;
  set_.attach(w, "motion." + std::to_string(number_));
  set_velocity(w.state.time);
}

void DrivenSet::schedule(Schedule& s) {
  using enum Field;
  const std::string& name = layout_.phases[set_.phase()].name;
  s.add({stage::kick_and_drift, name + ", motion", {{name, {}, {velocity, acceleration}}}, [this] { lead(); }});
  s.add({stage::motion, name, {{name, {}, {velocity, acceleration}}}, [this] { hold(); }});
}

Vec3 DrivenSet::velocity_at(double time) const {
  Vec3 v{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) v[d] = velocity_[d]({0, 0, 0}, time);
  return v;
}

void DrivenSet::set_velocity(double time) {
  PhaseParticles& p = set_.particles();
  const Vec3 velocity = velocity_at(time);
  for (int d = 0; d < layout_.dimensions; ++d) {
    const double speed = velocity[static_cast<std::size_t>(d)];
    double *v = p.column(Field::velocity, d), *a = p.column(Field::acceleration, d);
    for (std::size_t q = 0; q < set_.size(); ++q) {
      const std::uint32_t k = set_.place(q);
      v[k] = speed;
      a[k] = 0.0;
    }
  }
}

/// The velocity in the middle of the step carries the set through it.
void DrivenSet::lead() { set_velocity(w_->state.time + 0.5 * w_->state.dt); }

/// The forces of the step are known: they are noted, and the set goes on as it is driven.
void DrivenSet::hold() {
  const PhaseParticles& p = set_.particles();
  Vec3 force{};
  for (int d = 0; d < layout_.dimensions; ++d) {
    const double* a = p.column(Field::acceleration, d);
    force[static_cast<std::size_t>(d)] =
        p.mass() * sum_of(p, set_.size(), [&](std::size_t q) { return a[set_.place(q)]; });
  }
  const double power = dot(force, velocity_at(w_->state.time));
  if (w_->state.steps == 0) {
    force_.start(force);
  } else {
    force_.add(force, w_->state.dt);
    taken_ += 0.5 * w_->state.dt * (power_ + power);
  }
  power_ = power;
  set_velocity(w_->state.time);
}

void DrivenSet::history(HistoryRow& row) const {
  const Vec3 force = force_.value();
  for (int d = 0; d < std::min(layout_.dimensions, 3); ++d)
    row.add("motion_" + std::to_string(number_) + "_force_" + axes[d] + " [N]", force[static_cast<std::size_t>(d)]);
}

/// The drive gives the set what its motion gains, less what the rest of the body and the weight give it.
double DrivenSet::budget_energy() {
  const Vec3 now = velocity_at(w_->state.time), start = velocity_at(0.0);
  const double mass = set_.particles().mass() * static_cast<double>(set_.count());
  return taken_ - 0.5 * mass * (dot(now, now) - dot(start, start));
}

void DrivenSet::archive(Archive& a) {
  force_.archive(a, "force on a driven set");
  a.number("power of that force", power_);
  a.number("work of that force", taken_);
}

MarkedSet::MarkedSet(const Scene& scene, const Layout& layout, std::size_t number)
    : layout_(layout), marker_(scene.markers[number]), number_(number), set_(layout, scene.markers[number]) {}

void MarkedSet::begin(State&, const std::vector<ParticleBlock>& blocks) { set_.find(blocks); }

void MarkedSet::attach(Workspace& w) { set_.attach(w, "marker." + std::to_string(number_)); }

namespace {

/// Mean of `n` places along a periodic axis (m) of which some may stand on the other end of the domain, `whole`: all
/// of these as they are. The circular mean is their middle (Mardia & Jupp 2000, section 2.2), about which each has its
/// nearest image; the mean of those is an image of the true one. The image is the one next to `whole`, so that a body
/// that goes round the domain goes on; it changes where 0.618 of the places changed sides, of which no number of them
/// can be exactly.
template <class Place>
double periodic_mean(const PhaseParticles& p, std::size_t size, double n, double period, double whole,
                     const Place& place) {
  const double turn = 2.0 * std::numbers::pi / period;
  const double c = sum_of(p, size, [&](std::size_t q) { return std::cos(turn * place(q)); }),
               s = sum_of(p, size, [&](std::size_t q) { return std::sin(turn * place(q)); });
  if (!(std::hypot(c, s) > 1e-3 * n)) return whole;  // it goes all the way round
  const double middle = std::atan2(s, c) / turn;
  const double off = sum_of(p, size, [&](std::size_t q) {
    const double way = place(q) - middle;
    return way - period * std::round(way / period);
  });
  const double mean = middle + off / n,
               image = mean + period * std::floor((whole - mean) / period + 0.3819660112501051);
  return std::abs(image - whole) < 1e-9 * period ? whole : image;
}

}  // namespace

void MarkedSet::history(HistoryRow& row) const {
  const PhaseParticles& p = set_.particles();
  const auto n = static_cast<double>(set_.count());
  for (int d = 0; d < std::min(layout_.dimensions, 3); ++d) {
    const auto axis = static_cast<std::size_t>(d);
    const double* x = p.column(Field::position, d);
    const auto place = [&](std::size_t q) { return x[set_.place(q)]; };
    const double whole = sum_of(p, set_.size(), place) / n;
    const double period = layout_.bounds.high[axis] - layout_.bounds.low[axis];
    row.add(marker_.name + "_" + axes[d] + " [m]",
            layout_.bounds.periodic[axis] ? periodic_mean(p, set_.size(), n, period, whole, place) : whole);
  }
}

}  // namespace barchan
