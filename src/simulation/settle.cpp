#include "simulation/settle.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "engine/team.hpp"
#include "scene/couplings.hpp"
#include "scene/settling_scene.hpp"
#include "scene/side_names.hpp"
#include "simulation/grains_file.hpp"
#include "simulation/settle_room.hpp"
#include "simulation/simulation.hpp"
#include "start/ball_surfaces.hpp"
#include "start/ground.hpp"
#include "start/places.hpp"
#include "start/shapes.hpp"
#include "start/shared_start.hpp"

namespace barchan {

namespace {

// A bed rests when its farthest grain goes less than this in sqrt(d/g), twice, and when in a trial no grain goes
// farther than `at_place` (diameters). A trial begins as the run does, with the contacts that were, and nothing slows
// the grains.
constexpr double at_rest = 2e-4, at_place = 5e-3;
constexpr double trial_time = 6.0;  // sqrt(d/g)
constexpr int most_trials = 8;      // deep beds may always find a grain that goes on a little
// sqrt(d/g): in this time what slows the grains takes a speed to its e-th part; at the begin of a stage, when stiffer
// contacts push them apart, and else.
constexpr double slow_push = 0.05, slow_fall = 2.0, push = 0.5;
constexpr double soft_overlap = 0.002;  // diameters: of the lowest grains in the soft bed
constexpr double soft_impact = 0.03;    // diameters: of grains that fall into it
constexpr double stiffer = 8.0;         // contacts from stage to stage

/// The loose lattice from which the grains fall: `s` is the scene in which they do.
Fill loose_lattice(const Scene& s, const Fill& fill, const SettlingRoom& c, const SphereSize& size) {
  Fill grains = fill;
  BoxShape loosely{c.low, c.high};
  const std::size_t up = up_axis(s.domain);
  loosely.min[up] = c.from;
  loosely.max[up] = s.domain.origin[up] + s.domain.size[up] - 1.01 * size.largest();
  grains.shape = loosely;
  grains.packing = Packing::square;
  // What disorder the sizes do not bring, a little motion does.
  const double shake = std::sqrt(norm(s.domain.gravity) * size.mean), wave = 2.1 / size.mean;
  char formula[3][96];
  std::snprintf(formula[0], sizeof formula[0], "%.17g*sin(%.17g*(1.3*x + 0.7*y + 0.9*z))", shake, wave);
  std::snprintf(formula[1], sizeof formula[1], "%.17g*sin(%.17g*(0.8*x - 1.1*y + 1.7*z))", shake, wave);
  std::snprintf(formula[2], sizeof formula[2], "%.17g*sin(%.17g*(1.9*x + 0.6*y - 1.2*z))", shake, wave);
  for (std::size_t d = 0; d < static_cast<std::size_t>(s.dimensions); ++d) grains.velocity[d] = {formula[d], 0.0};
  grains.log_profile.reset();
  return grains;
}

/// Walls as they are; grains of the lattice that are over the ground of the walls, not much higher than they shall lie.
/// `thickness`: becomes that of the bed where it is largest (m).
std::vector<ParticleBlock> begin_loosely(const Scene& scene, const Fill& fill, const Scene& s, const SettlingRoom& c,
                                         double& thickness) {
  const SphereSize size = *s.phases[0].diameter();
  const std::size_t up = up_axis(scene.domain), across = across_axis(scene.domain);
  Scene alone = s;
  alone.fills = {loose_lattice(s, fill, c, size)};
  std::vector<ParticleBlock> blocks = generate(s), grains = generate(alone);
  const double stretch = loose_lattice_height * std::pow(size.largest_share(), s.dimensions),
               bottom = scene.domain.origin[up];
  // Fixed spheres: those of walls whose particles lie in the domain.
  const PeriodicSpace space(s.domain);
  const auto width = [](const Phase& p) { return p.diameter() ? p.diameter()->largest() : p.spacing; };
  double widest = size.largest();
  for (const Phase& p : s.phases) widest = std::max(widest, width(p));
  Places fixed(space, widest);
  for (std::size_t p = 1; p < s.phases.size(); ++p)
    if (s.phases[p].name != settling_box)
      for (const Vec3& x : blocks[p].position) fixed.add(space.wrapped(x), width(s.phases[p]), 0);
  std::vector<Ground> floors;
  for (const Fill& f : s.fills)
    if (const auto* bed = std::get_if<BedShape>(&f.shape)) floors.emplace_back(*bed, scene.domain);
  std::optional<Ground> top;
  if (const auto* bed = std::get_if<BedShape>(&fill.shape)) top.emplace(*bed, scene.domain);
  Scene in_walls = s;  // the lattice fits the box
  std::erase_if(in_walls.fills, [](const Fill& f) { return f.phase == settling_box; });
  const NoRoom none(in_walls, s.phases[0], 0.5 * size.largest());
  ParticleBlock& kept = blocks[0];
  const ParticleBlock& all = grains[0];
  for (std::size_t i = 0; i < all.position.size(); ++i) {
    const Vec3& x = all.position[i];
    double floor = c.from;
    for (const Ground& g : floors) floor = std::max(floor, bottom + g.height(x[0], x[across]));
    const double high = top ? bottom + top->height(x[0], x[across]) : c.high[up];
    if (!floors.empty() && x[up] < floor) continue;
    if (fixed.owner_near(x, size.largest(), 1.0) >= 0 || none.at(x)) continue;
    if (x[up] > floor + (high - floor) * stretch + 2.0 * size.largest()) continue;
    thickness = std::max(thickness, high - floor);
    kept.position.push_back(x);
    kept.velocity.push_back(all.velocity[i]);
    if (!all.radius.empty()) kept.radius.push_back(all.radius[i]);
  }
  if (kept.position.empty())
    throw SceneError(scene.file + ": fill: no room for a settled bed of \"" + fill.phase +
                     "\" over the walls; expected a higher bed");
  return blocks;
}

/// Walls as they are, and the grains of the fill's file.
std::vector<ParticleBlock> begin_with_file(const Scene& scene, std::size_t k, const Scene& s) {
  std::vector<ParticleBlock> blocks = generate(s);
  SettledGrains grains = grains_of_file(scene, k);
  blocks[0].velocity.assign(grains.position.size(), Vec3{});
  blocks[0].position = std::move(grains.position);
  blocks[0].contacts = std::move(grains.contacts);
  if (s.phases[0].diameter()->spread > 0.0) blocks[0].radius = std::move(grains.radius);
  return blocks;
}

/// The farthest way of a grain since its place was told last, which is told anew (m).
double way_of(const PhaseParticles& p, std::vector<Vec3>& place) {
  double most = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    Vec3& x = place[static_cast<std::size_t>(p.id()[i] - p.first_id())];
    double way2 = 0.0;
    for (int a = 0; a < p.dimensions(); ++a) {
      const double now = p.column(Field::position, a)[i], way = now - x[static_cast<std::size_t>(a)];
      way2 += way * way;
      x[static_cast<std::size_t>(a)] = now;
    }
    most = std::max(most, way2);
  }
  return std::sqrt(most);
}

/// How grains move while they settle.
struct Rest {
  bool pushed = false;      // slowed more at the begin
  bool trial = false;       // not slowed, for `trial_time`; else until they rest
  double first_look = 0.0;  // sqrt(d/g)
  double latest = 0.0;      // s
};
/// Lets the grains of the first phase move. Their places and contacts become those of the blocks. Returns the farthest
/// way of a grain (m), nothing when they do not come to rest before `latest`.
std::optional<double> rest(const Scene& s, std::vector<ParticleBlock>& blocks, const Rest& how, Team& team) {
  Simulation run(s, make_plan(s, blocks), blocks);
  PhaseParticles& p = run.phases()[0];
  const double d = s.phases[0].diameter()->mean, unit = std::sqrt(d / norm(s.domain.gravity));
  const auto damp = [&] {
    const double slow = how.pushed && run.time() < push * unit ? slow_push : slow_fall;
    const double share = std::exp(-run.last_step() / (slow * unit));
    for (const Field f : {Field::velocity, Field::angular_velocity})
      for (int a = 0; p.has(f) && a < p.components(f); ++a)
        for (std::size_t i = 0; i < p.size(); ++i) p.column(f, a)[i] *= share;
  };
  std::vector<Vec3> place = blocks[0].position;
  const auto go_to = [&](double time) {
    while (run.time() < time) {
      team.step([&] { run.step(time - run.time()); });
      if (!how.trial) damp();
    }
  };
  if (how.trial) go_to(trial_time * unit);
  // Sorting wraps grains into a periodic domain: a way of a period is none, and no grain rests in that moment.
  double next = how.first_look * unit;
  for (int calm = 0; !how.trial && calm < 2; next += unit) {
    go_to(next);
    calm = way_of(p, place) < at_rest * d ? calm + 1 : 0;
    if (run.time() > how.latest) return std::nullopt;
  }
  if (how.trial) way_of(p, place);
  ParticleBlock& block = blocks[0];
  place.swap(block.position);
  block.contacts = run.resting_contacts(0);
  block.velocity.assign(block.position.size(), Vec3{});
  double farthest = 0.0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    Vec3 way = block.position[i] - place[i];
    for (std::size_t a = 0; a < 3; ++a)
      if (s.domain.periodic[a]) way[a] -= s.domain.size[a] * std::round(way[a] / s.domain.size[a]);
    farthest = std::max(farthest, norm(way));
  }
  return farthest;
}

/// The places of the grains in the domain of the scene, less those outside of the fill's shape.
void cut(const Scene& scene, std::size_t k, const Scene& s, ParticleBlock& block) {
  for (Vec3& x : block.position)
    for (std::size_t a = 0; a < 3; ++a)
      if (s.domain.periodic[a]) x[a] -= s.domain.size[a] * std::floor((x[a] - s.domain.origin[a]) / s.domain.size[a]);
  if (block.radius.empty()) block.radius.assign(block.position.size(), 0.5 * s.phases[0].diameter()->mean);
  if (!std::holds_alternative<FileShape>(scene.fills[k].shape)) {
    SettledGrains grains{std::move(block.position), std::move(block.radius), std::move(block.contacts)};
    keep_inside(scene, k, grains);
    block.position = std::move(grains.position);
    block.radius = std::move(grains.radius);
    block.contacts = std::move(grains.contacts);
  }
  block.velocity.assign(block.position.size(), Vec3{});
}

/// The stiffnesses (N/m) through which the contacts go before they are those of the scene.
std::vector<double> soft_stages(const Scene& s, double thickness) {
  const SphereSize size = *s.phases[0].diameter();
  const double d = size.mean, g = norm(s.domain.gravity), fall = slow_fall * std::sqrt(g * d),
               mass = s.phases[0].density * std::numbers::pi / 6.0 * std::pow(size.largest(), 3),
               layers = std::max(1.0, thickness / d);
  const double first =
      std::max(layers * mass * g / (soft_overlap * d), 0.5 * mass * std::pow(fall / (soft_impact * d), 2));
  const GrainsKeys& keys = s.phases[0].grains();
  std::vector<double> stages;
  const double last = keys.stiffness ? *keys.stiffness : 300.0 * first;
  for (double k = first; k * 1.5 < last; k *= stiffer) stages.push_back(k);
  return stages;
}

/// The same with soft contacts of a stiffness.
Scene softened(Scene s, double stiffness) {
  for (Interaction& pair : s.interactions) pair.law = soft_contact_law;
  std::get<GrainsKeys>(s.phases[0].own).stiffness = stiffness;
  s.time.largest_speed = 2.0 * slow_fall * std::sqrt(norm(s.domain.gravity) * s.phases[0].diameter()->mean);
  return s;
}

}  // namespace

SettledGrains settle(const Scene& scene, std::size_t k, std::ostream* words) {
  const ComputedByAll alone;  // every rank makes the whole bed
  const SettlingRoom c = settling_room(scene, k);
  const Scene s = settling_scene(scene, k, c);
  double thickness = 0.0;
  const bool from_file = std::holds_alternative<FileShape>(scene.fills[k].shape);
  std::vector<ParticleBlock> blocks =
      from_file ? begin_with_file(scene, k, s) : begin_loosely(scene, scene.fills[k], s, c, thickness);
  const double unit = std::sqrt(s.phases[0].diameter()->mean / norm(s.domain.gravity)),
               fall = std::sqrt(2.0 * thickness / norm(s.domain.gravity)) / unit;
  std::vector<Scene> stages;
  if (!from_file)
    for (const double stiffness : soft_stages(s, thickness)) stages.push_back(softened(s, stiffness));
  stages.push_back(s);
  const double place = at_place * s.phases[0].diameter()->mean, latest = (400.0 + 20.0 * fall) * unit;
  TeamInside threads(blocks[0].position.size());
  const auto tell = [&](const std::string& what) {
    if (words != nullptr)
      *words << "settling  " << scene.fills[k].phase << ": " << blocks[0].position.size() << " grains, " << what
             << std::endl;
  };
  const auto settle_once = [&](std::size_t stage) {
    tell("contacts " + std::to_string(stage + 1) + " of " + std::to_string(stages.size()));
    const double first_look = stage == 0 && !from_file ? fall : 2.0 * push;
    if (!rest(stages[stage], blocks, {from_file || stage > 0, false, first_look, latest}, threads.team()))
      throw SceneError(
          scene.file + ": fill." + std::to_string(k) +
          ".packing: the grains do not come to rest; expected friction above 0, and a restitution below 1");
    if (stage == 0 || stage + 1 == stages.size()) cut(scene, k, s, blocks[0]);
  };
  for (std::size_t stage = 0; stage < stages.size() && !blocks[0].position.empty(); ++stage) settle_once(stage);
  Scene as_in_the_run = s;
  std::get<GrainsKeys>(as_in_the_run.phases[0].own).restitution =
      find_phase(scene, scene.fills[k].phase)->grains().restitution;
  for (int trials = 1; trials <= most_trials && !blocks[0].position.empty(); ++trials) {
    tell("trial " + std::to_string(trials));
    const std::size_t before = blocks[0].position.size();
    const auto way = rest(as_in_the_run, blocks, {false, true, 0.0, latest}, threads.team());
    cut(scene, k, s, blocks[0]);
    if (*way < place && blocks[0].position.size() == before) break;
  }
  return {std::move(blocks[0].position), std::move(blocks[0].radius), std::move(blocks[0].contacts)};
}

void SettledBeds::archive(Archive& a, const Scene& scene) {
  for (std::size_t k = 0; k < scene.fills.size(); ++k)
    if (scene.fills[k].packing == Packing::settled) {
      a.array("places of a settled bed", of_fill[k].position);
      a.array("radii of a settled bed", of_fill[k].radius);
      a.array("contacts of a settled bed", of_fill[k].contacts);
    }
}

std::vector<ParticleBlock> make_particles(const Scene& scene, std::ostream* words, SettledBeds* beds) {
  refuse_beds_in_one_place(scene);
  if (why_start_is_whole(scene).empty()) Exchange::share_out();
  return generate(scene, [&](const Scene& of, std::size_t fill, const std::vector<ParticleBlock>&) {
    if (of.fills[fill].packing != Packing::settled) return grains_of_file(of, fill);
    if (!beds) return settle(of, fill, words);
    const auto there = beds->of_fill.find(fill);
    if (there == beds->of_fill.end()) return beds->of_fill[fill] = settle(of, fill, words);
    return there->second;
  });
}

}  // namespace barchan
