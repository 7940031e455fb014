// Of sides through which fluids flow: what cannot enter or leave, and sides that are no such sides.
#include <algorithm>
#include <cmath>

#include "checks/checks.hpp"
#include "start/flow_ends.hpp"

namespace barchan {
namespace {

/// One section [[inflow]] or [[outflow]].
struct Section {
  std::string dotted;  // "inflow.0"
  const std::string& phase;
  Side side;
};

std::vector<Section> sections_of(const Scene& scene) {
  std::vector<Section> all;
  for (std::size_t k = 0; k < scene.inflows.size(); ++k)
    all.push_back({"inflow." + std::to_string(k), scene.inflows[k].phase, scene.inflows[k].side});
  for (std::size_t k = 0; k < scene.outflows.size(); ++k)
    all.push_back({"outflow." + std::to_string(k), scene.outflows[k].phase, scene.outflows[k].side});
  return all;
}

void check_fluid(const Scene& scene, const Section& section, const Report& report) {
  const std::string at = section.dotted + ".phase";
  if (report.touched(at) || !report.has(at)) return;
  const Phase* phase = find_phase(scene, section.phase);
  if (!phase) return report(at, unknown_phase(section.phase, scene));
  if (phase->kind() != PhaseKind::fluid)
    return report(at, "\"" + phase->name + "\" is no fluid; expected a phase of kind fluid");
  if (!report.misread("phases") && phase->fluid().energy)
    report(at, "what enters \"" + phase->name + "\" has no internal energy that the scene says; expected no phases." +
                   phase->name + ".energy");
  if (!report.misread("phases") && phase->fluid().enclosed.value_or(false))
    report(at, "\"" + phase->name + "\" flows through a side and is no closed content; expected no phases." +
                   phase->name + ".enclosed");
  for (std::size_t k = 0; k < scene.forcings.size(); ++k)
    if (scene.forcings[k].phase == phase->name && scene.forcings[k].hold != Hold::none)
      report(at, "forcing." + std::to_string(k) + " holds \"" + phase->name +
                     "\", and what enters says how it flows; expected one of the two");
}

void check_side(const Scene& scene, const Section& section, const std::vector<Section>& others, const Report& report) {
  const std::string at = section.dotted + ".side";
  if (report.touched(at) || !report.has(at) || report.touched("domain") || report.touched("dimensions")) return;
  const std::string word = word_of(section.side);
  check_side_names({word}, at, scene, report);
  if (report.touched(at)) return;
  for (const Section& other : others) {
    if (&other == &section) break;
    if (other.side == section.side && other.phase == section.phase)
      return report(at, "\"" + section.phase + "\" flows through \"" + word + "\" by " + other.dotted +
                            " too; expected one section a side");
    if (side_at(scene.domain, other.side).axis != side_at(scene.domain, section.side).axis)
      return report(at, "\"" + word + "\" and \"" + word_of(other.side) + "\" of " + other.dotted +
                            " meet in a corner, beyond which nothing is said; expected sides of one axis");
  }
  const auto& open = scene.domain.open;
  const bool grains = std::any_of(scene.phases.begin(), scene.phases.end(), [](const Phase& phase) {
    return phase.kind() == PhaseKind::grains && phase.diameter();
  });
  if (!grains && std::find(open.begin(), open.end(), word) != open.end())
    return report(at, "\"" + word + "\" stands in domain.open, where particles are gone; expected one of the two");
  const Phase* fluid = find_phase(scene, section.phase);
  for (const Fill& fill : scene.fills) {
    const auto* sides = std::get_if<SidesShape>(&fill.shape);
    const Phase* wall = find_phase(scene, fill.phase);
    if (sides && wall && fluid && entry_between(scene, *fluid, *wall) &&
        std::find(sides->sides.begin(), sides->sides.end(), word) != sides->sides.end())
      return report(at, "the wall \"" + wall->name + "\" closes \"" + word + "\" to \"" + section.phase +
                            "\"; expected a side without such a wall");
  }
}

/// m, of a section's layer: what the scene says, or the usual one.
double layer_of(const Scene& scene, const Phase& fluid, Side side) {
  for (const FlowEnd& end : flow_ends(scene, fluid))
    if (end.side == side) return end.layer;
  return 0.0;
}

/// Beside the layer of one phase of a fluid the other phase needs its own: neither has a surface there.
void check_joined_layers(const Scene& scene, const std::vector<Section>& sections, const Report& report) {
  if (report.misread("phases") || report.misread("interactions")) return;
  for (std::size_t k = 0; k < sections.size(); ++k)
    for (std::size_t j = 0; j < k; ++j) {
      const Section &one = sections[j], &other = sections[k];
      const std::string& at = other.dotted;
      const Phase *a = find_phase(scene, one.phase), *b = find_phase(scene, other.phase);
      if (one.side != other.side || !a || !b || a == b || report.touched(at)) continue;
      if (a->kind() != PhaseKind::fluid || b->kind() != PhaseKind::fluid || a->spacing == b->spacing ||
          !entry_between(scene, *a, *b))
        continue;
      const double difference = layer_of(scene, *a, one.side) - layer_of(scene, *b, one.side);
      if (std::abs(difference) < std::max(a->spacing, b->spacing)) continue;
      report(report.has(at + ".layer") ? at + ".layer" : at + ".phase",
             "\"" + a->name + "\" and \"" + b->name +
                 "\" are joined and need layers of one length; expected the same layer (m) in " + one.dotted);
    }
}

/// Synthetic turbulence that cannot be, or that the spacing cannot carry.
void check_fluctuations(const Scene& scene, std::size_t number, const Report& report) {
  const std::string at = "inflow." + std::to_string(number) + ".fluctuations";
  const Inflow& inflow = scene.inflows[number];
  if (!inflow.fluctuations || report.touched("inflow") || report.misread("phases") || report.touched("dimensions"))
    return;
  const Phase* fluid = find_phase(scene, inflow.phase);
  if (!fluid || fluid->kind() != PhaseKind::fluid) return;
  const Fluctuations& given = *inflow.fluctuations;
  const Turbulence turbulence = fluid->fluid().turbulence;
  if (turbulence == Turbulence::k_omega)
    return report(at, "k and omega of \"" + fluid->name +
                          "\" stand for all fluctuations; expected turbulence = \"smagorinsky\", or no turbulence");
  if (turbulence == Turbulence::mixing_length)
    return report(at, "the mixing length of \"" + fluid->name +
                          "\" stands for all fluctuations; expected turbulence = \"smagorinsky\", or no turbulence");
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d)
    if (!(given.rms[d] > 0.0)) return report(at + ".rms", "a component is not positive; expected m/s of each");
  const double limit = fluid->density * given.rms[0] * given.rms[1];
  if (!(std::abs(given.shear_stress) < limit))
    return report(at + ".shear-stress",
                  "more than fluctuations of this rms can give; expected less than density "
                  "times rms x times rms y, " +
                      number_text(limit) + " Pa");
  if (given.length < 4.0 * fluid->spacing)
    report(at + ".length", "shorter than four spacings of \"" + fluid->name + "\", " +
                               number_text(4.0 * fluid->spacing) + " m, which the fluid cannot carry");
}

}  // namespace

void check_flow_ends(const Scene& scene, const Report& report) {
  const std::vector<Section> sections = sections_of(scene);
  for (const Section& section : sections) {
    check_fluid(scene, section, report);
    check_side(scene, section, sections, report);
  }
  check_joined_layers(scene, sections, report);
  for (std::size_t k = 0; k < scene.inflows.size(); ++k) {
    const std::string dotted = "inflow." + std::to_string(k);
    check_fluctuations(scene, k, report);
    const std::string log = dotted + ".velocity.log-profile", profile = dotted + ".velocity.profile";
    if (report.is_section(dotted + ".velocity") && !report.touched(dotted)) {
      if (!report.has(log) && !report.has(profile))
        report(dotted + ".velocity", "no velocity; expected { log-profile = ... } or { profile = ... }");
      if (report.has(log) && report.has(profile))
        report(profile, "a second wind after log-profile; expected one of the two");
      if (report.has(profile) && side_at(scene.domain, scene.inflows[k].side).axis == up_axis(scene.domain))
        report(profile, "a profile is by height, and \"" + word_of(scene.inflows[k].side) +
                            "\" has one height; expected a side that cuts the ground, or formulas");
    }
    if (scene.inflows[k].log_profile && scene.inflows[k].side != Side::left && !report.touched(dotted))
      report(dotted + ".velocity", "a logarithmic wind blows along x; expected side = \"left\", or formulas");
  }
}

}  // namespace barchan
