// Bodies: keys that their formulation does not read, contacts of bodies, sets of their particles.
#include <algorithm>

#include "checks/checks.hpp"
#include "scene/contact_words.hpp"
#include "scene/couplings.hpp"

namespace barchan {
namespace {

void check_formulation(const Phase& phase, const Report& report) {
  const std::string dotted = "phases." + phase.name;
  const bool total = is_total(phase);
  const auto refuse = [&](const char* key, const char* other) {
    if (report.has(dotted + "." + key) && !report.touched(dotted + "." + key))
      report(dotted + "." + key, std::string("nothing reads it; expected formulation = \"") + other + "\" too");
  };
  for (const char* key : {"elasticity", "hourglass", "retardation", "wave-correction"})
    if (!total) refuse(key, "total-lagrangian");
  for (const char* key : {"artificial-viscosity", "artificial-viscosity-beta", "artificial-stress", "energy"})
    if (total) refuse(key, "updated-lagrangian");
}

/// restitution and friction, and what a contact of bodies has no use for.
void check_contact(const Interaction& pair, const Phase& a, const Phase& b, const Report& report) {
  const std::string dotted = "interactions." + pair.a + "-" + pair.b;
  const auto elastic = [](const Phase& p) { return p.kind() == PhaseKind::elastic; };
  if (pair.surfaces && (a.name == b.name || !elastic(a) || !elastic(b) || !touch_as_bodies(pair, a, b)))
    report(dotted + ".surfaces", a.name != b.name && elastic(a) && elastic(b)
                                     ? "nothing reads it without restitution; expected restitution too"
                                     : "only two elastic bodies touch so; expected no such key here");
  if (touches_itself(pair, a, b)) return;
  if (a.name == b.name && a.kind() == PhaseKind::elastic) {
    for (const char* key : {".restitution", ".friction"})
      if (report.has(dotted + key))
        report(dotted + key, "nothing reads it without restitution; expected restitution too");
    return;
  }
  if (!touch_as_bodies(pair, a, b)) {
    for (const char* key : {".restitution", ".friction"})
      if (report.has(dotted + key))
        report(dotted + key, bodies_may_touch(a, b)
                                 ? "nothing reads it without restitution; expected restitution too"
                                 : "only a body with another body or a wall has it; expected no such key here");
    return;
  }
  for (const char* key : {".radius", ".radius-in-metres", ".kernel"})
    if (report.has(dotted + key))
      report(dotted + key,
             "bodies touch where the spacings of their particles end; expected no such key with "
             "restitution or a total Lagrangian body");
}

/// The kinds of phases that a set may be of; any: somebody else tells.
enum class Holds { bodies_and_grains, bodies_and_walls, any };

/// Why the grains of a set may not stay; empty: they do.
std::string what_moves_grains_out(const Scene& scene, const Phase& grains) {
  const bool enter = std::any_of(scene.influxes.begin(), scene.influxes.end(),
                                 [&](const Influx& influx) { return influx.phase == grains.name; });
  if (enter) return "grains of \"" + grains.name + "\" enter by an [[influx]]";
  if (grains.diameter() && !scene.domain.open.empty())
    return "grains of \"" + grains.name + "\" may leave through domain.open";
  return {};
}

void check_set(const BodySet& set, const std::string& dotted, const Scene& scene, const Report& report, Holds holds) {
  if (report.touched(dotted) || !report.has(dotted + ".phase")) return;
  const Phase* phase = find_phase(scene, set.phase);
  if (!phase) return report(dotted + ".phase", unknown_phase(set.phase, scene));
  const bool body = phase->kind() == PhaseKind::elastic || phase->kind() == PhaseKind::rigid,
             walls = holds == Holds::bodies_and_walls,
             grains = holds == Holds::bodies_and_grains && phase->kind() == PhaseKind::grains,
             known = body || grains || (walls && phase->kind() == PhaseKind::wall);
  if (!report.touched("phases." + phase->name + ".kind") && !known && holds != Holds::any)
    return report(dotted + ".phase", "\"" + phase->name + "\" is no body" + (walls ? " and no wall" : "") +
                                         "; expected a phase of kind elastic, rigid or " + (walls ? "wall" : "grains"));
  if (const std::string why = grains ? what_moves_grains_out(scene, *phase) : ""; !why.empty())
    return report(dotted + ".phase", why + ", and a marker needs those of the start; expected grains that stay");
  for (std::size_t d = 0; set.box && d < static_cast<std::size_t>(scene.dimensions); ++d)
    if (!(set.box->min[d] <= set.box->max[d]))
      return report(dotted + ".box", "its lower corner lies above its upper one; expected min <= max");
}

/// Why the force of a phase on a wall is not measured; empty: it is.
std::string what_cannot_be_measured(const Scene& scene, const Phase& wall, const Phase& other,
                                    const ForceMeter& meter) {
  const std::string name = "the force of \"" + other.name + "\" ";
  if (other.kind() == PhaseKind::grains) {
    if (!of_spheres(*entry_between(scene, wall, other)))
      return name + "on a wall is not measured; expected grains with " + sphere_laws_that_read("");
    if (other.grains().sleep) return name + "on a wall is not measured where grains sleep; expected sleep = false";
    if (meter.box)
      return name + "on a part of a wall is not measured; expected no box (a part may be a phase of its own)";
    return {};
  }
  if (other.kind() != PhaseKind::fluid) return name + "on a wall is not measured; expected fluids or grains";
  if (wall.wall().law == WallLaw::repulsive)
    return "the force on a repulsive wall is not measured; expected law = \"adami\"";
  if (has_eddies(scene, other))
    return "the force of the turbulent fluid \"" + other.name +
           "\" is not measured; expected a laminar one (or [[wall-shear]])";
  return {};
}

/// Walls count too, where fluids and spheres act on them, by laws whose reaction is known.
void check_force(const ForceMeter& meter, const std::string& dotted, const Scene& scene, const Report& report) {
  const Phase* phase = find_phase(scene, meter.phase);
  if (!phase || report.touched(dotted) || report.touched("phases")) return;
  const auto refuse = [&](const std::string& what) { report(dotted + ".phase", what); };
  if (phase->kind() != PhaseKind::wall && phase->kind() != PhaseKind::elastic)
    return refuse("\"" + phase->name + "\" is neither wall nor body; expected a phase of kind wall or elastic");
  const auto refuse_by = [&](const std::string& what) { report(dotted + ".by", what); };
  if (phase->kind() != PhaseKind::wall) {
    if (!meter.by.empty()) refuse_by("the force on a body is that of all; expected a wall, or no `by`");
    return;
  }
  if (!meter.by.empty()) {
    const Phase* by = find_phase(scene, meter.by);
    if (!by) return refuse_by(unknown_phase(meter.by, scene));
    if (!entry_between(scene, *phase, *by))
      return refuse_by("\"" + by->name + "\" and \"" + phase->name +
                       "\" have no entry in [interactions]: it is always 0");
  }
  for (const Phase& other : scene.phases) {
    if (!entry_between(scene, *phase, other) || !(meter.by.empty() || meter.by == other.name)) continue;
    const auto what = what_cannot_be_measured(scene, *phase, other, meter);
    if (!what.empty()) return meter.by.empty() ? refuse(what) : refuse_by(what);
  }
}

bool good_name(const std::string& name) {
  return !name.empty() &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

/// Names that become parts of columns' names: of letters, and each once.
template <class Named>
void check_names(const std::vector<Named>& all, const std::string& section, const Report& report) {
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::string dotted = section + std::to_string(k), &name = all[k].name;
    if (!report.has(dotted + ".name") || report.touched(dotted + ".name")) continue;
    if (!good_name(name))
      report(dotted + ".name",
             "\"" + name + "\" becomes a part of a column's name; expected letters, digits and underscores");
    for (std::size_t other = 0; other < k; ++other)
      if (all[other].name == name)
        report(dotted + ".name", "\"" + name + "\" is given twice; expected a name of its own");
  }
}

/// Waves of compression become fast as 1/sqrt(1 - 2 nu), and the pressure large: a square that was stretched at 10 1/s
/// gained 1e-5 of its energy in 200 us with 0.49, 1.3e-4 with 0.499, 1.3e-3 with 0.4999, 6 % with 0.4999999999.
void check_poisson(const Phase& phase, const Report& report) {
  constexpr double most = 0.4999;
  const std::string dotted = "phases." + phase.name + ".poisson";
  if (phase.elastic().poisson > most && !report.touched(dotted))
    report(dotted, number_text(phase.elastic().poisson) +
                       " is so near to 0.5 that the body does not keep its energy; expected at most " +
                       number_text(most) + " (rubber: 0.49 to 0.4995)");
}

}  // namespace

void check_bodies(const Scene& scene, const Report& report) {
  const auto known = [&](const Phase& phase) { return !report.touched("phases." + phase.name); };
  for (const Phase& phase : scene.phases)
    if (known(phase) && phase.kind() == PhaseKind::elastic) {
      check_formulation(phase, report);
      check_poisson(phase, report);
    }
  for (const Interaction& pair : scene.interactions) {
    const Phase *a = find_phase(scene, pair.a), *b = find_phase(scene, pair.b);
    if (a && b && known(*a) && known(*b) && !report.touched("interactions." + pair.a + "-" + pair.b))
      check_contact(pair, *a, *b, report);
  }
  for (std::size_t k = 0; k < scene.motions.size(); ++k)
    check_set(scene.motions[k], "motion." + std::to_string(k), scene, report, Holds::bodies_and_walls);
  check_names(scene.markers, "marker.", report);
  for (std::size_t k = 0; k < scene.markers.size(); ++k)
    if (const std::string dotted = "marker." + std::to_string(k) + ".name";
        find_phase(scene, scene.markers[k].name) && !report.touched(dotted))
      report(dotted, "\"" + scene.markers[k].name +
                         "\" is a phase too, and the columns of both would have one name; expected another name");
  for (std::size_t k = 0; k < scene.markers.size(); ++k)
    check_set(scene.markers[k], "marker." + std::to_string(k), scene, report, Holds::bodies_and_grains);
  check_names(scene.force_meters, "force.", report);
  for (std::size_t k = 0; k < scene.force_meters.size(); ++k) {
    const std::string dotted = "force." + std::to_string(k);
    check_set(scene.force_meters[k], dotted, scene, report, Holds::any);
    check_force(scene.force_meters[k], dotted, scene, report);
  }
}

}  // namespace barchan
