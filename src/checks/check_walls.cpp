// Walls: keys that their law does not read, and velocities that would carry them away. Without a [[motion]]
// (check_motions.cpp) a wall's particles stay where they are; its velocity is that at which its surface slides along
// itself, and only a fluid that sticks to it feels that.
#include <cctype>
#include <cmath>

#include "checks/checks.hpp"
#include "scene/couplings.hpp"
#include "scene/side_names.hpp"
#include "start/ball_surfaces.hpp"

namespace barchan {
namespace {

bool mentions(const std::string& formula, char variable) {
  for (std::size_t k = 0; k < formula.size(); ++k) {
    const auto letter = [&](std::size_t at) {
      return at < formula.size() && (std::isalnum(static_cast<unsigned char>(formula[at])) || formula[at] == '_');
    };
    if (formula[k] == variable && !letter(k + 1) && !(k > 0 && letter(k - 1))) return true;
  }
  return false;
}

/// Whether a shape is the same at every place along an axis of the domain.
struct SameAlong {
  const Domain& domain;
  std::size_t axis;

  bool operator()(const BoxShape& box) const {
    const double low = domain.origin[axis], high = low + domain.size[axis], slack = 1e-9 * domain.size[axis];
    return box.min[axis] <= low + slack && box.max[axis] >= high - slack;
  }
  bool operator()(const BedShape& bed) const {
    if (axis == up_axis(domain)) return false;
    if (!bed.dune) return true;
    const bool formula = bed.dune->form == DuneShape::Form::formula;
    return axis == across_axis(domain) && !(formula && mentions(bed.dune->formula.formula, 'z'));
  }
  bool operator()(const FormulaShape& shape) const { return !mentions(shape.inside.formula, "xyz"[axis]); }
  bool operator()(const SidesShape& sides) const {
    return std::none_of(sides.sides.begin(), sides.sides.end(),
                        [&](const std::string& side) { return side_at(domain, side).axis == axis; });
  }
  bool operator()(const DiscShape&) const { return axis == 2; }
  bool operator()(const RingShape&) const { return axis == 2; }
  bool operator()(const PolygonShape&) const { return axis == 2; }
  bool operator()(const SurfaceShape& surface) const { return axis == 2 && !surface.triangles; }
  bool operator()(const SphereShape&) const { return false; }
  bool operator()(const CubeShape&) const { return false; }
  bool operator()(const PointsShape&) const { return false; }
  bool operator()(const FileShape&) const { return false; }
  bool operator()(const RemainderShape&) const { return false; }
};

/// A wall of `sides`, or a box beyond a side: it may slide along a side that ends, as the lid of a cavity does.
bool outside(const Shape& shape, const Domain& domain, int dimensions) {
  if (std::holds_alternative<SidesShape>(shape)) return true;
  const auto* box = std::get_if<BoxShape>(&shape);
  for (std::size_t axis = 0; box && axis < static_cast<std::size_t>(dimensions); ++axis) {
    const double low = domain.origin[axis], high = low + domain.size[axis], slack = 1e-9 * domain.size[axis];
    if (!domain.periodic[axis] && (box->max[axis] <= low + slack || box->min[axis] >= high - slack)) return true;
  }
  return false;
}

void check_keys(const Scene& scene, const Phase& wall, const Report& report) {
  const std::string dotted = "phases." + wall.name;
  const auto refuse = [&](std::initializer_list<const char*> keys, const std::string& why) {
    for (const char* key : keys)
      if (report.has(dotted + key) && !report.touched(dotted + key)) report(dotted + key, why);
  };
  if (!meets(scene, wall, PhaseKind::fluid)) {
    if (!report.misread("interactions"))
      refuse({".law", ".slip", ".velocity", ".roughness", ".shear-stress"},
             "it acts on fluids only, and no fluid interacts with this wall; expected an entry of a fluid with \"" +
                 wall.name + "\" in [interactions], or no such key");
  } else if (wall.wall().law == WallLaw::repulsive) {
    refuse({".slip", ".velocity", ".roughness", ".shear-stress"},
           "a repulsive wall only pushes; expected law = \"adami\", or no such key");
  } else if (wall.wall().shear_stress) {
    refuse({".slip", ".velocity", ".roughness"},
           "the friction of this wall is its shear-stress; expected either the one or the other");
  } else if (wall.wall().slip == Slip::free_slip) {
    refuse({".velocity", ".roughness"},
           "it does not act on a fluid that slips; expected slip = \"no-slip\", or no such key");
  }
}

/// Walls that fluids cannot be beside, whatever the keys' own bounds say.
void check_sizes(const Scene& scene, const Phase& wall, const Report& report) {
  const std::string dotted = "phases." + wall.name;
  if (const auto roughness = wall.wall().roughness; roughness && !report.touched(dotted + ".roughness"))
    for (const Phase& fluid : scene.phases)
      if (fluid.kind() == PhaseKind::fluid && entry_between(scene, wall, fluid) && !(*roughness < fluid.spacing))
        return report(dotted + ".roughness", number_text(*roughness) + " m reaches beyond the first row of \"" +
                                                 fluid.name + "\", " + number_text(fluid.spacing) +
                                                 " m; expected a roughness length below a spacing");
  if (!wall.wall().shear_stress || report.touched(dotted + ".shear-stress")) return;
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const auto* sides = std::get_if<SidesShape>(&scene.fills[k].shape);
    if (scene.fills[k].phase != wall.name || !sides) continue;
    for (const std::string& side : sides->sides) {
      const std::size_t axis = side_at(scene.domain, side).axis;
      if ((*wall.wall().shear_stress)[axis] != 0.0)
        return report(dotted + ".shear-stress",
                      std::string("its part along ") + "xyz"[axis] + " stands across the side \"" + side +
                          "\" of fill." + std::to_string(k) + "; expected 0 there: a shear stress pulls along a wall");
    }
  }
}

/// m, how wide a ball passes between spheres of a wall on the lattice of a fill; below zero: none does.
double opening_of(const Fill& fill, int dimensions, double spacing, double diameter) {
  if (dimensions == 2) return spacing - diameter;
  const bool square = fill.packing == Packing::square || fill.packing == Packing::fitted;
  return (square ? std::sqrt(2.0) : 2.0 / std::sqrt(3.0)) * spacing - diameter;
}

/// A wall that grains touch by its particles, as spheres, must not let them through.
void check_openings(const Scene& scene, const Phase& wall, const Report& report) {
  const double diameter = wall.diameter() ? wall.diameter()->least() : wall.spacing;
  const std::string dotted = "phases." + wall.name + (wall.diameter() ? ".diameter" : ".spacing");
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Fill& fill = scene.fills[k];
    if (fill.phase != wall.name || touched_by_surface(scene, wall, fill.shape) || fill.packing == Packing::random ||
        std::holds_alternative<SidesShape>(fill.shape) || std::holds_alternative<PointsShape>(fill.shape))
      continue;
    const double opening = opening_of(fill, scene.dimensions, wall.spacing, diameter);
    for (const Phase& grains : scene.phases) {
      const Interaction* pair = entry_between(scene, wall, grains);
      if (!grains.if_grains() || !grains.diameter() || !pair || !of_spheres(*pair) || report.touched(dotted)) continue;
      const double smallest = grains.diameter()->least();
      if (!(opening > 0.0) || !(opening >= smallest * (1.0 - 1e-6))) continue;
      report(
          dotted,
          "grains of \"" + grains.name + "\", " + number_text(smallest) +
              " m across, pass between the spheres of the wall in fill." + std::to_string(k) + ", " +
              number_text(diameter) + " m across and " + number_text(wall.spacing) +
              " m apart; expected a smaller spacing of \"" + wall.name +
              "\", or a larger diameter of it: openings below " + number_text(smallest) + " m" +
              (wall.diameter() ? ", or no diameter: grains touch a box, disc, polygon or surface by its shape" : ""));
    }
  }
}

void check_velocity(const Scene& scene, const Phase& wall, const Report& report) {
  const std::string dotted = "phases." + wall.name + ".velocity";
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    const Expression& component = wall.wall().velocity[axis];
    if (!component.is_formula() && component.value == 0.0) continue;
    for (std::size_t k = 0; k < scene.fills.size(); ++k) {
      const Fill& fill = scene.fills[k];
      if (fill.phase != wall.name || report.touched(dotted)) continue;
      const bool slides = scene.domain.periodic[axis] || outside(fill.shape, scene.domain, scene.dimensions);
      if (slides && std::visit(SameAlong{scene.domain, axis}, fill.shape)) continue;
      const std::string name(1, "xyz"[axis]);
      report(dotted,
             "along " + name + " it would carry the wall of fill." + std::to_string(k) +
                 " away, and a surface that slides carries no wall; expected a [[motion]] of the wall, or 0 along " +
                 name +
                 " (a wall slides along its surface: along a side of the domain, or along a periodic axis when "
                 "its shape is the same all along)");
    }
  }
}

}  // namespace

void check_walls(const Scene& scene, const Report& report) {
  for (const Phase& wall : scene.phases) {
    if (wall.kind() != PhaseKind::wall || report.touched("phases." + wall.name + ".kind")) continue;
    check_keys(scene, wall, report);
    if (!report.misread("fill") && !report.misread("interactions")) {
      check_sizes(scene, wall, report);
      check_openings(scene, wall, report);
    }
    if (report.has("phases." + wall.name + ".velocity") && !report.misread("fill") && !report.touched("domain"))
      check_velocity(scene, wall, report);
  }
}

}  // namespace barchan
