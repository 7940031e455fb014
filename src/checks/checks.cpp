#include "checks/checks.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "base/errors.hpp"
#include "scene/couplings.hpp"
#include "scene/formula.hpp"
#include "scene/keys.hpp"
#include "scene/nearest.hpp"
#include "scene/side_names.hpp"
#include "start/lattice.hpp"

namespace barchan {

namespace {

/// The element of a number from 0; null where `number` is none, as a section is asked for where an array stands.
const toml::node* element(const toml::array& array, const std::string& number) {
  std::size_t index = 0;
  const char* end = number.data() + number.size();
  const auto [rest, error] = std::from_chars(number.data(), end, index);
  return error == std::errc() && rest == end ? array.get(index) : nullptr;
}

}  // namespace

const toml::node* Report::find(const std::string& dotted) const {
  const toml::node* node = &document_;
  std::size_t begin = 0;
  while (node && begin <= dotted.size()) {
    const std::size_t end = std::min(dotted.find('.', begin), dotted.size());
    const std::string part = dotted.substr(begin, end - begin);
    if (const toml::table* table = node->as_table()) node = table->get(part);
    else if (const toml::array* array = node->as_array()) node = element(*array, part);
    else node = nullptr;
    begin = end + 1;
  }
  return node;
}

bool Report::has(const std::string& dotted) const { return find(dotted) != nullptr; }

bool Report::is_section(const std::string& dotted) const {
  const toml::node* node = find(dotted);
  return node && node->is_table();
}

void Report::operator()(const std::string& dotted, const std::string& what) const {
  std::string place = dotted;
  const toml::node* node = find(place);
  while (!node && place.find('.') != std::string::npos) {
    place = place.substr(0, place.rfind('.'));
    node = find(place);
  }
  problems_.add(node ? node->source() : document_.source(), dotted, what);
}

void check_side_names(const std::vector<std::string>& sides, const std::string& dotted, const Scene& scene,
                      const Report& report) {
  if (report.touched(dotted)) return;  // a word is no side
  for (const std::string& side : sides) {
    const bool deep = scene.dimensions == 2 && (side == "front" || side == "back");
    const std::size_t axis = deep ? 2
                             : scene.dimensions == 2 && side != "left" && side != "right"
                                 ? 1
                                 : side_at(scene.domain, side).axis;
    if (axis == 2 && scene.dimensions == 2)
      report(dotted, "\"" + side + "\" needs three dimensions; expected \"bottom\", \"top\", \"left\" or \"right\"");
    else if (scene.domain.periodic[axis])
      report(dotted, "\"" + side + "\" lies on the periodic axis " + std::string(1, static_cast<char>('x' + axis)) +
                         "; expected a side of an axis that is not periodic");
  }
}

namespace {

std::vector<std::string> phase_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const Phase& phase : scene.phases) names.push_back(phase.name);
  return names;
}

}  // namespace

std::string unknown_phase(const std::string& name, const Scene& scene) {
  const std::vector<std::string> names = phase_names(scene);
  return "there is no phase \"" + shortened(name) + "\"; expected " +
         (names.empty() ? "a phase of [phases]" : one_of(names)) + did_you_mean(nearest(name, names));
}

namespace {

/// A key of another kind of phase; a phase that no fill mentions.
void check_phases(const Scene& scene, const Report& report) {
  if (scene.phases.empty() && !report.touched("phases"))
    report("phases", "no phase; expected at least one section [phases.NAME]");
  for (const Phase& phase : scene.phases) {
    const std::string dotted = "phases." + phase.name;
    if (report.touched(dotted + ".kind")) continue;
    const std::string kind = phase.kind_word();
    for (const Key* key : keys_of("phases")) {
      const std::string here = dotted + "." + std::string(key->name);
      if (belongs_to_kind(*key, kind) || !report.has(here)) continue;
      const std::string_view instead = kind != "column"           ? ""
                                       : key->name == "roughness" ? "; that of its wind is a key of log-profile"
                                       : key->name == "velocity"
                                           ? "; its wind is friction-velocity, speed or log-profile"
                                           : "";
      report(here, "not a key of a phase of kind " + kind + "; expected in a phase of kind " +
                       kinds_text(*key, " or ") + " only" + std::string(instead));
    }
    const auto mentions = [&](const auto& section) { return section.phase == phase.name; };
    const bool filled = std::any_of(scene.fills.begin(), scene.fills.end(), mentions) ||
                        std::any_of(scene.influxes.begin(), scene.influxes.end(), mentions);
    if (!filled && phase.has_particles() && !report.touched("fill"))
      report(dotted, "no particle; expected a [[fill]] with phase = \"" + phase.name + "\"");
  }
}

void check_interactions(const Scene& scene, const Report& report) {
  const bool rigid = std::any_of(scene.phases.begin(), scene.phases.end(),
                                 [](const Phase& p) { return p.kind() == PhaseKind::rigid; });  // moves without others
  if (scene.interactions.empty() && !rigid && !report.touched("interactions"))
    report("interactions", "no pair of phases; expected at least one, as in air-sand = 2.5");
  std::vector<const Interaction*> seen;
  for (const Interaction& pair : scene.interactions) {
    const std::string name = pair.b.empty() ? pair.a : pair.a + "-" + pair.b;
    const std::string dotted = "interactions." + name;
    if (pair.b.empty() || pair.b.find('-') != std::string::npos) {
      report(dotted, "not a pair of phases; expected two names with a dash between them, as in air-sand" +
                         did_you_mean(nearest(name, {"kernel"})));
      continue;
    }
    bool known = true;
    for (const std::string& phase : {pair.a, pair.b}) {
      if (find_phase(scene, phase)) continue;
      if (known || pair.a != pair.b) report(dotted, unknown_phase(phase, scene));
      known = false;
    }
    if (!known) continue;
    for (const Interaction* other : seen)
      if (other->a == pair.b && other->b == pair.a)
        report(dotted, "the pair is given twice; expected either " + name + " or " + other->a + "-" + other->b);
    seen.push_back(&pair);
    const bool walls =
        find_phase(scene, pair.a)->kind() == PhaseKind::wall && find_phase(scene, pair.b)->kind() == PhaseKind::wall;
    if (walls) report(dotted, "walls do not interact; expected at least one phase of another kind");
  }
  for (const auto& pair : scene.apart) {
    const std::string dotted = "interactions." + pair[0] + "-" + pair[1];
    for (const std::string& name : pair)
      if (!find_phase(scene, name) && !report.touched(dotted)) report(dotted, unknown_phase(name, scene));
    for (const Interaction& other : scene.interactions)
      if (other.a == pair[1] && other.b == pair[0] && !report.touched(dotted))
        report(dotted, "the pair is given twice; expected either " + pair[0] + "-" + pair[1] + " or " + other.a + "-" +
                           other.b);
  }
  for (const Phase& phase : scene.phases) {
    const bool alone = std::none_of(scene.interactions.begin(), scene.interactions.end(), [&](const Interaction& pair) {
      return pair.a == phase.name || pair.b == phase.name;
    });
    if (phase.kind() == PhaseKind::wall && alone && !report.touched("interactions") &&
        !report.touched("phases." + phase.name + ".kind"))
      report("phases." + phase.name,
             "nothing interacts with this wall; expected an entry of [interactions] with \"" + phase.name + "\"");
  }
}

void check_open(const Scene& scene, const Report& report) {
  if (report.touched("domain.open")) return;
  const auto& open = scene.domain.open;
  if (std::find(open.begin(), open.end(), "none") == open.end()) check_side_names(open, "domain.open", scene, report);
  else if (open.size() > 1) report("domain.open", "\"none\" with a side; expected it alone, or sides only");
}

/// On a periodic axis a sphere may touch another one on both sides, but not itself.
void check_room_for_a_sphere(const Scene& scene, const Report& report, std::size_t axis) {
  if (report.touched("interactions") || report.touched("phases")) return;
  for (const Interaction& pair : scene.interactions) {
    const Phase* phase = pair.a == pair.b && of_spheres(pair) ? find_phase(scene, pair.a) : nullptr;
    if (!phase || !phase->diameter() || !(scene.domain.size[axis] < phase->diameter()->largest() * (1.0 - 1e-9)))
      continue;
    char text[256];
    std::snprintf(text, sizeof text,
                  "%.10g m along the periodic axis %c is less than the largest diameter of \"%s\": such a sphere "
                  "overlaps its own image; expected at least %.10g m, or a smaller diameter",
                  scene.domain.size[axis], static_cast<char>('x' + axis), pair.a.c_str(), phase->diameter()->largest());
    report("domain.size", text);
  }
}

/// A whole number of spacings along a periodic axis, and room for two of the largest kernels.
void check_domain(const Scene& scene, const Report& report) {
  if (report.touched("domain.size") || report.touched("spacing") || report.touched("dimensions") ||
      scene.spacing <= 0.0)
    return;
  if (scene.dimensions == 2 && scene.domain.periodic[2])
    report("domain.periodic", "there is no z in two dimensions; expected x or y");
  double cells = 1.0;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis)
    cells *= scene.domain.size[axis] / scene.spacing;
  if (cells > 1e9) {
    char text[160];
    std::snprintf(text, sizeof text, "%.10g m makes room for %.3g particles in the domain; expected at most 10^9",
                  scene.spacing, cells);
    report("spacing", text);
    return;
  }
  const Interaction* widest = nullptr;
  const auto reach = [&](const Interaction& pair) { return pair.radius * spacing_of(scene, pair); };
  for (const Interaction& pair : scene.interactions)
    if (!of_spheres(pair) && (!widest || reach(pair) > reach(*widest))) widest = &pair;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    if (!scene.domain.periodic[axis]) continue;
    const std::string misfit = misfit_of_period(scene, axis);
    if (!misfit.empty()) report("domain.size", misfit);
    check_room_for_a_sphere(scene, report, axis);
    if (!widest || report.misread("interactions") || !(widest->radius > 0.0)) continue;
    const double least = 2.0 * reach(*widest);
    if (scene.domain.size[axis] > least) continue;
    char numbers[160];
    std::snprintf(numbers, sizeof numbers, "%.10g m along the periodic axis %c is too short for the kernel of ",
                  scene.domain.size[axis], static_cast<char>('x' + axis));
    char bound[64];
    std::snprintf(bound, sizeof bound, "; expected more than two kernel radii, %.10g m", least);
    report("domain.size", numbers + widest->a + "-" + widest->b + bound);
  }
}

bool fills_top_or_bottom(const Scene& scene, const Phase& wall) {
  return std::all_of(scene.fills.begin(), scene.fills.end(), [&](const Fill& fill) {
    const auto* shape = std::get_if<SidesShape>(&fill.shape);
    return fill.phase != wall.name || (shape && std::all_of(shape->sides.begin(), shape->sides.end(),
                                                            [](const auto& s) { return s == "bottom" || s == "top"; }));
  });
}

/// A held force along x: all that drives the fluid is known, and its sum is what the scene says.
void check_held_force(const Scene& scene, const Report& report, std::size_t number) {
  const std::string dotted = "forcing." + std::to_string(number), at = dotted + ".hold";
  const Forcing& forcing = scene.forcings[number];
  const Phase& fluid = *find_phase(scene, forcing.phase);
  const auto tell = [&](const std::string& what) {
    if (!report.touched(at)) report(at, what);
  };
  const bool by_walls = forcing.hold == Hold::stress;
  if (!report.has(dotted + ".friction-velocity") && !report.touched(dotted + ".friction-velocity"))
    report(dotted + ".friction-velocity", "missing; expected a number (m/s) or a formula in t with such a hold");
  if (!report.touched("domain.periodic") && !scene.domain.periodic[0])
    tell("the force is held along x, and x is not periodic; expected domain.periodic = [\"x\"]");
  if (!report.touched("domain.gravity") && scene.domain.gravity[0] != 0.0)
    tell("gravity pulls along x too; expected nothing else that drives \"" + fluid.name + "\" along x");
  for (std::size_t other = 0; other < scene.forcings.size(); ++other)
    if (other != number && scene.forcings[other].phase == fluid.name && scene.forcings[other].hold == Hold::none)
      tell("forcing." + std::to_string(other) + " drives \"" + fluid.name +
           "\" too; expected nothing else with a force that is held");
  if (report.misread("interactions") || report.misread("phases")) return;
  bool pulls = false;
  for (const Phase& wall : scene.phases) {
    if (wall.kind() != PhaseKind::wall || !entry_between(scene, fluid, wall)) continue;
    const Expression& along = wall.wall().velocity[0];
    if (along.is_formula() || along.value != 0.0 || motion_of(scene, wall))
      tell("the wall \"" + wall.name +
           "\" moves along x, and what it gives the fluid is not known beforehand; "
           "expected walls at rest, or no hold where a moving wall drives the fluid");
    if (!wall.wall().shear_stress || (*wall.wall().shear_stress)[0] == 0.0) continue;
    pulls = true;
    if (!fills_top_or_bottom(scene, wall))
      tell(
          "the wall \"" + wall.name +
          "\" with shear-stress is not only the domain's bottom or top, and its area is not known beforehand; expected "
          "fills with sides = [\"bottom\"] or [\"top\"]");
  }
  if (by_walls && !pulls)
    tell("no wall with shear-stress along x pulls \"" + fluid.name +
         "\"; expected such a wall, or hold = \"pressure-gradient\"");
  if (!by_walls && pulls)
    tell("a wall with shear-stress along x pulls \"" + fluid.name +
         "\" too; expected no such wall, or hold = \"stress\"");
  if (!by_walls || !pulls || !report.has(dotted + ".friction-velocity") ||
      report.touched(dotted + ".friction-velocity") || report.touched("time.end"))
    return;
  const double given = wall_pull(scene, fluid);
  const Formula friction_velocity(forcing.friction_velocity);
  const int times = friction_velocity.is_constant() ? 0 : 1000;
  for (int step = 0; step <= times; ++step) {
    const double t = times > 0 ? scene.time.end * step / times : 0.0, u = friction_velocity({}, t);
    const double wanted = fluid.density * u * std::abs(u);
    if (given * wanted >= 0.0 && std::abs(given) <= 1.01 * std::abs(wanted)) continue;
    return tell("walls with shear-stress alone pull with " + number_text(given) + " Pa, and rho u*^2 is " +
                number_text(wanted) + " Pa" + (times > 0 ? " at t = " + number_text(t) + " s" : std::string()) +
                "; expected walls that pull with that at most, or a larger friction-velocity");
  }
}

/// A hold needs a fluid and a periodic axis; a forcing says one thing.
void check_hold(const Scene& scene, const Report& report, std::size_t number) {
  const std::string dotted = "forcing." + std::to_string(number);
  const Forcing& forcing = scene.forcings[number];
  int ways = 0;
  for (const char* key : {".hold", ".acceleration", ".rate"}) ways += report.has(dotted + key);
  if (ways != 1) report(dotted, "expected one of acceleration, hold and rate");
  if (report.has(dotted + ".velocity") && !report.has(dotted + ".rate"))
    report(dotted + ".velocity", "nothing brings the fluid to it; expected rate too");
  if (report.has(dotted + ".box") && report.has(dotted + ".hold"))
    report(dotted + ".box", "what is held is that of the whole fluid; expected no such key with hold");
  if (const Phase* phase = find_phase(scene, forcing.phase);
      phase && report.has(dotted + ".rate") && phase->kind() != PhaseKind::fluid)
    report(dotted + ".rate", "\"" + phase->name + "\" is no fluid; expected a phase of kind fluid");
  for (std::size_t d = 0; forcing.box && d < static_cast<std::size_t>(scene.dimensions); ++d)
    if (!(forcing.box->min[d] < forcing.box->max[d]) && !report.touched(dotted))
      report(dotted + ".box", "the box is empty; expected min < max");
  for (std::size_t d = 0; forcing.box && d < static_cast<std::size_t>(scene.dimensions); ++d) {
    const double low = scene.domain.origin[d], high = low + scene.domain.size[d];
    if (!report.touched(dotted) && !report.touched("domain") &&
        (forcing.box->max[d] <= low || forcing.box->min[d] >= high))
      report(dotted + ".box", "the box lies outside the domain, which along " + std::string(1, "xyz"[d]) +
                                  " goes from " + number_text(low) + " to " + number_text(high) + " m");
  }
  if (report.has(dotted + ".friction-velocity") && !forcing.holds_force() && !report.touched(dotted + ".hold"))
    report(dotted + ".friction-velocity",
           "only a force that is held has one; expected hold = \"stress\" or \"pressure-gradient\"");
  if (forcing.hold == Hold::none || report.touched(dotted + ".hold")) return;
  const Phase* phase = find_phase(scene, forcing.phase);
  if (phase && phase->kind() != PhaseKind::fluid)
    report(dotted + ".hold", "\"" + phase->name + "\" is no fluid; expected a phase of kind fluid");
  const auto& periodic = scene.domain.periodic;
  if (!report.touched("domain.periodic") && !periodic[0] && !periodic[1] && !periodic[2])
    report(dotted + ".hold", "no axis is periodic; expected domain.periodic = [\"x\"], along which the fluid flows on");
  for (std::size_t other = 0; other < number; ++other)
    if (scene.forcings[other].hold != Hold::none && scene.forcings[other].phase == forcing.phase)
      report(dotted + ".hold", (forcing.hold == Hold::bulk_speed && scene.forcings[other].hold == Hold::bulk_speed
                                    ? "the mean velocity of \"" + forcing.phase + "\" is held twice"
                                    : "\"" + forcing.phase + "\" is held twice") +
                                   "; expected one such forcing");
  if (phase && phase->kind() == PhaseKind::fluid && forcing.holds_force()) check_held_force(scene, report, number);
}

void check_forcings(const Scene& scene, const Report& report) {
  for (std::size_t k = 0; k < scene.forcings.size(); ++k) {
    check_hold(scene, report, k);
    const std::string dotted = "forcing." + std::to_string(k) + ".phase";
    if (report.touched(dotted) || !report.has(dotted)) continue;
    const Phase* phase = find_phase(scene, scene.forcings[k].phase);
    if (!phase) report(dotted, unknown_phase(scene.forcings[k].phase, scene));
    else if (phase->kind() == PhaseKind::wall)
      report(dotted, "a force does not act on a wall; expected a phase of another kind");
  }
}

}  // namespace

void check(const toml::table& document, const Scene& scene, Problems& problems) {
  const Report report(document, problems);
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const std::string dotted = "fill." + std::to_string(k) + ".phase";
    if (report.has(dotted) && !report.touched(dotted) && !find_phase(scene, scene.fills[k].phase))
      report(dotted, unknown_phase(scene.fills[k].phase, scene));
  }
  check_formulas(document, scene, report);
  check_fills(scene, report);
  check_phases(scene, report);
  check_interactions(scene, report);
  problems.end_of_reading();  // names that mean nothing count as such: who meets whom is not known then
  check_open(scene, report);
  check_domain(scene, report);
  check_forcings(scene, report);
  check_flow_ends(scene, report);
  check_influxes(scene, report);
  check_physics(scene, report);
  check_bodies(scene, report);
  check_rigid(scene, report);
  check_motions(scene, report);
  check_columns(scene, report);
  check_walls(scene, report);
  check_up(scene, report);
  check_measuring(scene, report);
  check_run(scene, report);
}

}  // namespace barchan
