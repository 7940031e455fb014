// What a scene may mean otherwise, or what will go badly: told by the plan, before and after a run. Nothing here is
// wrong for certain, else it would be refused.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/errors.hpp"
#include "models/fluid/flow_zone.hpp"
#include "output/numbers.hpp"
#include "plan/plan.hpp"
#include "plan/side_warnings.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"
#include "scene/side_names.hpp"
#include "start/ball_surfaces.hpp"
#include "start/flow_ends.hpp"
#include "start/thin_wall.hpp"

namespace barchan {
namespace {

/// Under the cubic spline particles pair when the kernel is wide: of the perturbed Taylor-Green vortices (plain scheme,
/// t = 1) 0, 11, 30 and 61 % stood nearer than half a spacing with 2.4, 2.5, 2.6 and 3 spacings; in 3D from 57
/// neighbours, 2.4 spacings (Dehnen & Aly 2012). Wendland's kernels do not pair.
constexpr double widest_cubic_spline = 2.4;

/// The scene says that the two do not interact: nobody is told.
bool meant_apart(const Scene& scene, const std::string& a, const std::string& b) {
  return std::any_of(scene.apart.begin(), scene.apart.end(), [&](const auto& pair) {
    return (pair[0] == a && pair[1] == b) || (pair[0] == b && pair[1] == a);
  });
}

bool stands_behind_sides(const Scene& scene, const Phase& wall) {
  return std::any_of(scene.fills.begin(), scene.fills.end(), [&](const Fill& fill) {
    return fill.phase == wall.name && std::holds_alternative<SidesShape>(fill.shape);
  });
}

void warn_of_pairing(const Scene& scene, Plan& plan) {
  for (const PlanEntry& e : plan.entries)
    if (plan.phases[e.a].flows() && plan.phases[e.b].flows() && e.kernel == KernelKind::cubic_spline &&
        e.radius > widest_cubic_spline * e.spacing * (1.0 + 1e-9))
      plan.warnings.push_back(
          "interactions." + e.name +
          ": under the cubic spline particles pair with more than 2.4 spacings, and the run may die of "
          "it; take kernel = \"wendland-c2\"" +
          (scene.phases[e.a].fluid().scheme == FluidScheme::plain ? " or a smaller radius" : ""));
}

/// Grains sink in a dense fluid as in a vacuum with its drag, if nobody says that it bears them.
void warn_of_missing_buoyancy(const Scene& scene, Plan& plan) {
  constexpr double dense = 0.01;  // of the grains' density: the speed of sinking is then 0.5 % off
  for (const PlanEntry& e : plan.entries) {
    if (!e.blows || e.given.buoyancy || norm(scene.domain.gravity) == 0.0) continue;
    const Phase &fluid = scene.phases[e.fluid], &grains = scene.phases[e.other];
    if (fluid.density > dense * grains.density && fluid.density < grains.density)
      plan.warnings.push_back("interactions." + e.name + ": \"" + fluid.name + "\" is " +
                              brief(fluid.density / grains.density) + " times as dense as \"" + grains.name +
                              "\" and does not bear it; add buoyancy = true");
  }
}

void warn_of_walls_that_let_through(const Scene& scene, Plan& plan) {
  const auto meet = [&](std::size_t a, std::size_t b) {
    return entry_between(scene, scene.phases[a], scene.phases[b]);
  };
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& phase = plan.phases[k];
    for (std::size_t w = 0; w < plan.phases.size() && phase.moves(); ++w) {
      const PlanPhase& wall = plan.phases[w];
      if (wall.moves() || wall.count == 0 || meet(k, w) || meant_apart(scene, phase.name, wall.name)) continue;
      if (phase.flows() && !stands_behind_sides(scene, scene.phases[w])) continue;  // it may lie under a bed
      plan.warnings.push_back("interactions: no entry " + phase.name + "-" + wall.name + ": the wall \"" + wall.name +
                              "\" does not hold \"" + phase.name + "\", which passes through it; " + phase.name + "-" +
                              wall.name + " = false says that it is meant");
    }
  }
}

void warn_of_loose_bodies(const Scene& scene, Plan& plan) {
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    if (p.deforms() && p.count > 1 && !entry_between(scene, scene.phases[k], scene.phases[k]) &&
        !meant_apart(scene, p.name, p.name))
      plan.warnings.push_back("interactions: no entry " + p.name + "-" + p.name + ": nothing holds the body \"" +
                              p.name + "\" together");
    const bool body = p.moves() && !p.flows() && !p.own_steps() && p.count > 0;
    if (body && norm(scene.domain.gravity) > 0.0 &&
        std::none_of(plan.entries.begin(), plan.entries.end(),
                     [&](const PlanEntry& e) { return e.has(k) && e.partner(k) != k; }) &&
        std::none_of(scene.motions.begin(), scene.motions.end(), [&](const auto& m) { return m.phase == p.name; }))
      plan.warnings.push_back("interactions: no entry of \"" + p.name +
                              "\" with another phase: it falls; expected one with what bears it, as " + p.name +
                              "-floor");
  }
}

/// A wall that bodies touch by its particles is rough by their lattice: a ball leaves it sideways.
void warn_of_lattices(Plan& plan) {
  for (const PlanEntry& e : plan.entries)
    for (const std::size_t wall : {e.a, e.b})
      if (e.feels_lattice && !plan.phases[wall].moves())
        plan.warnings.push_back(
            "interactions." + e.name + ": the shape of \"" + plan.phases[wall].name +
            "\" has no outline for contacts, and bodies touch the lattice of its particles; a "
            "shape with one: sides, box, cube, polygon, surface of lines, in 2D also disc, ring, in 3D sphere");
}

/// Spheres touch a wall that moves by its shape where that has ends.
void warn_of_prisms_that_move(const Scene& scene, Plan& plan) {
  for (std::size_t w = 0; w < plan.phases.size(); ++w)
    for (std::size_t f = 0; f < scene.fills.size(); ++f) {
      if (scene.fills[f].phase != plan.phases[w].name) continue;
      if (!moves_as_rows(scene, scene.phases[w], scene.fills[f].shape)) continue;
      for (std::size_t k = 0; k < plan.phases.size(); ++k)
        if (plan.phases[k].own_steps() && entry_between(scene, scene.phases[k], scene.phases[w]))
          plan.warnings.push_back("fill." + std::to_string(f) +
                                  ".shape: in 3D a disc, a ring or a polygon that moves " +
                                  "is rows of spheres of one spacing to the grains of \"" + plan.phases[k].name +
                                  "\": a rough wall, through which smaller grains may pass; a closed surface of a " +
                                  "file is touched by its shape");
    }
}

/// A bar in a box is as thick as its rows of particles, and bends as those do. docs/impacts.md has the cantilever.
void warn_of_thickness(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan) {
  constexpr double share = 0.01;  // of the thickness: 3 % of what bends
  constexpr double few = 4.0;     // particles across
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const auto is_own = [&](const Fill& fill) { return fill.phase == plan.phases[k].name; };
    const auto fill = std::find_if(scene.fills.begin(), scene.fills.end(), is_own);
    if (!plan.phases[k].deforms() || std::count_if(scene.fills.begin(), scene.fills.end(), is_own) != 1) continue;
    const auto* box = std::get_if<BoxShape>(&fill->shape);
    if (!box || fill->packing != Packing::square || blocks[k].position.size() < 2) continue;
    const double dx = plan.phases[k].spacing;
    for (std::size_t d = 0; d < static_cast<std::size_t>(plan.dimensions); ++d) {
      double low = 1e300, high = -1e300;
      for (const Vec3& x : blocks[k].position) low = std::min(low, x[d]), high = std::max(high, x[d]);
      const double said = box->max[d] - box->min[d], rows = std::round((high - low) / dx) + 1.0;
      char text[400];
      if (std::abs(rows * dx / said - 1.0) > share) {
        std::snprintf(
            text, sizeof text,
            "fill.%zu.shape.box: along %c the box is %.4g m and the body %.0f rows of %.4g m, %.4g m (%+.1f %%): "
            "what bends it is of the rows; a spacing of %.6g m fits",
            static_cast<std::size_t>(fill - scene.fills.begin()), "xyz"[d], said, rows, dx, rows * dx,
            100.0 * (rows * dx / said - 1.0), said / rows);
        plan.warnings.emplace_back(text);
      }
      if (rows < few && rows > 1.0) {
        std::snprintf(
            text, sizeof text,
            "phases.%s: %.0f particles across along %c: a bar of two bends 26 %% too little; expected %.0f at least",
            plan.phases[k].name.c_str(), rows, "xyz"[d], few);
        plan.warnings.emplace_back(text);
      }
    }
  }
}

/// A fluid that is on both sides of a wall, or may come there, must not reach through it. Where it is on one side only
/// the kernel may lack a row: the last has next to no weight.
void look_at_thin_walls(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan) {
  std::string refused;
  for (const PlanEntry& e : plan.entries) {
    const PlanPhase& wall = plan.phases[e.other];
    if (!e.extends || wall.moves() || wall.count == 0) continue;
    const auto thin = thin_wall(scene, blocks, e.other, e.fluid, e.radius);
    if (!thin) continue;
    const bool wet = thin->wet[0] && thin->wet[1], both = wet || wall.travels();
    const double missing = e.radius / wall.spacing * (1.0 - 1e-9) - thin->rows;  // rows, where nothing is behind
    if (!both && missing <= 0.5) continue;                                       // it may be the wall of a vessel
    const double needed = both ? 2.0 * e.radius - e.spacing : e.radius - 0.5 * e.spacing;
    char text[500];
    std::snprintf(text, sizeof text,
                  ": the wall \"%s\" is %.2g rows of %.4g m thick at (%.4g, %.4g%s%s) m, and the kernel "
                  "of \"%s\" reaches through it: %s; expected a wall of %.4g m, %s, which this one is with a spacing "
                  "of %.3g m",
                  wall.name.c_str(), thin->rows, wall.spacing, thin->at[0], thin->at[1],
                  plan.dimensions == 3 ? ", " : "", plan.dimensions == 3 ? brief(thin->at[2]).c_str() : "",
                  plan.phases[e.fluid].name.c_str(),
                  wet              ? "the fluid on one side presses the fluid on the other"
                  : wall.travels() ? "a fluid that comes to both sides of a wall that moves acts on itself through it"
                  : missing > 1.25 ? "the fluid would fall through it"
                                   : "the fluid misses a part of it",
                  needed, both ? "twice the kernel radius less a spacing" : "the kernel radius less half a spacing",
                  thin->rows * wall.spacing * e.spacing / needed);
    if (both || missing > 1.25)
      refused += (refused.empty() ? "" : "\n") + located(scene, "interactions." + e.name) + text;
    else plan.warnings.push_back("interactions." + e.name + text);
  }
  if (!refused.empty()) throw SceneError(refused);
}

/// Suction takes a fluid of plain sums apart, and a flow that slows down is under suction.
void warn_of_suction(const Scene& scene, Plan& plan) {
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    if (!plan.phases[k].flows() || !flow_changes(scene, scene.phases[k])) continue;
    const FluidKeys& fluid = scene.phases[k].fluid();
    if (fluid.scheme == FluidScheme::plain && fluid.background_pressure == 0.0)
      plan.warnings.push_back("phases." + plan.phases[k].name +
                              ".scheme: a flow through sides that changes with time is under suction when it slows "
                              "down, and the plain scheme comes apart (a tide kept 55 % of its particles); expected "
                              "background-pressure = 0.05, or scheme = \"consistent\"");
  }
}

/// The pressure of a fluid at rest pushes its free surface; plain sums have nothing that holds it.
void warn_of_background_pressure(const Scene& scene, Plan& plan) {
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    if (!p.free_surface || scene.phases[k].fluid().scheme != FluidScheme::plain) continue;
    if (scene.phases[k].fluid().background_pressure > 0)
      plan.warnings.push_back("phases." + p.name +
                              ".background-pressure: it blows the free surface of a fluid of the plain scheme away (a "
                              "still tank lost 71 % of its water in 1 s with 0.01); expected 0, or scheme = "
                              "\"consistent\"");
  }
}

/// What has no entry passes through each other: two fluids, and the grains of one phase.
void warn_of_what_does_not_meet(const Scene& scene, Plan& plan) {
  for (std::size_t a = 0; a < plan.phases.size(); ++a) {
    const PlanPhase& p = plan.phases[a];
    const bool enters = std::any_of(scene.influxes.begin(), scene.influxes.end(),
                                    [&](const Influx& influx) { return influx.phase == p.name; });
    if (p.own_steps() && (p.count > 1 || enters) && !entry_between(scene, scene.phases[a], scene.phases[a]) &&
        !meant_apart(scene, p.name, p.name))
      plan.warnings.push_back("interactions: no entry " + p.name + "-" + p.name + ": the grains of \"" + p.name +
                              "\" pass through each other");
    for (std::size_t b = 0; b < a; ++b)
      if (p.flows() && plan.phases[b].flows() && p.count > 0 && plan.phases[b].count > 0 &&
          !entry_between(scene, scene.phases[a], scene.phases[b]) && !meant_apart(scene, p.name, plan.phases[b].name))
        plan.warnings.push_back("interactions: no entry " + plan.phases[b].name + "-" + p.name + ": the fluids \"" +
                                plan.phases[b].name + "\" and \"" + p.name +
                                "\" do not interact and pass through each other");
    for (std::size_t b = 0; b < plan.phases.size(); ++b) {
      const PlanPhase& body = plan.phases[b];
      if (p.flows() && body.moves() && !body.flows() && !body.own_steps() && p.count > 0 && body.count > 0 &&
          !entry_between(scene, scene.phases[a], scene.phases[b]) && !meant_apart(scene, p.name, body.name))
        plan.warnings.push_back("interactions: no entry " + p.name + "-" + body.name + ": \"" + p.name + "\" and \"" +
                                body.name + "\" pass through each other; " + p.name + "-" + body.name +
                                " = false says that it is meant");
    }
  }
}

/// What holds the mean speed of a wind pulls as hard as grains brake, and no friction velocity is given.
void warn_of_held_speed_over_grains(const Scene& scene, Plan& plan) {
  for (std::size_t k = 0; k < scene.forcings.size(); ++k) {
    const Forcing& f = scene.forcings[k];
    if (f.hold != Hold::bulk_speed) continue;
    for (const PlanEntry& e : plan.entries)
      if (e.blows && plan.phases[e.fluid].name == f.phase)
        plan.warnings.push_back(
            "forcing." + std::to_string(k) +
            ".hold: a wind whose bulk speed is held is pulled as hard as the grains of \"" + plan.phases[e.other].name +
            "\" brake it: its friction velocity u* is a result, which history.csv reports (" + f.phase +
            "_equivalent_friction_velocity); hold = \"stress\" or \"pressure-gradient\" keeps u*");
  }
}

void warn_of_strong_winds(Plan& plan) {
  for (const PlanEntry& e : plan.entries)
    if (const std::string& told = plan.phases[e.fluid].wind.beyond_measured; e.blows && !told.empty())
      plan.warnings.push_back(told);
}

/// Frames and rows cut steps: more often than steps, and the run is as much longer.
void warn_of_output(const Scene& scene, Plan& plan) {
  const double step = plan.step(), rows = row_interval(scene);
  const auto text = [](double x) {
    char number[32];
    std::snprintf(number, sizeof number, "%.4g", x);
    return std::string(number);
  };
  const auto shorter = [&](const std::string& key, double every, const char* what) {
    plan.warnings.push_back(key + ": " + text(every) + " s is shorter than the first step, " + text(step) + " s: " +
                            what + " cut the steps, and the run takes " + text(step / every) + " times as many");
  };
  if (scene.output.every > 0.0 && scene.output.every < 0.999 * step)
    shorter("output.every", scene.output.every, "frames");
  if (scene.output.history_every > 0.0 && rows < 0.999 * step) shorter("output.history-every", rows, "rows");
  if (scene.output.every > scene.time.end * (1.0 + 1e-9))
    plan.warnings.push_back("output.every: " + text(scene.output.every) + " s is beyond time.end, " +
                            text(scene.time.end) + " s: there are a first frame and a last one only");
  if (scene.output.history_every > scene.time.end * (1.0 + 1e-9))
    plan.warnings.push_back("output.history-every: " + text(scene.output.history_every) + " s is beyond time.end, " +
                            text(scene.time.end) + " s: there is a first row only");
  if (scene.output.every > 0.0 && scene.time.end / scene.output.every > 1.0001e4)
    plan.warnings.push_back("output.every: " + text(scene.output.every) + " s makes " +
                            text(scene.time.end / scene.output.every) + " frames");
}

/// What begins after the end measures nothing, and what samples less often than that measures the start alone.
void warn_of_late_instruments(const Scene& scene, Plan& plan) {
  for (const Instrument& i : plan.instruments)
    if (i.start > scene.time.end)
      plan.warnings.push_back(kind_name(i.kind) + " \"" + i.name + "\" starts after time.end and measures nothing");
    else if (i.every > scene.time.end)
      plan.warnings.push_back(kind_name(i.kind) + " \"" + i.name + "\" has every = " + brief(i.every) +
                              " s beyond time.end and measures once at most");
}

void warn_of_weight(const Scene& scene, Plan& plan) {
  const auto up = static_cast<std::size_t>(1);
  if (scene.domain.gravity[up] > 0.0)
    plan.warnings.emplace_back("domain.gravity: it points upwards, along +y; weight is along -y, as in [0, -9.81]");
}

/// Beds, the sides by name, and grains that enter have their heights along y, or along z where gravity is along -z.
void warn_of_another_up(const Scene& scene, Plan& plan) {
  const Vec3& g = scene.domain.gravity;
  const std::size_t axis = std::abs(g[2]) > std::abs(g[0]) ? 2 : 0;
  if (scene.dimensions == 2 || up_axis(scene.domain) == 2 || g[1] != 0.0 || g[axis] == 0.0 ||
      scene.domain.periodic[axis])
    return;
  std::string uses;
  const auto add = [&](const std::string& use) { uses += (uses.empty() ? "" : ", ") + use; };
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Fill& fill = scene.fills[k];
    const std::string dotted = "fill." + std::to_string(k);
    if (std::holds_alternative<BedShape>(fill.shape)) add(dotted + ".shape.bed");
    if (fill.packing == Packing::settled) add(dotted + ".packing");
    if (const auto* sides = std::get_if<SidesShape>(&fill.shape))
      for (const std::string& side : sides->sides)
        if (side == "bottom" || side == "top") add(dotted + ".shape.sides = \"" + side + "\"");
  }
  for (std::size_t k = 0; k < scene.influxes.size(); ++k)
    if (!scene.influxes[k].box) add("influx." + std::to_string(k));
  if (!uses.empty())
    plan.warnings.push_back("domain.gravity: it points along " + std::string(1, static_cast<char>('x' + axis)) +
                            ", and the heights of " + uses +
                            " are along y: \"bottom\" and \"top\" are the sides across y, a bed lies on the first; "
                            "turn the scene so that gravity is along -y or -z, as in [0, 0, -9.81]");
}

/// Where heights are along z, "back" is the upper side along y: who means the floor says "bottom".
void warn_of_no_bottom(const Scene& scene, Plan& plan) {
  if (scene.dimensions == 2 || up_axis(scene.domain) != 2) return;
  const auto stands_at = [&](const char* side) {
    return std::any_of(scene.fills.begin(), scene.fills.end(), [&](const Fill& fill) {
      const auto* sides = std::get_if<SidesShape>(&fill.shape);
      return sides && std::count(sides->sides.begin(), sides->sides.end(), side) > 0;
    });
  };
  if (stands_at("back") && !stands_at("bottom"))
    plan.warnings.emplace_back(
        "domain.gravity: it is along -z, so that \"bottom\" is the lower side of z and \"back\" the upper side of y; a "
        "wall "
        "stands at \"back\" and none at \"bottom\"");
}

/// Grains that enter faster or more densely than in any wind: a flux in g, or a speed in mm/s. A liquid carries dense
/// layers along its bed.
void warn_of_influxes(const Scene& scene, Plan& plan) {
  const std::size_t up = up_axis(scene.domain);
  constexpr double fastest = 100.0;  // m/s
  constexpr double liquid = 100.0;   // kg/m3
  bool is_wind = true;
  for (std::size_t k = 0; k < scene.phases.size(); ++k)
    is_wind = is_wind && !(plan.phases[k].flows() && scene.phases[k].density > liquid);
  const double dense = is_wind ? 0.05 : 0.4;  // of the volume at the lowest place; saltation has some 1e-3 there
  for (std::size_t k = 0; k < scene.influxes.size(); ++k) {
    const Influx& influx = scene.influxes[k];
    const std::string key = "influx." + std::to_string(k);
    if (influx.box) {
      // What falls out of the box in the time in which a grain crosses it, a quarter full: grains are put in at random.
      constexpr double full = 0.25;
      double room = 1.0;
      for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d)
        if (d != up) room *= influx.box->max[d] - influx.box->min[d];
      const double height = influx.box->max[up] - influx.box->min[up];
      const double speed = std::max(norm(influx.velocity), std::sqrt(2.0 * norm(scene.domain.gravity) * height));
      const double most = full * find_phase(scene, influx.phase)->density * room * speed;
      if (influx.flux > most)
        plan.warnings.push_back(key + ".flux: " + brief(influx.flux) + (scene.dimensions == 2 ? " kg/m/s" : " kg/s") +
                                " is more than the box can take, about " + brief(most) +
                                ": grains that find no room enter later or never; expected a larger box, a higher "
                                "velocity, or less");
    }
    if (!influx.speed || !influx.decay_height) continue;
    const double bottom = scene.domain.origin[up], h = *influx.decay_height;
    const double room = bottom + scene.domain.size[up] - influx.above.value_or(bottom);
    // Of a flux that falls as exp(-y/h): its density over that of the grains, at y = 0.
    const double share =
        influx.flux / (*influx.speed * h * -std::expm1(-room / h)) / find_phase(scene, influx.phase)->density;
    if (share > dense)
      plan.warnings.push_back(key + ".flux: " + brief(influx.flux) + " kg/m/s at " + brief(*influx.speed) +
                              " m/s fills " + brief(100.0 * share) +
                              " % of the space at the height where most grains enter: they collide there, and those "
                              "without room enter later or never" +
                              (is_wind ? "; sand in a wind has a flux of 0.01 to 0.1 kg/m/s" : ""));
    if (*influx.speed > fastest)
      plan.warnings.push_back(
          key + ".speed: at " + brief(*influx.speed) +
          " m/s a contact lasts as short as the steps must be then; grains in a wind have some m/s");
  }
}

/// Spacings. Below, water of plain sums presses 11 % less on a plate between two depths than it should, from here on 1
/// to 3 % (bench/robustness/thin_walls.py).
constexpr double least_plain_radius = 1.8;

/// A radius below one spacing meets no neighbour: it may have been meant in the other unit.
void warn_of_small_radius(const Scene& scene, Plan& plan) {
  for (const PlanEntry& e : plan.entries) {
    const Interaction& pair = *entry_between(scene, scene.phases[e.a], scene.phases[e.b]);
    const bool presses = std::any_of(plan.entries.begin(), plan.entries.end(),
                                     [&](const PlanEntry& other) { return other.extends && other.has(e.a); });
    if (e.a == e.b && presses && plan.phases[e.a].flows() && scene.phases[e.a].fluid().scheme == FluidScheme::plain &&
        e.radius >= e.spacing && e.radius < least_plain_radius * e.spacing * (1.0 - 1e-9))
      plan.warnings.push_back("interactions." + e.name +
                              ": with a radius below 1.8 spacings the plain scheme presses about 11 % less on walls "
                              "than the fluid at rest should; expected 1.8 or more, or scheme = \"consistent\"");
    const double stated = pair.radius_in_metres.value_or(pair.radius * e.spacing);
    if (pair.states_radius && !e.own_steps() && e.a != e.b && std::abs(e.radius - stated) > 1e-6 * stated) {
      plan.warnings.push_back("interactions." + e.name + ": its radius is not used: the two touch by their surfaces; " +
                              e.name + " = {} says all, or { restitution = 0.9 }");
      continue;
    }
    if (e.own_steps() || e.self_contact || !(pair.radius > 0.0 && pair.radius < 1.0)) continue;
    plan.warnings.push_back(
        "interactions." + pair.a + "-" + pair.b + ": a radius below one spacing meets no neighbour of a lattice; " +
        (pair.radius_in_metres ? "radius says one in spacings" : "radius-in-metres says one in metres"));
  }
}

/// Numbers that are right in other units: lengths in mm, densities in g/cm3, a dynamic viscosity.
void warn_of_units(const Scene& scene, Plan& plan) {
  constexpr double longest = 500.0, shortest = 1e-4;        // m, of a domain
  constexpr double lightest = 20.0;                         // kg/m3, of grains
  constexpr double water = 1000.0, water_viscosity = 1e-6;  // kg/m3, m2/s
  double length = 0.0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d)
    length = std::max(length, scene.domain.size[d]);
  if (length > longest || length < shortest)
    plan.warnings.push_back("domain.size: the domain is " + brief(length) + " m long; lengths are in m");
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const Phase& phase = scene.phases[k];
    const bool liquid = plan.phases[k].free_surface && norm(scene.domain.gravity) > 0.0;
    const double times = liquid ? phase.fluid().viscosity / water_viscosity : 0.0;
    const bool in_grams = times > 0.5 && times < 2.0 && std::abs(1000.0 * phase.density / water - 1.0) < 0.1;
    const bool spheres = plan.phases[k].own_steps(), body = plan.phases[k].deforms();
    if (in_grams || (spheres && phase.density < lightest) || (body && phase.density < 0.5 * lightest))
      plan.warnings.push_back("phases." + phase.name + ".density: " + brief(phase.density) + " kg/m3 is light for " +
                              (in_grams  ? "a liquid (water has 1000)"
                               : spheres ? "grains (quartz has 2650)"
                                         : "a solid (rubber has 1100)") +
                              "; densities are in kg/m3");
    if (!liquid || std::abs(phase.density / water - 1.0) > 0.1) continue;
    if (times > 500.0 && times < 2000.0)
      plan.warnings.push_back("phases." + phase.name + ".viscosity: " + brief(phase.fluid().viscosity) + " m2/s is " +
                              brief(times) +
                              " times that of water; it is the kinematic viscosity, of water 1e-6 m2/s (1e-3 Pa s over "
                              "its density)");
  }
}

/// In 2D all spheres lie in one slab, so that small ones fill less of its thickness.
void warn_of_two_sizes_in_a_slab(const Scene& scene, Plan& plan) {
  constexpr double alike = 0.8;  // of the diameters
  const PlanPhase *small = nullptr, *large = nullptr;
  for (const PlanPhase& p : plan.phases) {
    if (!p.own_steps()) continue;
    if (!small || p.diameter < small->diameter) small = &p;
    if (!large || p.diameter > large->diameter) large = &p;
  }
  if (scene.dimensions == 3 || !small || small->diameter > alike * large->diameter) return;
  plan.warnings.push_back(
      "dimensions: in 2D all grains are spheres in one slab, as thick as the largest mean diameter: a "
      "region of \"" +
      small->name + "\" has " + brief(small->diameter / large->diameter) + " of the mass that one of \"" + large->name +
      "\" has; a density of \"" + small->name + "\" " + brief(large->diameter / small->diameter) +
      " times as high makes up for it, or dimensions = 3");
}

/// What moves has weight in most scenes: a liquid or grains over a bottom without gravity may have been forgotten.
void warn_of_no_weight(const Scene& scene, Plan& plan) {
  if (scene.places.contains("domain.gravity") || norm(scene.domain.gravity) > 0.0) return;
  const bool on_bottom = std::any_of(scene.fills.begin(), scene.fills.end(), [](const Fill& fill) {
    const auto* sides = std::get_if<SidesShape>(&fill.shape);
    return sides && std::count(sides->sides.begin(), sides->sides.end(), "bottom") > 0;
  });
  for (std::size_t k = 0; k < plan.phases.size() && on_bottom; ++k)
    if (const PlanPhase& p = plan.phases[k]; p.free_surface || p.own_steps())
      return plan.warnings.push_back("domain.gravity: none, and \"" + p.name +
                                     "\" over the bottom has no weight; expected gravity = [0, -9.81" +
                                     (scene.dimensions == 3 ? ", 0]" : "]") + ", or [0, 0" +
                                     (scene.dimensions == 3 ? ", 0]" : "]") + " where that is meant");
}

/// Numbers of gravity in other units, sounds far above what a scene needs, and influxes that never begin.
void warn_of_numbers(const Scene& scene, Plan& plan) {
  constexpr double heavy = 50.0, too_stiff = 100.0;  // m/s2; of the largest speed
  if (const double g = norm(scene.domain.gravity); g > heavy)
    plan.warnings.push_back("domain.gravity: " + brief(g) + " m/s2 is " + brief(g / 9.81) +
                            " times that of the earth, 9.81 m/s2");
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    if (!p.flows() || !scene.phases[k].fluid().sound_speed || !(plan.largest_speed > 0.0)) continue;
    const double falls = std::sqrt(2.0 * norm(scene.domain.gravity) *
                                   scene.domain.size[up_axis(scene.domain)]);  // m/s, through the domain
    const double fastest = std::max(plan.largest_speed, falls);
    if (p.sound_speed > too_stiff * fastest)
      plan.warnings.push_back("phases." + p.name + ".sound-speed: " + brief(p.sound_speed) + " m/s is " +
                              brief(p.sound_speed / fastest) + " times what the scene can reach, " + brief(fastest) +
                              " m/s; ten times suffice, and the run is that much shorter");
  }
  for (std::size_t k = 0; k < scene.influxes.size(); ++k)
    if (scene.influxes[k].start > scene.time.end)
      plan.warnings.push_back("influx." + std::to_string(k) + " starts after time.end: nothing enters");
}

/// An atmosphere at the start: a free surface is at 0 Pa.
void warn_of_start_pressure(const Scene& scene, Plan& plan) {
  constexpr double large = 0.02;  // of rho c2: density is that much higher
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Fill& fill = scene.fills[k];
    const auto phase =
        std::find_if(plan.phases.begin(), plan.phases.end(), [&](const auto& p) { return p.name == fill.phase; });
    if (phase == plan.phases.end() || !phase->free_surface || fill.hydrostatic || fill.pressure.is_formula()) continue;
    const double density = scene.phases[static_cast<std::size_t>(phase - plan.phases.begin())].density;
    if (fill.pressure.value > large * density * phase->sound_speed * phase->sound_speed)
      plan.warnings.push_back("fill." + std::to_string(k) + ".pressure: " + brief(fill.pressure.value) +
                              " Pa at the start, and \"" + phase->name +
                              "\" has a free surface, which is at 0 Pa: it bursts; pressures are differences from "
                              "that of the air, expected \"hydrostatic\" or no such key");
  }
}

/// Contacts of spheres do not count: what flies alone needs no step for them.
void warn_of_long_step(Plan& plan) {
  double least = 1e300;
  std::string what;
  for (const StepLimit& limit : plan.limits)
    if (limit.value < least && !limit.name.starts_with("contact")) {
      least = limit.value;
      what = limit.name;
    }
  if (plan.fixed_step > 1.5 * least)
    plan.warnings.push_back("time.step: " + brief(plan.fixed_step) + " s is " + brief(plan.fixed_step / least) +
                            " times the step that the scene allows, " + brief(least) + " s (" + what +
                            "): it will break down; leave the key out, and each step is as long as it may be");
}

/// What enters a fluid that fills its space, and cannot leave it.
void warn_of_no_way_out(const Scene& scene, Plan& plan) {
  for (std::size_t k = 0; k < scene.inflows.size(); ++k) {
    const auto same = [&](const auto& end) { return end.phase == scene.inflows[k].phase; };
    const auto found = std::find_if(plan.phases.begin(), plan.phases.end(),
                                    [&](const PlanPhase& p) { return p.name == scene.inflows[k].phase; });
    if (found == plan.phases.end() || found->free_surface || !scene.domain.open.empty()) continue;
    if (std::none_of(scene.outflows.begin(), scene.outflows.end(), same))
      plan.warnings.push_back("inflow." + std::to_string(k) + ": \"" + found->name +
                              "\" enters, and nothing leaves: its pressure rises; expected an [[outflow]]");
  }
}

/// Layers of a side that are thinner than the kernel of the fluid at it.
void warn_of_few_layers(const Scene& scene, Plan& plan) {
  for (std::size_t f = 0; f < scene.fills.size(); ++f) {
    const auto* sides = std::get_if<SidesShape>(&scene.fills[f].shape);
    if (!sides || sides->layers == 0) continue;
    for (const PlanEntry& e : plan.entries) {
      const PlanPhase& wall = plan.phases[e.other];
      const double missing = e.radius / wall.spacing * (1.0 - 1e-9) - sides->layers;
      if (!e.extends || wall.name != scene.fills[f].phase || missing <= 0.5) continue;
      // Of several joined spacings the finest may stand at the wall.
      if (std::any_of(plan.entries.begin(), plan.entries.end(), [&](const PlanEntry& other) {
            return other.extends && other.other == e.other && other.radius < e.radius;
          }))
        continue;
      plan.warnings.push_back("fill." + std::to_string(f) + ".shape.layers: " + std::to_string(sides->layers) + " of " +
                              brief(wall.spacing) + " m, and the kernel of \"" + plan.phases[e.fluid].name +
                              "\" reaches " + brief(e.radius - 0.5 * e.spacing) +
                              " m into the wall: the fluid misses a part of it; expected " +
                              std::to_string(static_cast<int>(std::ceil(e.radius / wall.spacing - 0.5))) +
                              ", or no layers, which makes as many as are needed");
    }
  }
}

}  // namespace

void add_warnings(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan) {
  warn_of_pairing(scene, plan);
  warn_of_missing_buoyancy(scene, plan);
  warn_of_walls_that_let_through(scene, plan);
  warn_of_loose_bodies(scene, plan);
  warn_of_what_does_not_meet(scene, plan);
  warn_of_lattices(plan);
  warn_of_prisms_that_move(scene, plan);
  warn_of_background_pressure(scene, plan);
  warn_of_suction(scene, plan);
  warn_of_thickness(scene, blocks, plan);
  warn_of_missed_mass(scene, blocks, plan);
  look_at_thin_walls(scene, blocks, plan);
  warn_of_held_speed_over_grains(scene, plan);
  warn_of_strong_winds(plan);
  warn_of_output(scene, plan);
  warn_of_late_instruments(scene, plan);
  warn_of_weight(scene, plan);
  warn_of_another_up(scene, plan);
  warn_of_no_bottom(scene, plan);
  warn_of_influxes(scene, plan);
  warn_of_small_radius(scene, plan);
  warn_of_units(scene, plan);
  warn_of_two_sizes_in_a_slab(scene, plan);
  warn_of_no_weight(scene, plan);
  warn_of_numbers(scene, plan);
  warn_of_no_way_out(scene, plan);
  add_side_warnings(scene, blocks, plan);
  warn_of_start_pressure(scene, plan);
  warn_of_long_step(plan);
  warn_of_few_layers(scene, plan);
  warn_outside_stable_ranges(scene, plan);
}

}  // namespace barchan
