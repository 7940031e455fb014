#include "plan/rank_plan.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/memory.hpp"
#include "plan/formatted.hpp"

namespace barchan {

namespace {

constexpr std::size_t most_rows = 8;

std::string row(const std::string& name, const RankPlan::Rank& r) {
  return formatted("%-8s %11.0f %10.0f %7.3f %10s\n", name.c_str(), r.particles, r.ghosts, r.halo_share,
                   memory_text(r.memory).c_str());
}

}  // namespace

RankPlan::Rank of_all(const RankPlan& plan, Spread which) {
  RankPlan::Rank all = plan.ranks.front();
  const auto take = [&](double RankPlan::Rank::*value) {
    double least = all.*value, largest = least, sum = 0.0;
    for (const RankPlan::Rank& r : plan.ranks) {
      least = std::min(least, r.*value);
      largest = std::max(largest, r.*value);
      sum += r.*value;
    }
    all.*value = which == Spread::least     ? least
                 : which == Spread::largest ? largest
                                            : sum / static_cast<double>(plan.ranks.size());
  };
  for (const auto value :
       {&RankPlan::Rank::particles, &RankPlan::Rank::ghosts, &RankPlan::Rank::halo_share, &RankPlan::Rank::memory})
    take(value);
  return all;
}

namespace {

constexpr std::array<std::pair<const char*, Spread>, 3> spreads{
    {{"least", Spread::least}, {"mean", Spread::mean}, {"largest", Spread::largest}}};

nlohmann::ordered_json json_of(const RankPlan::Rank& r) {
  return {{"particles", r.particles}, {"ghosts", r.ghosts}, {"halo_share", r.halo_share}, {"memory", r.memory}};
}

}  // namespace

std::string to_text(const RankPlan& plan) {
  std::string t = formatted("\n%-8s %11s %10s %7s %10s\n", plan.ranks.size() == 1 ? "rank" : "ranks", "particles",
                            "ghosts", "share", "memory");
  if (plan.ranks.size() <= most_rows)
    for (std::size_t r = 0; r < plan.ranks.size(); ++r) t += row(std::to_string(r), plan.ranks[r]);
  else
    for (const auto& [name, which] : spreads) t += row(name, of_all(plan, which));
  if (plan.whole_particles > 0)
    t += formatted("every rank has %.0f particles of grains and bodies\n", plan.whole_particles);
  t += "at the start every rank makes " +
       (plan.why_start_is_whole.empty() ? "its part of the fluids, and all other particles"
                                        : "all particles, because " + plan.why_start_is_whole) +
       ": " + memory_text(plan.start_memory) +
       (plan.frames_in_pieces ? "; later each one writes its piece of the frames\n"
                              : "; later the first one has the frames of all\n");
  const auto idle = std::count_if(plan.ranks.begin(), plan.ranks.end(),
                                  [&](const RankPlan::Rank& r) { return r.particles <= plan.whole_particles; });
  if (idle > 0)
    t += formatted("warning: %ld of %zu ranks have no particles of their own: there are too few rows of cells\n",
                   static_cast<long>(idle), plan.ranks.size());
  return t;
}

std::string to_json(const RankPlan& plan) {
  nlohmann::ordered_json j;
  j["count"] = plan.ranks.size();
  j["of"] = nlohmann::ordered_json::array();
  for (const RankPlan::Rank& r : plan.ranks) j["of"].push_back(json_of(r));
  for (const auto& [name, which] : spreads) j[name] = json_of(of_all(plan, which));
  j["whole_particles"] = plan.whole_particles;
  j["start_memory"] = plan.start_memory;
  j["why_start_is_whole"] = plan.why_start_is_whole;
  j["frames_in_pieces"] = plan.frames_in_pieces;
  return j.dump();
}

}  // namespace barchan
