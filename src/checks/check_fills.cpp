#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "checks/checks.hpp"
#include "scene/couplings.hpp"
#include "scene/side_names.hpp"
#include "start/fitted.hpp"
#include "start/outline.hpp"
#include "start/region.hpp"

namespace barchan {
namespace {

const char* const shape_names[] = {"bed",     "box",  "disc",   "sphere", "ring",    "polygon",
                                   "surface", "cube", "points", "file",   "formula", "sides"};

/// The shape must be one, and companions (dune, layers) need the shape that they belong to.
void check_shape_keys(const std::string& shape, bool fitted, const Report& report) {
  std::string first;
  for (const char* name : shape_names) {
    if (!report.has(shape + "." + name)) continue;
    if (!first.empty()) {
      report(shape + "." + name, "a second shape after \"" + first + "\"; expected one shape a fill");
      continue;
    }
    first = name;
  }
  if (report.has(shape + ".dune") && first != "bed")
    report(shape + ".dune", "a dune without a bed; expected bed = DEPTH too");
  if (report.has(shape + ".from") && first != "bed")
    report(shape + ".from", "a lower bound without a bed; expected bed = DEPTH too");
  if (report.has(shape + ".layers") && first != "sides" && !(first == "bed" && fitted))
    report(shape + ".layers", first == "bed"
                                  ? "a bed of rows is as deep as it is; expected packing = \"fitted\" or no layers"
                                  : "layers without sides; expected sides = [...] too");
  if (report.has(shape + ".from") && first == "bed" && fitted)
    report(shape + ".from", "fitted rows are as deep as their layers; expected layers = NUMBER");
  const bool nothing =
      first.empty() && !report.has(shape + ".dune") && !report.has(shape + ".from") && !report.has(shape + ".layers");
  if (nothing && !report.touched(shape))
    report(shape,
           "no shape; expected \"the-rest\" or one of bed, box, disc, sphere, ring, polygon, surface, cube, points, "
           "file, formula, sides");
}

/// Polygons and surfaces: closed, not crossing themselves, of the scene's dimensions, not too thin.
void check_outline(const Fill& fill, double spacing, const std::string& shape, const Scene& scene,
                   const Report& report) {
  const auto* surface = std::get_if<SurfaceShape>(&fill.shape);
  if (!surface && report.has(shape + ".part") && report.is_section(shape))
    report(shape + ".part", "only the mesh of a file has parts; expected surface too");
  if (!surface && !std::holds_alternative<PolygonShape>(fill.shape)) {
    for (const char* key : {"scale", "turn", "move"})
      if (report.has(shape + "." + key) && report.is_section(shape))
        report(shape + "." + key, "this shape says itself where it is; expected polygon or surface too");
    return;
  }
  const std::string key = shape + (surface ? ".surface" : ".polygon");
  if (report.touched(shape) || report.touched("spacing") || !(spacing > 0.0)) return;
  if (surface && surface->triangles && scene.dimensions == 2)
    return report(key,
                  "a surface of triangles in two dimensions; expected lines, flat cells of one z, or dimensions = 3");
  const std::string misfit = misfit_of_outline(facets_of(fill.shape), facet_dimensions(fill.shape), spacing);
  if (!misfit.empty()) report(key, misfit);
}

/// What is left out by itself, and what has no places to leave out.
void check_leave_out(const Fill& fill, const std::string& dotted, const Report& report) {
  if (fill.leave_out == LeaveOut::nothing || report.touched(dotted)) return;
  const bool placed = std::holds_alternative<CubeShape>(fill.shape) ||
                      std::holds_alternative<PointsShape>(fill.shape) ||
                      std::holds_alternative<FileShape>(fill.shape) || std::holds_alternative<SidesShape>(fill.shape);
  const bool always = std::holds_alternative<RemainderShape>(fill.shape) || fill.packing == Packing::random;
  if (always)
    report(dotted + ".leave-out",
           "\"the-rest\" and random places leave out earlier fills by themselves; expected no such key");
  else if (placed || fill.packing == Packing::settled || fill.packing == Packing::fitted)
    report(dotted + ".leave-out",
           "these places are not chosen from a shape; expected a box, disc, sphere, ring, polygon, "
           "surface, bed or formula with packing = \"rows\" or \"staggered\"");
}

void check_dune(const DuneShape& dune, const std::string& dotted, const Scene& scene, const Report& report) {
  const bool by_formula = dune.form == DuneShape::Form::formula, clean = !report.touched(dotted);
  if (report.touched(dotted + ".form")) return;
  if (by_formula && !report.has(dotted + ".formula"))
    report(dotted + ".formula", "missing; expected a number (m) or a formula in x, z");
  if (!by_formula && report.has(dotted + ".formula"))
    report(dotted + ".formula", "a formula and another form; expected form = \"formula\"");
  if (dune.form != DuneShape::Form::asymmetric && report.has(dotted + ".slip-face-angle"))
    report(dotted + ".slip-face-angle", "only the asymmetric dune has a slip face; expected form = \"asymmetric\"");
  for (const char* name : {"height", "length", "at"}) {
    const std::string here = dotted + "." + name;
    if (clean && !by_formula && !report.has(here))
      report(here, "missing; expected a number" + std::string(std::string_view(name) == "at" ? "" : " > 0") + " (m)");
    if (by_formula && report.has(here))
      report(here, "a dune by formula has no " + std::string(name) + "; expected only its formula");
  }
  if (by_formula || report.touched(dotted)) return;
  const double lee = dune.height / std::tan(dune.slip_face_angle * std::numbers::pi / 180.0);
  if (dune.form == DuneShape::Form::asymmetric && lee >= dune.length)
    report(dotted + ".length", number_text(dune.length) + " m is shorter than the slip face of " +
                                   number_text(dune.height) + " m at " + number_text(dune.slip_face_angle) +
                                   " degrees; expected more than " + number_text(lee) + " m");
  if (scene.domain.periodic[0] && !report.touched("domain") && dune.length > scene.domain.size[0])
    report(dotted + ".length", number_text(dune.length) + " m is longer than the periodic domain; expected at most " +
                                   number_text(scene.domain.size[0]) + " m");
}

void check_sides(const SidesShape& sides, const Phase* phase, const std::string& dotted, const Scene& scene,
                 const Report& report) {
  if (sides.sides.empty() && !report.touched(dotted)) report(dotted, "no side; expected at least one");
  check_side_names(sides.sides, dotted, scene, report);
  if (phase && phase->kind() != PhaseKind::wall)
    report(dotted, "only walls lie outside the domain; expected a phase of kind wall");
}

/// A bed that the domain cuts off would be another one than the scene says.
void check_bed(const BedShape& bed, const std::string& shape, const Scene& scene, const Report& report) {
  if (report.touched(shape) || report.touched("domain")) return;
  const double height = scene.domain.size[up_axis(scene.domain)];
  const bool rises = bed.dune && bed.dune->form != DuneShape::Form::formula;
  const double top = bed.depth + (rises ? bed.dune->height : 0.0);
  if (bed.depth > height * (1.0 + 1e-9))
    report(shape + ".bed", number_text(bed.depth) + " m is more than the height of the domain; expected at most " +
                               number_text(height) + " m");
  else if (top > height * (1.0 + 1e-9))
    report(shape + ".dune.height", "the crest is " + number_text(top) +
                                       " m over the bottom of the domain; expected at most its height, " +
                                       number_text(height) + " m");
}

void check_sizes(const Fill& fill, const std::string& shape, const Scene& scene, const Report& report) {
  if (const auto* box = std::get_if<BoxShape>(&fill.shape); box && !report.touched(shape))
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis)
      if (!(box->max[axis] > box->min[axis])) {
        const std::string along = std::string(1, static_cast<char>('x' + axis));
        report(shape + ".box.max",
               box->max[axis] < box->min[axis]
                   ? "min and max are swapped along " + along + "; expected more than " + number_text(box->min[axis]) +
                         " m"
                   : "the box is empty along " + along + "; expected more than " + number_text(box->min[axis]) + " m");
        break;
      }
  if (const auto* ring = std::get_if<RingShape>(&fill.shape);
      ring && !report.touched(shape) && ring->inner >= ring->outer)
    report(shape + ".ring.outer",
           "the ring is empty; expected more than its inner radius, " + number_text(ring->inner) + " m");
}

/// What the kind of the phase forbids: walls are moved by their phase, only fluids have a pressure, only loose things
/// pack closely.
void check_phase_of(const Fill& fill, const Phase& phase, const std::string& dotted, const Report& report) {
  const bool wall = phase.kind() == PhaseKind::wall;
  if (wall && report.has(dotted + ".velocity"))
    report(dotted + ".velocity", "a wall has no initial velocity; expected no such key (phases." + phase.name +
                                     ".velocity lets the wall's surface slide)");
  const bool sizes = phase.diameter() && phase.diameter()->differ();
  if (report.has(dotted + ".seed") && !(fill.perturb > 0.0) && fill.packing != Packing::random && !sizes)
    report(dotted + ".seed",
           "nothing here is random; expected perturb above 0 or packing = \"random\" too, or diameters that "
           "differ");
  if (phase.kind() != PhaseKind::fluid && report.has(dotted + ".pressure"))
    report(dotted + ".pressure", "only fluids have an initial pressure; expected a phase of kind fluid");
  const bool body = phase.kind() == PhaseKind::elastic || phase.kind() == PhaseKind::rigid;
  const bool continuous = phase.kind() == PhaseKind::fluid || body;
  for (const char* key : {".mass", ".centre", ".inertia"})
    if (phase.kind() != PhaseKind::rigid && report.has(dotted + key))
      report(dotted + key, "only a rigid body has a mass of its own; expected a phase of kind rigid");
  if (phase.kind() != PhaseKind::rigid && report.has(dotted + ".angular-velocity"))
    report(dotted + ".angular-velocity", "only a rigid body turns as a whole; expected a phase of kind rigid");
  const bool close = fill.packing == Packing::hexagonal || fill.packing == Packing::random;
  if (close && continuous)
    report(dotted + ".packing",
           "a continuous phase needs one particle a square of side dx; expected \"rows\" or \"relaxed\"");
  const bool from_file = std::holds_alternative<FileShape>(fill.shape);
  const bool may_settle =
      from_file || std::holds_alternative<BoxShape>(fill.shape) || std::holds_alternative<BedShape>(fill.shape);
  if (fill.packing == Packing::settled && (!phase.if_grains() || !phase.diameter() || !may_settle))
    report(dotted + ".packing",
           "only spheres settle, in a box or a bed or from a file; expected grains with a diameter, and such a shape");
  if (fill.packing == Packing::settled && fill.perturb > 0.0)
    report(dotted + ".perturb", "grains at rest stay where they are; expected no such key");
  if (from_file) {
    if (!phase.if_grains() || !phase.diameter())
      report(dotted + ".shape.file", "only spheres are read from a file; expected grains with a diameter");
    for (const char* key : {".packing", ".perturb", ".seed"})
      if (report.has(dotted + key) && fill.packing != Packing::settled)
        report(dotted + key, "the file says where the grains are; expected no such key, or packing = \"settled\"");
  }
  const bool placed = std::holds_alternative<CubeShape>(fill.shape) ||
                      std::holds_alternative<PointsShape>(fill.shape) || std::holds_alternative<SidesShape>(fill.shape);
  if (close && !continuous && placed)
    report(dotted + ".packing", "cube, points and sides place their particles themselves; expected \"rows\"");
}

/// Fitted rows need a ground that is a surface: a wall's bed, and for a fluid such a bed before it.
void check_fitted(const Scene& scene, std::size_t k, const Phase& phase, const std::string& dotted,
                  const Report& report) {
  const Fill& fill = scene.fills[k];
  const auto* bed = std::get_if<BedShape>(&fill.shape);
  const bool wall = phase.kind() == PhaseKind::wall && bed;
  const bool rest = phase.kind() == PhaseKind::fluid && std::holds_alternative<RemainderShape>(fill.shape);
  const bool tried = std::any_of(scene.fills.begin(), scene.fills.begin() + static_cast<std::ptrdiff_t>(k),
                                 [](const Fill& f) { return f.packing == Packing::fitted; });  // told there
  if (report.touched(dotted + ".shape") || report.touched(dotted + ".packing")) return;
  if (!wall && !rest)
    report(dotted + ".packing",
           "fitted rows follow the ground; expected a bed of a wall, or \"the-rest\" of a fluid over one");
  else if (fitted_bed(scene, k) >= 0 && wall) report(dotted + ".packing", "a second ground; expected one fitted bed");
  else if (rest && fitted_bed(scene, k) < 0 && !tried)
    report(
        dotted + ".packing",
        "no ground to follow; expected an earlier fill of a wall with shape = { bed = ... } and packing = \"fitted\"");
  else if (wall && phase.spacing > 0.0 && !report.touched("spacing") && !report.touched("domain")) {
    const std::string misfit = misfit_of_ground(scene, *bed, phase.spacing);
    if (!misfit.empty()) report(dotted + ".shape.bed", misfit);
  }
}

void check_along_ground(const Fill& fill, const std::string& profile, const Scene& scene, const Report& report) {
  if (!fill.log_profile || !fill.log_profile->along_ground) return;
  const std::string key = profile + ".along-ground";
  const bool bed = std::any_of(scene.fills.begin(), scene.fills.end(),
                               [](const Fill& f) { return std::holds_alternative<BedShape>(f.shape); });
  if (!bed) report(key, "no ground to follow; expected a fill with shape = { bed = ... }");
  else if (!fill.log_profile->over_ground)
    report(key, "not with over-ground = false, which counts heights from the bottom; expected one of the two");
}

}  // namespace

void check_fills(const Scene& scene, const Report& report) {
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Fill& fill = scene.fills[k];
    const std::string dotted = "fill." + std::to_string(k);
    const std::string shape = dotted + ".shape";
    const auto found =
        std::find_if(scene.phases.begin(), scene.phases.end(), [&](const Phase& p) { return p.name == fill.phase; });
    const Phase* phase =
        found == scene.phases.end() || report.touched("phases." + fill.phase + ".kind") ? nullptr : &*found;
    if (report.is_section(shape)) check_shape_keys(shape, fill.packing == Packing::fitted, report);
    if (const auto* bed = std::get_if<BedShape>(&fill.shape); bed && bed->dune)
      check_dune(*bed->dune, shape + ".dune", scene, report);
    if (const auto* bed = std::get_if<BedShape>(&fill.shape); bed && fill.packing != Packing::fitted)
      check_bed(*bed, shape, scene, report);
    if (const auto* sides = std::get_if<SidesShape>(&fill.shape))
      check_sides(*sides, phase, shape + ".sides", scene, report);
    check_sizes(fill, shape, scene, report);
    check_outline(fill, spacing_of(scene, fill), shape, scene, report);
    check_leave_out(fill, dotted, report);
    check_along_ground(fill, dotted + ".velocity.log-profile", scene, report);
    if (phase && fill.packing == Packing::settled && !(scene.domain.gravity[up_axis(scene.domain)] < 0.0) &&
        !report.touched("domain.gravity"))
      report(dotted + ".packing",
             "nothing makes the grains fall; expected domain.gravity = [0, -9.81], in three dimensions [0, -9.81, 0] "
             "or [0, 0, -9.81]");
    if (phase) check_phase_of(fill, *phase, dotted, report);
    if (fill.packing == Packing::relaxed && !report.touched(dotted)) {
      const std::string misfit = misfit_of_region(scene, k);
      if (!misfit.empty()) report(dotted + ".packing", misfit);
      else if (phase && phase->if_grains())
        report(dotted + ".packing", "grains are loose; expected a phase of kind fluid, elastic or wall");
    }
    if (phase && fill.packing == Packing::fitted) check_fitted(scene, k, *phase, dotted, report);
  }
}

}  // namespace barchan
