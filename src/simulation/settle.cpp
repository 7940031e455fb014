#include "simulation/settle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/errors.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

namespace {

constexpr double at_rest = 1e-3;     // of sqrt(g d): the fastest grain of a bed at rest
constexpr double restitution = 0.2;  // while they settle
constexpr double loose = 1.35;       // height of the lattice over that of the bed, for equal grains
const char* const box_name = "settling_box";

/// The box that a fill's grains fall into, and its height when they have settled.
struct Container {
  Vec3 low{}, high{};
  double from = 0.0;  // m, where the grains begin
};

Container container_of(const Scene& scene, const Fill& fill, std::size_t k) {
  Container c;
  c.low = scene.domain.origin;
  c.high = scene.domain.origin + scene.domain.size;
  c.from = c.low[1];
  if (const auto* box = std::get_if<BoxShape>(&fill.shape)) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d) {
      if (d != 1) c.low[d] = std::max(c.low[d], box->min[d]);
      c.high[d] = std::min(c.high[d], box->max[d]);
    }
    c.from = std::max(c.low[1], box->min[1]);
  } else if (const auto* bed = std::get_if<BedShape>(&fill.shape)) {
    if (bed->dune && bed->dune->form == DuneShape::Form::formula)
      throw SceneError(scene.file + ": fill." + std::to_string(k) +
                       ".packing: a settled bed needs a height; expected a dune of another form");
    c.high[1] = c.low[1] + bed->depth + (bed->dune ? bed->dune->height : 0.0);
    c.from = c.low[1] + bed->from;
  }
  return c;
}

/// The scene in which the grains settle: they alone, the walls that they feel, and a box.
Scene settling_scene(const Scene& scene, std::size_t k, const Container& c) {
  const Fill& fill = scene.fills[k];
  const Phase& phase =
      *std::find_if(scene.phases.begin(), scene.phases.end(), [&](const Phase& p) { return p.name == fill.phase; });
  const SphereSize size = *phase.diameter();
  Scene s = scene;
  s.phases = {phase};
  std::get<GrainsKeys>(s.phases[0].own).restitution = std::min(restitution, phase.grains().restitution);
  s.interactions.clear();
  s.fills.clear();
  s.forcings.clear();
  s.measuring = {};
  s.output.fields.clear();
  s.time.fixed_step.reset();
  ContactLaw law = ContactLaw::linear;
  for (const Interaction& pair : scene.interactions) {
    if (pair.law == ContactLaw::kernel || (pair.a != phase.name && pair.b != phase.name)) continue;
    const std::string& other = pair.a == phase.name ? pair.b : pair.a;
    const auto found =
        std::find_if(scene.phases.begin(), scene.phases.end(), [&](const Phase& p) { return p.name == other; });
    if (other == phase.name) law = pair.law;
    else if (!found->if_wall()) continue;
    else s.phases.push_back(*found);
    s.interactions.push_back(pair);
  }
  for (std::size_t f = 0; f < k; ++f)
    for (const Phase& p : s.phases)
      if (p.if_wall() && p.name == scene.fills[f].phase && !std::holds_alternative<SidesShape>(scene.fills[f].shape))
        s.fills.push_back(scene.fills[f]);
  std::erase_if(s.phases, [&](const Phase& p) {
    return p.if_wall() &&
           std::none_of(s.fills.begin(), s.fills.end(), [&](const Fill& f) { return f.phase == p.name; });
  });
  std::erase_if(s.interactions, [&](const Interaction& pair) {
    const auto there = [&](const std::string& name) {
      return std::any_of(s.phases.begin(), s.phases.end(), [&](const Phase& p) { return p.name == name; });
    };
    return !there(pair.a) || !there(pair.b);
  });
  const double height =
      (c.high[1] - c.from) * loose * std::pow(1.0 + size.spread, scene.dimensions) + 3.0 * size.largest();
  s.domain.origin = c.low;
  s.domain.size = c.high - c.low;
  s.domain.size[1] = c.from - c.low[1] + height;
  Phase box;
  box.name = box_name;
  box.density = phase.density;
  box.own = WallKeys{};
  box.spacing = scene.spacing;
  Fill sides;
  sides.phase = box_name;
  SidesShape shape{{"bottom"}, 1};
  const char* const names[3][2] = {{"left", "right"}, {"", ""}, {"back", "front"}};
  for (const std::size_t d : {std::size_t{0}, std::size_t{2}}) {
    if (d == 2 && scene.dimensions == 2) continue;
    const double whole = scene.domain.size[d];
    s.domain.periodic[d] = scene.domain.periodic[d] && s.domain.size[d] > whole * (1.0 - 1e-9);
    if (!s.domain.periodic[d]) shape.sides.insert(shape.sides.end(), {names[d][0], names[d][1]});
  }
  s.domain.periodic[1] = false;
  sides.shape = shape;
  s.phases.push_back(box);
  Interaction at_box;
  at_box.a = phase.name;
  at_box.b = box_name;
  at_box.law = law;
  s.interactions.push_back(at_box);
  s.fills.push_back(sides);
  Fill grains = fill;
  BoxShape loosely{c.low, c.high};
  loosely.min[1] = c.from;
  loosely.max[1] = c.from + height - 1.01 * size.largest();
  grains.shape = loosely;
  grains.packing = Packing::square;
  // What disorder the sizes do not bring, a little motion does.
  const double shake = std::sqrt(norm(scene.domain.gravity) * size.mean), wave = 2.1 / size.mean;
  char formula[3][96];
  std::snprintf(formula[0], sizeof formula[0], "%.17g*sin(%.17g*(1.3*x + 0.7*y + 0.9*z))", shake, wave);
  std::snprintf(formula[1], sizeof formula[1], "%.17g*sin(%.17g*(0.8*x - 1.1*y + 1.7*z))", shake, wave);
  std::snprintf(formula[2], sizeof formula[2], "%.17g*sin(%.17g*(1.9*x + 0.6*y - 1.2*z))", shake, wave);
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d) grains.velocity[d] = {formula[d], 0.0};
  grains.log_profile.reset();
  s.fills.push_back(grains);
  s.time.end = 1e3;
  return s;
}

}  // namespace

SettledGrains settle(const Scene& scene, std::size_t k, const std::vector<ParticleBlock>&) {
  const Fill& fill = scene.fills[k];
  const Container c = container_of(scene, fill, k);
  const Scene s = settling_scene(scene, k, c);
  const auto blocks = generate(s);
  Simulation run(s, make_plan(s, blocks), blocks);
  const PhaseParticles& p = run.phases()[0];
  const double g = norm(scene.domain.gravity), d = p.mean_radius() * 2.0, height = s.domain.size[1];
  const double limit = at_rest * std::sqrt(g * d),
               latest = 20.0 * std::sqrt(2.0 * height / g) + 400.0 * std::sqrt(d / g);
  const auto fastest = [&] {
    double most = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      double v2 = 0.0;
      for (int a = 0; a < p.dimensions(); ++a) v2 += std::pow(p.column(Field::velocity, a)[i], 2);
      most = std::max(most, v2);
    }
    return std::sqrt(most);
  };
  // A grain on its way up is slow for a moment as well: two looks, apart by the fall through a tenth of a diameter.
  double next = std::sqrt(2.0 * height / g);
  for (int calm = 0; calm < 2;) {
    while (run.time() < next) run.step(next - run.time());
    calm = fastest() < limit ? calm + 1 : 0;
    next += std::sqrt(0.2 * d / g);
    if (run.time() > latest)
      throw SceneError(
          scene.file + ": fill." + std::to_string(k) +
          ".packing: the grains do not come to rest; expected friction above 0, and a restitution below 1");
  }
  std::vector<std::size_t> place(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) place[static_cast<std::size_t>(p.id()[i] - p.first_id())] = i;
  SettledGrains settled;
  for (const std::size_t i : place) {
    Vec3 x{};
    for (int a = 0; a < p.dimensions(); ++a) x[static_cast<std::size_t>(a)] = p.column(Field::position, a)[i];
    for (std::size_t a = 0; a < 3; ++a)
      if (s.domain.periodic[a]) x[a] -= s.domain.size[a] * std::floor((x[a] - s.domain.origin[a]) / s.domain.size[a]);
    settled.position.push_back(x);
    settled.radius.push_back(p.has(Field::radius) ? p.column(Field::radius)[i] : p.mean_radius());
  }
  return settled;
}

std::vector<ParticleBlock> make_particles(const Scene& scene) { return generate(scene, settle); }

}  // namespace barchan
