#include "measure/instrument.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "models/fluid/relief.hpp"
#include "scene/couplings.hpp"
#include "scene/side_names.hpp"
#include "start/generate.hpp"

namespace barchan {
namespace {

/// Builds the instruments of one scene.
class Maker {
 public:
  Maker(const Scene& scene, const Layout& layout) : scene_(scene), bounds_(layout.domain), layout_(layout) {}

  Instrument common(const Measured& measured, InstrumentKind kind, const std::string& prefix) const {
    Instrument i;
    i.kind = kind;
    i.name = measured.name;
    i.stem = prefix + "_" + measured.name;
    i.phase = number(measured.phase);
    i.phase_name = measured.phase;
    const double history = row_interval(scene_);
    i.every = measured.every > 0 ? measured.every : history;
    i.start = measured.start;
    i.dimensions = scene_.dimensions;
    i.has_pressure = layout_.phases[i.phase].flows();
    for (const Interaction& pair : scene_.interactions)
      if (pair.a == measured.phase && pair.b == measured.phase) {
        i.kernel = pair.kernel;
        i.radius = pair.radius * spacing_of(scene_, pair);
      }
    return i;
  }

  Instrument probe(const Probe& p) const {
    Instrument i = common(p, InstrumentKind::probe, "probe");
    i.rows = i.points = {p.at};
    return i;
  }

  /// Points every quarter of a spacing from the bottom to the top of the domain.
  Instrument gauge(const Gauge& g) const {
    Instrument i = common(g, InstrumentKind::gauge, "gauge");
    i.axis = up_axis(scene_.domain);
    i.rows = {g.at};
    const double low = bounds_.low[i.axis], height = bounds_.high[i.axis] - low;
    const double steps = std::ceil(4.0 * height / layout_.phases[i.phase].spacing);
    for (double k = 0.0; k <= steps; ++k) {
      Vec3 x = g.at;
      x[i.axis] = low + k * height / steps;
      i.points.push_back(x);
    }
    return i;
  }

  Instrument profile(const Profile& p) const {
    Instrument i = common(p, p.box ? InstrumentKind::slices : InstrumentKind::line, "profile");
    if (p.box) {
      i.axis = p.along;
      i.low = p.box->min;
      i.high = p.box->max;
      const double length = i.high[i.axis] - i.low[i.axis];
      const std::size_t n = whole(p.count, length, i);
      for (std::size_t k = 0; k < n; ++k) {
        Vec3 x = 0.5 * (i.low + i.high);
        x[i.axis] = i.low[i.axis] + (static_cast<double>(k) + 0.5) * length / static_cast<double>(n);
        i.rows.push_back(x);
      }
      return i;
    }
    const Vec3 along = p.to - p.from;
    const std::size_t n = p.count > 0 ? static_cast<std::size_t>(p.count) : whole(0, norm(along), i) + 1;
    for (std::size_t k = 0; k < n; ++k)
      i.rows.push_back(p.from + (static_cast<double>(k) / static_cast<double>(n - 1)) * along);
    i.points = i.rows;
    return i;
  }

  Instrument grid(const Grid& g) const {
    Instrument i = common(g, InstrumentKind::grid, "grid");
    i.low = g.min.value_or(bounds_.low);
    i.high = g.max.value_or(bounds_.high);
    const double spacing = g.spacing > 0 ? g.spacing : layout_.phases[i.phase].spacing;
    for (std::size_t d = 0; d < 3; ++d) {
      const double side = d < dimensions() ? i.high[d] - i.low[d] : 0.0;
      const double steps = std::round(side / spacing);
      i.count[d] = side > 0 ? static_cast<std::size_t>(std::max(steps, 1.0)) + 1 : 1;
      i.step[d] = i.count[d] > 1 ? side / static_cast<double>(i.count[d] - 1) : spacing;
    }
    for (std::size_t z = 0; z < i.count[2]; ++z)
      for (std::size_t y = 0; y < i.count[1]; ++y)
        for (std::size_t x = 0; x < i.count[0]; ++x)
          i.rows.push_back(i.low + Vec3{static_cast<double>(x) * i.step[0], static_cast<double>(y) * i.step[1],
                                        static_cast<double>(z) * i.step[2]});
    i.points = i.rows;
    return i;
  }

  /// Columns along x; in each, points no more than a spacing apart along x and, in three dimensions, along z.
  Instrument wall_shear(const WallShear& w) const {
    Instrument i = common(w, InstrumentKind::wall_shear, "wall_shear");
    i.wall = number(w.wall);
    i.spacing = layout_.phases[i.phase].spacing;
    i.density = scene_.phases[i.phase].density;
    say_what_shears(i);
    const Relief ground = w.top ? Relief() : ground_of(w.wall, i.spacing);
    const Vec3 size = bounds_.high - bounds_.low;
    const std::size_t columns = whole(w.count, size[0], i);
    const double width = size[0] / static_cast<double>(columns);
    const std::size_t across = whole(0, width * (1.0 - 1e-9), i), deep = dimensions() == 3 ? whole(0, size[2], i) : 1;
    i.points_per_row = across * deep;
    const auto on_surface = [&](Vec3& x) {
      x[1] = w.top ? bounds_.high[1] : bounds_.low[1];
      if (!ground.exists()) return Vec3{0.0, w.top ? -1.0 : 1.0, 0.0};
      const auto [height, along_x, along_z] = ground.at(x[0], x[2]);
      x[1] = height;
      return 1.0 / std::sqrt(1.0 + along_x * along_x + along_z * along_z) * Vec3{-along_x, 1.0, -along_z};
    };
    for (std::size_t c = 0; c < columns; ++c) {
      Vec3 x = 0.5 * (bounds_.low + bounds_.high);
      const double left = bounds_.low[0] + static_cast<double>(c) * width;
      x[0] = left + 0.5 * width;
      on_surface(x);
      i.rows.push_back(x);
      if (i.over_sand()) continue;
      for (std::size_t a = 0; a < across; ++a)
        for (std::size_t b = 0; b < deep; ++b) {
          x[0] = left + (static_cast<double>(a) + 0.5) * width / static_cast<double>(across);
          if (deep > 1) x[2] = bounds_.low[2] + (static_cast<double>(b) + 0.5) * size[2] / static_cast<double>(deep);
          i.normals.push_back(on_surface(x));
          i.points.push_back(x);
        }
    }
    return i;
  }

  Instrument saltation(const SaltationLayer& s) const {
    Instrument i = common(s, InstrumentKind::saltation, "saltation");
    i.axis = 1;
    i.low = bounds_.low;
    i.high = bounds_.high;
    i.diameter = layout_.phases[i.phase].size();
    i.flight = s.flight * i.diameter;
    i.hops = layout_.phases[i.phase].own_steps();
    i.area = scene_.domain.size[0] * (dimensions() == 3 ? scene_.domain.size[2] : 1.0);
    for (const PlanEntry& e : layout_.entries)
      if (e.wind_by_height && e.has(i.phase)) i.air = static_cast<int>(e.partner(i.phase));
    if (i.air >= 0) {
      const ColumnKeys& wind = scene_.phases[static_cast<std::size_t>(i.air)].column();
      if (wind.held) i.held_wind = wind.log_profile;
    }
    const double height = i.high[1] - i.low[1];
    const double slices = s.count > 0 ? s.count : std::max(std::round(height / i.diameter), 1.0);
    for (double k = 0.5; k < slices; ++k) {
      Vec3 x = 0.5 * (i.low + i.high);
      x[1] = i.low[1] + k * height / slices;
      i.rows.push_back(x);
    }
    return i;
  }

 private:
  std::size_t dimensions() const { return static_cast<std::size_t>(scene_.dimensions); }
  std::size_t number(const std::string& name) const {
    std::size_t k = 0;
    while (k + 1 < scene_.phases.size() && scene_.phases[k].name != name) ++k;
    return k;
  }
  /// How the fluid of a wall's shear rubs on the wall, with what is read for it.
  void say_what_shears(Instrument& i) const {
    const Phase& fluid = scene_.phases[i.phase];
    const PlanPhase& wall = layout_.phases[i.wall];
    i.roughness = wall.surface.roughness;
    i.domain = layout_.domain;
    if (wall.surface.friction == Friction::rough) {
      i.shear = drags_by_law(scene_, fluid) ? ShearOf::layers : ShearOf::rough;
      for (const PlanEntry& e : layout_.entries) {
        if (e.has(i.phase) && e.has(i.wall)) {  // the particles that feel the wall, by the weights by which they do
          i.kernel = e.kernel;
          i.radius = e.radius;
        }
        if (e.blows && e.fluid == i.phase) i.bed = 0.5 * layout_.phases[e.other].diameter;
      }
      return;
    }
    // Monaghan's viscosity as a kinematic one, as the fluid's passes have it.
    const double artificial = fluid.fluid().artificial_viscosity * 0.5 * i.radius *
                              layout_.phases[i.phase].sound_speed / (2.0 * (scene_.dimensions + 2));
    i.viscosity = fluid.density * (fluid.fluid().viscosity + artificial);
    i.radius *= 1.5;  // half of the neighbourhood lies behind the wall
  }
  /// The surface of a wall that fitted rows follow; none: the wall's surface is a side of the domain.
  Relief ground_of(const std::string& wall, double spacing) const {
    if (std::none_of(scene_.fills.begin(), scene_.fills.end(),
                     [&](const Fill& fill) { return fill.phase == wall && fill.packing == Packing::fitted; }))
      return {};
    std::array<int, 2> counts{};
    for (std::size_t c = 0; c < (dimensions() == 3 ? 2 : 1); ++c)
      counts[c] = static_cast<int>(std::ceil(8.0 * scene_.domain.size[2 * c] / spacing));
    return {layout_.domain, counts, fitted_heights(scene_, counts)};
  }
  /// `count`, or as many as there are spacings of the measured phase in the length.
  std::size_t whole(int count, double length, const Instrument& i) const {
    if (count > 0) return static_cast<std::size_t>(count);
    return static_cast<std::size_t>(std::max(std::round(length / layout_.phases[i.phase].spacing), 1.0));
  }

  const Scene& scene_;
  const Bounds& bounds_;
  const Layout& layout_;
};

}  // namespace

std::vector<std::string> Instrument::files() const {
  switch (kind) {
    case InstrumentKind::probe:
    case InstrumentKind::gauge: return {stem + ".csv"};
    case InstrumentKind::grid: return {stem + ".vti"};
    case InstrumentKind::saltation: {
      std::vector<std::string> all{stem + ".csv", stem + ".vtp", stem + ".json"};
      if (hops) all.push_back("hops_" + name + ".csv");
      return all;
    }
    default: return {stem + ".csv", stem + ".vtp"};
  }
}

std::vector<Instrument> make_instruments(const Scene& scene, const Layout& layout) {
  const Maker maker(scene, layout);
  std::vector<Instrument> instruments;
  for (const Probe& p : scene.measuring.probes) instruments.push_back(maker.probe(p));
  for (const Gauge& g : scene.measuring.gauges) instruments.push_back(maker.gauge(g));
  for (const Profile& p : scene.measuring.profiles) instruments.push_back(maker.profile(p));
  for (const Grid& g : scene.measuring.grids) instruments.push_back(maker.grid(g));
  for (const WallShear& w : scene.measuring.wall_shears) instruments.push_back(maker.wall_shear(w));
  for (const SaltationLayer& s : scene.measuring.saltation) instruments.push_back(maker.saltation(s));
  return instruments;
}

std::string kind_name(InstrumentKind kind) {
  switch (kind) {
    case InstrumentKind::probe: return "probe";
    case InstrumentKind::gauge: return "gauge";
    case InstrumentKind::line:
    case InstrumentKind::slices: return "profile";
    case InstrumentKind::grid: return "grid";
    case InstrumentKind::wall_shear: return "wall-shear";
    case InstrumentKind::saltation: return "saltation";
  }
  return "";
}

std::string to_text(const Instrument& i) {
  const char* rows = i.kind == InstrumentKind::wall_shear                                      ? "columns"
                     : i.kind == InstrumentKind::slices || i.kind == InstrumentKind::saltation ? "slices"
                                                                                               : "points";
  char text[160];
  std::snprintf(text, sizeof text, "%zu %s, every %g s from %g s", i.rows.size(), rows, i.every, i.start);
  if (i.in_time()) std::snprintf(text, sizeof text, "every %g s", i.every);
  return kind_name(i.kind) + " " + i.name + " (" + i.phase_name + ", " + text + ")";
}

std::vector<std::string> not_measured(const std::vector<Instrument>& instruments) {
  std::vector<std::string> words;
  for (const InstrumentKind kind : {InstrumentKind::probe, InstrumentKind::gauge, InstrumentKind::line,
                                    InstrumentKind::grid, InstrumentKind::wall_shear, InstrumentKind::saltation})
    if (std::none_of(instruments.begin(), instruments.end(),
                     [&](const Instrument& i) { return kind_name(i.kind) == kind_name(kind); }))
      words.push_back(kind_name(kind));
  return words;
}

}  // namespace barchan
