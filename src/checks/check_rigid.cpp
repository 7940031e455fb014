// Rigid bodies: what may touch them and by which surface, keys that nothing reads, and what turns.
#include <algorithm>

#include "checks/checks.hpp"
#include "scene/couplings.hpp"
#include "scene/formula.hpp"

namespace barchan {
namespace {

bool rigid(const Phase& phase) { return phase.kind() == PhaseKind::rigid; }

/// Keys of a motion that only rigid bodies have, and of those that turn freely.
void check_turning(const Motion& motion, const std::string& dotted, const Scene& scene, const Report& report) {
  const Phase* phase = find_phase(scene, motion.phase);
  if (!phase || report.touched(dotted + ".phase") || report.touched("phases." + phase->name + ".kind")) return;
  if (phase->kind() == PhaseKind::wall) return;  // check_motions.cpp
  const bool rigid = phase->kind() == PhaseKind::rigid, free = motion.about && !motion.angular_velocity;
  for (const char* key : {".about", ".angular-velocity", ".torque", ".friction"})
    if (!rigid && report.has(dotted + key))
      report(dotted + key, "only rigid bodies and walls turn as a whole; expected a phase of kind rigid or wall");
  if (!rigid) return;
  for (const char* key : {".torque", ".friction"})
    if (!free && report.has(dotted + key))
      report(dotted + key,
             "acts on bodies that turn freely about a place; expected about = [...] and no angular-velocity");
  if (free && report.has(dotted + ".velocity"))
    report(dotted + ".velocity",
           "the place about which bodies turn freely stays where it is; expected angular-velocity too, or no such "
           "key");
}

/// A fluid of the consistent scheme acts on the surfaces of bodies.
void check_fluid(const Scene& scene, const Interaction& pair, const Phase& body, const Phase& fluid,
                 const Report& report) {
  const std::string scheme = "phases." + fluid.name + ".scheme", entry = "interactions." + pair.a + "-" + pair.b;
  if (report.touched(scheme)) return;
  if (has_eddies(scene, fluid) && !report.touched("phases." + fluid.name + ".turbulence"))
    report(entry,
           "the friction of a turbulent fluid on a rigid body is not there yet; expected a laminar fluid (no "
           "turbulence, no wall with roughness or shear-stress), or no such entry");
  for (const Phase& other : scene.phases)
    if (other.name != fluid.name && other.kind() == PhaseKind::fluid && entry_between(scene, body, other))
      return report(entry,
                    "a body in two fluids, of which one has the consistent scheme, is not there yet; expected one "
                    "fluid about \"" +
                        body.name + "\", or the scheme \"plain\" for all");
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const std::string shape = "fill." + std::to_string(k) + ".shape";
    if (scene.fills[k].phase != body.name || report.touched(shape)) continue;
    if (!has_surface(scene.fills[k].shape, scene.dimensions) ||
        std::holds_alternative<SidesShape>(scene.fills[k].shape))
      report(
          shape,
          "a fluid of the consistent scheme acts on the surface of a body, and this shape has none; expected " +
              std::string(scene.dimensions == 2 ? "box, cube, disc, ring, polygon or surface" : "box, cube or sphere") +
              ", or phases." + fluid.name + ".scheme = \"plain\"");
  }
}

/// The entries that a rigid phase cannot have.
void check_partner(const Scene& scene, const Interaction& pair, const Phase& a, const Phase& b, const Report& report) {
  const std::string dotted = "interactions." + pair.a + "-" + pair.b;
  if (report.touched(dotted)) return;
  const Phase& other = rigid(a) ? b : a;
  if (other.kind() == PhaseKind::column)
    report(dotted,
           "a column of air does not act on a rigid body; expected an entry with fluids, bodies, walls or grains "
           "without a "
           "diameter");
  if (other.kind() == PhaseKind::fluid && other.fluid().scheme == FluidScheme::consistent)
    check_fluid(scene, pair, rigid(a) ? a : b, other, report);
  if (other.if_grains() && other.diameter() && of_spheres(pair)) {
    if (other.if_grains()->sleep && !report.touched("phases." + other.name + ".sleep"))
      report("phases." + other.name + ".sleep",
             "a rigid body that comes does not wake grains that sleep; expected no such key with the entry " + pair.a +
                 "-" + pair.b);
    for (std::size_t k = 0; k < scene.fills.size(); ++k) {
      const Fill& fill = scene.fills[k];
      const std::string shape = "fill." + std::to_string(k) + ".shape",
                        packing = "fill." + std::to_string(k) + ".packing";
      if (fill.phase == (rigid(a) ? a : b).name && !report.touched(shape) && !has_surface(fill.shape, scene.dimensions))
        report(shape, "spheres touch the surface of a body, and this shape has none; expected " +
                          std::string(scene.dimensions == 2 ? "box, cube, disc, ring, polygon or surface"
                                                            : "box, cube or sphere"));
      if (fill.phase == other.name && fill.packing == Packing::settled && !report.touched(packing))
        report(
            packing,
            "grains settle without rigid bodies, and would stand in them; expected rows, staggered or random, or a bed "
            "that settled in a scene without the body: barchan generate BED.toml -o bed.vtp, then shape = { file = "
            "\"bed.vtp\" }");
    }
  }
}

/// All fills of two phases that touch by surfaces must have one.
void check_surfaces(const Scene& scene, const Interaction& pair, const Report& report) {
  bool flat = false, edges = false;  // boxes in 3D
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Fill& fill = scene.fills[k];
    const std::string shape = "fill." + std::to_string(k) + ".shape";
    const Phase* phase = find_phase(scene, fill.phase);
    if (!phase || (fill.phase != pair.a && fill.phase != pair.b) || report.touched(shape)) continue;
    if (!has_surface(fill.shape, scene.dimensions))
      report(shape, "the entry " + pair.a + "-" + pair.b +
                        " acts between surfaces, and this shape has none; expected " +
                        (scene.dimensions == 2 ? "box, cube, disc, ring, polygon or surface" : "box, cube or sphere") +
                        (phase->if_wall() ? ", or sides" : ""));
    const bool box = std::holds_alternative<BoxShape>(fill.shape) || std::holds_alternative<CubeShape>(fill.shape);
    if (scene.dimensions == 2 || !box) continue;
    (fill.phase == pair.a ? flat : edges) = true;
    if (pair.a == pair.b) edges = true;
  }
  if (flat && edges)
    report(
        "interactions." + pair.a + "-" + pair.b,
        "boxes in three dimensions may touch along their edges, which is not there yet; expected spheres on one side");
}

/// Moments of inertia that a body can have.
void check_inertia(const Scene& scene, std::size_t k, const Report& report) {
  const Fill& fill = scene.fills[k];
  const std::string dotted = "fill." + std::to_string(k);
  if (fill.centre && !fill.inertia && !report.touched(dotted + ".centre"))
    report(dotted + ".centre",
           "the inertia of the shape is that about its own centre; expected inertia = ... next to it");
  if (!fill.inertia || report.touched(dotted + ".inertia")) return;
  Vec3 about{};
  for (std::size_t d = 0; d < 3; ++d) about[d] = Formula(fill.inertia->about[d])({});
  const std::size_t first = scene.dimensions == 2 ? 2 : 0;
  for (std::size_t d = first; d < 3; ++d) {
    const double others = about[(d + 1) % 3] + about[(d + 2) % 3];
    if (!(about[d] > 0.0)) return report(dotted + ".inertia", "expected moments above 0 (kg m2)");
    if (first == 0 && about[d] > others * (1.0 + 1e-9))
      return report(dotted + ".inertia",
                    "the moment about " + std::string(1, "xyz"[d]) +
                        " is more than the other two together, which no body has; expected one of at most " +
                        number_text(others) + " kg m2");
  }
}

/// Keys of contacts that nothing reads.
void check_stiffness(const Scene& scene, const Phase& phase, const Report& report) {
  const std::string dotted = "phases." + phase.name;
  const bool touches = std::any_of(scene.phases.begin(), scene.phases.end(), [&](const Phase& other) {
    return touch_by_surfaces(phase, other) && entry_between(scene, phase, other);
  });
  for (const char* key : {".stiffness", ".largest-overlap"})
    if (!touches && report.has(dotted + key) && !report.touched(dotted + key))
      report(dotted + key, "nothing reads it; expected an entry with a rigid phase or a wall");
  if (report.has(dotted + ".stiffness") && report.has(dotted + ".largest-overlap") &&
      !report.touched(dotted + ".largest-overlap"))
    report(dotted + ".largest-overlap", "stiffness says how stiff contacts are; expected no such key with it");
}

}  // namespace

void check_rigid(const Scene& scene, const Report& report) {
  const auto known = [&](const Phase& phase) { return !report.touched("phases." + phase.name + ".kind"); };
  for (std::size_t k = 0; k < scene.motions.size(); ++k)
    check_turning(scene.motions[k], "motion." + std::to_string(k), scene, report);
  for (const Interaction& pair : scene.interactions) {
    const Phase *a = find_phase(scene, pair.a), *b = find_phase(scene, pair.b);
    if (!a || !b || !known(*a) || !known(*b) || (!rigid(*a) && !rigid(*b))) continue;
    check_partner(scene, pair, *a, *b, report);
    if (touch_by_surfaces(*a, *b)) check_surfaces(scene, pair, report);
  }
  for (std::size_t k = 0; k < scene.fills.size(); ++k)
    if (const Phase* phase = find_phase(scene, scene.fills[k].phase); phase && known(*phase) && rigid(*phase))
      check_inertia(scene, k, report);
  for (const Phase& phase : scene.phases)
    if (known(phase) && rigid(phase) && !report.misread("interactions")) check_stiffness(scene, phase, report);
}

}  // namespace barchan
