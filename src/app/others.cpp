// barchan plan, generate, compare, schema.
#include <omp.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "app/commands.hpp"
#include "base/errors.hpp"
#include "output/compare.hpp"
#include "output/series.hpp"
#include "scene/reader.hpp"
#include "simulation/estimate.hpp"
#include "simulation/settle.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

void use_threads(int wanted, const Plan& plan) {
  const int useful = 1 + static_cast<int>(plan.particles() / 2000.0);
  omp_set_num_threads(wanted > 0 ? wanted : std::min(omp_get_max_threads(), useful));
}

int plan(const std::string& file, const std::vector<std::string>& overrides, int threads, bool json) {
  const Scene scene = read_scene(file, overrides);
  const auto blocks = make_particles(scene);
  Plan plan = make_plan(scene, blocks);
  use_threads(threads, plan);
  const Estimate estimate = measure(scene, plan, blocks);
  std::cout << (json ? to_json(plan, scene, estimate) : to_text(plan, scene) + to_text(estimate));
  return 0;
}

int generate(const std::string& file, const std::string& output, const std::vector<std::string>& overrides) {
  const Scene scene = read_scene(file, overrides);
  const auto blocks = make_particles(scene);
  const Plan plan = make_plan(scene, blocks);
  const bool vtu = std::filesystem::path(output).extension() == ".vtu";
  if (!vtu && std::filesystem::path(output).extension() != ".vtp")
    throw SceneError("-o " + output + ": expected a file that ends in .vtp or .vtu");
  write_frame(output, Simulation(scene, plan, blocks).frame(0), vtu ? FrameFormat::vtu : FrameFormat::vtp,
              scene.output.compress);
  std::cout << output << ": " << static_cast<long>(plan.particles()) << " particles\n";
  return 0;
}

int compare(const std::string& a, const std::string& b, double tolerance, bool json) {
  const auto differences = compare_files(a, b, tolerance);
  std::cout << (json ? to_json(differences) : to_text(differences)) << '\n';
  for (const auto& d : differences)
    if (!d.same) return 1;
  return 0;
}

int schema() {
  std::cout << scene_schema() << '\n';
  return 0;
}

}  // namespace barchan
