#include "models/fluid/enclosed.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>

#include "engine/exchange.hpp"
#include "scene/couplings.hpp"

namespace barchan {
namespace {

/// The widest spacing (m) of any phase: cells of it have a particle wherever a phase is.
double coarsest(const Scene& scene) {
  double widest = 0.0;
  for (const Phase& phase : scene.phases) widest = std::max(widest, phase.spacing);
  return widest;
}

/// Cells of about the widest spacing over the domain, with one more layer outside its closed axes.
class Cells {
 public:
  using Cell = std::array<long, 3>;

  Cells(const Scene& scene) : domain_(scene.domain), dimensions_(static_cast<std::size_t>(scene.dimensions)) {
    for (std::size_t axis = 0; axis < dimensions_; ++axis) {
      counts_[axis] = std::max(1l, std::lround(domain_.size[axis] / coarsest(scene)));
      stored_[axis] = counts_[axis] + (domain_.periodic[axis] ? 0 : 2);
    }
    taken_.assign(static_cast<std::size_t>(stored_[0] * stored_[1] * stored_[2] + 63) / 64, 0);
  }

  /// On several ranks: what any of them has taken is taken.
  void join_ranks() { Exchange().reduce(taken_.data(), taken_.size(), Exchange::Take::bits); }

  /// Along closed axes -1 and the count are the layers outside; farther cells are cut off.
  Cell cell_of(const Vec3& x) const {
    Cell cell{};
    for (std::size_t axis = 0; axis < dimensions_; ++axis) {
      const double width = domain_.size[axis] / static_cast<double>(counts_[axis]);
      cell[axis] = static_cast<long>(std::floor((x[axis] - domain_.origin[axis]) / width));
      if (domain_.periodic[axis]) cell[axis] = (cell[axis] % counts_[axis] + counts_[axis]) % counts_[axis];
    }
    return cell;
  }

  void take(const Cell& cell) {
    if (stored(cell)) taken_[index(cell) / 64] |= bit(index(cell));
  }

  /// Whether a cell is taken within so many cells along each axis; not along the axis `flat`.
  bool taken_about(const Cell& centre, long reach, std::size_t flat = 3) const {
    std::array<long, 3> far{};
    for (std::size_t axis = 0; axis < dimensions_; ++axis) far[axis] = axis == flat ? 0 : reach;
    for (long z = -far[2]; z <= far[2]; ++z)
      for (long y = -far[1]; y <= far[1]; ++y)
        for (long x = -far[0]; x <= far[0]; ++x) {
          Cell cell{centre[0] + x, centre[1] + y, centre[2] + z};
          for (std::size_t axis = 0; axis < dimensions_; ++axis)
            if (domain_.periodic[axis]) cell[axis] = (cell[axis] % counts_[axis] + counts_[axis]) % counts_[axis];
          if (stored(cell) && (taken_[index(cell) / 64] & bit(index(cell))) != 0) return true;
        }
    return false;
  }

  const Cell& counts() const { return counts_; }
  Vec3 centre(const Cell& cell) const {
    Vec3 x{};
    for (std::size_t axis = 0; axis < dimensions_; ++axis)
      x[axis] = domain_.origin[axis] +
                domain_.size[axis] * (static_cast<double>(cell[axis]) + 0.5) / static_cast<double>(counts_[axis]);
    return x;
  }

 private:
  static std::int64_t bit(std::size_t k) { return static_cast<std::int64_t>(std::uint64_t{1} << k % 64); }
  std::size_t index(const Cell& cell) const {
    std::size_t index = 0;
    for (std::size_t axis = 3; axis-- > 0;)
      index = index * static_cast<std::size_t>(stored_[axis]) +
              static_cast<std::size_t>(cell[axis] + (stored_[axis] > counts_[axis] ? 1 : 0));
    return index;
  }
  bool stored(const Cell& cell) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const long outside = stored_[axis] > counts_[axis] ? 1 : 0;
      if (cell[axis] < -outside || cell[axis] >= counts_[axis] + outside) return false;
    }
    return true;
  }

  const Domain& domain_;
  std::size_t dimensions_;
  Cell counts_{1, 1, 1}, stored_{1, 1, 1};
  std::vector<std::int64_t> taken_;  // a bit a cell
};

std::string place_text(const Vec3& x, int dimensions) {
  char text[100];
  if (dimensions == 3) std::snprintf(text, sizeof text, "(%.4g, %.4g, %.4g) m", x[0], x[1], x[2]);
  else std::snprintf(text, sizeof text, "(%.4g, %.4g) m", x[0], x[1]);
  return text;
}

bool flows_through(const Scene& scene, const Phase& fluid, std::size_t axis, bool upper) {
  const auto ends = flow_ends(scene, fluid);
  return std::any_of(ends.begin(), ends.end(),
                     [&](const FlowEnd& end) { return end.axis() == axis && end.upper() == upper; });
}

/// The place of a cell without a particle about it that is next to the fluid; empty when there is none. Space behind a
/// row of solids, as in a hill of fitted rows, is three cells from the fluid.
std::string find_free_space(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t fluid) {
  double room = 1.0, particles = 0.0;
  for (const ParticleBlock& block : blocks) particles += static_cast<double>(block.count());
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis)
    room *= scene.domain.size[axis] / coarsest(scene);
  if (room > 27.0 * particles) return "most of the domain";  // more cells than the particles are neighbours of
  Cells all(scene), own(scene);
  for (const ParticleBlock& block : blocks)
    for (const Vec3& x : block.position) all.take(all.cell_of(x));
  for (const Vec3& x : blocks[fluid].position) own.take(own.cell_of(x));
  all.join_ranks();
  own.join_ranks();
  const Cells::Cell& n = all.counts();
  const auto cells = static_cast<std::size_t>(n[0] * n[1] * n[2]);
  const auto cell = [&n](std::size_t k) {
    const auto q = static_cast<long>(k);
    return Cells::Cell{q % n[0], q / n[0] % n[1], q / (n[0] * n[1])};
  };
  const Exchange::Share share = Exchange().share();
  std::size_t first = share.begin(cells);
  while (first < share.end(cells) && (all.taken_about(cell(first), 1) || !own.taken_about(cell(first), 2))) ++first;
  if (first == share.end(cells)) first = cells;
  first = static_cast<std::size_t>(Exchange().least(static_cast<std::int64_t>(first)));
  return first < cells ? place_text(all.centre(cell(first)), scene.dimensions) : "";
}

/// Where the fluid stands at a side of the domain and no wall beyond it, of those in `walls`; the first such particle.
std::optional<Vec3> find_open_side(const Scene& scene, const Phase& phase, const std::vector<Vec3>& places,
                                   const Cells& walls) {
  const auto ends = flow_ends(scene, phase);
  for (const Vec3& x : places) {
    if (std::any_of(ends.begin(), ends.end(), [&](const FlowEnd& e) { return e.beyond(x[e.axis()]) > 0.0; })) continue;
    const Cells::Cell cell = walls.cell_of(x);
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis)
      for (const long side : {0l, walls.counts()[axis] - 1}) {
        if (scene.domain.periodic[axis] || cell[axis] != side || flows_through(scene, phase, axis, side > 0)) continue;
        Cells::Cell beyond = cell;
        beyond[axis] += side == 0 ? -1 : 1;
        if (!walls.taken_about(beyond, 1, axis)) return x;
      }
  }
  return std::nullopt;
}

}  // namespace

Enclosure find_enclosure(const Scene& scene, const Layout& layout, const std::vector<ParticleBlock>& blocks,
                         std::size_t fluid) {
  const Phase& phase = scene.phases[fluid];
  Enclosure result;
  result.free_space = find_free_space(scene, blocks, fluid);
  result.open = !result.free_space.empty();
  bool walled = false;
  std::string piston;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    if (!entry_between(scene, phase, scene.phases[k])) continue;
    walled = walled || !layout.phases[k].moves();
    if (layout.phases[k].travels()) piston = layout.phases[k].name;
    if (layout.phases[k].flows() && k != fluid) return result.why = layout.phases[k].name + " can give way", result;
  }
  if (!result.free_space.empty()) return result.why = "free space at " + result.free_space, result;

  Cells walls(scene);
  for (std::size_t k = 0; k < blocks.size(); ++k)
    if (!layout.phases[k].moves() && entry_between(scene, phase, scene.phases[k]))
      for (const Vec3& x : blocks[k].position) walls.take(walls.cell_of(x));
  struct Found {
    bool any = false;
    Vec3 at{};
  } found;
  if (const auto x = find_open_side(scene, phase, blocks[fluid].position, walls)) found = {true, *x};
  found = Exchange().of_first(found.any, found);
  if (found.any) {
    result.why = "no wall that it interacts with beyond " + place_text(found.at, scene.dimensions);
    result.open = true;
    return result;
  }
  if (!flow_ends(scene, phase).empty()) return result.why = "it flows through a side", result;
  if (!piston.empty()) return result.why = piston + " moves, and the room with it", result;
  result.shut_in = true;
  result.why = walled ? "shut in by walls, and no free space" : "no free space, and every side is periodic";
  return result;
}

}  // namespace barchan
