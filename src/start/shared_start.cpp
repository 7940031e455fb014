#include "start/shared_start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/aligned.hpp"
#include "base/errors.hpp"
#include "scene/couplings.hpp"

namespace barchan {

namespace {

bool is_fluid(const Scene& scene, const Fill& fill) {
  const Phase* phase = find_phase(scene, fill.phase);
  return phase && phase->kind() == PhaseKind::fluid;
}

/// A box of space; nothing is in it as long as low is above high.
struct Box {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};  // m
};

Box box_about(const std::vector<Vec3>& places, double reach) {
  Box box;
  for (const Vec3& x : places)
    for (std::size_t d = 0; d < 3; ++d) {
      box.low[d] = std::min(box.low[d], x[d] - reach);
      box.high[d] = std::max(box.high[d], x[d] + reach);
    }
  return box;
}

/// Whether a place, or an image of it beyond a periodic side, is in the box.
bool is_in_box(const Box& box, const Vec3& x, const Domain& domain) {
  for (std::size_t d = 0; d < 3; ++d) {
    const auto inside = [&](double place) { return place >= box.low[d] && place <= box.high[d]; };
    const double period = domain.periodic[d] ? domain.size[d] : 0.0;
    if (!inside(x[d]) && !(period > 0.0 && (inside(x[d] - period) || inside(x[d] + period)))) return false;
  }
  return true;
}

}  // namespace

std::string why_start_is_whole(const Scene& scene) {
  bool any = false, fluid_before = false;
  for (const Phase& phase : scene.phases) {
    if (phase.kind() != PhaseKind::fluid) continue;
    any = true;
    if (!entry_between(scene, phase, phase)) return "\"" + phase.name + "\" has no entry with itself";
  }
  if (!any) return "there is no fluid";
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Fill& fill = scene.fills[k];
    if (fluid_before && fill.packing == Packing::random)
      return "fill." + std::to_string(k) + " has random places next to a fluid";
    fluid_before = fluid_before || is_fluid(scene, fill);
  }
  return "";
}

bool comes_in_rows(const Fill& fill) {
  const bool placed = std::holds_alternative<PointsShape>(fill.shape) ||
                      std::holds_alternative<CubeShape>(fill.shape) || std::holds_alternative<SidesShape>(fill.shape) ||
                      std::holds_alternative<FileShape>(fill.shape);
  return !placed && (fill.packing == Packing::square || fill.packing == Packing::hexagonal);
}

Places PlacesOfFluids::own() const {
  Places all(space_, widest_);
  for (const Filled& filled : fills_)
    for (const Vec3& x : filled.places) all.add(x, filled.spacing, filled.fill);
  return all;
}

Places PlacesOfFluids::near(const std::vector<Vec3>& places, double reach) const {
  struct Item {
    Vec3 x;
    double spacing;
    std::int64_t fill;
  };
  std::vector<Item> items;
  std::vector<std::size_t> counts;
  for (const Box& box : ranks::each(box_about(places, reach))) {
    const std::size_t before = items.size();
    for (const Filled& filled : fills_)
      for (const Vec3& x : filled.places)
        if (is_in_box(box, x, space_.domain())) items.push_back({x, filled.spacing, filled.fill});
    counts.push_back(items.size() - before);
  }
  Places all(space_, widest_);
  for (const Item& item : ranks::exchanged(items, counts)) all.add(item.x, item.spacing, static_cast<int>(item.fill));
  return all;
}

void leave_out(std::vector<Vec3>& places, bool by_all, const std::function<bool(const Vec3&)>& is_taken) {
  if (!by_all) {
    std::erase_if(places, is_taken);
    return;
  }
  std::vector<std::size_t> taken;
  for (std::size_t k = 0; k < places.size(); ++k)
    if (is_taken(places[k])) taken.push_back(k);
  ranks::join(taken);
  std::vector<bool> leaves(places.size(), false);
  for (const std::size_t k : taken) leaves[k] = true;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < places.size(); ++k)
    if (!leaves[k]) places[kept++] = places[k];
  places.resize(kept);
}

ParticlePiece ParticleNumbers::follow(std::size_t count) {
  const ParticlePiece piece{ranks::before(count), ranks::total(count)};
  runs_.push_back({total_ + piece.first, count});
  total_ += piece.total;
  return piece;
}

void ParticleNumbers::deal(ParticleBlock& block) const {
  constexpr double uneven = 1.25;  // times the mean number of particles
  const ranks::Share share = ranks::own_share();
  const std::size_t most = static_cast<std::size_t>(ranks::largest(static_cast<std::int64_t>(block.position.size())));
  const bool any_pressure = ranks::any(!block.pressure.empty());
  if (any_pressure) block.pressure.resize(block.position.size(), 0.0);
  if (runs_.size() == 1 &&
      static_cast<double>(most * share.count) <= uneven * static_cast<double>(total_ + share.count)) {
    block.piece = ParticlePiece{runs_[0].first, total_};
    return;
  }
  struct Item {
    std::uint64_t number;
    Vec3 position, velocity;
    double pressure;
  };
  // The numbers of a run go up, and so do the ranks to which its particles go.
  std::vector<Item> items;
  std::vector<std::size_t> counts;
  items.reserve(block.position.size());
  for (ranks::Share to{0, share.count}; to.number < to.count; ++to.number) {
    const std::size_t before = items.size(), begin = to.begin(total_), end = to.end(total_);
    std::size_t at = 0;
    for (const Run& run : runs_) {
      const std::size_t first = std::max(begin, run.first), last = std::min(end, run.first + run.count);
      for (std::size_t number = first; number < last; ++number) {
        const std::size_t k = at + (number - run.first);
        items.push_back({number, block.position[k], block.velocity[k], any_pressure ? block.pressure[k] : 0.0});
      }
      at += run.count;
    }
    counts.push_back(items.size() - before);
  }
  give_back(block.position);
  give_back(block.velocity);
  give_back(block.pressure);
  const std::vector<Item> come = ranks::exchanged(items, counts);
  give_back(items);
  const std::size_t first = share.begin(total_);
  block.position.resize(come.size());
  block.velocity.resize(come.size());
  if (any_pressure) block.pressure.resize(come.size());
  for (const Item& item : come) {
    const std::size_t k = item.number - first;
    block.position[k] = item.position;
    block.velocity[k] = item.velocity;
    if (any_pressure) block.pressure[k] = item.pressure;
  }
  block.piece = ParticlePiece{first, total_};
}

void check_together(std::size_t first, const std::function<void(std::size_t& at)>& check) {
  std::size_t at = 0;
  if (!ranks::active()) return check(at);
  constexpr auto nobody = std::numeric_limits<std::uint64_t>::max();
  std::string told;
  std::uint64_t place = nobody;
  try {
    check(at);
  } catch (const SceneError& error) {
    told = error.what();
    place = first + at;
  }
  const int rank = ranks::best(place, std::less<>{});
  if (place != nobody) throw SceneError(ranks::text_of(rank, told));
}

}  // namespace barchan
