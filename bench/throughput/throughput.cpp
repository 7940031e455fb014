// How fast whole steps are: air in two and three dimensions, grains, elastic bodies, a dune.
//
//   throughput [--case air2d|air2d-consistent|air3d|grains2d|elastic2d|elastic2d-total|dune] [--n N] [--threads T]
//   [--steps S] [--json]
//
// Steps run without output. One thread: processor time of that thread, so that a busy machine does not matter; more
// threads: wall time. The parts of a step are shares of wall time. Pairs are counted from both sides and are those
// within the kernel radius, not those in the skin. Medians of five stretches of S steps, after a warm-up that includes
// rebuilds of the lists.
#include <omp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/clock.hpp"
#include "base/denormals.hpp"
#include "checks/reader.hpp"
#include "simulation/simulation.hpp"
#include "throughput/bare_air.hpp"

namespace {

using namespace barchan;

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

/// A periodic box of Taylor-Green flow, perturbed by a fifth of a spacing.
std::string air(int dimensions, double n, const std::string& scheme, double radius) {
  const double per_side = std::round(std::pow(n, 1.0 / dimensions)), dx = 1.0 / per_side;
  const bool flat = dimensions == 2;
  return "dimensions = " + std::to_string(dimensions) + "\nspacing = " + number(dx) + "\n[domain]\nsize = " +
         (flat ? "[1, 1]\nperiodic = [\"x\", \"y\"]" : "[1, 1, 1]\nperiodic = [\"x\", \"y\", \"z\"]") +
         "\n[phases.air]\nkind = \"fluid\"\ndensity = 1.0\nviscosity = 1e-3\nsound-speed = 10\nscheme = \"" + scheme +
         "\"\n[interactions]\nkernel = \"wendland-c2\"\nair-air = " + number(radius) +
         "\n[[fill]]\nphase = \"air\"\nshape = \"the-rest\"\nperturb = 0.2\nvelocity = [\"-cos(2*pi*x)*sin(2*pi*y)\", "
         "\"sin(2*pi*x)*cos(2*pi*y)\"" +
         (flat ? "]" : ", 0]") + "\n[time]\nend = 10\n";
}

/// A deep bed of staggered grains on a floor.
std::string grains(double n) {
  const double per_side = std::round(std::sqrt(n)), dx = 1e-3, size = per_side * dx;
  return "dimensions = 2\nspacing = 1e-3\n[domain]\nsize = [" + number(size) + ", " + number(size * 1.2) +
         "]\nperiodic = [\"x\"]\ngravity = [0, -9.81]\n[phases.sand]\nkind = \"grains\"\ndensity = 2650\nrestitution = "
         "0.7\n"
         "[phases.floor]\nkind = \"wall\"\n[interactions]\nsand-sand = 1.1\nsand-floor = 1.1\n"
         "[[fill]]\nphase = \"floor\"\nshape = { box = { min = [0, 0], max = [" +
         number(size) +
         ", 0.002] } }\n"
         "packing = \"staggered\"\n[[fill]]\nphase = \"sand\"\nshape = { bed = " +
         number(size) + ", from = 0.002 }\npacking = \"staggered\"\n[time]\nend = 10\n";
}

/// A square elastic body that vibrates. `own`: keys of its formulation.
std::string elastic(double n, const std::string& own) {
  const double per_side = std::round(std::sqrt(n)), dx = 1.0 / per_side;
  return "dimensions = 2\nspacing = " + number(dx) +
         "\n[domain]\nsize = [2, 2]\n[phases.body]\nkind = \"elastic\"\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"
         "formulation = " +
         own +
         "\n[interactions]\nkernel = \"wendland-c2\"\nbody-body = 2.6\n[[fill]]\nphase = "
         "\"body\"\n"
         "shape = { box = { min = [0.5, 0.5], max = [1.5, 1.5] } }\nvelocity = [\"0.1*sin(pi*(x-1))\", 0]\n[time]\nend "
         "= 10\n";
}

/// Directed pairs within the radius itself: the simulation's lists hold those in the skin too.
double true_pairs(Simulation& s) {
  double of_models = 0;  // lists that are not the simulation's: of total Lagrangian bodies
  for (const auto& e : s.plan().entries)
    if (e.forward < 0 && e.backward < 0) of_models += static_cast<double>(s.pairs(e));
  if (s.plan().directions.empty()) return of_models;
  auto particles = s.phases();
  std::vector<double> spacings;
  for (const auto& p : s.plan().phases) spacings.push_back(p.spacing);
  Neighbours exact(s.plan().bounds, s.plan().directions, 1e-4, spacings);
  exact.update(particles, true);
  double pairs = of_models;
  for (std::size_t k = 0; k < s.plan().directions.size(); ++k) pairs += static_cast<double>(exact.list(k).entries());
  return pairs;
}

/// CPU seconds of whole steps against those of a program that has only this air in it, step by step in turn.
void compare_with_bare(Simulation& s, int steps) {
  BareAir bare(s);
  const auto seconds = [](auto&& work) {
    const double begin = thread_seconds();
    work();
    return thread_seconds() - begin;
  };
  std::vector<double> ratios;
  for (int stretch = 0; stretch < 11; ++stretch) {
    double whole = 0, alone = 0;
    for (int k = 0; k < steps; ++k) {
      whole += seconds([&] { s.step(1.0); });
      alone += seconds([&] { bare.step(); });
    }
    ratios.push_back(whole / alone);
  }
  std::sort(ratios.begin(), ratios.end());
  std::printf("%.4f\n", ratios[5]);
}

}  // namespace

int main(int argc, char** argv) {
  flush_denormals();
  CLI::App app{"Whole steps a second"};
  std::string name = "air2d";
  double n = 2e5;
  int threads = 1, steps = 20, warm = 20;
  bool json = false;
  app.add_option("--case", name);
  app.add_option("--n", n);
  app.add_option("--threads", threads);
  app.add_option("--steps", steps);
  app.add_option("--warm", warm, "steps before the first stretch");
  app.add_flag("--json", json);
  std::string precision = "double";
  app.add_option("--precision", precision, "of the fluid's pair loops: double or mixed");
  bool bare = false;
  app.add_flag("--bare", bare, "CPU seconds over those of a program that has only this air in it (air2d, double)");
  CLI11_PARSE(app, argc, argv);
  omp_set_num_threads(threads);

  Scene scene = name == "air2d"              ? parse_scene(air(2, n, "plain", 3.0), name)
                : name == "air2d-consistent" ? parse_scene(air(2, n, "consistent", 2.6), name)
                : name == "air3d"            ? parse_scene(air(3, n, "plain", 2.86), name)
                : name == "grains2d"         ? parse_scene(grains(n), name)
                : name == "elastic2d"
                    ? parse_scene(elastic(n, "\"updated-lagrangian\"\nartificial-viscosity = 0.1"), name)
                : name == "elastic2d-total" ? parse_scene(elastic(n, "\"total-lagrangian\""), name)
                                            : read_scene(name);
  scene.precision = precision == "mixed" ? Precision::mixed : Precision::double_precision;
  const auto blocks = generate(scene);
  const Plan plan = make_plan(scene, blocks);
  Simulation s(scene, plan, blocks);
  for (int k = 0; k < warm; ++k) s.step(1.0);
  if (bare) {
    compare_with_bare(s, steps);
    return 0;
  }
  const auto clock = [&] {
    if (threads > 1) return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    return thread_seconds();
  };
  std::vector<double> rates;
  const auto rebuilds = s.neighbours().rebuilds();
  const auto before = s.seconds();
  const double begin = clock();
  for (int stretch = 0; stretch < 5; ++stretch) {
    const double start = clock();
    for (int k = 0; k < steps; ++k) s.step(1.0);
    rates.push_back(plan.particles() * steps / (clock() - start));
  }
  const double spent = clock() - begin;
  std::sort(rates.begin(), rates.end());
  const double every = 5.0 * steps / std::max(1.0, static_cast<double>(s.neighbours().rebuilds() - rebuilds));
  const double pairs = true_pairs(s), neighbours = pairs / plan.particles();
  const double bytes = static_cast<double>(s.bytes()) / plan.particles();
  std::vector<std::pair<std::string, double>> parts = s.seconds();
  double all = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) all += parts[k].second -= before[k].second;
  double fluid = 0;
  for (auto& [part, share] : parts) {
    share /= all;
    if (part == "fluid rates" || part == "elastic forces" || part == "contacts") fluid += share * spent;
  }
  if (json) {
    nlohmann::ordered_json j{{"case", name},
                             {"particles", plan.particles()},
                             {"threads", threads},
                             {"neighbours", neighbours},
                             {"particle_steps_per_second", rates[2]},
                             {"pairs_per_second", rates[2] * neighbours},
                             {"pair_pass_pairs_per_second", fluid > 0 ? pairs * 5.0 * steps / fluid : 0.0},
                             {"steps_per_rebuild", every},
                             {"skin", s.neighbours().skin()},
                             {"bytes_per_particle", bytes}};
    for (const auto& [part, share] : parts)
      if (share > 0) j["share"][part] = share;
    std::printf("%s\n", j.dump(2).c_str());
    return 0;
  }
  std::printf(
      "%-18s %9.0f particles  %d threads  %5.1f neighbours  %6.2f M particle-steps/s  %6.1f M pairs/s  "
      "pair pass %6.1f M pairs/s  a rebuild every %.1f steps, skin %.3f  %.0f B/particle\n",
      name.c_str(), plan.particles(), threads, neighbours, rates[2] * 1e-6, rates[2] * neighbours * 1e-6,
      fluid > 0 ? pairs * 5.0 * steps / fluid * 1e-6 : 0.0, every, s.neighbours().skin(), bytes);
  std::printf("  share of the step:");
  for (const auto& [part, share] : parts)
    if (share > 0.002) std::printf("  %s %.1f %%", part.c_str(), 100 * share);
  std::printf("\n");
}
