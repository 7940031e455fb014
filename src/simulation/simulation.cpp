#include "simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "base/errors.hpp"
#include "engine/rank_load.hpp"
#include "models/catalogue.hpp"
#include "models/walls/wall.hpp"
#include "output/numbers.hpp"
#include "scene/controls.hpp"
#include "scene/formula.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

Models joined(Models models, Models more) {
  for (auto& model : more) models.push_back(std::move(model));
  return models;
}

}  // namespace

Simulation::Simulation(const Scene& scene, const Plan& plan, std::vector<ParticleBlock> blocks, Storage storage,
                       Models more)
    : scene_(scene),
      plan_(plan),
      flows_through_(plan.flows_through()),
      models_(joined(make_models(scene_, plan_), std::move(more))),
      schedule_(make_schedule(models_)) {
  forget_formula_fault();  // those of shapes may have no number somewhere
  make_state(blocks);
  blocks = {};
  if (storage == Storage::shuffled) shuffle();
  work_ = std::make_unique<Workspace>(scene_, plan_, state_);
  for (const auto& model : models_) model->attach(*work_);
  for (const auto& l : plan_.limits) state_.limit_counts[l.name] = 0;
  for (const char* name : {"force", "output", "fixed", "retreat"}) state_.limit_counts[name] = 0;
  state_.dt = plan_.step();
  std::vector<std::string> names;
  for (const auto& p : plan_.phases) names.push_back(p.name);
  schedule_.use(*work_, names);
  schedule_.run(stage::walls, stage::energy);
  work_->must_search = true;
  schedule_.run(stage::walls, stage::energy);  // the weights of the consistent Laplacian are those of the pass before
  for (const auto& model : models_)
    if (const StepLimit* l = model->moving_limit()) state_.limit_counts[l->name] = 0;
  std::size_t longest = 0;
  for (const auto& [name, steps] : state_.limit_counts) longest = std::max(longest, name.size());
  state_.ruling_limit.reserve(longest);  // so that no step allocates for a name
  watch_ = std::make_unique<Watch>(Watch::Sight{scene_, plan_, state_.phases, work_->neighbours, *work_});
  budget_.emplace(scene_, plan_, state_);
  Touches seen;
  for (const auto& p : plan_.phases) seen.push_back({p.name, FieldSet(p.fields), {}});
  for (const auto& e : plan_.entries)
    if (e.keeps_apart) seen[e.a].records.ghosts = seen[e.b].records.ghosts = {Record::motion, Record::stress};
  schedule_.add({stage::watch, "all", seen, [this] { watch_->look(moment()); }});
  schedule_.use(*work_, names);
  schedule_.run(stage::kick,
                stage::kick);  // moves nothing; finds the largest acceleration, which limits the first step
}

Simulation::~Simulation() = default;

void Simulation::make_state(const std::vector<ParticleBlock>& blocks) {
  std::int64_t first = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const PlanPhase& q = plan_.phases[k];
    PhaseParticles p(q.name, plan_.dimensions, blocks[k].position.size(), q.mass, first);
    if (blocks[k].piece) p.be_piece(blocks[k].first());
    first += static_cast<std::int64_t>(q.count);
    for (const Field f : q.fields) p.add(f);
    for (int d = 0; d < plan_.dimensions; ++d)
      for (std::size_t i = 0; i < p.size(); ++i) {
        p.column(Field::position, d)[i] = blocks[k].position[i][static_cast<std::size_t>(d)];
        p.column(Field::velocity, d)[i] = blocks[k].velocity[i][static_cast<std::size_t>(d)];
      }
    state_.phases.push_back(std::move(p));
  }
  state_.ids.next = first;
  for (const auto& model : models_) model->begin(state_, blocks);
  face_walls(plan_, state_);
}

/// Puts the particles of every phase into an order without meaning, the same in every run.
void Simulation::shuffle() {
  for (PhaseParticles& p : state_.phases) {
    std::vector<std::uint32_t> order(p.size());
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), std::mt19937(20261124));
    p.permute(order.data());
  }
}

void Simulation::step(double largest) {
  RankLoad& load = work_->neighbours.load();
  load.begin_step();
  choose_step(largest);
  schedule_.run(stage::kick_and_drift, stage::grain_contacts);
  state_.time += state_.dt;
  ++state_.steps;
  work_->kick_time = 0.5 * state_.dt;
  schedule_.run(stage::strain_records, stage::kick);
  if (!std::isfinite(state_.largest_acceleration) || formula_fault()) watch_->explain(moment());
  for (const auto& model : models_)
    if (const auto trouble = model->trouble()) watch_->tell(*trouble, moment());
  if (watch_->due(state_.steps) || state_.largest_acceleration * state_.dt > watch_->signal_speed())
    schedule_.run(stage::watch, stage::watch);
  load.end_step();
}

void Simulation::rule(const std::string& name, double value, double& dt) {
  if (!(value < dt)) return;
  dt = value;
  state_.ruling_limit = name;
}

/// The step that stability allows (s). Throws BreakdownError when it collapsed.
double Simulation::stable_step() {
  double dt = 1e300;
  state_.ruling_limit.clear();
  if (plan_.fixed_step > 0) {
    rule("fixed", plan_.fixed_step, dt);
    return dt;
  }
  for (const auto& l : plan_.limits) rule(l.name, l.value, dt);
  for (const auto& model : models_)
    if (const StepLimit* l = model->moving_limit()) rule(l->name, l->value, dt);
  double shortest = 1e300;
  for (const auto& p : plan_.phases)
    if (p.moves()) shortest = std::min(shortest, p.smoothing_length);
  if (state_.largest_acceleration > 0)
    rule("force", scene_.time.safety * StepConstants::force * std::sqrt(shortest / state_.largest_acceleration), dt);
  if (dt < 1e-6 * plan_.step())
    throw BreakdownError("the time step collapsed to " + brief(dt) + " s (less than a millionth of " +
                         brief(plan_.step()) + " s), ruled by the limit \"" + state_.ruling_limit +
                         "\": " + watch_->most_accelerated(moment()) +
                         "; an enormous force acts: lower time.safety or the [[forcing]], raise the sound speed or the "
                         "contact-speed, or look for fills that overlap");
  return dt;
}

void Simulation::choose_step(double largest) {
  double dt = stable_step();
  if (state_.retreat.share < 1.0 && state_.time < state_.retreat.until) {
    dt *= state_.retreat.share;
    state_.ruling_limit = "retreat";
  }
  // The last steps before an output share what is left, so that none is tiny.
  const double left = std::ceil(largest / dt * (1.0 - 1e-9));
  if (left * dt > largest) {
    const double share = largest / left;
    if (left <= 1.0) state_.ruling_limit = "output";
    dt = share;
  }
  state_.dt = dt;
  ++state_.limit_counts[state_.ruling_limit];
}

void Simulation::check_start() {
  check_columns();
  try {
    if (!std::isfinite(state_.largest_acceleration) || formula_fault()) watch_->explain(moment());
    check();
    const double dt = stable_step();
    if (state_.largest_acceleration * dt > watch_->signal_speed())
      throw BreakdownError(watch_->most_accelerated(moment()) + ": in the first step of " + brief(dt) +
                           " s it gains more than the signal speed, " + brief(watch_->signal_speed()) +
                           " m/s: lower the [[forcing]] or the pressure of the fills, or raise the sound speed or the "
                           "contact-speed");
  } catch (const BreakdownError& e) {
    throw SceneError(located(scene_, "fill") + ": the scene is wrong at its start: " + e.what());
  }
}

/// A name finds one column of history.csv.
void Simulation::check_columns() const {
  std::vector<std::string> names = history().names;
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  if (twice == names.end()) return;
  throw SceneError(located(scene_, scene_.force_meters.empty() ? "marker" : "force") +
                   ": two columns of history.csv would be named \"" + *twice +
                   "\"; expected another name of a [[force]], a [[marker]] or a phase");
}

void Simulation::archive(Archive& a) {
  for (const auto& p : plan_.phases) {
    double speed = p.sound_speed;
    a.number("sound speed of " + p.name, speed);
    if (speed != p.sound_speed)
      throw SceneError("the checkpoint does not fit this scene: the sound speed of " + p.name + " was " + brief(speed) +
                       " m/s and is now " + brief(p.sound_speed) + " m/s");
  }
  for (Control& control : controls()) a.number("control " + control.name, control.value);
  state_.archive(a);
  work_->archive(a, loads_whole_);
  for (const auto& model : models_) model->archive(a);
  watch_->archive(a);
  budget_->archive(a);
  if (a.loads()) schedule_.run(stage::pack, stage::pack);  // the watch looks at records before the next step makes them
}

}  // namespace barchan
