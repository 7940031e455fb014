#include "simulation/measure_ranks.hpp"

#include <algorithm>

namespace barchan {

namespace {

double of(std::size_t count) { return static_cast<double>(count); }

}  // namespace

RankMeasure::RankMeasure(const Simulation& simulation, int ranks)
    : simulation_(simulation), ranks_(static_cast<std::size_t>(ranks)) {
  for (std::size_t p = 0; p < simulation.phases().size(); ++p) whole_.push_back(simulation.plan().is_whole(p));
  owners_ = simulation.neighbours().divided(ranks_, whole_);
}

RankPlan RankMeasure::plan(const MemoryOfOne& memory) const {
  RankPlan plan;
  plan.ranks.resize(ranks_);
  auto owners = owners_;
  simulation_.neighbours().rebalance(owners);
  std::vector<Part> parts(ranks_);
  double arrays = 0.0;
  for (std::size_t p = 0; p < whole_.size(); ++p) arrays += of(simulation_.phases()[p].bytes());
  for (std::size_t p = 0; p < whole_.size(); ++p) {
    const double n = of(simulation_.phases()[p].size()), share = of(simulation_.phases()[p].bytes()) / arrays;
    if (!owners[p]) {
      plan.whole_particles += n;
      for (std::size_t r = 0; r < ranks_; ++r) {
        plan.ranks[r].particles += n;
        parts[r].arrays += share;
      }
      continue;
    }
    const std::vector<RankHalo> halo = simulation_.neighbours().halo_of(p, owners);
    const double a_ghost = bytes_of_a_ghost(p);
    for (std::size_t r = 0; r < ranks_; ++r) {
      plan.ranks[r].particles += of(halo[r].particles);
      plan.ranks[r].ghosts += of(halo[r].ghosts);
      if (n > 0.0) parts[r].arrays += share * of(halo[r].particles) / n;
      parts[r].ghosts += of(halo[r].ghosts) * a_ghost;
    }
  }
  for (RankPlan::Rank& rank : plan.ranks) rank.halo_share = rank.particles > 0.0 ? rank.ghosts / rank.particles : 0.0;
  add_memory(plan, parts, memory);
  return plan;
}

/// Bytes: search position, image, its place among what comes, and its records where they are and on their way.
double RankMeasure::bytes_of_a_ghost(std::size_t phase) const {
  const double dimensions = simulation_.plan().dimensions;
  return dimensions * sizeof(float) + sizeof(Image) + sizeof(std::uint32_t) +
         2.0 * of(simulation_.bytes_of_an_image(phase));
}

/// Of a rank, until the particles are sorted first. `cells`: bytes of what is of all cells.
double RankMeasure::memory_at_start(const MemoryOfOne& memory, double cells) const {
  const Plan& plan = simulation_.plan();
  const bool shared = memory.why_start_is_whole.empty();
  double particles = 0.0, made = 0.0, columns = 0.0, order = 0.0, moving = 0.0;
  for (std::size_t p = 0; p < whole_.size(); ++p) {
    const PhaseParticles& phase = simulation_.phases()[p];
    const bool in_parts = shared && plan.phases[p].flows();
    const double n = of(phase.size()), here = in_parts ? n / of(ranks_) : n;
    particles += n;
    made += here;
    columns += here * of(phase.packed_width());
    if (!simulation_.neighbours().has_grid(p)) continue;
    order = std::max(order, 2.0 * sizeof(std::uint32_t) * here);
    // What leaves, what comes, and room for it.
    if (in_parts) moving = std::max(moving, 2.5 * here * of(phase.packed_width()) * (1.0 - 1.0 / of(ranks_)));
  }
  const double blocks = particles > 0.0 ? memory.blocks * made / particles : 0.0;
  return memory.program + columns + std::max(blocks, cells + order + moving);
}

/// What of one process is of all cells, a rank has too; the rest is its part of the particles, with ghosts. Before that
/// it has made particles and found their order.
void RankMeasure::add_memory(RankPlan& plan, const std::vector<Part>& parts, const MemoryOfOne& memory) const {
  const Neighbours& neighbours = simulation_.neighbours();
  const double dimensions = simulation_.plan().dimensions;
  double cells = 0.0, owners = 0.0, images = 0.0, gathered = 0.0;
  for (std::size_t p = 0; p < whole_.size(); ++p) {
    if (!neighbours.has_grid(p)) continue;
    const CellGrid& grid = neighbours.grid(p);
    cells += of(grid.bytes_of_cells());
    if (!owners_[p]) continue;
    owners += of(grid.cells()) * sizeof(std::int32_t);
    images += of(grid.images()) * bytes_of_a_ghost(p);
    // Of a checkpoint: cells and images of all ranks, search positions of images as they came and as they are.
    gathered += 3.0 * of(grid.cells()) * sizeof(std::uint32_t) +
                of(grid.images()) * (sizeof(Image) + 2.0 * dimensions * sizeof(float));
  }
  const double rest = std::max(memory.arrays - cells - images, 0.0);
  plan.start_memory = memory_at_start(memory, cells);
  plan.why_start_is_whole = memory.why_start_is_whole;
  plan.frames_in_pieces = simulation_.frames_are_in_pieces();
  for (std::size_t r = 0; r < ranks_; ++r) {
    const Part& part = parts[r];
    const double own = memory.program + cells + owners + part.arrays * (rest + memory.states) + part.ghosts;
    const double own_frame = part.arrays * memory.frame, frame = plan.frames_in_pieces ? own_frame : memory.frame;
    const double gathers = r == 0 ? std::max(frame, gathered) : own_frame;
    plan.ranks[r].memory = std::max(own + gathers, plan.start_memory);
  }
}

}  // namespace barchan
