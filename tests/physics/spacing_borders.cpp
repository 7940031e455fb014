// Two phases of one fluid with spacings 1 to 2 that pass fluid on through a border: conservation, streams, a vortex,
// the logarithmic layer, and the same bits for any threads, storage and restart.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;

/// A box that repeats itself on all sides. `border`: of the fine and the coarse phase, empty: there is only the coarse
/// one; `fills`: sections.
std::string box(int dimensions, const std::string& size, double spacing, const std::string& border,
                const std::string& fills) {
  const std::string phase = "kind = \"fluid\"\ndensity = 1\nsound-speed = 15\n";
  std::string text = "dimensions = " + std::to_string(dimensions) + "\nspacing = " + std::to_string(spacing) +
                     "\n[domain]\nsize = " + size +
                     "\nperiodic = " + (dimensions == 2 ? "[\"x\", \"y\"]" : "[\"x\", \"y\", \"z\"]") +
                     "\n[phases.coarse]\n" + phase;
  std::string pairs = "[interactions]\ncoarse-coarse = 2.6\n";
  if (!border.empty()) {
    text += "[phases.fine]\n" + phase + "spacing = " + std::to_string(0.5 * spacing) + "\n";
    pairs += "fine-fine = 2.6\nfine-coarse = { radius = 2.6, border = \"" + border + "\" }\n";
  }
  return text + pairs + fills + "[time]\nend = 1\nlargest-speed = 1.5\n[output]\nhistory-every = 1\n";
}

std::string section_of(const std::string& phase, const std::string& shape, const std::string& velocity,
                       const std::string& more = "perturb = 0.2") {
  return "[[fill]]\nphase = \"" + phase + "\"\nshape = " + shape + "\nvelocity = " + velocity + "\n" + more + "\n";
}

double column_of(const Simulation& run, const std::string& name) {
  const HistoryRow row = run.history();
  for (std::size_t c = 0; c < row.names.size(); ++c)
    if (row.names[c].rfind(name, 0) == 0) return row.values[c];
  ADD_FAILURE() << "no column " << name;
  return 0.0;
}

// ---- conservation ---------------------------------------------------------------------------------------------------

struct Totals {
  double mass = 0.0, kinetic = 0.0, speed = 0.0, arm = 0.0;  // speed, arm: sums of m |v|, m |x|, the scales
  Vec3 momentum{}, moment{};                                 // m v, m x
  void add(double m, const Vec3& x, const Vec3& v) {
    mass += m;
    for (std::size_t d = 0; d < 3; ++d) {
      momentum[d] += m * v[d];
      moment[d] += m * x[d];
      kinetic += 0.5 * m * v[d] * v[d];
    }
    speed += m * norm(v);
    arm += m * norm(x);
  }
};

Totals totals_of(const Simulation& run) {
  Totals sum;
  for (const PhaseParticles& p : run.phases())
    for (std::size_t k = 0; k < p.size(); ++k) {
      Vec3 x{}, v{};
      for (int d = 0; d < p.dimensions(); ++d) {
        x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
        v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d)[k];
      }
      sum.add(p.mass(), x, v);
    }
  return sum;
}

/// A run whose fluid is passed on before its first step, beside what its fills have.
void expect_all_kept(int dimensions, const std::string& filled, const std::string& border) {
  const std::string size = dimensions == 2 ? "[2, 1]" : "[1, 0.5, 0.5]";
  const std::string other = filled == "fine" ? "coarse" : "fine";
  const double spacing = dimensions == 2 ? 0.02 : 0.0625;
  const std::string velocity =
      dimensions == 2 ? "[\"1+sin(3*x*y)\", \"cos(9*y+x)\"]" : "[\"1+sin(3*x*y)\", \"cos(9*y+x)\", \"sin(5*z-x)\"]";
  // A few of the other phase stand in the middle, where they belong; all else is of one phase. Nothing changes at the
  // sides, where a place would go to the other side.
  const std::string few = dimensions == 2
                              ? "{ box = { min = [0.94, 0.44], max = [1.06, 0.56] } }"
                              : "{ box = { min = [0.4375, 0.1875, 0.1875], max = [0.5625, 0.3125, 0.3125] } }";
  const Scene scene = parse_scene(box(dimensions, size, spacing, border,
                                      section_of(other, few, velocity) + section_of(filled, "\"the-rest\"", velocity)),
                                  "test.toml");
  const auto blocks = make_particles(scene);
  const Plan plan = make_plan(scene, blocks);
  Totals before;
  for (const std::size_t phase : {0, 1})
    for (std::size_t k = 0; k < blocks[phase].position.size(); ++k)
      before.add(plan.phases[phase].mass, blocks[phase].position[k], blocks[phase].velocity[k]);
  const Simulation run(scene, plan, blocks);
  const std::size_t to = filled == "fine" ? 0 : 1;
  ASSERT_GT(run.phases()[to].size(), 2 * blocks[to].position.size()) << "too little became " << other;
  const Totals after = totals_of(run);
  const double lost = column_of(run, "fine-coarse_loss");
  const std::string name = filled + " fluid, " + std::to_string(dimensions) + "D: ";
  report(name + "mass", std::abs(after.mass / before.mass - 1.0), 1e-12);
  report(name + "momentum", norm(after.momentum - before.momentum) / before.speed, 1e-12);
  report(name + "place of the mass", norm(after.moment - before.moment) / before.arm, 1e-12);
  report(name + "energy", std::abs(after.kinetic + lost - before.kinetic) / before.kinetic, 1e-12);
  EXPECT_LE(std::abs(after.mass / before.mass - 1.0), 1e-12);
  EXPECT_LE(norm(after.momentum - before.momentum), 1e-12 * before.speed);
  EXPECT_LE(norm(after.moment - before.moment), 1e-12 * before.arm);
  EXPECT_LE(std::abs(after.kinetic + lost - before.kinetic), 1e-12 * before.kinetic);
  EXPECT_NE(lost, 0.0);
}

TEST(SpacingBorders, ASplitKeepsMassMomentumAndPlace) {
  expect_all_kept(2, "coarse", "sqrt((x-1)^2+(y-0.5)^2)-0.3");
  expect_all_kept(3, "coarse", "sqrt((x-0.5)^2+(y-0.25)^2+(z-0.25)^2)-0.2");
}

TEST(SpacingBorders, AMergeKeepsMassMomentumAndPlace) {
  expect_all_kept(2, "fine", "0.3-sqrt((x-1)^2+(y-0.5)^2)");
  expect_all_kept(3, "fine", "0.2-sqrt((x-0.5)^2+(y-0.25)^2+(z-0.25)^2)");
}

// ---- who merges: a naive twin ---------------------------------------------------------------------------------------

/// The places of what the fine particles beyond x = 1 +- 0.5 become, by looking at all of them again and again.
std::vector<Vec3> merged_naively(const ParticleBlock& fine, double spacing, std::int64_t first_id) {
  struct One {
    Vec3 x;
    double distance;
    std::int64_t id;
    bool taken;
  };
  std::vector<One> all;
  for (std::size_t k = 0; k < fine.position.size(); ++k) {
    Vec3 x = fine.position[k];
    x[0] -= 2.0 * std::floor(x[0] / 2.0);
    x[1] -= std::floor(x[1]);
    all.push_back({x, std::abs(x[0] - 1.0) - 0.5, first_id + static_cast<std::int64_t>(k), false});
  }
  const auto apart = [](const Vec3& a, const Vec3& b) {
    Vec3 r = a - b;
    r[0] -= 2.0 * std::round(r[0] / 2.0);
    r[1] -= std::round(r[1]);
    return r;
  };
  const auto squared = [](const Vec3& r) { return r[0] * r[0] + r[1] * r[1]; };
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (all[k].distance > spacing) order.push_back(k);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return all[a].distance > all[b].distance; });
  std::vector<Vec3> merged;
  for (const std::size_t seed : order) {
    if (all[seed].taken) continue;
    const double near = 1.5 * std::sqrt(2.0) * spacing;
    std::vector<std::size_t> group{seed};
    const auto grow = [&](double radius) {
      group.assign(1, seed);
      while (group.size() < 4) {
        std::size_t best = all.size();
        double least = 1e300;
        for (std::size_t k = 0; k < all.size(); ++k) {
          if (all[k].taken || all[k].distance <= 0.0 || squared(apart(all[k].x, all[seed].x)) > radius * radius ||
              std::find(group.begin(), group.end(), k) != group.end())
            continue;
          double sum = 0.0;
          for (const std::size_t g : group) sum += squared(apart(all[k].x, all[g].x));
          if (sum < least) best = k, least = sum;
        }
        if (best == all.size()) return false;
        group.push_back(best);
      }
      return true;
    };
    if (!grow(near) && !(all[seed].distance > 4.0 * spacing && grow(4.0 * spacing))) continue;
    Vec3 away{};
    for (const std::size_t g : group) {
      away = away + apart(all[g].x, all[seed].x);
      all[g].taken = true;
    }
    merged.push_back(all[seed].x + 0.25 * away);
  }
  return merged;
}

TEST(SpacingBorders, MergeThoseThatALookAtAllParticlesMerges) {
  // The border lies on nodes of its grid, so that distances are those of the formula.
  const Scene scene = parse_scene(box(2, "[2, 1]", 0.05, "abs(x-1)-0.5",
                                      section_of("coarse", "{ box = { min = [0, 0], max = [0.05, 0.05] } }", "[1, 0]") +
                                          section_of("fine", "\"the-rest\"", "[1, 0]", "perturb = 0.3")),
                                  "test.toml");
  const auto blocks = make_particles(scene);
  const Simulation run(scene, make_plan(scene, blocks), blocks);
  const std::size_t few = blocks[0].position.size();
  const std::vector<Vec3> naive = merged_naively(blocks[1], 0.025, static_cast<std::int64_t>(few));
  const PhaseParticles& p = run.phases()[0];
  ASSERT_EQ(naive.size() + few, p.size());
  ASSERT_GT(p.size(), 100u);
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p.id()[k] < static_cast<std::int64_t>(few)) continue;
    const double x = p.column(Field::position, 0)[k], y = p.column(Field::position, 1)[k];
    EXPECT_TRUE(std::any_of(naive.begin(), naive.end(),
                            [&](const Vec3& q) {
                              const double dx = q[0] - x, dy = q[1] - y;
                              return std::hypot(dx - 2.0 * std::round(dx / 2.0), dy - std::round(dy)) < 1e-12;
                            }))
        << "at " << x << ", " << y;
  }
  // What finds no three others stays: few, and only near the border.
  std::size_t strays = 0;
  const PhaseParticles& fine = run.phases()[1];
  for (std::size_t k = 0; k < fine.size(); ++k)
    strays += std::abs(fine.column(Field::position, 0)[k] - 1.0) > 0.5 + 0.05 ? 1 : 0;
  const double left = static_cast<double>(strays) / (4.0 * static_cast<double>(naive.size()));
  report("fine particles left beyond the border, of all", left, 0.02);
  EXPECT_LE(left, 0.02);
}

// ---- flows ----------------------------------------------------------------------------------------------------------

// Corrected operators are exact for a uniform field on any arrangement of particles, and a split or a merge of equal
// velocities has that velocity: the stream stays uniform to rounding, through a border in all directions.
TEST(SpacingBorders, AStreamThroughARoundBorderStaysUniform) {
  const auto run =
      small::simulation(box(2, "[1, 1]", 0.02, "sqrt((x-0.5)^2+(y-0.5)^2)-0.25",
                            section_of("fine", "{ box = { min = [0.4, 0.4], max = [0.6, 0.6] } }", "[1, 0.5]") +
                                section_of("coarse", "\"the-rest\"", "[1, 0.5]")));
  while (run->time() < 0.2) run->step(1.0);
  double error = 0.0, mass = 0.0, density = 0.0;
  for (const PhaseParticles& p : run->phases()) {
    mass += p.mass() * static_cast<double>(p.size());
    for (std::size_t k = 0; k < p.size(); ++k) {
      error = std::max(
          {error, std::abs(p.column(Field::velocity, 0)[k] - 1.0), std::abs(p.column(Field::velocity, 1)[k] - 0.5)});
      density = std::max(density, std::abs(p.column(Field::density)[k] - 1.0));
    }
  }
  report("largest error of the velocity over that of the stream", error, 1e-12);
  report("largest error of the density", density, 1e-12);
  report("mass", std::abs(mass - 1.0), 1e-12);
  EXPECT_LE(error, 1e-12);
  EXPECT_LE(density, 1e-12);
  EXPECT_LE(std::abs(mass - 1.0), 1e-12);
  // The disc holds 0.196 of the mass; the stream carries 0.1 of it in and out.
  EXPECT_GT(column_of(*run, "fine-coarse_to_coarse"), 0.05);
  EXPECT_GT(column_of(*run, "fine-coarse_to_fine"), 0.05 + 0.19);
}

/// A turbulent layer of constant stress, 0.12 m high, u* = 0.4 m/s over z0 = 0.1 mm, in air of these spacings (mm).
std::string layer_of(const std::vector<double>& spacings) {
  const std::vector<std::string> names{"air", "above", "high"};
  const std::vector<std::string> tops =
      spacings.size() == 1 ? std::vector<std::string>{"0.12"} : std::vector<std::string>{"0.024", "0.048", "0.12"};
  std::string text = "spacing = 3e-3\n[domain]\nsize = [0.06, 0.12]\nperiodic = [\"x\"]\n", pairs, fills, low = "0";
  for (std::size_t k = 0; k < spacings.size(); ++k) {
    text += "[phases." + names[k] +
            "]\nkind = \"fluid\"\ndensity = 1.225\nviscosity = 1.48e-5\nsound-speed = 70\n"
            "turbulence = \"mixing-length\"\nspacing = " +
            std::to_string(1e-3 * spacings[k]) + "\n";
    pairs += names[k] + "-" + names[k] + " = 2.1\n" + names[k] + "-ground = 2.1\n";
    if (k > 0) pairs += names[k - 1] + "-" + names[k] + " = { radius = 2.1, border = \"y - " + tops[k - 1] + "\" }\n";
    fills += section_of(names[k], "{ box = { min = [0, " + low + "], max = [0.06, " + tops[k] + "] } }",
                        "{ log-profile = { friction-velocity = 0.4, roughness = 1e-4 } }");
    low = tops[k];
  }
  return text + "[phases.ground]\nkind = \"wall\"\nroughness = 1e-4\n[phases.lid]\nkind = \"wall\"\nspacing = " +
         std::to_string(1e-3 * spacings.back()) + "\nshear-stress = [0.196, 0]\n[interactions]\n" + pairs +
         names[spacings.size() - 1] + "-lid = 2.1\n" +
         "[[fill]]\nphase = \"ground\"\nshape = { sides = [\"bottom\"] }\n[[fill]]\nphase = \"lid\"\nshape = { sides = "
         "[\"top\"] }\n" +
         fills + "[time]\nend = 1\nlargest-speed = 7\n";
}

/// The largest error of the speed over that of the logarithm, and of the whole viscosity, above the first two fine
/// rows.
std::array<double, 2> errors_of_layer(const std::vector<double>& spacings) {
  const auto run = small::simulation(layer_of(spacings));
  while (run->time() < 0.1) run->step(1.0);
  std::array<double, 2> worst{};
  for (std::size_t phase = 0; phase < spacings.size(); ++phase) {
    const PhaseParticles& p = run->phases()[phase];
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double y = p.column(Field::position, 1)[k];
      if (y < 0.006) continue;
      worst[0] = std::max(worst[0], std::abs(p.column(Field::velocity, 0)[k] / (std::log(y / 1e-4)) - 1.0));
      worst[1] = std::max(worst[1], std::abs((p.column(Field::eddy_viscosity)[k] + 1.48e-5) / (0.16 * y) - 1.0));
    }
  }
  return worst;
}

// u = (u*/0.4) ln(y/z0) and nu_t = 0.4 u* y are kept (Prandtl 1932), through two borders as in one spacing.
TEST(SpacingBorders, ALogarithmicLayerPassesThrough) {
  const auto joined = errors_of_layer({3, 6, 12}), fine = errors_of_layer({3}), coarse = errors_of_layer({6});
  report("3, 6 and 12 mm: largest error of the speed", joined[0], 0.01);
  report("3 mm alone", fine[0], 0.01);
  report("6 mm alone", coarse[0], 0.01);
  report("3, 6 and 12 mm: largest error of the eddy viscosity", joined[1], 0.03);
  report("3 mm alone", fine[1], 0.03);
  EXPECT_LE(joined[0], 0.01);
  EXPECT_LE(joined[1], 0.03);
}

const std::string swirl = "*exp(0.5-50*((x-XC-2*rint((x-XC)/2))^2+(y-0.5)^2))";

/// The mean error of the velocity within 0.35 of a vortex whose swirl is 0.5 at r = 0.1, carried by 1 in 1 s from
/// x = `from` to `from` + 1. The exact flow is steady: v = 0.5 (r/0.1) exp((1 - (r/0.1)^2)/2), p = -0.125 exp(1 -
/// (r/0.1)^2).
double vortex_error(const std::string& text, double from) {
  const auto run = small::simulation(text);
  while (run->time() < 1.0 - 1e-9) run->step(1.0 - run->time());
  double sum = 0.0, all = 0.0;
  for (const PhaseParticles& p : run->phases())
    for (std::size_t k = 0; k < p.size(); ++k) {
      double x = p.column(Field::position, 0)[k] - from - run->time();
      x -= 2.0 * std::round(x / 2.0);
      const double y = p.column(Field::position, 1)[k] - 0.5, r2 = x * x + y * y, s = 5.0 * std::exp(0.5 - 50.0 * r2);
      if (r2 > 0.35 * 0.35) continue;
      sum +=
          p.mass() * std::hypot(p.column(Field::velocity, 0)[k] - 1.0 + y * s, p.column(Field::velocity, 1)[k] - x * s);
      all += p.mass();
    }
  return sum / all;
}

std::string with_centre(std::string text, double from) {
  for (std::size_t at; (at = text.find("XC")) != std::string::npos;) text.replace(at, 2, from > 0.5 ? "1" : "0");
  return text;
}

TEST(SpacingBorders, AVortexIsCarriedThrough) {
  const std::string velocity = "[\"1-5*(y-0.5)" + swirl + "\", \"5*(x-XC-2*rint((x-XC)/2))" + swirl + "\"]";
  const std::string pressure = "perturb = 0.2\npressure = \"-0.125*exp(1-100*((x-XC-2*rint((x-XC)/2))^2+(y-0.5)^2))\"";
  const std::string fine = section_of("fine", "{ box = { min = [0.5, 0], max = [1.5, 1] } }", velocity, pressure);
  const std::string rest = section_of("coarse", "\"the-rest\"", velocity, pressure);
  const double coarse = vortex_error(with_centre(box(2, "[2, 1]", 0.02, "", rest), 0.0), 0.0);
  const std::string joined = box(2, "[2, 1]", 0.02, "abs(x-1)-0.5", fine + rest);
  const double into_fine = vortex_error(with_centre(joined, 0.0), 0.0);
  const double into_coarse = vortex_error(with_centre(joined, 1.0), 1.0);
  report("L1 of the coarse spacing alone over the swirl", coarse / 0.5, 0.004);
  report("coarse to fine, over that", into_fine / coarse, 1.3);
  report("fine to coarse, over that", into_coarse / coarse, 1.3);
  EXPECT_LE(into_fine, 1.3 * coarse);
  EXPECT_LE(into_coarse, 1.4 * coarse);  // measured 1.29; the rest is for other instruction sets
}

// ---- bits -----------------------------------------------------------------------------------------------------------

std::string busy() {
  return box(2, "[1, 1]", 0.04, "sqrt((x-0.5)^2+(y-0.5)^2)-0.25",
             section_of("fine", "{ box = { min = [0.4, 0.4], max = [0.6, 0.6] } }", "[1, 0]") +
                 section_of("coarse", "\"the-rest\"", "[\"1-0.5*sin(6.2831853*y)\", \"0.5*sin(6.2831853*x)\"]"));
}

/// Ids and fields in the order of the ids.
std::vector<double> state_of(const Simulation& run) {
  std::vector<double> all;
  for (const PhaseParticles& p : run.phases()) {
    std::vector<std::size_t> order(p.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p.id()[a] < p.id()[b]; });
    for (const std::size_t k : order) {
      all.push_back(static_cast<double>(p.id()[k]));
      for (const auto& about : field_table)
        for (int c = 0; p.has(about.id) && c < p.components(about.id); ++c) all.push_back(p.column(about.id, c)[k]);
    }
  }
  const auto row = run.history_row();
  all.insert(all.end(), row.begin(), row.end());
  return all;
}

TEST(SpacingBorders, HaveTheSameBitsForAnyThreadsStorageAndRestart) {
  const Scene scene = parse_scene(busy(), "test.toml");
  const auto blocks = make_particles(scene);
  const Plan plan = make_plan(scene, blocks);
  const int threads = omp_get_max_threads();
  const auto steps = [](Simulation& run, int count) {
    for (int k = 0; k < count; ++k) run.step(1.0);
  };
  omp_set_num_threads(1);
  Simulation first(scene, plan, blocks);
  steps(first, 40);
  Archive saved;
  first.archive(saved);
  steps(first, 40);
  const auto bits = state_of(first);
  EXPECT_GT(column_of(first, "fine-coarse_to_coarse"), 0.0);
  const auto same = [&](const Simulation& other) {
    const auto theirs = state_of(other);
    return theirs.size() == bits.size() && std::memcmp(theirs.data(), bits.data(), bits.size() * sizeof(double)) == 0;
  };
  for (const int t : {1, 2, 3}) {
    omp_set_num_threads(t);
    Simulation shuffled(scene, plan, blocks, Simulation::Storage::shuffled);
    steps(shuffled, 80);
    EXPECT_TRUE(same(shuffled)) << t << " threads";
  }
  Simulation again(scene, plan, blocks);
  Archive loaded(saved.bytes());
  again.archive(loaded);
  loaded.finish();
  steps(again, 40);
  EXPECT_TRUE(same(again)) << "from a checkpoint";
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace barchan
