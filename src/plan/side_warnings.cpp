#include "plan/side_warnings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "output/numbers.hpp"
#include "scene/side_names.hpp"

namespace barchan {
namespace {

/// Whether walls and bodies stand between a phase and a side of the domain: in most rows of particles across the side
/// one of them is farther out than the phase. Of a side that is not the bottom the lowest rows count.
bool is_closed(const Scene& scene, const std::vector<ParticleBlock>& blocks, const Plan& plan, std::size_t guest,
               std::size_t axis, bool upper) {
  const std::size_t up = up_axis(scene.domain);
  const double width = 2.0 * std::max(scene.spacing, plan.phases[guest].spacing), sign = upper ? 1.0 : -1.0;
  using Row = std::array<long, 3>;
  const auto row_of = [&](const Vec3& x) {
    Row row{};
    for (std::size_t d = 0; d < 3; ++d) row[d] = d == axis ? 0 : static_cast<long>(std::floor(x[d] / width));
    return row;
  };
  std::map<Row, double> outermost;  // of the phase
  long lowest = std::numeric_limits<long>::max();
  for (const Vec3& x : blocks[guest].position) {
    const auto [at, isnew] = outermost.try_emplace(row_of(x), sign * x[axis]);
    if (!isnew) at->second = std::max(at->second, sign * x[axis]);
    lowest = std::min(lowest, at->first[up]);
  }
  std::set<Row> closed;
  for (std::size_t p = 0; p < plan.phases.size(); ++p) {
    if (p == guest || plan.phases[p].flows() || plan.phases[p].own_steps()) continue;
    for (const Vec3& x : blocks[p].position)
      if (const auto at = outermost.find(row_of(x)); at != outermost.end() && sign * x[axis] > at->second)
        closed.insert(at->first);
  }
  std::size_t rows = 0, held = 0;
  for (const auto& [row, place] : outermost) {
    if (axis != up && row[up] > lowest + 1) continue;
    ++rows;
    held += closed.count(row);
  }
  return 2 * held >= rows;
}

/// A side that nothing closes, and where what flows or falls would stop the run.
void warn_of_sides_without_a_wall(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan) {
  if (norm(scene.domain.gravity) == 0.0) return;
  std::vector<std::string> closed = scene.domain.open;
  bool any = false;
  for (const Fill& fill : scene.fills) {
    const auto wall =
        std::find_if(plan.phases.begin(), plan.phases.end(), [&](const PlanPhase& p) { return p.name == fill.phase; });
    if (wall == plan.phases.end() || wall->moves()) continue;
    any = true;
    if (const auto* sides = std::get_if<SidesShape>(&fill.shape))
      closed.insert(closed.end(), sides->sides.begin(), sides->sides.end());
  }
  const auto guest = std::find_if(plan.phases.begin(), plan.phases.end(),
                                  [](const PlanPhase& p) { return (p.free_surface || p.own_steps()) && p.count > 20; });
  if (!any || guest == plan.phases.end() || !scene.inflows.empty() || !scene.outflows.empty() ||
      !scene.domain.open.empty())
    return;
  std::string missing;
  for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d)
    for (const std::string side : side_names(scene.domain)[d])
      if (side != "top" && !scene.domain.periodic[d] && std::find(closed.begin(), closed.end(), side) == closed.end() &&
          !is_closed(scene, blocks, plan, static_cast<std::size_t>(guest - plan.phases.begin()), d,
                     side_at(scene.domain, side).upper))
        missing += (missing.empty() ? "\"" : ", \"") + side + "\"";
  if (!missing.empty())
    plan.warnings.push_back("domain: no wall at " + missing + ": \"" + guest->name +
                            "\" that comes there stops the run; expected it among the sides of a wall, in domain.open, "
                            "or a periodic axis");
}

/// A wall by a shape that stands nowhere near the domain: a surface in millimetres, or one that was moved by them.
void warn_of_walls_far_away(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan) {
  for (std::size_t p = 0; p < plan.phases.size(); ++p) {
    const PlanPhase& wall = plan.phases[p];
    if (wall.moves() || wall.flows() || blocks[p].position.empty()) continue;
    double nearest = 1e300;  // m, to the domain
    for (const Vec3& x : blocks[p].position) {
      double away = 0.0;
      for (std::size_t d = 0; d < static_cast<std::size_t>(scene.dimensions); ++d) {
        const double low = scene.domain.origin[d], high = low + scene.domain.size[d];
        away = std::max({away, low - x[d], x[d] - high});
      }
      nearest = std::min(nearest, away);
    }
    if (nearest > 10.0 * wall.spacing)
      plan.warnings.push_back("phases." + wall.name + ": all of it stands outside the domain, by " + brief(nearest) +
                              " m at least, and acts on nothing; `scale` of a surface makes metres of its numbers, and "
                              "`move` is in metres");
  }
}

}  // namespace

void add_side_warnings(const Scene& scene, const std::vector<ParticleBlock>& blocks, Plan& plan) {
  warn_of_sides_without_a_wall(scene, blocks, plan);
  warn_of_walls_far_away(scene, blocks, plan);
}

}  // namespace barchan
