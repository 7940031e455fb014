#include "start/generate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/errors.hpp"
#include "scene/couplings.hpp"
#include "scene/formula.hpp"
#include "scene/keys.hpp"
#include "scene/located.hpp"
#include "scene/log_wind.hpp"
#include "start/fitted.hpp"
#include "start/flow_ends.hpp"
#include "start/ground.hpp"
#include "start/lattice.hpp"
#include "start/places.hpp"
#include "start/random.hpp"
#include "start/region.hpp"
#include "start/shape_content.hpp"
#include "start/shapes.hpp"
#include "start/shared_start.hpp"
#include "start/sphere_sizes.hpp"

namespace barchan {
namespace {

/// A mistake that only shows when the particles are there. `key`: of the fill, "" for all of it.
[[noreturn]] void fail(const Scene& scene, std::size_t fill, const std::string& what, const std::string& key = "") {
  throw SceneError(located(scene, "fill." + std::to_string(fill) + key) + ": " + what);
}

std::string point_text(const Vec3& x, int dimensions) {
  char text[120];
  if (dimensions == 3) std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g)", x[0], x[1], x[2]);
  else std::snprintf(text, sizeof text, "(%.6g, %.6g)", x[0], x[1]);
  return text;
}

bool inside_domain(const Scene& scene, const Vec3& x, double spacing) {
  const double slack = 1e-6 * spacing;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    const double s = x[axis] - scene.domain.origin[axis];
    if (!scene.domain.periodic[axis] && (s < -slack || s > scene.domain.size[axis] + slack)) return false;
  }
  return true;
}

/// `first`: number of the first of these places in the fill.
void perturb(std::vector<Vec3>& places, const Fill& fill, const Scene& scene, std::size_t first) {
  if (fill.perturb <= 0.0) return;
  const PeriodicSpace space(scene.domain);
  Random random(fill.seed);
  random.skip(first * static_cast<std::size_t>(scene.dimensions));
  const double most = fill.perturb * spacing_of(scene, fill);
  for (Vec3& x : places) {
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis)
      x[axis] += random.uniform(-most, most);
    x = space.wrapped(x);
  }
}

/// Initial velocities of a fill; formulas are evaluated at t = 0. Nothing else knows the wind profile.
class InitialVelocity {
 public:
  InitialVelocity(const Fill& fill, const Scene& scene)
      : log_(fill.log_profile),
        bottom_(scene.domain.origin[1]),
        size_(scene.domain.size[1]),
        step_(0.5 * spacing_of(scene, fill)),
        ground_(scene),
        components_{Formula(fill.velocity[0]), Formula(fill.velocity[1]), Formula(fill.velocity[2])} {}

  Vec3 operator()(const Vec3& x) const {
    Vec3 v{components_[0](x), components_[1](x), components_[2](x)};
    if (!log_) return v;
    if (log_->along_ground) {
      const auto wind = along_ground(x);
      v[0] += wind[0];
      v[1] += wind[1];
    } else {
      v[0] += log_wind(*log_, x[1] - bottom_ - (log_->over_ground ? ground_.height(x[0], x[2]) : 0.0));
    }
    return v;
  }

 private:
  /// Streamlines at even shares s = (y - h)/(H - h) of the height: u = U(s H_0) H_0/(H - h), v = u (1 - s) dh/dx, with
  /// H_0 = H - h over the flat bed. du/dx + dv/dy = 0.
  std::array<double, 2> along_ground(const Vec3& x) const {
    const double ground = ground_.height(x[0], x[2]), flat = size_ - ground_.flat(), room = size_ - ground;
    const double share = (x[1] - bottom_ - ground) / room;
    const double slope = (ground_.height(x[0] + step_, x[2]) - ground_.height(x[0] - step_, x[2])) / (2.0 * step_);
    const double u = log_wind(*log_, share * flat) * flat / room;
    return {u, u * (1.0 - share) * slope};
  }

  std::optional<LogProfile> log_;
  double bottom_, size_, step_;  // m
  Ground ground_;
  std::array<Formula, 3> components_;
};

/// Spheres, loose or fixed, lie in the ground of the air, which has another wall than they have: nothing joins the two.
/// Grains with a law of drag by name fly between particles of air that are coarser than they are.
bool may_overlap(const Scene& scene, const Fill& a, const Fill& b) {
  const Phase *p = find_phase(scene, a.phase), *q = find_phase(scene, b.phase);
  if (!p || !q) return false;
  if (const Interaction* entry = entry_between(scene, *p, *q)) return entry->drag_law != DragLaw::none;
  const auto ground_and_spheres = [](const Phase& wall, const Phase& spheres) {
    return wall.if_wall() && !wall.diameter() && spheres.diameter();
  };
  return ground_and_spheres(*p, *q) || ground_and_spheres(*q, *p);
}

/// `at`: becomes the number of the place that is looked at.
void check_places(const std::vector<Vec3>& places, std::size_t k, const Scene& scene, PhaseKind kind,
                  const Occupied& occupied, std::size_t& at) {
  const std::string phase = " of phase \"" + scene.fills[k].phase + "\"";
  const double dx = spacing_of(scene, scene.fills[k]);
  std::vector<bool> apart;  // by fill: that this one may overlap
  for (const Fill& fill : scene.fills) apart.push_back(may_overlap(scene, scene.fills[k], fill));
  for (at = 0; at < places.size(); ++at) {
    const Vec3& x = places[at];
    if (kind != PhaseKind::wall && !inside_domain(scene, x, dx))
      fail(scene, k,
           "a particle" + phase + " at " + point_text(x, scene.dimensions) +
               " m lies outside the domain; expected a shape inside it");
    constexpr double least = (1.0 - 1e-6) * overlap_distance;
    const int other =
        std::max({occupied.inside.owner_near(x, dx, least, apart), occupied.outside.owner_near(x, dx, least, apart),
                  occupied.of_fluids.owner_near(x, dx, least, apart)});
    if (other < 0) continue;
    fail(scene, k,
         "a particle" + phase + " at " + point_text(x, scene.dimensions) + " m overlaps fill." + std::to_string(other) +
             " of phase \"" + scene.fills[static_cast<std::size_t>(other)].phase +
             "\"; expected at least half a spacing between particles of different fills, or leave-out = "
             "\"earlier-fills\" in the later one");
  }
}

/// Two single particles of one fill that stand too near each other.
void check_points(const std::vector<Vec3>& places, std::size_t k, const Scene& scene) {
  const double dx = spacing_of(scene, scene.fills[k]);
  Places others(PeriodicSpace(scene.domain), dx);
  constexpr double least = (1.0 - 1e-6) * overlap_distance;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (const int other = others.owner_near(places[i], dx, least); other >= 0)
      fail(scene, k,
           "the points " + std::to_string(other) + " and " + std::to_string(i) + ", at " +
               point_text(places[i], scene.dimensions) +
               " m, are nearer than half a spacing; expected at least half a spacing between particles",
           ".shape.points");
    others.add(places[i], dx, static_cast<int>(i));
  }
}

/// Names the formula behind a velocity or pressure that is not finite. `at`: becomes the number of the particle in the
/// fill that is looked at.
void check_values(const ParticleBlock& block, std::size_t first, std::size_t k, const Scene& scene, std::size_t& at) {
  const Fill& fill = scene.fills[k];
  for (std::size_t i = first; i < block.position.size(); ++i) {
    at = i - first;
    const auto check = [&](double value, const Expression& expression, const char* key) {
      if (std::isfinite(value)) return;
      const std::string cause = expression.is_formula() ? "the formula \"" + shortened(expression.formula) + "\" gives "
                                                        : std::string("the wind and the number give ");
      fail(scene, k,
           cause +
               (std::isnan(value) ? "nan"
                : value > 0       ? "inf"
                                  : "-inf") +
               " at " + point_text(block.position[i], scene.dimensions) +
               " m; expected a finite number at every particle",
           key);
    };
    for (std::size_t d = 0; d < 3; ++d) check(block.velocity[i][d], fill.velocity[d], ".velocity");
    if (block.pressure.size() > i) check(block.pressure[i], fill.pressure, ".pressure");
  }
}

void append(ParticleBlock& block, const std::vector<Vec3>& places, const Fill& fill, const Scene& scene) {
  const InitialVelocity velocity(fill, scene);
  const bool gives_pressure = fill.pressure.is_formula() || fill.pressure.value != 0.0;
  if (gives_pressure) block.pressure.resize(block.position.size(), 0.0);
  const bool any_pressure = !block.pressure.empty() || gives_pressure;
  const Formula pressure(fill.pressure);
  for (const Vec3& x : places) {
    block.position.push_back(x);
    block.velocity.push_back(velocity(x));
    if (any_pressure) block.pressure.push_back(pressure(x));
  }
}

/// Adds the rotation of a rigid body about its centre of mass to the new particles.
void turn(ParticleBlock& block, std::size_t first, const AxialExpression& rate, const Vec3& centre) {
  const Vec3 w{Formula(rate.about[0])({}), Formula(rate.about[1])({}), Formula(rate.about[2])({})};
  for (std::size_t i = first; i < block.position.size(); ++i)
    block.velocity[i] = block.velocity[i] + cross(w, block.position[i] - centre);
}

/// Radii of new spheres. The seed is another one than that of their places.
void append_radii(ParticleBlock& block, const SphereSize& size, unsigned seed) {
  Random random(0x5eed00000000ull + seed);
  while (block.radius.size() < block.position.size())
    block.radius.push_back(0.5 * size.mean * (size.differ() ? relative_diameter(size, random) : 1.0));
}

/// Radii and contacts of spheres that settled.
void append_settled(ParticleBlock& block, std::size_t first, const SettledGrains& settled) {
  block.radius.insert(block.radius.end(), settled.radius.begin(), settled.radius.end());
  for (RestingContact contact : settled.contacts) {
    contact.sphere += first;
    block.contacts.push_back(contact);
  }
}

/// Where the surface of a fitted wall is, seen from each of its particles.
void append_surface(ParticleBlock& block, std::size_t first, const BedShape& bed, const Scene& scene, double spacing) {
  const Terrain terrain(Ground(bed, scene.domain), scene.domain, spacing);
  block.normal.resize(first, Vec3{});
  block.depth.resize(first, 0.0);
  block.bend.resize(first, {});
  for (std::size_t i = first; i < block.position.size(); ++i) {
    const Vec3 foot = terrain.foot(block.position[i]), out = foot - block.position[i];
    const double depth = norm(out);
    block.normal.push_back(depth > 0.0 ? 1.0 / depth * out : Vec3{});
    block.depth.push_back(depth);
    block.bend.push_back(terrain.bend(foot[0], foot[2]));
  }
}

/// The same of a wall with relaxed places: how deep they lie in its shape.
void append_border(ParticleBlock& block, std::size_t first, std::size_t k, const Scene& scene, double spacing) {
  const Solid region = region_of_fill(scene, k, 8.0 * spacing);
  block.normal.resize(first, Vec3{});
  block.depth.resize(first, 0.0);
  for (std::size_t i = first; i < block.position.size(); ++i) {
    const Vec3& x = block.position[i];
    block.normal.push_back(way_out(region, x, 1e-3 * spacing, scene.dimensions));
    block.depth.push_back(norm(block.normal[i]) > 0.0 ? std::max(0.0, region.depth(x)) : 0.0);
  }
}

/// The places of a fill, while it is made.
struct FillPlaces {
  std::vector<Vec3> places, even;  // even: before they were disturbed
  SettledGrains settled{};
  bool shared = false;    // ranks share them out
  ParticlePiece piece{};  // those of this rank, where they are shared
};

void refuse_none(const Scene& scene, std::size_t k, std::size_t count) {
  if (count > 0) return;
  const Phase* const phase = find_phase(scene, scene.fills[k].phase);
  const auto size = phase ? phase->diameter() : std::nullopt;
  fail(scene, k,
       "no particle of phase \"" + scene.fills[k].phase + "\"" +
           (size ? ": a grain of " + number_text(size->mean) +
                       " m finds no room; expected a larger shape, a smaller diameter"
                 : "; expected a larger shape, a smaller spacing") +
           ", or an earlier place in the file");
}

/// Places of a fill of a fluid that comes in rows: on several ranks of a part of them.
void make_in_rows(FillPlaces& made, const Scene& scene, std::size_t k, Occupied& occupied, ParticleNumbers& numbers) {
  made.places = places_of(scene, k, occupied, ranks::own_share());
  made.piece = numbers.follow(made.places.size());
  refuse_none(scene, k, made.piece.total);
  made.even = made.places;
  perturb(made.places, scene.fills[k], scene, made.piece.first);
  check_together(made.piece.first,
                 [&](std::size_t& at) { check_places(made.places, k, scene, PhaseKind::fluid, occupied, at); });
}

/// Places of any other fill, on all ranks; of a fluid that is shared out each keeps its part.
void make_whole(FillPlaces& made, const Scene& scene, std::size_t k, const Phase& phase, const Settle& settle,
                const std::vector<ParticleBlock>& before, Occupied& occupied, ParticleNumbers& numbers) {
  const Fill& fill = scene.fills[k];
  const bool from_file = std::holds_alternative<FileShape>(fill.shape);
  occupied.ask_own();
  if (fill.packing == Packing::settled || from_file) {
    if (!settle) fail(scene, k, "a settled packing or a file cannot be made here");
    made.settled = settle(scene, k, before);
    if (!from_file) keep_inside(scene, k, made.settled);
    made.places = made.settled.position;
  } else {
    made.places = places_of(scene, k, occupied);
    leave_out_beyond_flow_ends(scene, phase, made.places);
    made.even = made.places;
    perturb(made.places, fill, scene, 0);
  }
  refuse_none(scene, k, made.places.size());
  check_together(0, [&](std::size_t& at) { check_places(made.places, k, scene, phase.kind(), occupied, at); });
  if (std::holds_alternative<PointsShape>(fill.shape)) check_points(made.places, k, scene);
  if (!made.shared) return;
  const ranks::Share share = ranks::own_share();
  for (std::vector<Vec3>* places : {&made.places, &made.even}) {
    const std::size_t n = places->size();
    *places = std::vector<Vec3>(places->begin() + static_cast<std::ptrdiff_t>(share.begin(n)),
                                places->begin() + static_cast<std::ptrdiff_t>(share.end(n)));
  }
  made.piece = numbers.follow(made.places.size());
}

/// Adds what a wall or spheres have beside places and velocities.
void append_own(ParticleBlock& block, std::size_t first, std::size_t k, const Scene& scene, const Phase& phase) {
  const Fill& fill = scene.fills[k];
  if (const auto* bed = std::get_if<BedShape>(&fill.shape); bed && fill.packing == Packing::fitted)
    append_surface(block, first, *bed, scene, phase.spacing);
  else if (phase.if_wall() && fill.packing == Packing::relaxed) append_border(block, first, k, scene, phase.spacing);
  else if (!block.depth.empty()) {
    block.normal.resize(block.position.size(), Vec3{});
    block.depth.resize(block.position.size(), 0.0);
  }
  if (!block.bend.empty()) block.bend.resize(block.position.size(), {});
}

}  // namespace

std::vector<double> fitted_heights(const Scene& scene, const std::array<int, 2>& counts) {
  std::vector<double> heights;
  const int fill = fitted_bed(scene, scene.fills.size());
  if (fill < 0) return heights;
  const Ground ground(std::get<BedShape>(scene.fills[static_cast<std::size_t>(fill)].shape), scene.domain);
  const Vec3 &low = scene.domain.origin, &size = scene.domain.size;
  for (int k = 0; k <= counts[1]; ++k)
    for (int i = 0; i <= counts[0]; ++i)
      heights.push_back(low[1] + ground.height(low[0] + size[0] * i / std::max(counts[0], 1),
                                               low[2] + size[2] * k / std::max(counts[1], 1)));
  return heights;
}

std::vector<ParticleBlock> generate(const Scene& scene, const Settle& settle) {
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    const std::string misfit = scene.domain.periodic[axis] ? misfit_of_period(scene, axis) : "";
    if (!misfit.empty()) throw SceneError(located(scene, "domain.size") + ": " + misfit);
  }
  double widest = 0.0;
  for (const Fill& fill : scene.fills) widest = std::max(widest, spacing_of(scene, fill));
  Occupied occupied(PeriodicSpace(scene.domain), widest);
  std::vector<ParticleBlock> blocks(scene.phases.size());
  std::vector<ParticleNumbers> numbers(scene.phases.size());
  const auto is_shared = [](const Phase& phase) { return ranks::active() && phase.kind() == PhaseKind::fluid; };
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Fill& fill = scene.fills[k];
    const auto phase =
        std::find_if(scene.phases.begin(), scene.phases.end(), [&](const Phase& p) { return p.name == fill.phase; });
    if (phase == scene.phases.end()) fail(scene, k, "there is no phase \"" + fill.phase + "\"");
    const auto number = static_cast<std::size_t>(phase - scene.phases.begin());
    FillPlaces made;
    made.shared = is_shared(*phase);
    if (made.shared && comes_in_rows(fill)) make_in_rows(made, scene, k, occupied, numbers[number]);
    else make_whole(made, scene, k, *phase, settle, blocks, occupied, numbers[number]);
    if (k + 1 < scene.fills.size() && made.shared) occupied.fluids.add(k, phase->spacing, made.places);
    if (k + 1 < scene.fills.size() && !made.shared)
      for (const Vec3& x : made.places)
        (inside_domain(scene, x, phase->spacing) ? occupied.inside : occupied.outside)
            .add(x, phase->spacing, static_cast<int>(k));
    ParticleBlock& block = blocks[number];
    const std::size_t first = block.position.size();
    block.parts.push_back({k, first});
    if (phase->kind() == PhaseKind::rigid) block.parts.back().body = content_of_body(scene, k, made.places);
    append(block, made.places, fill, scene);
    if (fill.angular_velocity) turn(block, first, *fill.angular_velocity, block.parts.back().body->centre);
    append_settled(block, first, made.settled);
    if (const auto size = phase->diameter()) append_radii(block, *size, fill.seed);
    check_together(made.piece.first, [&](std::size_t& at) { check_values(block, first, k, scene, at); });
    append_own(block, first, k, scene, *phase);
    for (const std::size_t count : continue_beyond_flow_ends(scene, *phase, made.even, first, block))
      if (made.shared) numbers[number].follow(count);
  }
  for (std::size_t p = 0; p < blocks.size(); ++p)
    if (is_shared(scene.phases[p])) numbers[p].deal(blocks[p]);
  return blocks;
}

}  // namespace barchan
