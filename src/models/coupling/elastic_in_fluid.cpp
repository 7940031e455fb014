#include "models/coupling/elastic_in_fluid.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "models/walls/sides.hpp"

namespace barchan {

namespace {

constexpr std::uint32_t inner = 0xffffffffu;

}  // namespace

ElasticInFluid::ElasticInFluid(const Scene& scene, const Layout& layout, std::size_t solid)
    : scene_(scene), layout_(layout), solid_(solid) {
  for (const PlanEntry& e : layout.entries)
    if (e.extends && e.other == solid && e.corrected) fluids_.push_back(border_fluid(scene, layout, e));
  for (const BorderFluid& fluid : fluids_) neighbours_.emplace_back(layout, fluid.phase, fluid.radius);
}

void ElasticInFluid::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  double finest = 1e300, widest = 0.0, reach = 0.0;
  for (const BorderFluid& fluid : fluids_) {
    finest = std::min(finest, fluid.spacing);
    widest = std::max(widest, fluid.spacing);
  }
  for (const PlanEntry& e : layout_.entries)
    if (e.extends && e.other == solid_) reach = std::max(reach, e.radius);
  const double width = piece_width(layout_.dimensions) * finest;
  border_ = ElasticBorder(scene_, layout_, solid_, blocks[solid_], width, reach + widest);
  PhaseParticles& p = state.phases[solid_];
  nearest_ = p.add_own<std::uint32_t>("nearest piece of its surface", inner);
  p.keep_places();
  border_.move(p);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const auto near = border_.nearest(blocks[solid_].position[k]);
    if (near && near->distance < 0.0) p.own(nearest_)[k] = static_cast<std::uint32_t>(near->piece);
  }
  stress_.resize(border_.pieces().size());
  followed_.assign(stress_.size(), Followed{});
  parted_.assign(fluids_.size(), std::vector<double>(stress_.size(), 0.0));
  spray_.resize(fluids_.size());
  force_.resize(p.size());
}

void ElasticInFluid::attach(Workspace& w) {
  w_ = &w;
  w.particles(solid_).keep_places();
}

void ElasticInFluid::schedule(Schedule& s) {
  using enum Field;
  const std::string& name = layout_.phases[solid_].name;
  Touches held{{name, {position, velocity}, {}}}, loaded{{name, {position, velocity}, {acceleration}}};
  for (const BorderFluid& fluid : fluids_) {
    const std::string& other = layout_.phases[fluid.phase].name;
    held.push_back({other, {position, velocity, density, wholeness}, {position, velocity}});
    loaded.push_back({other, {position, velocity, pressure, acceleration, wholeness}, {}});
  }
  s.add({stage::walls, name + ", border", held, [this] { hold(); }});
  s.add(
      {stage::extend_solids,
       name + ", surface",
       {{name, {position, velocity, acceleration}, {wall_normal, wall_depth, surface_velocity, surface_acceleration}}},
       [this] { move_surface(); }});
  s.add({stage::reaction, name + ", border", loaded, [this] { load(); }});
}

/// The acoustic load takes rho c w from a row of the body, g = rho c/(rho_s dx) (1/s) of its motion, with velocities of
/// the step before. A leapfrog of frequency w and such a damping g' is stable for w^2 dt^2 + 2 g' dt < 4. Of a plate of
/// four rows between two layers of water g' lies between 2.0 and 2.3 g, measured at 1 and 1/4 of the water's density.
/// With 0.9 of that step waves of three rows along the plate grew by 25 a second (the run ended at 0.26 s), with 0.85
/// by 1 a second, with 0.81 the energy is 0.996 after a second; a plate of two rows held with 0.81, not with 0.85.
/// The pressure that follows the body's acceleration of the step before bounds lighter ones: at 0.1 and 0.03 of the
/// density they held with 0.94 rho_s/rho of the acoustic step, and 1.29 was too much.
void ElasticInFluid::limits(std::vector<StepLimit>& limits) const {
  constexpr double felt = 2.3, share = 0.77, lighter = 0.9;
  const PlanPhase& body = layout_.phases[solid_];
  const auto own = std::find_if(limits.begin(), limits.end(),
                                [&](const StepLimit& limit) { return limit.name == "elastic " + body.name; });
  if (own == limits.end()) return;
  const double frequency = scene_.time.safety * StepConstants::total * 2.0 / own->value;  // 1/s
  for (const BorderFluid& fluid : fluids_) {
    const PlanPhase& wet = layout_.phases[fluid.phase];
    const double ratio = scene_.phases[solid_].density / fluid.density;
    const double damping = felt * fluid.sound_speed / (ratio * body.spacing);  // 1/s
    const double step = 4.0 * share / (damping + std::sqrt(damping * damping + 4.0 * share * frequency * frequency));
    const double following = lighter * ratio * StepConstants::acoustic * wet.smoothing_length / fluid.sound_speed;
    limits.push_back({"load on " + body.name, scene_.time.safety * std::min(step, following),
                      "the load of \"" + wet.name + "\" follows its stiffest vibration"});
  }
}

/// Brings the border to where the body is, puts particles of the fluid back that came too near to it, and stops their
/// motion towards it.
void ElasticInFluid::hold() {
  border_.move(w_->particles(solid_));
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  const double dt = w_->state.dt;
  for (std::size_t c = 0; c < fluids_.size(); ++c) {
    const BorderFluid& fluid = fluids_[c];
    PhaseParticles& p = w_->particles(fluid.phase);
    spray_[c].begin(static_cast<std::size_t>(omp_get_max_threads()));
    std::array<double*, 3> x{}, v{};
    for (std::size_t d = 0; d < dimensions; ++d) {
      x[d] = p.column(Field::position, static_cast<int>(d));
      v[d] = p.column(Field::velocity, static_cast<int>(d));
    }
    const double* rho = p.column(Field::density);
    const double* const wholeness = fluid.free_surface ? p.column(Field::wholeness) : nullptr;
    const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      Vec3 at{};
      for (std::size_t d = 0; d < dimensions; ++d) at[d] = x[d][k];
      if (!border_.may_reach(at)) continue;
      const auto near = border_.nearest(at);
      const double room = room_at_border(rho[k], fluid.density) * fluid.spacing;
      if (!near || near->distance >= room) continue;
      const ElasticBorder::Piece& piece = border_.pieces()[near->piece];
      const Vec3 carried = piece.velocity_at(near->from);
      double into = 0.0;
      for (std::size_t d = 0; d < dimensions; ++d) into += (v[d][k] - carried[d]) * piece.normal[d];
      for (std::size_t d = 0; d < dimensions; ++d) {
        x[d][k] += (room - near->distance) * piece.normal[d];
        v[d][k] -= std::min(into, 0.0) * piece.normal[d];
      }
      const double alone = wholeness ? 1.0 - Spray::share(wholeness[k]) : 0.0;
      if (into < 0.0 && dt > 0.0 && alone > 0.0)
        spray_[c].of_threads[static_cast<std::size_t>(omp_get_thread_num())].push_back(
            {0, static_cast<std::uint32_t>(near->piece), 1, 0, {}, alone * p.mass() / dt * into * piece.normal});
    }
  }
}

/// Adds this step to the mean acceleration of each piece: the mean of a mean, each over a part of h/c. What vibrates
/// faster falls off with the square of its frequency, and what is slow lags by twice that time. A single mean over half
/// of h/c left a gate (Antoci et al. 2007, c = 68 m/s) 1.04 of its energy; over 0.7 of it a plate a quarter as dense as
/// the water around it came apart within a second.
void ElasticInFluid::follow() {
  constexpr double part = 0.3;
  PhaseParticles& p = w_->particles(solid_);
  double slowest = 0.0;  // s, h/c
  for (const BorderFluid& fluid : fluids_)
    slowest = std::max(slowest, layout_.phases[fluid.phase].smoothing_length / fluid.sound_speed);
  const double share = std::min(1.0, w_->state.dt / (part * slowest));
  std::array<const double*, 3> a{};
  for (int d = 0; d < layout_.dimensions; ++d) a[static_cast<std::size_t>(d)] = p.column(Field::acceleration, d);
  for (std::size_t q = 0; q < followed_.size(); ++q) {
    auto& [mean, of_means] = followed_[q];
    mean = mean + share * (border_.mean(q, p.places(), a) - mean);
    of_means = of_means + share * (mean - of_means);
  }
}

/// Normals, depths, velocities and accelerations of the nearest places of the surface.
void ElasticInFluid::move_surface() {
  follow();
  PhaseParticles& p = w_->particles(solid_);
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  std::array<const double*, 3> x{}, a{};
  std::array<double*, 3> normal{}, speed{}, followed{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    const int c = static_cast<int>(d);
    x[d] = p.column(Field::position, c);
    a[d] = p.column(Field::acceleration, c);
    normal[d] = p.column(Field::wall_normal, c);
    speed[d] = p.column(Field::surface_velocity, c);
    followed[d] = p.column(Field::surface_acceleration, c);
  }
  double* const depth = p.column(Field::wall_depth);
  const std::uint32_t* const nearest = p.own(nearest_);
  const double* const v[3] = {p.column(Field::velocity, 0), p.column(Field::velocity, 1),
                              dimensions == 3 ? p.column(Field::velocity, 2) : nullptr};
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Vec3 n_k{}, v_k{}, a_k{};
    depth[k] = 0.0;
    if (nearest[k] == inner) {
      for (std::size_t d = 0; d < dimensions; ++d) v_k[d] = v[d][k], a_k[d] = a[d][k];
    } else {
      const ElasticBorder::Piece& piece = border_.pieces()[nearest[k]];
      Vec3 r{};
      for (std::size_t d = 0; d < dimensions; ++d) {
        r[d] = x[d][k] - piece.place[d];
        if (const double period = layout_.bounds.high[d] - layout_.bounds.low[d]; layout_.bounds.periodic[d])
          r[d] -= period * std::nearbyint(r[d] / period);
      }
      depth[k] = std::max(-dot(r, piece.normal), 0.0);
      n_k = piece.normal;
      v_k = piece.velocity_at(r + depth[k] * n_k);
      a_k = followed_[nearest[k]].of_means;
    }
    for (std::size_t d = 0; d < dimensions; ++d) {
      normal[d][k] = n_k[d];
      speed[d][k] = v_k[d];
      followed[d][k] = a_k[d];
    }
  }
}

void ElasticInFluid::load() {
  std::fill(force_.begin(), force_.end(), Vec3{});
  const std::uint32_t* const places = w_->particles(solid_).places();
  places_.clear();
  for (const ElasticBorder::Piece& piece : border_.pieces())
    places_.push_back(piece_place(*w_, solid_, places[piece.anchor], piece.beside));
  for (std::size_t c = 0; c < fluids_.size(); ++c) {
    find_stress(c);
    radiate(fluids_[c], parted_[c]);
    sum(fluids_[c]);
    spray(c);
  }
  PhaseParticles& p = w_->particles(solid_);
  for (int d = 0; d < layout_.dimensions; ++d) {
    double* const a = p.column(Field::acceleration, d);
    for (std::size_t id = 0; id < force_.size(); ++id)
      a[places[id]] += force_[id][static_cast<std::size_t>(d)] / p.mass();
  }
}

/// What spray does: the reaction to its acceleration across the border.
void ElasticInFluid::spray(std::size_t number) {
  const BorderFluid& fluid = fluids_[number];
  if (!fluid.free_surface) return;
  const PhaseParticles& p = w_->particles(fluid.phase);
  const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
  std::array<const double*, 3> x{}, a{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    x[d] = p.column(Field::position, static_cast<int>(d));
    a[d] = p.column(Field::acceleration, static_cast<int>(d));
  }
  spray_[number].make_room(static_cast<std::size_t>(omp_get_max_threads()));
  const double* const wholeness = p.column(Field::wholeness);
  const Vec3& gravity = scene_.domain.gravity;
  const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double share = Spray::share(wholeness[k]);
    Vec3 at{}, push{};
    for (std::size_t d = 0; d < dimensions; ++d) {
      at[d] = x[d][k];
      push[d] = a[d][k] - gravity[d];
    }
    if (!(share < 1.0) || !border_.may_reach(at)) continue;
    const auto near = border_.nearest(at);
    if (!near || !(near->distance < fluid.radius)) continue;
    const Vec3& normal = border_.pieces()[near->piece].normal;
    const double off = dot(push, normal);
    if (off != 0.0)
      spray_[number].of_threads[static_cast<std::size_t>(omp_get_thread_num())].push_back(
          {0, static_cast<std::uint32_t>(near->piece), 0, 0, {}, -(1.0 - share) * p.mass() * off * normal});
  }
  spray_[number].gather();
  for (const Spray::Push& one : spray_[number].all) border_.spread(one.piece, one.force, force_);
}

void ElasticInFluid::find_stress(std::size_t fluid) {
  BorderNeighbours& near = neighbours_[fluid];
  near.look_from(*w_, places_);
  const auto& pieces = border_.pieces();
  const auto count = static_cast<std::int64_t>(pieces.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto q = static_cast<std::size_t>(i);
    if (!near.is_own(q)) continue;
    const BorderMotion border{pieces[q].normal, pieces[q].velocity, pieces[q].spin};
    stress_[q] = border_stress(layout_.dimensions, scene_.domain.gravity, fluids_[fluid], near.of(q), border);
  }
  near.share(stress_);
}

/// p -= rho c (w - mean of w), w the speed with which the fluid goes off the border. The mean is that of h/c: over 20
/// h/c it turned a part of the added mass into a force along the velocity, which fed the second mode of the plate of
/// FSI3 (Turek & Hron 2006) until the fluid broke up.
void ElasticInFluid::radiate(const BorderFluid& fluid, std::vector<double>& parted) {
  const double c = fluid.sound_speed, impedance = fluid.density * c,
               share = std::min(1.0, w_->state.dt * c / layout_.phases[fluid.phase].smoothing_length);
  for (std::size_t q = 0; q < stress_.size(); ++q) {
    if (!stress_[q].wet) continue;
    parted[q] += share * (stress_[q].parting - parted[q]);
    stress_[q].pressure -= stress_[q].share * impedance * (stress_[q].parting - parted[q]);
  }
}

/// Where no fluid is near, as between bodies that touch, the pressure is the mean of the others; beside a free surface
/// it is zero.
void ElasticInFluid::sum(const BorderFluid& fluid) {
  const auto& pieces = border_.pieces();
  double wet = 0.0, mean = 0.0;
  for (std::size_t q = 0; q < pieces.size(); ++q) {
    if (!stress_[q].wet) continue;
    wet += pieces[q].content;
    mean += pieces[q].content * stress_[q].pressure;
  }
  mean = fluid.free_surface || fluids_.size() > 1 || !(wet > 0.0) ? 0.0 : mean / wet;
  for (std::size_t q = 0; q < pieces.size(); ++q) {
    const double pressure = stress_[q].wet ? stress_[q].pressure : mean;
    border_.spread(q, pieces[q].content * (stress_[q].friction - pressure * pieces[q].normal), force_);
  }
}

void ElasticInFluid::archive(Archive& a) {
  a.values("accelerations followed at " + layout_.phases[solid_].name, followed_.data(), followed_.size());
  for (std::size_t c = 0; c < fluids_.size(); ++c)
    a.values("parting speeds at " + layout_.phases[solid_].name + " of " + layout_.phases[fluids_[c].phase].name,
             parted_[c].data(), parted_[c].size());
}

}  // namespace barchan
