#include "start/thin_wall.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "start/places.hpp"
#include "start/shapes.hpp"

namespace barchan {
namespace {

/// Free places about a wall particle: those of a lattice of the wall's spacing on it, in a ball that is wide enough for
/// the ways round edges.
class FreePlaces {
 public:
  FreePlaces(const Scene& scene, const Places& taken, double spacing, double radius)
      : scene_(scene), taken_(taken), spacing_(spacing), reach_(radius / spacing), solid_(scene.dimensions == 3) {
    const double way = std::sqrt(2.0) * reach_ + 1.0;  // round an edge
    const int n = static_cast<int>(std::ceil(way));
    for (int k = solid_ ? -n : 0; k <= (solid_ ? n : 0); ++k)
      for (int j = -n; j <= n; ++j)
        for (int i = -n; i <= n; ++i)
          if (i * i + j * j + k * k < way * way) steps_.push_back({i, j, k});
    groups_.resize(steps_.size());
  }

  /// The groups of joined free places that begin within the radius.
  struct Group {
    double distance;  // spacings, of its nearest place
    Vec3 nearest;     // m
  };
  std::vector<Group> groups_about(const Vec3& x) {
    std::vector<Group> found;
    if (!has_two_sides(x)) return found;
    for (std::size_t s = 0; s < steps_.size(); ++s) groups_[s] = is_free(at(x, steps_[s])) ? free : none;
    for (std::size_t s = 0; s < steps_.size(); ++s)
      if (groups_[s] == free)
        if (const Group group = gather(x, s); group.distance < reach_ * (1.0 - 1e-9)) found.push_back(group);
    return found;
  }

 private:
  using Step = std::array<int, 3>;
  static constexpr int none = 0, free = 1, gathered = 2;

  Vec3 at(const Vec3& x, const Step& s) const {
    return x + spacing_ * Vec3{static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])};
  }
  bool is_free(const Vec3& x) const {
    for (std::size_t d = 0; d < static_cast<std::size_t>(scene_.dimensions); ++d) {
      const double way = x[d] - scene_.domain.origin[d];
      if (!scene_.domain.periodic[d] && (way < 0.0 || way > scene_.domain.size[d])) return false;
    }
    return taken_.owner_near(x, spacing_, 0.75) < 0;
  }
  /// Whether space is free on both sides along an axis. Where a plate ends, one of its axes finds that.
  bool has_two_sides(const Vec3& x) const {
    const int most = static_cast<int>(std::ceil(reach_ * std::sqrt(static_cast<double>(scene_.dimensions))));
    for (std::size_t d = 0; d < static_cast<std::size_t>(scene_.dimensions); ++d) {
      int sides = 0;
      for (const int way : {-1, 1}) {
        bool open = false;
        for (int n = 1; n <= most && !open; ++n) {
          Step s{};
          s[d] = way * n;
          open = is_free(at(x, s));
        }
        sides += open ? 1 : 0;
      }
      if (sides == 2) return true;
    }
    return false;
  }
  /// All that is joined to a step, diagonals too.
  Group gather(const Vec3& x, std::size_t first) {
    Group group{1e300, x};
    std::vector<std::size_t> open{first};
    groups_[first] = gathered;
    while (!open.empty()) {
      const Step from = steps_[open.back()];
      open.pop_back();
      const double distance = std::sqrt(from[0] * from[0] + from[1] * from[1] + from[2] * from[2]);
      if (distance < group.distance) group = {distance, at(x, from)};
      for (std::size_t s = 0; s < steps_.size(); ++s) {
        const Step& to = steps_[s];
        const bool near =
            std::abs(to[0] - from[0]) <= 1 && std::abs(to[1] - from[1]) <= 1 && std::abs(to[2] - from[2]) <= 1;
        if (groups_[s] != free || !near) continue;
        groups_[s] = gathered;
        open.push_back(s);
      }
    }
    return group;
  }

  const Scene& scene_;
  const Places& taken_;
  double spacing_, reach_;  // m, spacings
  bool solid_;
  std::vector<Step> steps_;
  std::vector<int> groups_;
};

/// Whether a fill of the fluid holds a place.
class Wet {
 public:
  Wet(const Scene& scene, const std::string& fluid) : dimensions_(scene.dimensions) {
    for (const Fill& fill : scene.fills)
      if (fill.phase == fluid) fills_.push_back(region_of_shape(scene, fill));
  }
  bool operator()(const Vec3& x) const {
    return std::any_of(fills_.begin(), fills_.end(), [&](const ShapeRegion& region) {
      for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions_); ++d)
        if (x[d] < region.lower[d] || x[d] > region.upper[d]) return false;
      return region.inside(x);
    });
  }

 private:
  int dimensions_;
  std::vector<ShapeRegion> fills_;
};

bool has_one_side(const Shape& shape) {
  return std::holds_alternative<SidesShape>(shape) || std::holds_alternative<BedShape>(shape);
}

}  // namespace

std::optional<ThinWall> thin_wall(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t wall,
                                  std::size_t fluid, double radius) {
  const ParticleBlock& block = blocks[wall];
  if (std::all_of(block.parts.begin(), block.parts.end(),
                  [&](const ParticleBlock::Part& part) { return has_one_side(scene.fills[part.fill].shape); }))
    return std::nullopt;
  double widest = 0.0;
  for (const Phase& phase : scene.phases)
    if (phase.kind() == PhaseKind::wall) widest = std::max(widest, phase.spacing);
  Places taken(PeriodicSpace(scene.domain), widest);
  for (std::size_t k = 0; k < scene.phases.size(); ++k)
    if (scene.phases[k].kind() == PhaseKind::wall)
      for (const Vec3& x : blocks[k].position) taken.add(x, scene.phases[k].spacing, static_cast<int>(k));
  FreePlaces places(scene, taken, scene.phases[wall].spacing, radius);
  const Wet wet(scene, scene.phases[fluid].name);
  std::optional<ThinWall> thinnest;
  for (std::size_t p = 0; p < block.parts.size(); ++p) {
    if (has_one_side(scene.fills[block.parts[p].fill].shape)) continue;
    const std::size_t end = p + 1 < block.parts.size() ? block.parts[p + 1].first : block.position.size();
    for (std::size_t k = block.parts[p].first; k < end; ++k) {
      auto groups = places.groups_about(block.position[k]);
      if (groups.size() < 2) continue;
      std::sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
      const ThinWall found{block.position[k],
                           groups[0].distance + groups[1].distance - 1.0,
                           {wet(groups[0].nearest), wet(groups[1].nearest)}};
      const auto severity = [](const ThinWall& w) { return static_cast<int>(w.wet[0]) + static_cast<int>(w.wet[1]); };
      if (!thinnest || severity(found) > severity(*thinnest) ||
          (severity(found) == severity(*thinnest) && found.rows < thinnest->rows - 1e-9))
        thinnest = found;
    }
  }
  return thinnest;
}

}  // namespace barchan
