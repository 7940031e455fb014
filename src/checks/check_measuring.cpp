#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "checks/checks.hpp"
#include "scene/couplings.hpp"
#include "scene/keys.hpp"

namespace barchan {
namespace {

constexpr double most_points = 1e7;  // of one instrument

/// The checks of one scene, an instrument at a time; `dotted` is its place, "profile.0".
class Checker {
 public:
  Checker(const Scene& scene, const Report& report)
      : scene_(scene),
        report_(report),
        box_known_(!report.touched("domain") && !report.touched("dimensions") && !report.touched("spacing")) {}

  /// Name and phase. `grains`: they can be measured too.
  template <class T>
  void common(const std::vector<T>& list, std::size_t k, const std::string& dotted, bool grains) {
    const Measured& measured = list[k];
    if (fine(dotted + ".name")) {
      const std::string& name = measured.name;
      const bool good = !name.empty() && std::all_of(name.begin(), name.end(),
                                                     [](unsigned char c) { return std::isalnum(c) || c == '_'; });
      const auto same = [&](const Measured& other) { return other.name == name; };
      if (!good)
        report_(dotted + ".name",
                "\"" + name + "\" becomes a part of a file's name; expected letters, digits and underscores");
      else if (std::any_of(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(k), same))
        report_(dotted + ".name", "\"" + name + "\" is given twice; expected a name of its own");
    }
    if (fine(dotted + ".phase")) {
      const Phase* phase = find_phase(scene_, measured.phase);
      const bool known_kind = phase && !report_.touched("phases." + phase->name + ".kind");
      if (!phase) report_(dotted + ".phase", unknown_phase(measured.phase, scene_));
      else if (known_kind && phase->kind() != PhaseKind::fluid && !(grains && phase->kind() == PhaseKind::grains))
        report_(dotted + ".phase", "\"" + phase->name + "\" is of kind " + phase->kind_word() +
                                       "; expected a phase of kind " +
                                       (std::is_same_v<T, SaltationLayer> ? "grains"
                                        : grains                          ? "fluid or grains"
                                                                          : "fluid"));
    }
  }

  /// A key that must be a place in the domain.
  void inside(const Vec3& x, const std::string& dotted) {
    if (!fine(dotted) || !box_known_) return;
    const Domain& domain = scene_.domain;
    for (std::size_t axis = 0; axis < dimensions(); ++axis) {
      const double low = domain.origin[axis], high = low + domain.size[axis], slack = 1e-9 * domain.size[axis];
      if (x[axis] >= low - slack && x[axis] <= high + slack) continue;
      return report_(dotted, std::string(1, "xyz"[axis]) + " = " + number_text(x[axis]) +
                                 " m is outside the domain; expected " + number_text(low) + " to " + number_text(high) +
                                 " m");
    }
  }

  void profile(const Profile& p, const std::string& dotted) {
    const bool ends = report_.has(dotted + ".from") || report_.has(dotted + ".to");
    if (ends && report_.has(dotted + ".box"))
      return report_(dotted + ".box", "a box and a line; expected either from and to, or box");
    if (report_.has(dotted + ".box")) return slices(p, dotted);
    if (report_.has(dotted + ".along")) report_(dotted + ".along", "an axis without a box; expected box too");
    if (!ends) return report_(dotted, "neither a line nor a box; expected from and to, or box = { min, max }");
    for (const char* end : {".from", ".to"})
      if (!report_.has(dotted + end))
        return report_(dotted + end, "missing; expected both ends of the line, from and to");
    inside(p.from, dotted + ".from");
    inside(p.to, dotted + ".to");
    if (fine(dotted + ".from") && fine(dotted + ".to") && !(norm(p.to - p.from) > 0.0))
      report_(dotted + ".to", "the line has no length; expected another point than from");
    if (fine(dotted + ".count") && p.count == 1)
      report_(dotted + ".count", "a line has two ends; expected at least 2 points");
  }

  void grid(const Grid& g, const std::string& dotted) {
    if (g.min) inside(*g.min, dotted + ".min");
    if (g.max) inside(*g.max, dotted + ".max");
    if (report_.touched(dotted + ".min") || report_.touched(dotted + ".max") || !box_known_) return;
    const Vec3 min = g.min.value_or(scene_.domain.origin);
    const Vec3 max = g.max.value_or(scene_.domain.origin + scene_.domain.size);
    const Phase* phase = find_phase(scene_, g.phase);
    const double spacing = g.spacing > 0.0 ? g.spacing : phase ? phase->spacing : scene_.spacing;
    double points = 1.0;
    for (std::size_t axis = 0; axis < dimensions(); ++axis) {
      const double side = max[axis] - min[axis];
      if (side < 0.0)
        return report_(dotted + (g.max ? ".max" : ".min"),
                       std::string("below min along ") + "xyz"[axis] + "; expected max at or above min");
      points *= std::round(side / spacing) + 1.0;
    }
    if (points > most_points)
      report_(dotted + (g.spacing > 0.0 ? ".spacing" : ""),
              number_text(spacing) + " m makes " + number_text(points) + " points; expected at most 10^7");
  }

  void wall_shear(const WallShear& w, const std::string& dotted) {
    const Phase *fluid = find_phase(scene_, w.phase), *rough = find_phase(scene_, w.wall);
    if (rough && (rough->kind() != PhaseKind::wall || !rough->wall().roughness)) rough = nullptr;
    if (!rough && fluid && fluid->kind() == PhaseKind::fluid && fine(dotted + ".phase") &&
        !report_.touched("phases." + fluid->name) && fluid->fluid().viscosity <= 0.0 &&
        fluid->fluid().artificial_viscosity <= 0.0)
      report_(dotted + ".phase", "\"" + fluid->name +
                                     "\" has no viscosity, so that it shears nothing; expected phases." + fluid->name +
                                     ".viscosity above 0");
    if (!fine(dotted + ".wall")) return;
    const Phase* wall = find_phase(scene_, w.wall);
    if (!wall) return report_(dotted + ".wall", unknown_phase(w.wall, scene_));
    if (report_.touched("phases." + wall->name)) return;
    const auto wrong = [&](const std::string& what) { report_(dotted + ".wall", "\"" + wall->name + "\" " + what); };
    if (wall->kind() != PhaseKind::wall)
      return wrong(std::string("is of kind ") + wall->kind_word() + "; expected a phase of kind wall");
    if (wall->wall().slip != Slip::no_slip || wall->wall().law != WallLaw::adami)
      return wrong("lets the fluid slip; expected a wall with slip = \"no-slip\" and law = \"adami\"");
    if (wall->wall().shear_stress)
      return wrong("has a given stress (shear-stress): there is nothing to measure; expected another wall");
    const bool fitted = !w.top && std::any_of(scene_.fills.begin(), scene_.fills.end(), [&](const Fill& fill) {
      return fill.phase == wall->name && fill.packing == Packing::fitted;
    });
    if (!fitted && !stands_on_side(*wall, w) && !report_.misread("fill"))
      return wrong("has no fill on this side; expected shape = { sides = [\"" + std::string(w.top ? "top" : "bottom") +
                   "\"] } in one of its fills" + (w.top ? "" : ", or a bed with packing = \"fitted\"") +
                   " (of other walls the surface is not known)");
    const bool joined = std::any_of(scene_.interactions.begin(), scene_.interactions.end(), [&](const Interaction& i) {
      return (i.a == w.phase && i.b == w.wall) || (i.a == w.wall && i.b == w.phase);
    });
    if (!joined && fluid && !report_.misread("interactions"))
      wrong("does not interact with \"" + w.phase + "\"; expected an entry " + w.phase + "-" + w.wall +
            " in [interactions]");
    else if (fluid && fluid->kind() == PhaseKind::fluid && !report_.misread("phases"))
      rubs(*fluid, *wall, fitted, wrong);
  }

  void saltation(const SaltationLayer& s, const std::string& dotted) {
    const Phase* phase = find_phase(scene_, s.phase);
    if (phase && fine(dotted + ".phase") && !report_.touched("phases." + phase->name + ".kind") &&
        phase->kind() != PhaseKind::grains)
      report_(dotted + ".phase",
              "\"" + phase->name + "\" is of kind " + phase->kind_word() + "; expected a phase of kind grains");
  }

 private:
  bool stands_on_side(const Phase& wall, const WallShear& w) const {
    return std::any_of(scene_.fills.begin(), scene_.fills.end(), [&](const Fill& fill) {
      const auto* sides = std::get_if<SidesShape>(&fill.shape);
      return fill.phase == wall.name && sides &&
             std::find(sides->sides.begin(), sides->sides.end(), w.top ? "top" : "bottom") != sides->sides.end();
    });
  }

  /// Whether the stress of a fluid on a wall is known.
  template <class Wrong>
  void rubs(const Phase& fluid, const Phase& wall, bool fitted, const Wrong& wrong) {
    if (!wall.wall().roughness && fluid.fluid().turbulence != Turbulence::none)
      return wrong("is smooth, and \"" + fluid.name +
                   "\" is turbulent: the layer in which its viscosity acts is not resolved; expected phases." +
                   wall.name + ".roughness, or turbulence = \"none\"");
    if (!wall.wall().roughness || !drags_by_law(scene_, fluid)) return;
    if (!fitted)
      return wrong(
          "is not the ground of the wind over sand, whose layers say the stress; expected the bed with packing = "
          "\"fitted\" under the grains");
    const auto drags = std::count_if(scene_.interactions.begin(), scene_.interactions.end(), [&](const Interaction& i) {
      return (i.a == fluid.name || i.b == fluid.name) && i.drag_law != DragLaw::none;
    });
    if (drags > 1)
      wrong("lies under the layers of several phases of grains in \"" + fluid.name +
            "\"; expected one phase of grains with a law of drag by name");
  }

  bool fine(const std::string& dotted) const { return report_.has(dotted) && !report_.touched(dotted); }
  std::size_t dimensions() const { return static_cast<std::size_t>(scene_.dimensions); }

  void slices(const Profile& p, const std::string& dotted) {
    if (!p.box) return;
    inside(p.box->min, dotted + ".box.min");
    inside(p.box->max, dotted + ".box.max");
    if (fine(dotted + ".along") && p.along >= dimensions())
      report_(dotted + ".along", "there is no z in two dimensions; expected x or y");
    if (!fine(dotted + ".box.min") || !fine(dotted + ".box.max")) return;
    for (std::size_t axis = 0; axis < dimensions(); ++axis)
      if (!(p.box->max[axis] > p.box->min[axis]))
        return report_(dotted + ".box.max",
                       std::string("not above min along ") + "xyz"[axis] + "; expected a box with a size");
  }

  const Scene& scene_;
  const Report& report_;
  bool box_known_;
};

}  // namespace

void check_measuring(const Scene& scene, const Report& report) {
  Checker checker(scene, report);
  const Measuring& m = scene.measuring;
  const auto place = [](const char* section, std::size_t k) { return section + ("." + std::to_string(k)); };
  for (std::size_t k = 0; k < m.probes.size(); ++k) {
    checker.common(m.probes, k, place("probe", k), false);
    checker.inside(m.probes[k].at, place("probe", k) + ".at");
  }
  for (std::size_t k = 0; k < m.gauges.size(); ++k) {
    checker.common(m.gauges, k, place("gauge", k), false);
    checker.inside(m.gauges[k].at, place("gauge", k) + ".at");
  }
  for (std::size_t k = 0; k < m.profiles.size(); ++k) {
    checker.common(m.profiles, k, place("profile", k), m.profiles[k].box.has_value());
    checker.profile(m.profiles[k], place("profile", k));
  }
  for (std::size_t k = 0; k < m.grids.size(); ++k) {
    checker.common(m.grids, k, place("grid", k), false);
    checker.grid(m.grids[k], place("grid", k));
  }
  for (std::size_t k = 0; k < m.saltation.size(); ++k) {
    checker.common(m.saltation, k, place("saltation", k), true);
    checker.saltation(m.saltation[k], place("saltation", k));
  }
  for (std::size_t k = 0; k < m.wall_shears.size(); ++k) {
    checker.common(m.wall_shears, k, place("wall-shear", k), false);
    checker.wall_shear(m.wall_shears[k], place("wall-shear", k));
  }
}

}  // namespace barchan
