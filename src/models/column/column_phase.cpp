#include "models/column/column_phase.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "engine/phase_sums.hpp"
#include "laws/kept_drag.hpp"
#include "laws/turning_sphere.hpp"
#include "models/coupling/wind_exchange.hpp"
#include "models/drive.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/log_wind.hpp"

namespace barchan {

namespace {

/// Diameters of the grains of a phase, each its own or all the same.
class Diameters {
 public:
  Diameters(const PhaseParticles& grains, double mean)
      : radius_(grains.has(Field::radius) ? grains.column(Field::radius) : nullptr), mean_(mean) {}
  double operator[](std::size_t k) const { return radius_ ? 2.0 * radius_[k] : mean_; }

 private:
  const double* radius_;
  double mean_;  // m
};

constexpr double fine_diameters = 20.0;  // of fine cells above the grains of the start
constexpr double cells_a_diameter = 4.0;
constexpr double most_cells = 20000.0;
/// Of sqrt(d/g), the time in which a grain falls half its diameter: 20 us for 0.25 mm.
constexpr double interval_share = 0.004;
constexpr double gust_nodes = 4.0;  // diameters between places where gusts are known

}  // namespace

ColumnPhase::ColumnPhase(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene),
      layout_(layout),
      keys_(scene.phases[number].column()),
      number_(number),
      density_(scene.phases[number].density),
      area_(scene.domain.size[0] * (layout.dimensions == 3 ? scene.domain.size[2] : 1.0)),
      friction_velocity_(keys_.friction_velocity) {
  for (const PlanEntry& e : layout.entries) {
    if (!e.has(number)) continue;
    const std::size_t grains = e.partner(number);
    const PlanPhase& plan = layout.phases[grains];
    feeling_.push_back({grains,
                        e.given.drag_law,
                        scene.phases[grains].density,
                        plan.size(),
                        plan.own_steps(),
                        e.given.lift,
                        e.given.magnus,
                        {},
                        {},
                        {}});
    if (e.given.gusts > 0.0) {
      const double size = scene.domain.size[0], u = bagnold_threshold(scene.phases[grains].density / density_ - 1.0,
                                                                      std::abs(scene.domain.gravity[1]), plan.size());
      feeling_.back().gusts.emplace(e.given.gusts, keys_.viscosity, u, layout.domain.low[0], size,
                                    static_cast<std::size_t>(std::ceil(size / (gust_nodes * plan.size()))));
    }
    diameter_ = std::max(diameter_, plan.size());
    crowded_ = crowded_ || e.given.drag_law == DragLaw::di_felice;
  }
  const double g = std::abs(scene.domain.gravity[1]);
  interval_ = interval_share * std::sqrt(diameter_ / (g > 0.0 ? g : 9.81));
}

void ColumnPhase::attach(Workspace& w) {
  w_ = &w;
  for (Feeling& grains : feeling_)
    for (auto* values : {&grains.rate, &grains.wind}) values->assign(w.particles(grains.phase).size(), 0.0);
  place_ = w.state.air.size();
  w.state.air.emplace_back();
  make_profile();
  if (keys_.log_profile) {
    AirProfile& p = profile();
    for (std::size_t k = 0; k < p.cells(); ++k)
      p.speed[k] = log_wind(*keys_.log_profile, 0.5 * (p.face[k] + p.face[k + 1]) - p.face.front());
    if (keys_.held) {  // one cell: the mean over the height, and the stress of the logarithmic layer, rho u*|u*|
      const double u = keys_.log_profile->friction_velocity;
      p.speed.front() = mean_log_wind(*keys_.log_profile, p.face.back() - p.face.front());
      std::fill(p.stress.begin(), p.stress.end(), density_ * u * std::abs(u));
    }
  } else if (keys_.speed) {
    std::fill(profile().speed.begin(), profile().speed.end(), *keys_.speed);
  } else {
    find_steady_wind();
  }
  air_->update_mixing_length();
  air_->integrate_speed();
}

/// The grid: fine where nearly all grains of the start are.
void ColumnPhase::make_profile() {
  std::vector<double> heights;
  for (const Feeling& grains : feeling_) {
    const PhaseParticles& p = w_->particles(grains.phase);
    heights.insert(heights.end(), p.column(Field::position, 1), p.column(Field::position, 1) + p.size());
  }
  const double bottom = scene_.domain.origin[1], d = diameter_;
  double highest = bottom;
  if (!heights.empty()) {
    const auto most = heights.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(heights.size() - 1));
    std::nth_element(heights.begin(), most, heights.end());
    highest = *most;
  }
  const double top = bottom + keys_.height.value_or(scene_.domain.size[1]);
  const bool known = keys_.held && (keys_.speed || keys_.log_profile);  // nothing has to be resolved
  const double resolution = known ? top - bottom : keys_.resolution.value_or(d / cells_a_diameter);
  const double fine_top = std::min(highest + fine_diameters * d, top), cells = (fine_top - bottom) / resolution;
  if (cells > most_cells)
    throw SceneError(scene_.file + ": phases." + scene_.phases[number_].name + ".resolution: " + brief(resolution) +
                     " m makes " + brief(cells) + " cells up to the grains, " + brief(fine_top - bottom) +
                     " m over the bottom; expected at most " + brief(most_cells));
  profile() = AirColumn::grid(bottom, fine_top, top, resolution);
  profile().phase = number_;
  const AirColumn::Air air{density_, keys_.viscosity, keys_.mixing_length, keys_.slip};
  air_ = std::make_unique<AirColumn>(air, profile());
  spread_ = std::make_unique<AirColumn::Spread>(profile().cells());
  load_ = std::make_unique<AirColumn::Load>(profile().cells());
  solid_.assign(profile().cells(), 0.0);
}

double ColumnPhase::top_stress(double time) const {
  const double u = friction_velocity_({}, time);
  return density_ * u * std::abs(u);
}

/// The wind that the grains at their initial speeds let pass: steps of the air that grow until it rests.
void ColumnPhase::find_steady_wind() {
  AirProfile& p = profile();
  const double stress = top_stress(0.0);
  if (stress == 0.0) return;
  hold_ = interval_;
  double dt = interval_;
  for (int k = 0; k < 120; ++k, dt = std::min(1.25 * dt, 100.0)) {
    air_->integrate_speed();
    feel();
    spread_rates();
    spread_drag(false, load_->pull);
    air_->advance(dt, stress, *load_);
  }
  std::fill(p.given.begin(), p.given.end(), 0.0);
  p.boundary = 0.0;
}

void ColumnPhase::schedule(Schedule& s) {
  using enum Field;
  const std::string& name = scene_.phases[number_].name;
  Touches exchanged, pushed;
  for (const Feeling& grains : feeling_) {
    exchanged.push_back({layout_.phases[grains.phase].name, {position, velocity, radius}, {drag_acceleration}});
    if (grains.magnus) exchanged.back().writes = {drag_acceleration, angular_velocity};
    pushed.push_back({layout_.phases[grains.phase].name, {drag_acceleration}, {acceleration}});
  }
  s.add({stage::drag, name, exchanged, [this] { exchange(); },
         Repeat{wind_exchanges, interval_, [this] { return exchange_is_due() ? 1L : 0L; }}});
  s.add({stage::drag, name, pushed, [this] { act(); }});
}

/// Lets the clock of the exchanges go on.
bool ColumnPhase::exchange_is_due() {
  AirProfile& p = profile();
  const State& state = w_->state;
  const bool first = p.step < 0;
  if (first) {
    p.last = 0.0;
  } else if (p.step != state.steps) {
    p.elapsed += state.dt;
    p.kicked += 0.5 * (p.last + state.dt);
    p.last = state.dt;
  }
  p.step = state.steps;
  return first || barchan::exchange_is_due(p.elapsed, interval_);
}

/// The drag of the last exchange.
void ColumnPhase::act() {
  for (const Feeling& grains : feeling_) add_kept_drag(w_->particles(grains.phase));
}

/// Grains and air for the time to the next exchange: the drag in the present wind, the wind that this leaves, and the
/// drag in that.
void ColumnPhase::exchange() {
  AirProfile& p = profile();
  hold_ = time_to_next_exchange(interval_, w_->state.dt);
  if (!keys_.held) {
    spread_drag(true, load_->owed);
    for (std::size_t c = 0; c < p.cells(); ++c) load_->owed[c] -= p.given[c];
  }
  p.elapsed = p.kicked = 0.0;
  if (crowded_) find_voidage();
  feel();
  if (keys_.held) return;
  spread_rates();
  spread_drag(false, load_->pull);
  if (keys_.averaging) {
    const double before = p.boundary;
    average_load();
    air_->advance(*keys_.averaging, top_stress(w_->state.time), *load_);
    p.boundary = before + (p.stress.back() - p.stress.front()) * hold_;
    std::fill(p.given.begin(), p.given.end(), 0.0);
  } else {
    air_->advance(hold_, top_stress(w_->state.time), *load_);
  }
  follow_wind();
}

/// Air without inertia: the load becomes its exponential average. The air then goes a step as long as the average, of
/// which some thousand fit into one: it is as good as steady.
void ColumnPhase::average_load() {
  AirProfile& p = profile();
  const bool first = p.mean_rate.empty();
  if (first) {
    p.mean_rate.assign(p.cells(), 0.0);
    p.mean_push.assign(p.cells(), 0.0);
  }
  const double share = first ? 1.0 : -std::expm1(-hold_ / *keys_.averaging);
  for (std::size_t c = 0; c < p.cells(); ++c) {
    const double push = load_->rate[c] * p.speed[c] - load_->pull[c];
    p.mean_rate[c] += share * (load_->rate[c] - p.mean_rate[c]);
    p.mean_push[c] += share * (push - p.mean_push[c]);
    load_->rate[c] = p.mean_rate[c];
    load_->pull[c] = p.mean_rate[c] * p.speed[c] - p.mean_push[c];
    load_->owed[c] = 0.0;
  }
}

/// The wind that a grain feels: the mean over its height; of a logarithmic profile that is held, that at its centre.
double ColumnPhase::wind(double y, double radius) const {
  if (keys_.held && keys_.log_profile) return log_wind(*keys_.log_profile, y - profile().face.front());
  return air_->mean_speed(y - radius, y + radius);
}

/// Half of the curl of the wind about a grain (1/s), about z.
double ColumnPhase::rotation(double y, double radius) const {
  return 0.5 * (wind(y - 0.5 * radius, 0.5 * radius) - wind(y + 0.5 * radius, 0.5 * radius)) / radius;
}

/// Lift over the rate of the drag, m/s: of a grain of speed `along` the ground in a mean `wind` that `blows` with its
/// gust (models/coupling/sand_layer.hpp).
double ColumnPhase::lift_of(double y, double radius, double mean, double blows, double along) const {
  const double shear = wind(y + 0.5 * radius, 0.5 * radius) - wind(y - 0.5 * radius, 0.5 * radius);
  const double gain = mean != 0.0 ? blows / mean : 1.0, difference = blows - along;
  return gain * shear * difference / std::max({std::abs(difference), std::abs(blows), 1e-300});
}

void ColumnPhase::feel() {
  for (Feeling& grains : feeling_) {
    if (grains.gusts) grains.gusts->blow(w_->state.time + 0.5 * hold_);
    if (grains.law == DragLaw::di_felice) {
      const auto excess = [this](double re, double y) {
        return DiFeliceDrag::excess_in_crowd(re, std::max(1.0 - solid_[air_->cell_at(y)], 0.3));
      };
      layout_.dimensions == 2 ? feel<2>(grains, excess) : feel<3>(grains, excess);
    } else {
      with_drag_law(grains.law, [&](auto law) {
        const auto excess = [](double re, double) { return decltype(law)::excess(re); };
        layout_.dimensions == 2 ? feel<2>(grains, excess) : feel<3>(grains, excess);
      });
    }
  }
}

/// From a grain's place to that in the middle of the time for which its drag is kept (s). Speeds of the common
/// integrator are half a step behind places, and so is that time.
double ColumnPhase::time_ahead(const Feeling& grains) const {
  return std::max(0.5 * (hold_ - (grains.own_steps ? 0.0 : w_->state.dt)), 0.0);
}

/// The drag of each grain as a mean over the time for which it is kept: exact for a wind and a rate that do not change,
/// which are those of the middle of that time.
template <int Dim, class DragOf>
void ColumnPhase::feel(Feeling& grains, const DragOf& excess) {
  PhaseParticles& p = w_->particles(grains.phase);
  constexpr auto dimensions = static_cast<std::size_t>(Dim);
  std::array<const double*, dimensions> v{};
  std::array<double*, dimensions> drag{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    v[d] = p.column(Field::velocity, static_cast<int>(d));
    drag[d] = p.column(Field::drag_acceleration, static_cast<int>(d));
  }
  std::array<double*, spins(Dim)> spin{};
  if (grains.magnus) spin = spin_columns<Dim>(p, Field::angular_velocity);
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  const Diameters diameter(p, grains.diameter);
  const double weight = weight_share(scene_, scene_.phases[grains.phase]);
  const double time = hold_, ahead = time_ahead(grains);
  const auto n = static_cast<std::int64_t>(p.size());
  for (auto* values : {&grains.rate, &grains.wind}) values->resize(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double d = diameter[k], stokes = 18.0 * density_ * keys_.viscosity / (grains.density * d * d);
    const double at = y[k] + ahead * v[1][k];
    const double speed = wind(at, 0.5 * d), blows = grains.gusts ? grains.gusts->felt(x[k], speed) : speed;
    std::array<double, dimensions> air{blows}, own{}, gravity{};
    for (std::size_t c = 0; c < dimensions; ++c) {
      own[c] = v[c][k];
      gravity[c] = weight * scene_.domain.gravity[c];
    }
    const auto kept = kept_drag<dimensions>(
        air, own, gravity, stokes, d / keys_.viscosity, [&](double re) { return excess(re, at); }, time);
    for (std::size_t c = 0; c < dimensions; ++c) drag[c][k] = kept.drag[c];
    grains.rate[k] = kept.rate;
    grains.wind[k] = speed;
    if (grains.lift > 0.0) drag[1][k] += grains.lift * kept.rate * lift_of(at, 0.5 * d, speed, blows, own[0]);
    if (!grains.magnus || own == std::array<double, dimensions>{}) continue;
    std::array<double, dimensions> through{};
    for (std::size_t c = 0; c < dimensions; ++c) through[c] = own[c] - air[c];
    std::array<double, spins(Dim)> turns{};
    for (std::size_t c = 0; c < turns.size(); ++c) turns[c] = spin[c][k];
    const TurningSphere sphere{density_ / grains.density, keys_.viscosity, d, rotation(at, 0.5 * d)};
    const auto pushed = sphere.turn<dimensions>(turns, through, time);
    for (std::size_t c = 0; c < dimensions; ++c) drag[c][k] += pushed[c];
    for (std::size_t c = 0; c < turns.size(); ++c) spin[c][k] = turns[c];
  }
}

/// The drag in the wind that the air's step has made.
void ColumnPhase::follow_wind() {
  for (Feeling& grains : feeling_) {
    PhaseParticles& p = w_->particles(grains.phase);
    const Diameters diameter(p, grains.diameter);
    const double *y = p.column(Field::position, 1), *vy = p.column(Field::velocity, 1);
    double* drag = p.column(Field::drag_acceleration, 0);
    const double ahead = time_ahead(grains);
    const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      drag[k] += grains.rate[k] * (wind(y[k] + ahead * vy[k], 0.5 * diameter[k]) - grains.wind[k]);
    }
  }
}

/// How much more the grains of each cell take off as the air gets faster.
void ColumnPhase::spread_rates() {
  spread_->clear();
  for (const Feeling& grains : feeling_) {
    const PhaseParticles& p = w_->particles(grains.phase);
    const Diameters diameter(p, grains.diameter);
    const double* y = p.column(Field::position, 1);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double r = 0.5 * diameter[k];
      spread_->add(*air_, y[k] - r, y[k] + r, p.mass_of(k) * grains.rate[k] / area_);
    }
  }
  spread_->gather(*air_, load_->rate);
}

/// For how long the present drag has acted since the last exchange. Grains of the common integrator are kicked twice a
/// step: by the drag of the step before at its beginning, and by that of its end.
double ColumnPhase::impulse_time(const Feeling& grains) const {
  return grains.own_steps ? profile().elapsed : profile().kicked;
}

/// What the present drag gives the grains of each cell, Pa; or what it has given them since the last exchange, Pa s.
void ColumnPhase::spread_drag(bool so_far, std::vector<double>& sums) {
  spread_->clear();
  for (const Feeling& grains : feeling_) {
    const double time = so_far ? impulse_time(grains) : 1.0;
    const PhaseParticles& p = w_->particles(grains.phase);
    const Diameters diameter(p, grains.diameter);
    const double *y = p.column(Field::position, 1), *drag = p.column(Field::drag_acceleration, 0);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double r = 0.5 * diameter[k];
      spread_->add(*air_, y[k] - r, y[k] + r, p.mass_of(k) * drag[k] * time / area_);
    }
  }
  spread_->gather(*air_, sums);
}

/// The part of each cell that is solid; 2D: of a slab one diameter thick.
void ColumnPhase::find_voidage() {
  spread_->clear();
  for (const Feeling& grains : feeling_) {
    const PhaseParticles& p = w_->particles(grains.phase);
    const Diameters diameter(p, grains.diameter);
    const double* y = p.column(Field::position, 1);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double r = 0.5 * diameter[k];
      spread_->add(*air_, y[k] - r, y[k] + r, p.mass_of(k) / (grains.density * area_));
    }
  }
  spread_->gather(*air_, solid_);
  const AirProfile& air = profile();
  for (std::size_t c = 0; c < solid_.size(); ++c) solid_[c] /= air.face[c + 1] - air.face[c];
}

void ColumnPhase::report(Warnings& warnings) const {
  const std::string& told = layout_.phases[number_].wind.beyond_measured;
  if (!feeling_.empty() && !told.empty()) warnings.add("wind of " + scene_.phases[number_].name, told);
}

/// The profile belongs to the state; what is made of it is made again.
void ColumnPhase::archive(Archive& a) {
  if (a.loads()) air_->integrate_speed();
}

/// Of the air, counted at the same moment as that of the grains: less what they have got since the last exchange. A
/// wind that is held loses nothing to them.
double ColumnPhase::momentum() const {
  const AirProfile& air = profile();
  double sum = air_->momentum();
  if (keys_.held) return area_ * sum;
  for (const double given : air.given) sum += given;
  sum *= area_;
  for (const Feeling& grains : feeling_) {
    const PhaseParticles& p = w_->particles(grains.phase);
    const double* drag = p.column(Field::drag_acceleration, 0);
    const double time = grains.own_steps ? air.elapsed : air.kicked + 0.5 * air.last;
    sum -= time * sum_of(p, [&](std::size_t k) { return p.mass_of(k) * drag[k]; });
  }
  return sum;
}

void ColumnPhase::history(HistoryRow& row) const {
  const std::string& name = scene_.phases[number_].name;
  if (!keys_.held) add_pull(row, name, top_stress(w_->state.time), density_);
  if (!keys_.averaging) row.add(name + "_momentum_x [kg m/s]", momentum());
  row.add(name + "_boundary_impulse_x [kg m/s]", area_ * profile().boundary);
}

}  // namespace barchan
