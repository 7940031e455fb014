// Air without particles: what its profile by height needs of the scene.
#include <algorithm>

#include "checks/checks.hpp"
#include "scene/couplings.hpp"
#include "scene/keys.hpp"

namespace barchan {
namespace {

bool given(const Expression& e) { return e.is_formula() || e.value != 0.0; }

/// The phase of kind column that feels the same grains, other than this one; or a fluid that does.
const Phase* other_air(const Scene& scene, const Phase& column, const Phase& grains) {
  for (const Phase& other : scene.phases)
    if (other.name != column.name && (other.kind() == PhaseKind::fluid || other.kind() == PhaseKind::column) &&
        entry_between(scene, other, grains))
      return &other;
  return nullptr;
}

void check_wind(const Phase& column, const std::string& dotted, const Report& report) {
  const ColumnKeys& own = column.column();
  if (!report.touched(dotted + ".viscosity") && !(own.viscosity > 0.0))
    report(dotted + ".viscosity", "missing or 0: the drag of grains needs it; expected a number > 0 (m2/s)");
  if (own.speed && own.log_profile)
    report(dotted + ".log-profile", "a second wind at the start, after speed; expected one of them");
  if (own.held && !own.speed && !own.log_profile && !given(own.friction_velocity) &&
      !report.touched(dotted + ".friction-velocity"))
    report(dotted + ".held", "no wind to hold; expected log-profile, speed (0 of still air) or friction-velocity");
  if (own.averaging && !own.held && own.slip == Slip::free_slip && report.has(dotted + ".slip"))
    report(dotted + ".slip", "nothing would hold air without inertia; expected \"no-slip\", or no averaging");
  if (own.averaging && !own.held && (own.speed || own.log_profile))
    report(dotted + ".averaging",
           "air without inertia does not remember the wind of the start; expected no such key, or no "
           "speed and no log-profile");
  if (own.averaging && own.held && !own.speed && !own.log_profile)
    report(dotted + ".averaging", "grains do not brake a wind that is held; expected no such key");
  if (own.held && (own.speed || own.log_profile)) {
    const std::string why = "a wind that is held at its start needs none; expected no such key";
    for (const char* key : {".friction-velocity", ".mixing-length", ".slip", ".averaging"})
      if (report.has(dotted + key)) report(dotted + key, why);
    if (own.log_profile && report.has(dotted + ".resolution"))
      report(dotted + ".resolution", "a logarithmic wind that is held has no cells; expected no such key");
    for (const char* key : {".height"})
      if (report.has(dotted + key)) report(dotted + key, why);
    if (own.speed && report.has(dotted + ".resolution"))
      report(dotted + ".resolution", "a uniform wind that is held has no cells; expected no such key");
  }
}

/// Lengths that the column, or the domain, cannot hold.
void check_lengths(const Scene& scene, const Phase& column, const std::string& dotted, const Report& report) {
  if (report.touched("domain") || report.touched(dotted)) return;
  const ColumnKeys& own = column.column();
  const double height = own.height.value_or(scene.domain.size[1]);
  const auto refuse = [&](const char* key, double value, const std::string& what) {
    report(dotted + key, number_text(value) + " m " + what);
  };
  const std::string of_column = " the height of the column, " + number_text(height) + " m";
  if (own.resolution && !(*own.resolution < height))
    refuse(".resolution", *own.resolution, "is not below" + of_column + "; expected cells that it holds");
  if (own.log_profile && !(own.log_profile->roughness < height))
    refuse(".log-profile.roughness", own.log_profile->roughness,
           "is not below" + of_column + ": there is no wind below the roughness length; expected a smaller one");
  for (const Fill& fill : scene.fills) {
    const auto* bed = std::get_if<BedShape>(&fill.shape);
    const Phase* grains = find_phase(scene, fill.phase);
    if (bed && grains && own.height && entry_between(scene, column, *grains) && !(*own.height > bed->from + bed->depth))
      return refuse(".height", *own.height,
                    "ends inside the bed of \"" + grains->name + "\", whose surface is " +
                        number_text(bed->from + bed->depth) + " m over the bottom; expected a higher one");
  }
}

void check_column(const Scene& scene, const Phase& column, const Report& report) {
  const std::string dotted = "phases." + column.name;
  check_wind(column, dotted, report);
  check_lengths(scene, column, dotted, report);
  for (std::size_t k = 0; k < scene.fills.size(); ++k)
    if (scene.fills[k].phase == column.name)
      report("fill." + std::to_string(k) + ".phase",
             "\"" + column.name + "\" is of kind column and has no particles; expected no such fill");
  for (std::size_t k = 0; k < scene.forcings.size(); ++k)
    if (scene.forcings[k].phase == column.name)
      report("forcing." + std::to_string(k) + ".phase",
             "\"" + column.name + "\" is of kind column, which friction-velocity drives; expected another phase");
  const Vec3& g = scene.domain.gravity;
  if (!report.touched("domain.gravity") && (g[0] != 0.0 || g[2] != 0.0 || g[1] > 0.0))
    report("domain.gravity",
           "the profile of \"" + column.name +
               "\" is one along y, over the bottom of the domain; expected gravity along -y, or none");
  if (!column.column().held && !report.touched("domain.periodic") &&
      !(scene.domain.periodic[0] && (scene.dimensions == 2 || scene.domain.periodic[2])))
    report(dotted + ".held", std::string("a wind that grains brake is a mean along ") +
                                 (scene.dimensions == 2 ? "x" : "x and z") + "; expected domain.periodic = [" +
                                 (scene.dimensions == 2 ? "\"x\"" : "\"x\", \"z\"") + "], or held = true");
  if (report.misread("interactions")) return;
  bool felt = false;
  for (const Interaction& pair : scene.interactions) {
    if (pair.a != column.name && pair.b != column.name) continue;
    const std::string entry = "interactions." + pair.a + "-" + pair.b;
    const Phase* other = find_phase(scene, pair.a == column.name ? pair.b : pair.a);
    if (!other) continue;
    felt = true;
    if (report.touched(entry)) continue;
    if (other->kind() != PhaseKind::grains) {
      report(entry, "a column of air acts on grains only, and \"" + other->name + "\" is of kind " +
                        other->kind_word() + "; expected no such entry");
      continue;
    }
    for (const char* key : {".radius", ".radius-in-metres", ".kernel"})
      if (report.has(entry + key))
        report(entry + key,
               "a column of air has no kernel: on a grain acts the wind of its height; expected no such key");
    if (!report.is_section(entry)) report(entry, "a column of air has no radius; expected {} or { drag = LAW }");
    if (report.is_section(entry) && report.has(entry + ".drag") && pair.drag != 0.0)
      report(entry + ".drag", "a number; expected the name of a law, as \"duran\"");
    if (const Phase* air = other_air(scene, column, *other))
      report(entry,
             "\"" + other->name + "\" interacts with \"" + air->name + "\" already; expected one kind of air for it");
  }
  if (!felt)
    report(dotted, "nothing interacts with this air; expected an entry of [interactions] with \"" + column.name +
                       "\" and grains");
}

}  // namespace

void check_columns(const Scene& scene, const Report& report) {
  for (const Phase& phase : scene.phases)
    if (!report.touched("phases." + phase.name + ".kind") && phase.kind() == PhaseKind::column)
      check_column(scene, phase, report);
}

}  // namespace barchan
