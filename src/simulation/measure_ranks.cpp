#include "simulation/measure_ranks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace barchan {

namespace {

double of(std::size_t count) { return static_cast<double>(count); }

}  // namespace

RankMeasure::RankMeasure(const Simulation& simulation, int ranks)
    : simulation_(simulation), ranks_(static_cast<std::size_t>(ranks)) {
  for (std::size_t p = 0; p < simulation.phases().size(); ++p) whole_.push_back(simulation.plan().is_whole(p));
  owners_ = simulation.neighbours().divided(ranks_, whole_);
  begin();
}

void RankMeasure::begin() {
  const Neighbours& neighbours = simulation_.neighbours();
  const std::size_t phases = simulation_.phases().size();
  searches_ = neighbours.rebuilds();
  steps_ = simulation_.steps();
  handed_on_ = ranks::handed_on;
  seconds_ = simulation_.processor_seconds();
  before_.assign(ranks_, {});
  simulation_.count_traffic(before_);
  rank_of_id_.assign(phases, {});
  use_.assign(phases, {});
  for (std::size_t p = 0; p < phases; ++p) {
    if (!owners_[p]) continue;
    use_[p] = neighbours.grid(p).use();
    const std::vector<std::uint32_t> cells = neighbours.grid(p).cells_of_particles();
    rank_of_id_[p].assign(cells.size(), -1);
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (const std::size_t number = number_of(p, k); number < cells.size())
        rank_of_id_[p][number] = owners_[p]->owner[cells[k]];
  }
}

/// Of a particle among those of the start; those that were made later have none.
std::size_t RankMeasure::number_of(std::size_t phase, std::size_t place) const {
  const PhaseParticles& particles = simulation_.phases()[phase];
  return static_cast<std::size_t>(particles.id()[place] - particles.first_id());
}

/// Of the pairs and particles of a phase: by it the time of a step is shared out.
double RankMeasure::work_of(std::size_t phase) const {
  double work = of(simulation_.phases()[phase].size());
  const auto& directions = simulation_.plan().directions;
  for (std::size_t d = 0; d < directions.size(); ++d)
    if (directions[d].a == phase) work += static_cast<double>(simulation_.neighbours().list(d).entries());
  return work;
}

/// The parts of the time of the steps that went into phases that every rank holds whole, and into contacts of spheres,
/// which ranks share out. A stage counts by whose work its tasks are: of an entry between a whole phase and one that is
/// shared out each rank does its rows.
RankMeasure::TimeShares RankMeasure::shares_of_time(bool contacts_are_shared) const {
  const Plan& plan = simulation_.plan();
  double all = 0.0, whole = 0.0, contacts = 0.0, whole_work = 0.0, work = 0.0;
  for (std::size_t p = 0; p < whole_.size(); ++p) {
    work += work_of(p);
    if (whole_[p]) whole_work += work_of(p);
  }
  const auto share_of = [&](const std::string& owner) {
    for (std::size_t p = 0; p < whole_.size(); ++p)
      if (plan.phases[p].name == owner) return whole_[p] ? 1.0 : 0.0;
    for (const PlanEntry& e : plan.entries)
      if (e.name == owner) return whole_[e.a] && whole_[e.b] ? 1.0 : 0.0;
    return whole_work / work;
  };
  for (std::size_t s = 0; s < seconds_.size(); ++s) {
    const double seconds = simulation_.processor_seconds()[s] - seconds_[s];
    all += seconds;
    if (s == stage::grain_contacts && contacts_are_shared) {
      contacts += seconds;
      continue;
    }
    const auto& tasks = simulation_.schedule().tasks(s);
    double share = 0.0;
    for (const Task& task : tasks) share += share_of(task.owner) / of(tasks.size());
    whole += share * seconds;
  }
  return all > 0.0 ? TimeShares{whole / all, contacts / all} : TimeShares{whole_work / work, 0.0};
}

RankPlan RankMeasure::plan(double seconds, const MemoryOfOne& memory) const {
  const double steps = static_cast<double>(std::max(simulation_.steps() - steps_, 1L));
  RankPlan plan;
  plan.ranks.resize(ranks_);
  plan.searches_a_step = static_cast<double>(simulation_.neighbours().rebuilds() - searches_) / steps;
  plan.seconds_alone = seconds;
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
    add_halo(plan, p, halo, steps);
    const double work = work_of(p), a_ghost = bytes_of_a_ghost(p);
    for (std::size_t r = 0; r < ranks_ && n > 0.0; ++r) {
      const double own = of(halo[r].particles) / n;
      parts[r].work += work * own;
      parts[r].arrays += share * own;
      parts[r].ghosts += of(halo[r].ghosts) * a_ghost;
    }
  }
  const double sums = static_cast<double>(ranks::handed_on.sums - handed_on_.sums) / steps,
               bytes = static_cast<double>(ranks::handed_on.bytes - handed_on_.bytes) / steps;
  for (std::size_t r = 0; r + 1 < ranks_; ++r) {
    plan.ranks[r].messages += sums;
    plan.ranks[r].bytes += bytes;
  }
  add_displacements(plan, owners);
  std::vector<RankTraffic> models(ranks_);
  const bool contacts_are_shared = simulation_.count_traffic(models);
  for (std::size_t r = 0; r < ranks_; ++r) {
    plan.ranks[r].messages += (models[r].messages - before_[r].messages) / steps;
    plan.ranks[r].bytes += (models[r].bytes - before_[r].bytes) / steps;
  }
  for (RankPlan::Rank& rank : plan.ranks) rank.halo_share = rank.particles > 0.0 ? rank.ghosts / rank.particles : 0.0;
  add_seconds(plan, parts, shares_of_time(contacts_are_shared));
  add_memory(plan, parts, memory);
  return plan;
}

/// Ghosts of a phase, and what goes to other ranks for them.
void RankMeasure::add_halo(RankPlan& plan, std::size_t phase, const std::vector<RankHalo>& halo, double steps) const {
  const CellGrid& grid = simulation_.neighbours().grid(phase);
  const ImageUse &before = use_[phase], &now = grid.use();
  const double fills = static_cast<double>(now.fills - before.fills) / steps,
               filled = of(now.filled - before.filled) / steps,
               returns = static_cast<double>(now.returns - before.returns) / steps,
               returned = of(now.returned - before.returned) / steps;
  const double searches = plan.searches_a_step, dimensions = simulation_.plan().dimensions;
  for (std::size_t r = 0; r < halo.size(); ++r) {
    RankPlan::Rank& rank = plan.ranks[r];
    rank.particles += of(halo[r].particles);
    rank.ghosts += of(halo[r].ghosts);
    // Twice a search each rank tells every other one how many items will come: particles, and questions for cells.
    rank.messages += searches * 2.0 * of(ranks_ - 1);
    rank.bytes += searches * 2.0 * of(ranks_ - 1) * sizeof(std::size_t);
    for (const auto& [to, sent] : halo[r].to) {
      RankPlan::Rank& other = plan.ranks[static_cast<std::size_t>(to)];
      const double images = of(sent.images), cells = of(sent.cells), some = sent.images > 0 ? 1.0 : 0.0;
      rank.messages += some * (fills + searches) + searches;
      rank.bytes +=
          images * (filled + searches * dimensions * sizeof(float)) + searches * cells * sizeof(std::uint32_t);
      other.messages += some * returns + searches;
      other.bytes += images * returned + searches * cells * sizeof(std::uint32_t);
    }
  }
  add_moves(plan, phase, steps);
}

/// Bounds of the displacements of blocks: six numbers a block and phase, in every step.
void RankMeasure::add_displacements(RankPlan& plan, const std::vector<std::optional<CellOwners>>& owners) const {
  std::vector<const CellOwners*> cells;
  for (const auto& one : owners) cells.push_back(one ? &*one : nullptr);
  const double width = 6.0 * sizeof(float) * of(std::count_if(cells.begin(), cells.end(), [](auto* c) { return c; }));
  for (std::size_t r = 0; r < ranks_; ++r)
    for (const auto& [to, blocks] : simulation_.neighbours().told_blocks(cells, static_cast<std::int32_t>(r))) {
      plan.ranks[r].messages += 1.0;
      plan.ranks[r].bytes += width * of(blocks.tells.size());
    }
}

/// Particles that have come into cells of another rank since the start, as sorted last.
void RankMeasure::add_moves(RankPlan& plan, std::size_t phase, double steps) const {
  const std::vector<std::uint32_t> cells = simulation_.neighbours().grid(phase).cells_of_particles();
  const double width = of(simulation_.phases()[phase].packed_width());
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> moved;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const std::size_t number = number_of(phase, k);
    if (number >= rank_of_id_[phase].size()) continue;
    const std::int32_t from = rank_of_id_[phase][number], to = owners_[phase]->owner[cells[k]];
    if (from >= 0 && from != to) ++moved[{from, to}];
  }
  for (const auto& [way, count] : moved) {
    RankPlan::Rank& rank = plan.ranks[static_cast<std::size_t>(way.first)];
    rank.messages += std::min(of(count) / steps, plan.searches_a_step);
    rank.bytes += of(count) * width / steps;
  }
}

void RankMeasure::add_seconds(RankPlan& plan, const std::vector<Part>& parts, const TimeShares& time) const {
  using C = RankConstants;
  const double seconds = plan.seconds_alone;
  double all = 0.0;
  for (const Part& part : parts) all += part.work;
  if (seconds <= 0.0) return;
  const double rounds = std::ceil(std::log2(of(ranks_))), whole = all > 0.0 ? time.whole : 1.0 - time.contacts;
  const double reducing = rounds * C::reductions * C::latency;
  double slowest = 0.0;
  for (std::size_t r = 0; r < ranks_; ++r) {
    RankPlan::Rank& rank = plan.ranks[r];
    const double own = all > 0.0 ? parts[r].work / all : 0.0;
    rank.seconds = seconds * (whole + time.contacts / of(ranks_) + (1.0 - whole - time.contacts) * own) +
                   rank.messages * C::latency + rank.bytes / C::bandwidth + reducing;
    slowest = std::max(slowest, rank.seconds);
  }
  plan.whole_share = whole;
  plan.efficiency = seconds / (of(ranks_) * slowest);
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
    const bool in_parts = shared && plan.phases[p].flows;
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
