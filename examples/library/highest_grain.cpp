// How high do the particles of each phase stand, after a number of steps? A scene is read, planned and integrated in this
// program; nothing is written.
//
//   highest_grain SCENE.toml STEPS
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "base/fields.hpp"
#include "plan/plan.hpp"
#include "checks/reader.hpp"
#include "simulation/settle.hpp"
#include "simulation/simulation.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "expected: highest_grain SCENE.toml STEPS\n"), 2;
  try {
    const barchan::Scene scene = barchan::read_scene(argv[1]);
    const auto particles = barchan::make_particles(scene);
    const barchan::Plan plan = barchan::make_plan(scene, particles);
    barchan::Simulation simulation(scene, plan, particles);
    for (long k = std::atol(argv[2]); k > 0; --k) simulation.step(scene.time.end);
    std::printf("t = %.6g s\n", simulation.time());
    for (const barchan::PhaseParticles& phase : simulation.phases()) {
      if (phase.size() == 0) continue;
      const double* y = phase.column(barchan::Field::position, 1);
      std::printf("%s: %.6g m\n", phase.name().c_str(), *std::max_element(y, y + phase.size()));
    }
  } catch (const std::exception& error) { return std::fprintf(stderr, "%s\n", error.what()), 1; }
}
