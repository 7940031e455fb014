// Of grains that enter: phases that cannot, sides that are none, and keys that nobody reads.
#include <algorithm>

#include "checks/checks.hpp"
#include "scene/side_names.hpp"

namespace barchan {
namespace {

void check_phase(const Scene& scene, const Influx& influx, const std::string& at, const Report& report) {
  if (report.touched(at) || !report.has(at)) return;
  const Phase* phase = find_phase(scene, influx.phase);
  if (!phase) return report(at, unknown_phase(influx.phase, scene));
  if (phase->kind() != PhaseKind::grains || !phase->diameter())
    report(at, "\"" + phase->name +
                   "\" has no spheres that enter one by one; expected a phase of kind grains with a diameter");
}

void check_side(const Scene& scene, const Influx& influx, const std::string& at, const Report& report) {
  if (report.touched(at) || !report.has(at) || report.touched("domain") || report.touched("dimensions")) return;
  const std::string word = word_of(*influx.side);
  check_side_names({word}, at, scene, report);
  const Phase* grains = find_phase(scene, influx.phase);
  if (report.touched(at) || !grains) return;
  for (const Fill& fill : scene.fills) {
    const auto* sides = std::get_if<SidesShape>(&fill.shape);
    const Phase* wall = find_phase(scene, fill.phase);
    if (sides && wall && entry_between(scene, *grains, *wall) &&
        std::find(sides->sides.begin(), sides->sides.end(), word) != sides->sides.end())
      return report(at, "the wall \"" + wall->name + "\" closes \"" + word + "\" to \"" + influx.phase +
                            "\"; expected a side without such a wall");
  }
}

/// No more than grains that are packed as loosely as a stream can still flow, at the speed with which they enter, over
/// the whole height.
void check_flux(const Scene& scene, const Influx& influx, const std::string& dotted, const Report& report) {
  const Phase* grains = find_phase(scene, influx.phase);
  for (const char* key : {"", ".flux", ".speed", ".above"})
    if (report.touched(dotted + key)) return;
  if (!grains || !influx.speed || report.touched("domain") || report.touched("phases." + grains->name + ".density"))
    return;
  constexpr double packing = 0.6;  // of the volume; spheres at random, poured
  const std::size_t up = up_axis(scene.domain);
  const double bottom = scene.domain.origin[up], top = bottom + scene.domain.size[up];
  const double most = packing * grains->density * *influx.speed * (top - influx.above.value_or(bottom));
  if (influx.flux > most)
    report(dotted + ".flux", number_text(influx.flux) + " kg/m/s is more than grains of \"" + grains->name +
                                 "\" can be that enter at " + number_text(*influx.speed) +
                                 " m/s, packed over the whole height of the side; expected at most " +
                                 number_text(most) + " kg/m/s");
}

/// Grains that are poured: a box in the domain that has room for one of them.
void check_box(const Scene& scene, const Influx& influx, const std::string& dotted, const Report& report) {
  for (const char* key : {"file", "above", "decay-height", "speed", "speed-spread", "angle", "angle-spread"})
    if (report.has(dotted + "." + key))
      report(dotted + "." + key, "of grains that enter through a side; expected side in place of box, or no such key");
  const Phase* grains = find_phase(scene, influx.phase);
  if (report.touched(dotted + ".box") || report.touched("domain") || report.touched("dimensions")) return;
  const double least = grains && grains->diameter() ? grains->diameter()->largest() : 0.0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d) {
    const double low = influx.box->min[d], high = influx.box->max[d], rounding = 1e-9 * scene.domain.size[d];
    if (low < scene.domain.origin[d] - rounding || high > scene.domain.origin[d] + scene.domain.size[d] + rounding)
      return report(dotted + ".box", "reaches out of the domain; expected a box in it");
    if (high < low)
      return report(dotted + ".box", "min and max are swapped along " + std::string(1, static_cast<char>('x' + d)) +
                                         "; expected min below max");
    if (!(high - low >= least) || !(high > low))
      return report(dotted + ".box",
                    "a grain of \"" + influx.phase + "\", " + number_text(least) +
                        " m across, has no room in it; expected a larger box" +
                        (least > 0.1 * scene.domain.size[d] ? ", or a smaller diameter in metres" : ""));
  }
}

}  // namespace

void check_influxes(const Scene& scene, const Report& report) {
  for (std::size_t k = 0; k < scene.influxes.size(); ++k) {
    const Influx& influx = scene.influxes[k];
    const std::string dotted = "influx." + std::to_string(k);
    check_phase(scene, influx, dotted + ".phase", report);
    if (influx.end && !(*influx.end > influx.start) && !report.touched(dotted + ".until"))
      report(dotted + ".until",
             "it ends before it starts; expected a time after influx." + std::to_string(k) + ".start");
    if (influx.box && report.has(dotted + ".side"))
      report(dotted + ".side", "grains are poured into the box; expected one of the two");
    if (influx.box) {
      check_box(scene, influx, dotted, report);
      continue;
    }
    if (report.has(dotted + ".velocity"))
      report(dotted + ".velocity", "only of grains that are poured into a box; expected box too, or speed and angle");
    if (!influx.side) {
      if (!report.has(dotted + ".side")) report(dotted + ".side", "missing; expected it, or a box");
      continue;
    }
    check_side(scene, influx, dotted + ".side", report);
    const bool file = report.has(dotted + ".file");
    for (const char* key : {"decay-height", "speed"})
      if (!file && !report.has(dotted + "." + key))
        report(dotted + "." + key, "missing; expected it, or a file of grains in flight");
    for (const char* key : {"decay-height", "speed", "speed-spread", "angle", "angle-spread"})
      if (file && report.has(dotted + "." + key))
        report(dotted + "." + key,
               "the grains of influx." + std::to_string(k) + ".file say how they move; expected one of the two");
    const std::size_t up = up_axis(scene.domain);
    const double bottom = scene.domain.origin[up], top = bottom + scene.domain.size[up];
    if (influx.above && !report.touched(dotted + ".above") && !report.touched("domain") &&
        !(*influx.above >= bottom && *influx.above < top))
      report(dotted + ".above", "no grain could enter from there on; expected a height in the domain");
    if (!file) check_flux(scene, influx, dotted, report);
  }
}

}  // namespace barchan
