#include "models/grains/sphere_room.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "models/grains/sphere_pairs.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"
#include "scene/side_names.hpp"
#include "start/ball_surfaces.hpp"

namespace barchan {

namespace {

// Of the smaller diameter. Beds at rest have 1e-4 to 1e-2, soft ones more: what settled before, or comes from a file,
// may overlap as far as contacts bear without harm.
constexpr double most_at_start = 0.049, most_of_settled = 0.1;

}  // namespace

bool touch_as_spheres(const Layout& layout, std::size_t a, std::size_t b) {
  return std::any_of(layout.entries.begin(), layout.entries.end(),
                     [&](const PlanEntry& e) { return e.own_steps() && e.has(a) && e.partner(a) == b; });
}

SphereRoom::SphereRoom(const Scene& scene, const Layout& layout, std::size_t phase, double reach)
    : layout_(layout), reach_(reach) {
  const SideNames& names = side_names(scene.domain);
  std::array<double, 3> period{};
  for (std::size_t d = 0; d < 3; ++d)
    period[d] = layout.bounds.periodic[d] ? layout.bounds.high[d] - layout.bounds.low[d] : 0.0;
  surfaces_.prepare(period);
  std::vector<std::size_t> bodies(scene.phases.size(), 0);  // by phase
  for (std::size_t f = 0; f < scene.fills.size(); ++f) {
    const Fill& fill = scene.fills[f];
    const Phase* const other = find_phase(scene, fill.phase);
    const auto number = static_cast<std::size_t>(other - scene.phases.data());
    const std::size_t body = bodies[number]++;
    if (!touch_as_spheres(layout, phase, number)) continue;
    if (const auto* planes = std::get_if<SidesShape>(&fill.shape)) {
      for (std::size_t axis = 0; axis < static_cast<std::size_t>(layout.dimensions); ++axis)
        for (const bool high : {false, true})
          if (std::find(planes->sides.begin(), planes->sides.end(), names[axis][high]) != planes->sides.end())
            sides_.push_back({axis, f, high, high ? layout.domain.high[axis] : layout.domain.low[axis]});
      continue;
    }
    const std::vector<RigidBody>& rigid = layout.phases[number].rigid_bodies;
    if (rigid.empty() && !touched_by_surface(scene, *other, fill.shape)) continue;
    auto surface = SolidSurface::of(fill.shape, scene, layout.phases[number].spacing, reach);
    if (!surface) continue;
    surfaces_.add_surface(surfaces_.add_solid(), std::move(*surface));
    solids_.push_back({f, number, rigid.empty() ? RigidBody{} : rigid[body]});
  }
}

void SphereRoom::move(const State& state, const std::vector<const WallMotion*>& motions) {
  for (std::size_t k = 0; k < solids_.size(); ++k) {
    Solid& solid = solids_[k];
    const auto number = static_cast<std::uint32_t>(k);
    if (const WallMotion* motion = motions[solid.phase]) {
      solid.start.dimensions = layout_.dimensions;
      solid.start.first_place = solid.start.now.place = -1.0 * motion->arm({0, 0, 0});
      surfaces_.move(number, solid.start, motion->now());
    }
    for (const RigidBody& body : state.bodies)
      if (body.phase == solid.phase && body.fill == solid.fill) surfaces_.move(number, solid.start, body);
  }
}

bool SphereRoom::has_side(std::size_t axis, bool high) const {
  return std::any_of(sides_.begin(), sides_.end(),
                     [&](const Side& side) { return side.axis == axis && side.high == high; });
}

SphereRoom::Nearest SphereRoom::nearest(const Vec3& x) const {
  Nearest nearest{reach_, 0};
  for (const Side& side : sides_) {
    const double gap = side.high ? side.place - x[side.axis] : x[side.axis] - side.place;
    if (gap < nearest.gap) nearest = {gap, side.fill};
  }
  for (std::size_t k = 0; k < solids_.size(); ++k) {
    const auto number = static_cast<std::uint16_t>(k);
    if (const double gap = surfaces_.distance(x, nearest.gap, {&number, 1}); gap < nearest.gap)
      nearest = {gap, solids_[k].fill};
  }
  return nearest;
}

namespace {

/// A sphere of a fill at the start.
struct Placed {
  Vec3 x;
  double radius;
  std::uint32_t phase, fill, number;  // number: in its phase
};

/// Cells as wide as the largest of their spheres, for the search of those that a sphere may overlap.
class StartGrid {
 public:
  /// `widest`: the largest diameter (m).
  StartGrid(const Layout& layout, double widest)
      : bounds_(layout.bounds), widest_(widest), width_{widest, widest, widest} {
    for (std::size_t d = 0; d < 3; ++d) {
      const double size = bounds_.high[d] - bounds_.low[d];
      if (d < static_cast<std::size_t>(layout.dimensions) && widest > 0.0)
        count_[d] = static_cast<long>(std::clamp(std::floor(size / widest), 1.0, 1e6));
      if (bounds_.periodic[d]) width_[d] = size / static_cast<double>(count_[d]);
    }
  }
  void add(const Vec3& x, std::uint32_t number) {
    cells_.emplace_back(join(cell_of(x, 0), cell_of(x, 1), cell_of(x, 2)), number);
  }
  /// After the last add() and before each_near().
  void sort() { std::sort(cells_.begin(), cells_.end()); }

  /// Calls f with the number of each sphere in a cell that the sphere a may reach.
  template <class F>
  void each_near(const Placed& a, const F& f) const {
    if (cells_.empty()) return;
    const double reach = (a.radius + 0.5 * widest_) / widest_;
    std::array<std::vector<long>, 3> along;
    double all = 1.0;
    for (std::size_t d = 0; d < 3; ++d) {
      const long n = count_[d], c = cell_of(a.x, d);
      const long steps = static_cast<long>(std::clamp(std::ceil(reach), 1.0, static_cast<double>(n)));
      const long first = std::max(c - steps, bounds_.periodic[d] ? c - std::max(n / 2, 1l) : 0l);
      const long last = std::min(c + steps, bounds_.periodic[d] ? first + n - 1 : n - 1);
      for (long at = first; at <= last; ++at) along[d].push_back((at % n + n) % n);
      all *= static_cast<double>(along[d].size());
    }
    if (all > static_cast<double>(cells_.size()) && reach > 1.0) {
      for (const auto& [cell, number] : cells_) f(number);
      return;
    }
    for (const long k : along[2])
      for (const long j : along[1])
        for (const long i : along[0]) {
          const long cell = join(i, j, k);
          for (auto b = std::lower_bound(cells_.begin(), cells_.end(), std::pair{cell, 0u});
               b != cells_.end() && b->first == cell; ++b)
            f(b->second);
        }
  }

 private:
  long cell_of(const Vec3& x, std::size_t d) const {
    if (count_[d] == 1) return 0;
    const long c = static_cast<long>(std::floor((x[d] - bounds_.low[d]) / width_[d]));
    return bounds_.periodic[d] ? (c % count_[d] + count_[d]) % count_[d] : std::clamp(c, 0l, count_[d] - 1);
  }
  long join(long i, long j, long k) const { return (k * count_[1] + j) * count_[0] + i; }

  decltype(Layout::bounds) bounds_;
  double widest_;  // m
  std::array<double, 3> width_;
  std::array<long, 3> count_{1, 1, 1};
  std::vector<std::pair<long, std::uint32_t>> cells_;
};

class StartChecker {
 public:
  StartChecker(const Scene& scene, const Layout& layout, const std::vector<std::uint32_t>& laws,
               const std::vector<ParticleBlock>& blocks)
      : scene_(scene), layout_(layout), laws_(laws) {
    for (std::size_t p = 0; p < blocks.size(); ++p) add(p, blocks[p]);
  }

  /// Spheres in walls, sides and bodies.
  void solids() const {
    double widest = 0.0;
    for (const Placed& a : all_) widest = std::max(widest, a.radius);
    std::vector<std::optional<SphereRoom>> rooms(layout_.phases.size());
    for (const Placed& a : all_) {
      if (!layout_.phases[a.phase].own_steps()) continue;
      auto& room = rooms[a.phase];
      if (!room) room.emplace(scene_, layout_, a.phase, widest);
      const SphereRoom::Nearest there = room->nearest(a.x);
      const double overlap = std::min(a.radius - there.gap, 1e3 * a.radius);
      if (overlap > most(a) * 2.0 * a.radius) refuse(a, there.fill, overlap, 2.0 * a.radius);
    }
  }

  /// Spheres in spheres. Those of unequal sizes are in grids of their own, each half as wide as the one before it.
  void pairs() const {
    double widest = 0.0;
    for (const Placed& a : all_) widest = std::max(widest, 2.0 * a.radius);
    std::vector<StartGrid> grids{{layout_, widest}};
    constexpr std::size_t most_grids = 30;
    for (std::uint32_t a = 0; a < all_.size(); ++a) {
      std::size_t m = 0;
      for (double half = 0.5 * widest; 2.0 * all_[a].radius <= half && m + 1 < most_grids; half *= 0.5)
        if (++m == grids.size()) grids.emplace_back(layout_, half);
      grids[m].add(all_[a].x, a);
    }
    for (StartGrid& grid : grids) grid.sort();
    for (std::uint32_t a = 0; a < all_.size(); ++a) {
      if (!layout_.phases[all_[a].phase].own_steps()) continue;
      for (const StartGrid& grid : grids)
        grid.each_near(all_[a], [&](std::uint32_t b) {
          if (b < a || !layout_.phases[all_[b].phase].own_steps()) pair(all_[a], all_[b]);
        });
    }
  }

 private:
  void add(std::size_t phase, const ParticleBlock& block) {
    const PlanPhase& plan = layout_.phases[phase];
    const std::size_t n = layout_.phases.size();
    const auto row = laws_.begin() + static_cast<std::ptrdiff_t>(phase * n);
    if (std::all_of(row, row + static_cast<std::ptrdiff_t>(n), [](auto law) { return law == SphereCells::none; }))
      return;
    const Phase& own = scene_.phases[phase];
    if (!plan.own_steps() && plan.moves()) return;
    for (std::size_t k = 0; k < block.parts.size(); ++k) {
      const Fill& fill = scene_.fills[block.parts[k].fill];
      if (!plan.own_steps() && touched_by_surface(scene_, own, fill.shape)) continue;
      const std::size_t end = k + 1 < block.parts.size() ? block.parts[k + 1].first : block.position.size();
      for (std::size_t i = block.parts[k].first; i < end; ++i) {
        bool inside = plan.own_steps();
        for (std::size_t d = 0; !inside && d < static_cast<std::size_t>(layout_.dimensions); ++d)
          if (!layout_.bounds.periodic[d] &&
              !(block.position[i][d] >= layout_.bounds.low[d] && block.position[i][d] <= layout_.bounds.high[d]))
            break;
          else inside = d + 1 == static_cast<std::size_t>(layout_.dimensions);
        if (!inside) continue;
        const double radius =
            block.radius.empty() ? 0.5 * (plan.own_steps() ? plan.diameter : plan.spacing) : block.radius[i];
        all_.push_back({block.position[i], radius, static_cast<std::uint32_t>(phase),
                        static_cast<std::uint32_t>(block.parts[k].fill), static_cast<std::uint32_t>(i)});
      }
    }
  }

  /// Of the diameter.
  double most(const Placed& a) const {
    const Fill& fill = scene_.fills[a.fill];
    const bool settled = fill.packing == Packing::settled || std::holds_alternative<FileShape>(fill.shape);
    return settled ? most_of_settled : most_at_start;
  }

  void pair(const Placed& a, const Placed& b) const {
    if (laws_[a.phase * layout_.phases.size() + b.phase] == SphereCells::none) return;
    double r2 = 0.0;
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
      double apart = a.x[d] - b.x[d];
      const double period = layout_.bounds.high[d] - layout_.bounds.low[d];
      if (layout_.bounds.periodic[d]) apart -= period * std::round(apart / period);
      r2 += apart * apart;
    }
    const double overlap = a.radius + b.radius - std::sqrt(r2), diameter = 2.0 * std::min(a.radius, b.radius);
    const bool moves = layout_.phases[b.phase].own_steps();
    const double share = moves && a.fill != b.fill ? std::min(most(a), most(b)) : most(a);
    if (overlap > share * diameter) refuse(a, b.fill, overlap, diameter);
  }

  [[noreturn]] void refuse(const Placed& a, std::size_t fill, double overlap, double diameter) const {
    char at[120];
    const Vec3& x = a.x;
    if (layout_.dimensions == 3) std::snprintf(at, sizeof at, "(%.6g, %.6g, %.6g)", x[0], x[1], x[2]);
    else std::snprintf(at, sizeof at, "(%.6g, %.6g)", x[0], x[1]);
    const bool own = fill == a.fill;
    throw SceneError(located(scene_, "fill." + std::to_string(a.fill)) + ": a sphere of \"" +
                     layout_.phases[a.phase].name + "\" at " + at + " m overlaps " +
                     (own ? "another one of this fill"
                          : "fill." + std::to_string(fill) + " of phase \"" + scene_.fills[fill].phase + "\"") +
                     " by " + brief(overlap / diameter) +
                     " of its diameter at the start, and the contact would shoot it off; expected " +
                     (own ? "a larger spacing of the phase" : "spheres that stand outside of it") + " (an overlap of " +
                     brief(most_at_start) + " is allowed)");
  }

  const Scene& scene_;
  const Layout& layout_;
  const std::vector<std::uint32_t>& laws_;
  std::vector<Placed> all_;
};

}  // namespace

void check_room_at_start(const Scene& scene, const Layout& layout, const std::vector<std::uint32_t>& laws,
                         const std::vector<ParticleBlock>& blocks) {
  StartChecker checker(scene, layout, laws, blocks);
  checker.solids();
  checker.pairs();
}

}  // namespace barchan
