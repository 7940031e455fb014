// Walls that a [[motion]] carries: keys that only bodies read, shapes that cannot leave their place, and what touches
// them by laws that do not know a wall that moves.
#include "checks/checks.hpp"
#include "scene/contact_words.hpp"
#include "scene/couplings.hpp"

namespace barchan {
namespace {

/// Why the wall cannot leave its place, whatever touches it; empty: it can. `at`: the key that is wrong.
std::string what_holds(const Scene& scene, const Phase& wall, std::size_t fill, std::string& at) {
  const Fill& f = scene.fills[fill];
  at = "fill." + std::to_string(fill) + ".shape";
  if (std::holds_alternative<SidesShape>(f.shape))
    return "\"" + wall.name +
           "\" moves, and a side of the domain stays where it is; expected another shape, as a box, or another phase "
           "for the sides";
  if (std::holds_alternative<BedShape>(f.shape) || f.packing == Packing::fitted)
    return "\"" + wall.name + "\" moves, and ground stays where it is; expected another shape, as a box or a polygon";
  return {};
}

/// Why the wall does not move with such a partner; empty: it does.
std::string what_knows_no_motion(const Scene& scene, const Interaction& pair, const Motion& motion, const Phase& wall,
                                 const Phase& other) {
  const std::string name = "\"" + wall.name + "\" moves, and ";
  switch (other.kind()) {
    case PhaseKind::fluid:
      if (wall.wall().law == WallLaw::repulsive)
        return name + "the fluid does not follow a repulsive wall; expected law = \"adami\"";
      if (has_eddies(scene, other))
        return name + "the turbulent fluid \"" + other.name +
               "\" has no distance to its ground then; expected a laminar one";
      if (other.fluid().energy && motion.angular_velocity)
        return name + "the internal energy of \"" + other.name +
               "\" next to a wall that turns is not computed; expected no angular-velocity, or no energy";
      return {};
    case PhaseKind::grains:
      if (!of_spheres(pair))
        return name + "grains without a diameter do not touch it yet; expected spheres, with " +
               sphere_laws_that_read("");
      return {};
    case PhaseKind::elastic:
    case PhaseKind::rigid:
      return name +
             "bodies do not touch it yet; expected a rigid phase with such a [[motion]] in its place, or no "
             "such entry";
    case PhaseKind::wall:
    case PhaseKind::column: return {};
  }
  return {};
}

/// The keys of the motion itself.
void check_keys(const Motion& motion, const std::string& dotted, const Phase& wall, const Report& report) {
  const auto refuse = [&](const char* key, const std::string& why) {
    if (report.has(dotted + key) && !report.touched(dotted + key)) report(dotted + key, why);
  };
  refuse(".box", "a wall moves as a whole; expected no box (a part may be a phase of its own)");
  for (const char* key : {".torque", ".friction"})
    refuse(key,
           "acts on rigid bodies that turn freely; a wall goes as the scene says: expected velocity or "
           "angular-velocity, or a phase of kind rigid");
  if (motion.about && !motion.angular_velocity)
    refuse(".about", "a wall does not turn by itself; expected angular-velocity too, or a phase of kind rigid");
  if (!report.has(dotted + ".velocity") && !motion.angular_velocity && !motion.about)
    report(dotted, "nothing moves the wall \"" + wall.name + "\"; expected velocity or angular-velocity");
  for (const char* key : {".velocity", ".roughness", ".shear-stress"})
    if (const std::string of_wall = "phases." + wall.name + key; report.has(of_wall) && !report.touched(of_wall))
      report(of_wall,
             "a [[motion]] carries this wall, and its surface goes with it; expected either the one or the "
             "other");
}

void check_driven_wall(const Scene& scene, std::size_t number, const Phase& wall, const Report& report) {
  const Motion& motion = scene.motions[number];
  const std::string dotted = "motion." + std::to_string(number);
  check_keys(motion, dotted, wall, report);
  for (std::size_t k = 0; k < number; ++k)
    if (scene.motions[k].phase == wall.name && !report.touched(dotted + ".phase"))
      report(dotted + ".phase",
             "motion." + std::to_string(k) + " moves \"" + wall.name + "\" too; expected one motion of a wall");
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    std::string at;
    if (scene.fills[k].phase != wall.name) continue;
    const std::string why = what_holds(scene, wall, k, at);
    if (!why.empty() && !report.touched(at)) report(at, why);
  }
  for (const Interaction& pair : scene.interactions) {
    if (pair.a != wall.name && pair.b != wall.name) continue;
    const Phase* other = find_phase(scene, pair.a == wall.name ? pair.b : pair.a);
    const std::string at = "interactions." + pair.a + "-" + pair.b;
    if (!other || report.touched(at) || report.touched("phases." + other->name + ".kind")) continue;
    const std::string why = what_knows_no_motion(scene, pair, motion, wall, *other);
    if (!why.empty()) report(at, why);
  }
}

}  // namespace

void check_motions(const Scene& scene, const Report& report) {
  for (std::size_t k = 0; k < scene.motions.size(); ++k) {
    const std::string dotted = "motion." + std::to_string(k);
    const Phase* phase = find_phase(scene, scene.motions[k].phase);
    if (!phase || phase->kind() != PhaseKind::wall || report.touched(dotted) || !report.has(dotted + ".phase") ||
        report.touched("phases." + phase->name + ".kind"))
      continue;
    check_driven_wall(scene, k, *phase, report);
  }
}

}  // namespace barchan
