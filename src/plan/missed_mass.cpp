// Fluids and elastic bodies whose rows of particles miss the mass of their shapes, and the spacings that fit.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "plan/plan.hpp"
#include "start/shape_content.hpp"

namespace barchan {
namespace {

/// Lengths of boxes and of the domain that rows of a fill must make up, along all axes (m).
std::vector<double> lengths_of_rows(const Scene& scene, const Fill& fill) {
  std::vector<double> lengths;
  const auto* box = std::get_if<BoxShape>(&fill.shape);
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d)
    if (box || std::holds_alternative<RemainderShape>(fill.shape))
      lengths.push_back(box ? box->max[d] - box->min[d] : scene.domain.size[d]);
  return lengths;
}

/// The spacings next to dx, finer and coarser, of which all lengths are whole numbers; empty: none within a factor of
/// two, or there are no lengths.
std::string spacings_that_fit(const std::vector<double>& lengths, double dx) {
  if (lengths.empty()) return "";
  const auto fits = [&](double spacing) {
    return std::all_of(lengths.begin(), lengths.end(), [&](double length) {
      const double count = length / spacing;
      return count > 0.5 && std::abs(count - std::round(count)) < 1e-4 * count / static_cast<double>(lengths.size());
    });
  };
  const double rows = lengths.front() / dx;
  std::string text;
  const auto add = [&](double spacing) {
    char number[32];
    std::snprintf(number, sizeof number, "%.8g", spacing);
    text += (text.empty() ? "" : " or ") + std::string(number);
  };
  for (double n = std::floor(rows) + 1.0; n <= 2.0 * rows + 1.0; ++n)
    if (fits(lengths.front() / n)) {
      add(lengths.front() / n);
      break;
    }
  for (double n = std::ceil(rows) - 1.0; n >= 1.0 && n >= 0.5 * rows; --n)
    if (fits(lengths.front() / n)) {
      add(lengths.front() / n);
      break;
    }
  return text;
}

/// Places (m) of a fill in a formula: nothing else bounds the formula but the domain. Empty for other shapes, and where
/// ranks share the particles out.
std::vector<Vec3> places_in_formula(const Fill& fill, std::size_t number, const ParticleBlock& block) {
  if (!std::holds_alternative<FormulaShape>(fill.shape) || block.piece) return {};
  for (std::size_t k = 0; k < block.parts.size(); ++k) {
    if (block.parts[k].fill != number) continue;
    const std::size_t end = k + 1 < block.parts.size() ? block.parts[k + 1].first : block.position.size();
    return {block.position.begin() + static_cast<std::ptrdiff_t>(block.parts[k].first),
            block.position.begin() + static_cast<std::ptrdiff_t>(end)};
  }
  return {};
}

}  // namespace

void warn_of_missed_mass(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan) {
  constexpr double of_shapes = 1e-3;
  constexpr double of_what_is_left = 1e-2;  // by other shapes, whose particles keep their distance
  // What settled or lies at random holds less than its shape; a formula holds its particles, whatever it bounds.
  const auto has_outline = [&](const Fill& fill) {
    return !std::holds_alternative<FormulaShape>(fill.shape) &&
           std::none_of(plan.phases.begin(), plan.phases.end(),
                        [&](const PlanPhase& other) { return other.name == fill.phase && other.own_steps(); });
  };
  for (std::size_t k = 0; k < plan.phases.size(); ++k) {
    const PlanPhase& p = plan.phases[k];
    double share = of_shapes;
    if (!(p.flows() || p.deforms()) || p.count == 0 || !flow_ends(scene, scene.phases[k]).empty()) continue;
    double content = 0.0;
    std::vector<double> lengths;
    bool known = true, boxes = true;
    for (std::size_t f = 0; f < scene.fills.size() && known; ++f) {
      const Fill& fill = scene.fills[f];
      if (fill.phase != p.name) continue;
      const bool is_cut =
          fill.leave_out == LeaveOut::earlier_fills || std::holds_alternative<RemainderShape>(fill.shape);
      for (std::size_t other = 0; is_cut && other < f; ++other) {
        known = known && (scene.fills[other].phase == p.name || has_outline(scene.fills[other]));
        if (!std::holds_alternative<SidesShape>(scene.fills[other].shape)) share = of_what_is_left;
      }
      const auto held =
          known ? content_of_fill(scene, f, places_in_formula(fill, f, blocks[k]), rough_sampling) : std::nullopt;
      known = held.has_value();
      if (known) content += held->content;
      const std::vector<double> own = lengths_of_rows(scene, fill);
      lengths.insert(lengths.end(), own.begin(), own.end());
      boxes = boxes && !own.empty();
    }
    if (!known || !(content > 0.0)) continue;
    const double rows = static_cast<double>(p.count) * std::pow(p.spacing, plan.dimensions);
    if (std::abs(rows / content - 1.0) <= share) continue;
    const std::string fitting = boxes ? spacings_that_fit(lengths, p.spacing) : "";
    char text[300];
    std::snprintf(text, sizeof text,
                  "phases.%s: the mass of its %zu particles of %.6g m is %+.2f %% off that of its "
                  "shapes: rows do not fit them, and where walls stand a gap or a row too many is left; ",
                  p.name.c_str(), p.count, p.spacing, 100.0 * (rows / content - 1.0));
    plan.warnings.push_back(text + (fitting.empty() ? "a smaller spacing or packing = \"relaxed\" misses less"
                                                    : "a spacing of " + fitting + " m fits"));
  }
}

}  // namespace barchan
