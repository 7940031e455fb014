// barchan plan, generate, compare.
#include <chrono>
#include <filesystem>
#include <iostream>

#include "app/commands.hpp"
#include "base/denormals.hpp"
#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "output/compare.hpp"
#include "output/series.hpp"
#include "simulation/grains_file.hpp"
#include "simulation/measure_cost.hpp"
#include "simulation/settle.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

int plan(const std::string& file, const std::vector<std::string>& overrides, int threads, bool json, int ranks) {
  const Scene scene = read_scene(file, overrides);
  if (threads > 0) use_threads(threads, 0);
  const auto start = std::chrono::steady_clock::now();
  auto blocks = make_particles(scene, json ? nullptr : &std::cout);
  const std::chrono::duration<double> making = std::chrono::steady_clock::now() - start;
  Plan plan = make_plan(scene, blocks);
  use_threads(threads, plan.particles());
  const bool retreats = !scene.time.fixed_step;
  const MemoryNeed memory = memory_need(scene, plan, retreats);
  if (!json) std::cout << to_text(plan, scene) << std::flush;  // before anything is allocated
  Estimate estimate;
  try {
    check_memory(scene, memory);
    estimate = measure(scene, plan, std::move(blocks), retreats, ranks);
    estimate.start_seconds = making.count();
  } catch (const SceneError& error) {
    if (json) throw;
    std::cout << to_text(memory) << "not measured\n";
    throw;
  }
  if (estimate.memory.parts.empty()) estimate.memory = memory;
  std::cout << (json ? to_json(plan, scene, estimate) : to_text(estimate));
  if (!estimate.failure.empty()) throw BreakdownError("the run breaks down in its first steps: " + estimate.failure);
  return 0;
}

int generate(const std::string& file, const std::string& output, const std::vector<std::string>& overrides,
             int threads) {
  const bool vtu = std::filesystem::path(output).extension() == ".vtu";
  if (!vtu && std::filesystem::path(output).extension() != ".vtp")
    throw SceneError("-o " + output + ": expected a file that ends in .vtp or .vtu");
  const Scene scene = read_scene(file, overrides);
  if (threads > 0) use_threads(threads, 0);
  auto blocks = make_particles(scene, &std::cout);
  const Plan plan = make_plan(scene, blocks);
  use_threads(threads, plan.particles());
  std::vector<std::vector<RestingContact>> contacts;
  for (const ParticleBlock& block : blocks) contacts.push_back(block.contacts);
  Simulation start(scene, plan, std::move(blocks));
  Frame frame = start.frame(0);
  for (std::size_t k = 0; k < contacts.size(); ++k) add_contacts(frame, contacts[k], start.phases()[k].first_id());
  write_frame(output, frame, vtu ? FrameFormat::vtu : FrameFormat::vtp, scene.output.compress);
  std::cout << output << ": " << static_cast<long>(plan.particles()) << " particles\n";
  return 0;
}

int compare(const std::string& a, const std::string& b, double tolerance, bool json) {
  keep_denormals();
  const auto differences = compare_files(a, b, tolerance);
  std::cout << (json ? to_json(differences) : to_text(differences)) << '\n';
  for (const auto& d : differences)
    if (!d.same) return 1;
  return 0;
}

}  // namespace barchan
