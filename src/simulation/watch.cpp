#include "simulation/watch.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/exchange.hpp"
#include "engine/integrate.hpp"
#include "engine/pair_loop.hpp"
#include "models/drive.hpp"
#include "models/walls/sides.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

template <std::size_t Dim>
std::array<const double*, Dim> columns(const PhaseParticles& p, Field field) {
  std::array<const double*, Dim> c{};
  for (std::size_t d = 0; d < Dim; ++d) c[d] = p.column(field, static_cast<int>(d));
  return c;
}

/// Particles begin .. end of a phase against its bounds: a NaN fails every bound.
template <std::size_t Dim, bool Dense, class Part, class Guard>
Part look_at_block(const PhaseParticles& p, const Guard& g, double fastest2, std::size_t begin, std::size_t end) {
  const auto x = columns<Dim>(p, Field::position), v = columns<Dim>(p, Field::velocity);
  const double* rho = Dense ? p.column(Field::density) : nullptr;
  double squares = 0.0, fastest = 0.0, lightest = 1e300, densest = -1e300, wrong = 0.0;
#pragma omp simd reduction(+ : squares, wrong) reduction(max : fastest, densest) reduction(min : lightest)
  for (std::size_t k = begin; k < end; ++k) {
    double v2 = 0.0;
    int good = 1;  // a number, so that & evaluates all conditions without a branch
    for (std::size_t d = 0; d < Dim; ++d) {
      v2 += v[d][k] * v[d][k];
      good &= static_cast<int>(x[d][k] >= g.low[d]) & static_cast<int>(x[d][k] <= g.high[d]);
    }
    good &= static_cast<int>(v2 <= fastest2);
    if constexpr (Dense) {
      good &= static_cast<int>(rho[k] >= g.least_density) & static_cast<int>(rho[k] <= g.most_density);
      lightest = rho[k] < lightest ? rho[k] : lightest;
      densest = rho[k] > densest ? rho[k] : densest;
    }
    squares += v2;
    fastest = v2 > fastest ? v2 : fastest;
    wrong += good ? 0.0 : 1.0;
  }
  return {squares, fastest, lightest, densest, wrong};
}

/// The square of the least distance between a particle of the list's first phase and one of its second.
template <int Dim, int Fields>
double least_separation(std::size_t size, const PairList& list, const RecordArray& own, const RecordArray& others) {
  double least = 1e300;
  const auto n = static_cast<std::int64_t>(size);
#pragma omp parallel for schedule(static) reduction(min : least)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto row = list.row(k);
    if (row.begin == row.end) continue;
    std::array<Lanes, static_cast<std::size_t>(Dim)> x;
    for (std::size_t d = 0; d < Dim; ++d) x[d] = Lanes(own[k][d]);
    Lanes nearest(1e300);
    for_each_neighbour<Fields>(
        row, others, [&](const Lanes* b) __attribute__((always_inline)) {
          std::array<Lanes, static_cast<std::size_t>(Dim)> r;
          nearest = simd::min(separation<Dim>(x, b, r), nearest);
        });
    for (int lane = 0; lane < static_cast<int>(Lanes::width); ++lane) least = std::min(least, nearest[lane]);
  }
  return least;
}

}  // namespace

std::vector<Field> frame_fields(const Scene& scene) {
  std::vector<Field> fields{Field::velocity, Field::density, Field::pressure, Field::smoothing_length};
  for (const auto& name : scene.output.fields) {
    const auto field = find_field(name);
    if (field && *field != Field::position && std::find(fields.begin(), fields.end(), *field) == fields.end())
      fields.push_back(*field);
  }
  return fields;
}

namespace {

std::vector<Field> kept_fields(const Scene& scene) {
  std::vector<Field> fields = frame_fields(scene);
  fields.push_back(Field::position);
  return fields;
}

}  // namespace

Watch::Watch(const Sight& sight) : see_(sight), good_(sight.particles, kept_fields(sight.scene)) {
  make_guards();
  make_pairs();
  fastest_of_.resize(see_.particles.size());
  for (const auto& f : see_.scene.forcings)
    for (const auto& g : guards_)
      if (see_.plan.phases[g.phase].name == f.phase)
        forces_.push_back({g.phase,
                           static_cast<std::size_t>(&f - see_.scene.forcings.data()),
                           {Formula(f.acceleration[0]), Formula(f.acceleration[1]), Formula(f.acceleration[2])}});
  double face = 1.0, shortest = 1e300, pull = 0.0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(see_.plan.dimensions); ++d) {
    face *= see_.scene.domain.size[d];
    shortest = std::min(shortest, see_.scene.domain.size[d]);
  }
  for (const auto& p : see_.plan.phases) pull += norm(p.surface.stress) * face / shortest;
  for (const Forcing& f : see_.scene.forcings)
    if (const Phase* fluid = find_phase(see_.scene, f.phase); fluid && f.holds_force())
      pull +=
          fluid->density * std::pow(largest_friction_velocity(see_.scene, f.friction_velocity), 2) * face / shortest;
  for (const auto& g : guards_) {
    const PhaseParticles& p = see_.particles[g.phase];
    const PlanPhase& plan = see_.plan.phases[g.phase];
    const Exchange among(p);
    const auto count = static_cast<double>(among.total(p.size()));
    mass_ += p.mass() * count;
    start_energy_ += 0.5 * p.mass() * count * std::pow(plan.rules.idle * plan.sound_speed, 2);
    among.in_turn(start_energy_, [&] {
      for (std::size_t k = 0; k < p.size(); ++k) {
        double v2 = 0.0;
        for (int d = 0; d < p.dimensions(); ++d) v2 += std::pow(p.column(Field::velocity, d)[k], 2);
        start_energy_ += 0.5 * p.mass() * v2;
        start_fastest_ = std::max(start_fastest_, std::sqrt(v2));
        if (plan.flows())  // its pressure may become motion
          start_energy_ +=
              0.5 * p.mass() *
              std::pow(p.column(Field::pressure)[k] / (see_.scene.phases[g.phase].density * plan.sound_speed), 2);
      }
    });
    start_fastest_ = among.largest(start_fastest_);
  }
  drag_ = mass_ > 0 ? pull / mass_ : 0.0;
  start_speed_ = mass_ > 0 ? std::sqrt(2.0 * start_energy_ / mass_) : 0.0;
  for (const auto& p : see_.plan.phases) start_speed_ += p.wind.largest_speed;
  if (!see_.scene.motions.empty() || !see_.scene.inflows.empty() || !see_.scene.influxes.empty())
    start_speed_ += see_.plan.largest_speed;  // what drives or enters feeds energy
  torques_ =
      std::any_of(see_.scene.motions.begin(), see_.scene.motions.end(), [](const Motion& m) { return m.torque; });
}

/// The bounds of each phase that moves.
void Watch::make_guards() {
  const Plan& plan = see_.plan;
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    if (!p.moves()) continue;
    const PhaseRules& rules = p.rules;
    Guard g;
    g.phase = k;
    const bool by_contacts = !(rules.signal_speed > 0.0);
    g.signal_speed = by_contacts ? 1e300 : rules.signal_speed;
    g.way = rules.way > 0.0 ? rules.way : 2.0 * p.smoothing_length;
    for (std::size_t d = 0; d < 3; ++d) {
      const double margin = WatchBounds::outside * p.spacing;
      const Bounds& room = p.flow_ends.empty() ? plan.domain : plan.bounds;
      g.closed[d] = {-1, -1};
      g.low[d] = room.periodic[d] ? -1e300 : room.low[d] - margin;
      g.high[d] = room.periodic[d] ? 1e300 : room.high[d] + margin;
      if (p.open[d][0]) g.low[d] = -1e300;  // models/open_sides.hpp takes what passes it
      if (p.open[d][1]) g.high[d] = 1e300;
    }
    for (const auto& e : plan.entries) {
      if (!e.has(k)) continue;
      if (p.flows() && e.a == e.b) g.own_list = e.forward;
      const std::size_t other = e.partner(k);
      if (by_contacts && e.stopping_depth > 0.0) {
        const double d = 0.5 * (p.spacing + plan.phases[other].spacing);
        g.signal_speed = std::min(g.signal_speed, p.sound_speed * e.stopping_depth / d);
      }
      if (plan.phases[other].moves() || plan.phases[other].travels() ||
          Exchange().total(see_.particles[other].size()) == 0)
        continue;
      Sides sides;
      close_sides(sides, see_.particles[other], plan.bounds, plan.phases[other].spacing);
      for (std::size_t d = 0; d < 3; ++d) {
        sides.low[d] = Exchange().largest(sides.low[d]);
        sides.high[d] = Exchange().least(sides.high[d]);
        if (sides.low[d] > -Sides::far) g.closed[d][0] = static_cast<int>(other);
        if (sides.high[d] < Sides::far) g.closed[d][1] = static_cast<int>(other);
        // A grain or a body whose centre is beyond the side is half its diameter deep in the wall.
        if (rules.stops_at_sides && g.closed[d][0] >= 0) g.low[d] = plan.bounds.low[d];
        if (rules.stops_at_sides && g.closed[d][1] >= 0) g.high[d] = plan.bounds.high[d];
      }
    }
    g.dense = see_.particles[k].has(Field::density);
    g.reference_density = see_.scene.phases[k].density;
    const double share = rules.density_share;
    g.least_density = share > 0.0 ? (1.0 - share) * g.reference_density : 1e-300;
    g.most_density = share > 0.0 ? (1.0 + share) * g.reference_density : 1e300;
    guards_.push_back(g);
  }
}

void Watch::make_pairs() {
  const auto between = [&](std::size_t a, std::size_t b) {
    return 0.5 * (see_.plan.phases[a].spacing + see_.plan.phases[b].spacing);
  };
  const auto wall = [&](std::size_t k) { return !see_.plan.phases[k].moves(); };
  for (const auto& e : see_.plan.entries) {
    if (!e.keeps_apart || (e.forward < 0 && e.backward < 0)) continue;
    const bool turned = wall(e.a);
    const bool at_wall = wall(e.a) || wall(e.b);
    pairs_.push_back({turned ? e.b : e.a, turned ? e.a : e.b, turned ? e.backward : e.forward, e.reads_stress,
                      (at_wall ? WatchBounds::wall_depth : WatchBounds::coincidence) * between(e.a, e.b), e.radius});
  }
}

double Watch::signal_speed() const {
  double largest = 0.0;
  for (const auto& g : guards_) largest = std::max(largest, g.signal_speed);
  return largest;
}

double Watch::speed_bound(const Guard& g, double dt) const { return std::min(g.signal_speed, g.way / dt); }

void Watch::look(const Moment& now) {
  const double fastest = look_at_phases(now);
  // Two that were apart have come nearer by twice the way of the fastest at most, and half as much again for those that
  // were faster in between.
  const double way_since = 3.0 * std::max(fastest, last_fastest_) * (now.time - last_time_);
  for (auto& pair : pairs_) pair.left -= way_since;
  last_fastest_ = fastest;
  const double way = 2.0 * fastest * now.dt;  // in the next step
  const bool keeps = now.step - good_.step() >= keep_interval;
  look_at_pairs(now, way * longest_interval);
  if (++looks_ % 2 == 0 || keeps) look_at_pairing(now, false);
  look_at_energy(now);
  if (keeps) good_.keep(see_.particles, now.time, now.step);
  next_ = now.step + longest_interval;
  for (const auto& pair : pairs_)  // two particles must not come near and separate again between two looks
    if (pair.left < way * longest_interval)
      next_ = std::min(next_, now.step + std::max(1L, static_cast<long>(pair.left / way)));
}

void Watch::look_closely(const Moment& now) {
  last_fastest_ = look_at_phases(now);
  look_at_pairs(now, 1e300);
  look_at_pairing(now, true);
  look_at_energy(now);
  good_.keep(see_.particles, now.time, now.step);
}

void Watch::look_aside(const Moment& now) {
  const std::tuple kept(forced_, last_time_, last_fastest_, wall_speed_, extreme_, fastest_);
  look_closely(now);
  std::tie(forced_, last_time_, last_fastest_, wall_speed_, extreme_, fastest_) = kept;
}

void Watch::explain(const Moment& now) { tell_worst(now); }

double Watch::look_at_phases(const Moment& now) {
  double fastest_solid = 0.0, energy = 0.0, wrong = 0.0;
  for (const Guard& g : guards_) {
    const PhaseParticles& p = see_.particles[g.phase];
    const Exchange among(p);
    const double bound = speed_bound(g, now.dt), bound2 = bound * bound;
    const auto n = static_cast<std::int64_t>((p.size() + block - 1) / block);
    if (parts_.size() < static_cast<std::size_t>(n)) parts_.resize(static_cast<std::size_t>(n));
    const bool flat = see_.plan.dimensions == 2;
    const auto look = flat ? (g.dense ? look_at_block<2, true, Part, Guard> : look_at_block<2, false, Part, Guard>)
                           : (g.dense ? look_at_block<3, true, Part, Guard> : look_at_block<3, false, Part, Guard>);
#pragma omp parallel for schedule(static)
    for (std::int64_t q = 0; q < n; ++q) {
      const std::size_t begin = static_cast<std::size_t>(q) * block;
      parts_[static_cast<std::size_t>(q)] = look(p, g, bound2, begin, std::min(begin + block, p.size()));
    }
    Part all;
    for (std::int64_t q = 0; q < n; ++q) {
      const Part& part = parts_[static_cast<std::size_t>(q)];
      all.squares += part.squares;
      all.wrong += part.wrong;
      all.fastest = std::max(all.fastest, part.fastest);
      all.lightest = std::min(all.lightest, part.lightest);
      all.densest = std::max(all.densest, part.densest);
    }
    if (among.is_shared()) all = of_all_ranks(all);
    energy += 0.5 * p.mass() * all.squares;
    fastest_of_[g.phase] = std::sqrt(all.fastest);
    wrong += all.wrong;
    if (!see_.plan.phases[g.phase].flows()) fastest_solid = std::max(fastest_solid, std::sqrt(all.fastest));
    else if (among.total(p.size()) > 0)
      note_density(g, std::max(all.densest, 2.0 * g.reference_density - all.lightest) / g.reference_density - 1.0, now);
  }
  energy_ = energy;
  if (wrong > 0.0) tell_worst(now);
  return fastest_solid;
}

bool Watch::too_near(Apart& pair) const {
  const PairList& list = see_.neighbours.list(static_cast<std::size_t>(pair.list));
  const Record record = pair.stress ? Record::stress : Record::motion;
  see_.work.fill_images(pair.b, record);  // no task may have read them since they were packed
  const RecordArray &own = see_.work.records(pair.a, record), &others = see_.work.records(pair.b, record);
  const std::size_t n = see_.particles[pair.a].size();
  const double least = Exchange().least(see_.plan.dimensions == 2 ? least_separation<2, 8>(n, list, own, others)
                                        : pair.stress             ? least_separation<3, 16>(n, list, own, others)
                                                                  : least_separation<3, 8>(n, list, own, others));
  pair.left = std::sqrt(std::min(least, pair.reach * pair.reach)) - pair.distance;
  return pair.left < 0.0;
}

/// Looks at those that may come too near within a way (m).
void Watch::look_at_pairs(const Moment& now, double way) {
  for (Apart& pair : pairs_)
    if (pair.left <= way && too_near(pair)) tell_pair(pair, now);
}

void Watch::look_at_pairing(const Moment& now, bool all) const {
  for (const Guard& g : guards_)
    if (g.own_list >= 0) look_for_pairing(g, now, all);
}

/// The square of the distance (m2) of a fluid particle to the nearest of its phase.
template <std::size_t Dim>
double Watch::nearest_in(const Guard& g, std::size_t k) const {
  const PhaseParticles& p = see_.particles[g.phase];
  const CellGrid& grid = see_.neighbours.grid(g.phase);
  const Image* images = grid.image_list().data();
  const auto x = columns<Dim>(p, Field::position);
  const auto row = see_.neighbours.list(static_cast<std::size_t>(g.own_list)).row(k);
  const std::size_t n = p.size(), all = n + grid.images();
  double least = 1e300;
  for (const std::uint32_t* q = row.begin; q != row.end; ++q) {
    const std::size_t b = *q / PairList::stride;
    double r2 = 0.0;
    if (b < n) {
      for (std::size_t d = 0; d < Dim; ++d) r2 += (x[d][k] - x[d][b]) * (x[d][k] - x[d][b]);
    } else if (b < all) {
      const Image& image = images[b - n];
      for (std::size_t d = 0; d < Dim; ++d) {
        const double source = grid.is_shared() ? ghosts_[d][b - n] : x[d][image.source];
        const double r = x[d][k] - source - image.shift[d] * grid.period()[d];
        r2 += r * r;
      }
    } else {
      continue;  // the dummy
    }
    least = r2 < least ? r2 : least;
  }
  return least;
}

double Watch::nearest(const Guard& g, std::size_t k) const {
  return see_.plan.dimensions == 2 ? nearest_in<2>(g, k) : nearest_in<3>(g, k);
}

double Watch::strongest_force(const Moment& now) const {
  constexpr std::size_t sample = 64;
  double strongest = drag_;
  for (const Force& f : forces_) {
    const PhaseParticles& p = see_.particles[f.phase];
    const Exchange among(p);
    const bool constant =
        f.acceleration[0].is_constant() && f.acceleration[1].is_constant() && f.acceleration[2].is_constant();
    const std::size_t stride = constant ? p.size() : std::max<std::size_t>(1, among.total(p.size()) / sample);
    double most = 0.0;
    for (std::size_t k = constant ? 0 : (stride - among.before(p.size()) % stride) % stride; k < p.size();
         k += stride) {
      Vec3 x{};
      for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
      const auto at = [&](std::size_t d) {
        return f.acceleration[d].is_constant() ? f.acceleration[d].constant() : f.acceleration[d](x, now.time);
      };
      most = std::max(most, norm({at(0), at(1), at(2)}));
    }
    strongest += among.largest(most);
  }
  return strongest;
}

/// What all ranks see; of one process the same.
Watch::Part Watch::of_all_ranks(Part part) {
  Part all;
  for (const Part& one : Exchange().each(part)) {
    all.squares += one.squares;
    all.wrong += one.wrong;
    all.fastest = std::max(all.fastest, one.fastest);
    all.lightest = std::min(all.lightest, one.lightest);
    all.densest = std::max(all.densest, one.densest);
  }
  return all;
}

void Watch::take_places_of_ghosts(std::size_t phase) const {
  see_.neighbours.grid(phase).take_places(see_.particles[phase], ghosts_);
}

}  // namespace barchan
