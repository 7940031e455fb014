#include "models/open_sides.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "models/workspace.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"
#include "scene/side_names.hpp"
#include "start/flow_ends.hpp"

namespace barchan {

namespace {

/// The wall behind a side that the fluid feels; null: there is none.
const Phase* wall_behind(const Scene& scene, const Phase& fluid, const std::string& side) {
  for (const Fill& fill : scene.fills) {
    const auto* sides = std::get_if<SidesShape>(&fill.shape);
    const Phase* wall = find_phase(scene, fill.phase);
    if (sides && wall && entry_between(scene, fluid, *wall) &&
        std::find(sides->sides.begin(), sides->sides.end(), side) != sides->sides.end())
      return wall;
  }
  return nullptr;
}

/// Whether a fluid enters or leaves through a side by a section of its own.
bool flows_through(const Scene& scene, const Phase& fluid, const std::string& side) {
  const auto ends = flow_ends(scene, fluid);
  return std::any_of(ends.begin(), ends.end(), [&](const FlowEnd& end) { return word_of(end.side) == side; });
}

/// The side away from gravity, where gravity is along one axis that does not repeat; empty: there is none.
std::string upper_side(const Scene& scene) {
  std::string side;
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d) {
    const double g = scene.domain.gravity[d];
    if (g == 0.0) continue;
    if (!side.empty() || scene.domain.periodic[d]) return "";
    side = side_names(scene.domain)[d][g < 0.0 ? 1 : 0];
  }
  return side;
}

}  // namespace

std::array<std::array<bool, 2>, 3> open_sides(const Scene& scene, std::size_t fluid, bool free_surface) {
  std::array<std::array<bool, 2>, 3> open{};
  const bool said = !scene.domain.open.empty();
  const std::vector<std::string> sides = said ? scene.domain.open : std::vector<std::string>{upper_side(scene)};
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t end = 0; end < 2; ++end) {
      const std::string name = side_names(scene.domain)[d][end];
      if (!free_surface || flows_through(scene, scene.phases[fluid], name) ||
          std::find(sides.begin(), sides.end(), name) == sides.end())
        continue;
      const Phase* wall = wall_behind(scene, scene.phases[fluid], name);
      if (wall && said)
        throw SceneError(located(scene, "domain.open") + ": the wall \"" + wall->name + "\" closes \"" + name +
                         "\" to \"" + scene.phases[fluid].name + "\"; expected a side without such a wall");
      open[d][end] = !wall;
    }
  return open;
}

std::array<std::array<bool, 2>, 3> open_sides_of_spheres(const Scene& scene, std::size_t grains) {
  std::array<std::array<bool, 2>, 3> open{};
  const auto& sides = scene.domain.open;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t end = 0; end < 2; ++end) {
      const std::string name = side_names(scene.domain)[d][end];
      open[d][end] =
          std::find(sides.begin(), sides.end(), name) != sides.end() && !wall_behind(scene, scene.phases[grains], name);
    }
  return open;
}

void add_passed(HistoryRow& row, const std::string& name_side_way, int dimensions, const PassedSide& passed) {
  row.add(name_side_way + " [kg]", passed.mass);
  row.add(name_side_way + "_number", static_cast<double>(passed.particles));
  for (int d = 0; d < dimensions; ++d)
    row.add(name_side_way + "_momentum_" + "xyz"[d] + " [kg m/s]", passed.momentum[static_cast<std::size_t>(d)]);
  row.add(name_side_way + "_energy [J]", passed.energy);
}

OpenSides::OpenSides(const Scene& scene, const Layout& layout, std::size_t phase)
    : scene_(scene), plan_(layout.phases[phase]), phase_(phase) {
  const double margin = beyond * plan_.spacing;
  for (std::size_t d = 0; d < 3; ++d) {
    low_[d] = plan_.open[d][0] ? layout.domain.low[d] - margin : -1e300;
    high_[d] = plan_.open[d][1] ? layout.domain.high[d] + margin : 1e300;
  }
}

void OpenSides::begin(State& state, const std::vector<ParticleBlock>&) {
  place_ = state.departed.size();
  state.departed.emplace_back();
  state.departed.back().phase = static_cast<std::int64_t>(phase_);
  PhaseParticles& p = state.phases[phase_];
  p.number_may_change();
  const Exchange among = p.is_part() ? Exchange() : Exchange::none();
  among.in_turn(start_mass_, [&] {
    for (std::size_t k = 0; k < p.size(); ++k) start_mass_ += p.mass_of(k);
  });
}

void OpenSides::attach(Workspace& w) { w_ = &w; }

void OpenSides::schedule(Schedule& s) {
  s.add({stage::walls, plan_.name + ", open sides", {plan_.all_fields()}, [this] { leave(); }});
}

bool OpenSides::is_beyond(const PhaseParticles& p, std::size_t k) const {
  for (int d = 0; d < p.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    const double x = p.column(Field::position, d)[k];
    if (x < low_[c] || x > high_[c]) return true;
  }
  return false;
}

bool OpenSides::any_beyond(const PhaseParticles& p) const {
  bool any = false;
  const auto n = static_cast<std::int64_t>(p.size());
  for (int d = 0; d < p.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    if (!plan_.open[c][0] && !plan_.open[c][1]) continue;
    const double *x = p.column(Field::position, d), low = low_[c], high = high_[c];
    int beyond_here = 0;
#pragma omp parallel for simd schedule(static) reduction(| : beyond_here)
    for (std::int64_t k = 0; k < n; ++k) beyond_here |= static_cast<int>(x[k] < low) | static_cast<int>(x[k] > high);
    any = any || beyond_here != 0;
  }
  return any;
}

/// The first of the open sides that a particle passed.
PassedSide& OpenSides::side_of(const PhaseParticles& p, std::size_t k) {
  for (int d = 0; d < p.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    const double x = p.column(Field::position, d)[k];
    if (x < low_[c]) return passed_[c][0];
    if (x > high_[c]) return passed_[c][1];
  }
  throw std::logic_error("a particle of \"" + plan_.name + "\" left and passed no side");
}

void OpenSides::book(const PhaseParticles& p, std::size_t k, Departed& departed) {
  const double m = p.mass_of(k);
  PassedSide& passed = side_of(p, k);
  if (departed.particles++ == 0) departed.first = w_->state.time;
  ++passed.particles;
  departed.mass += m;
  passed.mass += m;
  for (int d = 0; d < p.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    const double v = p.column(Field::velocity, d)[k];
    departed.momentum[c] += m * v;
    passed.momentum[c] += m * v;
    departed.kinetic += 0.5 * m * v * v;
    passed.energy += 0.5 * m * v * v;
    departed.potential -= m * plan_.weight_share * scene_.domain.gravity[c] * p.column(Field::position, d)[k];
  }
  if (!p.has(Field::density)) return;
  const double strain = p.column(Field::density)[k] / scene_.phases[phase_].density - 1.0;
  departed.stored += 0.5 * m * std::pow(plan_.sound_speed * strain, 2);
}

void OpenSides::leave() {
  PhaseParticles& p = w_->particles(phase_);
  const Exchange among(p);
  if (!among.any(any_beyond(p))) return;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < p.size(); ++k) kept += is_beyond(p, k) ? 0 : 1;
  if (among.total(kept) == 0 && !plan_.own_steps()) {
    trouble_ = "all particles of \"" + plan_.name + "\" are beyond " + sides_text() +
               ": nothing is left to compute; close a side with a wall, or enlarge domain.size";
    return;
  }
  struct Booked {
    Departed departed;
    std::array<std::array<PassedSide, 2>, 3> passed;
  } booked{w_->state.departed[place_], passed_};
  among.in_turn(booked, [&] {
    passed_ = booked.passed;
    for (std::size_t k = 0; k < p.size(); ++k)
      if (is_beyond(p, k)) book(p, k, booked.departed);
    booked.passed = passed_;
  });
  w_->state.departed[place_] = booked.departed;
  passed_ = booked.passed;
  p.remove_if([&](std::size_t k) { return is_beyond(p, k); });
  w_->must_search = true;  // on all ranks
}

std::string OpenSides::sides_text() const {
  std::string text;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t end = 0; end < 2; ++end)
      if (plan_.open[d][end]) text += std::string(text.empty() ? "" : " or ") + side_names(scene_.domain)[d][end];
  return "the open side (" + text + ")";
}

void OpenSides::history(HistoryRow& row) const {
  if (scene_.domain.open.empty()) return;
  const int dimensions = w_->particles(phase_).dimensions();
  row.add(plan_.name + "_left [" + (dimensions == 2 ? "kg/m]" : "kg]"), w_->state.departed[place_].mass);
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t end = 0; end < 2; ++end)
      if (plan_.open[d][end])
        add_passed(row, plan_.name + "_" + side_names(scene_.domain)[d][end] + "_out", dimensions, passed_[d][end]);
}

void OpenSides::archive(Archive& a) {
  a.number(plan_.name + " passed sides", passed_);
  if (a.loads()) trouble_.reset();  // it is that of steps which are given up
}

/// ", 12 % of its mass at the start,"; where particles entered too, of all the mass that was in the run.
std::string OpenSides::share_of_mass(double left) const {
  double entered = 0.0;
  for (const Departed& row : w_->state.departed)
    if (row.phase == static_cast<std::int64_t>(phase_) && row.mass < 0.0) entered -= row.mass;
  const double all = start_mass_ + entered;
  if (!(all > 0.0)) return "";
  return ", " + brief(100.0 * left / all) + " % of its mass at the start" +
         (entered > 0.0 ? " and of what entered since," : ",");
}

void OpenSides::report(Warnings& warnings) const {
  const Departed& departed = w_->state.departed[place_];
  if (departed.particles == 0) return;
  warnings.add("left " + plan_.name, brief(static_cast<double>(departed.particles)) + " particles of \"" + plan_.name +
                                         "\"" + share_of_mass(departed.mass) + " left through " + sides_text() +
                                         ", the first at t = " + brief(departed.first) +
                                         " s; domain.open says which sides are open");
}

}  // namespace barchan
