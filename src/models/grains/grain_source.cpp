#include "models/grains/grain_source.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "models/workspace.hpp"
#include "output/numbers.hpp"
#include "output/series.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"
#include "scene/scene_files.hpp"
#include "scene/side_names.hpp"
#include "start/ball_surfaces.hpp"
#include "start/flow_ends.hpp"
#include "start/random.hpp"
#include "start/sphere_sizes.hpp"

namespace barchan {

namespace {

/// A normal deviate (Box & Muller 1958).
double normal(Random& random) {
  const double u = 1.0 - random.uniform(0.0, 1.0), v = random.uniform(0.0, 1.0);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

std::size_t number_of(const Scene& scene, const std::string& phase) {
  for (std::size_t k = 0; k < scene.phases.size(); ++k)
    if (scene.phases[k].name == phase) return k;
  throw std::logic_error("an influx of a phase that is not there");
}

const FrameField* field_of(const Frame& frame, const char* name, int components) {
  for (const FrameField& field : frame.fields)
    if (field.name == name && field.components == components) return &field;
  return nullptr;
}

constexpr double slowest = 0.1;  // of the mean speed of a distribution

/// That of the side; of a box the vertical one.
std::size_t axis_of_influx(const Domain& domain, const Influx& influx) {
  return influx.box ? up_axis(domain) : side_at(domain, *influx.side).axis;
}

bool is_upper(const Domain& domain, const Influx& influx) { return !influx.box && side_at(domain, *influx.side).upper; }

std::string name_of(const Scene& scene, std::size_t influx) {
  const Influx& own = scene.influxes[influx];
  if (!own.box) return own.phase + "_" + word_of(*own.side);
  const auto before =
      std::count_if(scene.influxes.begin(), scene.influxes.begin() + static_cast<std::ptrdiff_t>(influx),
                    [&](const Influx& other) { return other.box && other.phase == own.phase; });
  return own.phase + "_poured" + (before > 0 ? "_" + std::to_string(before + 1) : "");
}

}  // namespace

Arrivals::Arrivals(const Scene& scene, std::size_t influx, double slab)
    : influx_(scene.influxes[influx]),
      size_(*find_phase(scene, influx_.phase)->diameter()),
      density_(find_phase(scene, influx_.phase)->density),
      slab_(slab),
      up_(up_axis(scene.domain)),
      ground_(influx_.above.value_or(scene.domain.origin[up_])),
      top_(scene.domain.origin[up_] + scene.domain.size[up_]),
      axis_(axis_of_influx(scene.domain, influx_)),
      inwards_(influx_.box                       ? 0.0
               : is_upper(scene.domain, influx_) ? -1.0
                                                 : 1.0) {
  double mass = mass_of(0.5 * size_.mean) * size_.mean_cube();
  if (!influx_.file.empty()) {
    read_patterns(scene, influx);
    double sum = 0.0, before = 0.0;
    for (const Pattern& p : patterns_) {
      sum += (p.weight - before) * mass_of(p.radius);
      before = p.weight;
      fastest_ = std::max(fastest_, norm(p.velocity));
    }
    mass = sum / patterns_.back().weight;
  } else if (influx_.box) {
    fastest_ = norm(influx_.velocity);
  } else {
    const double steep = std::min(std::abs(influx_.angle) + 4.0 * influx_.angle_spread, 80.0);
    fastest_ = (*influx_.speed + 4.0 * influx_.speed_spread) / std::cos(steep * std::numbers::pi / 180.0);
  }
  const std::size_t across = axis_ == 0 ? 3 - up_ : 0;
  const double width = scene.dimensions == 2 || influx_.box ? 1.0 : scene.domain.size[across];
  mean_wait_ = mass / (influx_.flux * width);
}

double Arrivals::mass_of(double radius) const {
  return density_ * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius / slab_;
}

void Arrivals::read_patterns(const Scene& scene, std::size_t influx) {
  const auto refuse = [&](const std::string& what) {
    throw SceneError(located(scene, "influx." + std::to_string(influx) + ".file") + ": \"" + influx_.file + "\" " +
                     what);
  };
  Frame frame;
  try {
    frame = read_frame(path_of_file(scene, influx_.file));
  } catch (const OutputError& e) {
    throw SceneError(located(scene, "influx." + std::to_string(influx) + ".file") + ": " + e.what() +
                     "; expected a .vtp of Barchan");
  }
  const auto name = std::find(frame.phase_names.begin(), frame.phase_names.end(), influx_.phase);
  if (name == frame.phase_names.end())
    refuse("has no phase \"" + influx_.phase + "\"; expected a frame of a run with it");
  const auto number = static_cast<std::int32_t>(name - frame.phase_names.begin());
  const FrameField *radii = field_of(frame, "radius", 1), *velocity = field_of(frame, "velocity", 3);
  if (!velocity) refuse("has no field velocity; expected a frame of a run");
  if (size_.differ() && !radii)
    refuse("has no field radius, and the grains of \"" + influx_.phase +
           "\" differ; expected a frame with output.fields = [\"radius\"]");
  double sum = 0.0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (frame.phase[i] != number) continue;
    const double y = frame.points[3 * i + up_], radius = radii ? radii->values[i] : 0.5 * size_.mean;
    const Vec3 v{velocity->values[3 * i], velocity->values[3 * i + 1], velocity->values[3 * i + 2]};
    const std::string which = "has particle " + std::to_string(frame.id[i]);
    if (!std::isfinite(y + v[0] + v[1] + v[2])) refuse(which + " at no finite place or velocity");
    if (!size_.has(2.0 * radius))
      refuse(which + " with the diameter " + brief(2.0 * radius) + " m; expected " + brief(size_.least()) + " to " +
             brief(size_.largest()) + " m, the diameters of the phase");
    const double through = inwards_ * v[axis_];
    if (!(through > 0.0) || y < ground_ || y > top_) continue;
    sum += through;
    patterns_.push_back({y, radius, sum, v});
  }
  if (patterns_.empty())
    refuse("has no grain of \"" + influx_.phase + "\" between " + "xyz"[up_] + " = " + brief(ground_) + " and " +
           brief(top_) + " m that moves inwards through the side; expected grains in flight");
}

Arrivals::Grain Arrivals::operator()(std::int64_t n) const {
  Random seeds(0x1f10ull + influx_.seed);
  Random random(seeds.next() ^ (0x9e3779b97f4a7c15ull * static_cast<std::uint64_t>(n + 1)));
  Grain grain;
  grain.wait = -mean_wait_ * std::log(1.0 - random.uniform(0.0, 1.0));
  grain.shares[0] = random.uniform(0.0, 1.0);
  if (!patterns_.empty()) {
    const double at = random.uniform(0.0, patterns_.back().weight);
    const auto found = std::upper_bound(patterns_.begin(), patterns_.end(), at,
                                        [](double weight, const Pattern& p) { return weight < p.weight; });
    const Pattern& pattern = found == patterns_.end() ? patterns_.back() : *found;
    grain.height = pattern.height;
    grain.radius = pattern.radius;
    grain.velocity = pattern.velocity;
    return grain;
  }
  grain.radius = 0.5 * size_.mean * relative_diameter(size_, random);
  if (influx_.box) {
    for (const std::size_t d : {1u, 2u}) grain.shares[d] = random.uniform(0.0, 1.0);
    grain.velocity = influx_.velocity;
    return grain;
  }
  // Heights are exponentially distributed between the ground and the top, where
  // the centre has room.
  const double low = ground_ + grain.radius, room = std::max(top_ - grain.radius - low, 0.0), h = *influx_.decay_height;
  grain.height = low - h * std::log(1.0 - random.uniform(0.0, 1.0) * -std::expm1(-room / h));
  const double speed = std::max(*influx_.speed + influx_.speed_spread * normal(random), slowest * *influx_.speed);
  const double angle = std::clamp(influx_.angle + influx_.angle_spread * normal(random), -80.0, 80.0);
  grain.velocity[axis_] = inwards_ * speed;
  grain.velocity[up_] = speed * std::tan(angle * std::numbers::pi / 180.0);
  return grain;
}

Vec3 Arrivals::again(std::int64_t n, std::int64_t attempt) const {
  Random seeds(0xa9a1full + influx_.seed);
  Random random(seeds.next() ^ (0x9e3779b97f4a7c15ull * static_cast<std::uint64_t>(n + 1)));
  random.skip(3 * static_cast<std::uint64_t>(attempt));
  Vec3 shares;
  for (double& share : shares) share = random.uniform(0.0, 1.0);
  return shares;
}

GrainSource::GrainSource(const Scene& scene, const Layout& layout, std::size_t influx)
    : scene_(scene),
      layout_(layout),
      influx_(scene.influxes[influx]),
      phase_(number_of(scene, influx_.phase)),
      up_(up_axis(scene.domain)),
      axis_(axis_of_influx(scene.domain, influx_)),
      side_(influx_.box                       ? 0.5 * (influx_.box->min[axis_] + influx_.box->max[axis_])
            : is_upper(scene.domain, influx_) ? layout.domain.high[axis_]
                                              : layout.domain.low[axis_]),
      arrivals_(scene, influx, layout.dimensions == 2 ? layout.slab : 1.0),
      name_(name_of(scene, influx)),
      where_(influx_.box ? "into the box of influx." + std::to_string(influx) : "through " + word_of(*influx_.side)),
      by_particles_(scene.phases.size(), 0) {
  for (const Fill& fill : scene.fills) {
    const std::size_t wall = number_of(scene, fill.phase);
    if (!layout.phases[wall].moves() && touch_as_spheres(layout, phase_, wall) &&
        !std::holds_alternative<SidesShape>(fill.shape) && !touched_by_surface(scene, scene.phases[wall], fill.shape))
      by_particles_[wall] = 1;
  }
}

void GrainSource::begin(State& state, const std::vector<ParticleBlock>&) {
  place_ = state.departed.size();
  state.departed.emplace_back();
  state.departed.back().phase = static_cast<std::int64_t>(phase_);
  state.phases[phase_].number_may_change();
  next_ = influx_.start + arrivals_(0).wait;
}

void GrainSource::attach(Workspace& w) {
  w_ = &w;
  room_.emplace(scene_, layout_, phase_, 0.5 * layout_.phases[phase_].largest_size);
}

void GrainSource::schedule(Schedule& s) {
  Touches touches;
  for (std::size_t k = 0; k < layout_.phases.size(); ++k) {
    const PlanPhase& p = layout_.phases[k];
    if (k == phase_) touches.push_back(p.all_fields());
    else if (p.sphere_records || by_particles_[k] != 0) touches.push_back({p.name, FieldSet(p.fields), {}});
  }
  s.add({stage::walls, influx_.phase + ", influx " + where_, touches, [this] { enter(); }});
}

/// Whether a sphere at a place would overlap no other one, those of walls on
/// other ranks too, no wall and no body.
bool GrainSource::has_room(const Vec3& x, double radius) {
  constexpr double rounding = 1e-9;
  const bool outside = room_->nearest(x).gap < radius * (1.0 - rounding);
  return !Exchange().any(is_taken(x, radius)) && !outside;
}

/// m, a place along the side where a sphere has room between the sides of the
/// domain.
double GrainSource::across(double share, double radius) const {
  const std::size_t axis = axis_ == 0 ? 3 - up_ : 0;
  const double low = layout_.domain.low[axis] + (room_->has_side(axis, false) ? radius : 0.0),
               high = layout_.domain.high[axis] - (room_->has_side(axis, true) ? radius : 0.0);
  return low + share * std::max(high - low, 0.0);
}

/// Whether a particle of a wall is no sphere, but stands for a side of the
/// domain.
bool GrainSource::is_behind_side(const std::array<const double*, 3>& at, std::size_t k) const {
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d)
    if (!layout_.domain.periodic[d] && !(at[d][k] >= layout_.domain.low[d] && at[d][k] <= layout_.domain.high[d]))
      return true;
  return false;
}

/// Gathers the spheres of this rank that one may overlap which ends within
/// `reach` (m) of the side, on either side of it.
void GrainSource::gather(double reach) {
  constexpr double rounding = 1.0 + 1e-6;
  gathered_ = reach;
  at_side_.resize(layout_.phases.size());
  for (std::size_t q = 0; q < layout_.phases.size(); ++q) {
    const PlanPhase& other = layout_.phases[q];
    if (!other.sphere_records && by_particles_[q] == 0) continue;
    const PhaseParticles& p = w_->particles(q);
    const double* at = p.column(Field::position, static_cast<int>(axis_));
    const double* radii = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
    AtSide& there = at_side_[q];
    there.spheres.clear();
    there.looked_at = p.size();
    const double period = layout_.domain.periodic[axis_] ? layout_.domain.high[axis_] - layout_.domain.low[axis_] : 0.0;
    const auto away = [&](std::size_t k) {  // only a box may stand across a period
      const double way = at[k] - side_;
      return std::abs(period > 0.0 ? way - period * std::round(way / period) : way);
    };
    for (std::size_t k = 0; k < p.size(); ++k)
      if (away(k) < rounding * (reach + (radii ? radii[k] : 0.5 * other.largest_size)))
        there.spheres.push_back(static_cast<std::uint32_t>(k));
  }
}

/// Whether a sphere overlaps one at a place.
bool GrainSource::overlaps(std::size_t phase, std::size_t k, const Vec3& x, double radius) const {
  const PlanPhase& other = layout_.phases[phase];
  const PhaseParticles& p = w_->particles(phase);
  std::array<const double*, 3> at{};
  double squared = 0.0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    at[d] = p.column(Field::position, static_cast<int>(d));
    double apart = at[d][k] - x[d];
    const double period = layout_.domain.high[d] - layout_.domain.low[d];
    if (layout_.domain.periodic[d]) apart -= period * std::round(apart / period);
    squared += apart * apart;
  }
  if (!other.moves() && is_behind_side(at, k)) return false;
  const double touching = radius + (p.has(Field::radius) ? p.column(Field::radius)[k] : 0.5 * other.largest_size);
  return squared < touching * touching;
}

/// Whether some sphere of this rank overlaps one at a place.
bool GrainSource::is_taken(const Vec3& x, double radius) {
  const double reach = std::abs(x[axis_] - side_) + radius;
  if (!(reach <= gathered_)) gather(2.0 * reach);
  for (std::size_t q = 0; q < at_side_.size(); ++q) {
    const AtSide& there = at_side_[q];
    for (const std::uint32_t k : there.spheres)
      if (overlaps(q, k, x, radius)) return true;
    if (q != phase_) continue;
    for (std::size_t k = there.looked_at; k < w_->particles(q).size(); ++k)
      if (overlaps(q, k, x, radius)) return true;
  }
  return false;
}

/// Where a grain is `age` (s) after it passed the side.
Vec3 GrainSource::place_at_side(const Arrivals::Grain& grain, double age) const {
  Vec3 x{};
  x[axis_] = side_ + age * grain.velocity[axis_];
  x[up_] = grain.height + age * grain.velocity[up_];
  const std::size_t axis = axis_ == 0 ? 3 - up_ : 0;
  if (layout_.dimensions == 3) x[axis] = across(grain.shares[0], grain.radius) + age * grain.velocity[axis];
  return x;
}

Vec3 GrainSource::place_in_box(const Arrivals::Grain& grain) const {
  Vec3 x{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    const double low = influx_.box->min[d] + grain.radius, high = influx_.box->max[d] - grain.radius;
    x[d] = low + grain.shares[d] * std::max(high - low, 0.0);
  }
  return x;
}

/// s, in which a grain goes its diameter: by its speed, or as it falls.
double GrainSource::passage(const Arrivals::Grain& grain) const {
  const double d = 2.0 * grain.radius;
  if (!influx_.box) return d / std::abs(grain.velocity[axis_]);
  return d / std::max(norm(grain.velocity), std::sqrt(2.0 * norm(scene_.domain.gravity) * d));
}

/// Puts a grain where it is `age` (s) after it was due; false: its place is taken.
bool GrainSource::place(const Arrivals::Grain& grain, double age) {
  const Vec3 x = influx_.box ? place_in_box(grain) : place_at_side(grain, age);
  if (!has_room(x, grain.radius)) return false;
  PhaseParticles& p = w_->particles(phase_);
  const std::size_t k = p.create(1, w_->state.ids);
  for (int d = 0; d < layout_.dimensions; ++d) {
    p.column(Field::position, d)[k] = x[static_cast<std::size_t>(d)];
    p.column(Field::velocity, d)[k] = grain.velocity[static_cast<std::size_t>(d)];
  }
  if (p.has(Field::radius)) p.column(Field::radius)[k] = grain.radius;
  const double m = p.mass_of(k);
  Departed& departed = w_->state.departed[place_];
  if (departed.particles-- == 0) departed.first = w_->state.time;
  departed.mass -= m;
  ++entered_.particles;
  entered_.mass += m;
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    const double v = grain.velocity[d];
    departed.momentum[d] -= m * v;
    departed.kinetic -= 0.5 * m * v * v;
    departed.potential += m * layout_.phases[phase_].weight_share * scene_.domain.gravity[d] * x[d];
    entered_.momentum[d] += m * v;
    entered_.energy += 0.5 * m * v * v;
  }
  return true;
}

void GrainSource::enter() {
  const double now = w_->state.time;
  gathered_ = 0.0;
  room_->move(w_->state, w_->wall_motions);
  while (next_ <= std::min(now, influx_.end.value_or(now))) {
    waiting_.push_back({drawn_, next_, next_});
    next_ += arrivals_(++drawn_).wait;
  }
  if (influx_.end && now > *influx_.end) {
    given_up_ += static_cast<std::int64_t>(waiting_.size());
    waiting_.clear();
  }
  std::size_t kept = 0;
  for (Waiting one : waiting_) {
    Arrivals::Grain grain = arrivals_(one.number);
    const double pause = passage(grain);
    // One that finds its place taken enters later, at the side or elsewhere in the box.
    const bool first = one.attempts == 0;
    if (influx_.box && !first) grain.shares = arrivals_.again(one.number, one.attempts);
    if (one.again <= now) {
      if (place(grain, first ? now - one.since : 0.0)) continue;
      one.again = now + 0.5 * pause;
      ++one.attempts;
    }
    if (now > one.since + patience * pause) {
      ++given_up_;
      continue;
    }
    waiting_[kept++] = one;
  }
  waiting_.resize(kept);
}

void GrainSource::history(HistoryRow& row) const { add_passed(row, name_ + "_in", layout_.dimensions, entered_); }

void GrainSource::report(Warnings& warnings) const {
  if (given_up_ == 0) return;
  warnings.add("no room " + name_, brief(static_cast<double>(given_up_)) + " of " + brief(static_cast<double>(drawn_)) +
                                       " grains of \"" + influx_.phase + "\" found no room to enter " + where_ +
                                       ": others are in their places, and the flux is so much less; " +
                                       (influx_.box ? "make the box larger or the velocity higher"
                                                    : "raise influx.above over the bed that stands at the side") +
                                       ", or lower influx.flux");
}

void GrainSource::archive(Archive& a) {
  a.number(name_ + " next", next_);
  a.number(name_ + " drawn", drawn_);
  a.number(name_ + " given up", given_up_);
  a.number(name_ + " entered", entered_);
  std::uint64_t count = waiting_.size();
  a.number(name_ + " waiting", count);
  waiting_.resize(count);
  a.values(name_ + " those that wait", waiting_.data(), waiting_.size());
}

}  // namespace barchan
