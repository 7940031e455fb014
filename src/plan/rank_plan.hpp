// What a run on several ranks would be: simulation/measure_ranks.hpp measures it in one process.
#pragma once

#include <string>
#include <vector>

namespace barchan {

/// The constants of the prediction (docs/ranks.md says how they were measured).
struct RankConstants {
  static constexpr double latency = 2.5e-6;   // s, of a message, and of each of the log2(N) rounds of a reduction
  static constexpr double bandwidth = 5.0e9;  // bytes/s, of what a rank sends
  static constexpr double reductions = 14;    // a step
};

struct RankPlan {
  struct Rank {
    double particles = 0;            // those of phases that are whole among them
    double ghosts = 0;               // images of particles of other ranks, and of own ones beyond periodic sides
    double halo_share = 0;           // ghosts over particles
    double memory = 0;               // bytes, the most at any time
    double messages = 0, bytes = 0;  // that it sends in a step, a mean over steps with and without new lists
    double seconds = 0;              // of a step; 0: not measured
  };
  std::vector<Rank> ranks;
  double whole_particles = 0;      // that every rank has
  double whole_share = 0;          // of the time of a step, for phases that every rank holds whole
  double searches_a_step = 0;      // how often lists are made anew
  double seconds_alone = 0;        // of a step of one process with one thread
  double start_memory = 0;         // bytes of a rank, until particles are sorted first
  std::string why_start_is_whole;  // every rank makes all particles; empty: a part of those of fluids
  bool frames_in_pieces = false;   // each rank writes its own particles; else the first one has those of all
  double efficiency = 0;           // seconds_alone over ranks times the seconds of the slowest rank; 0: not measured
};

/// The least, mean or largest of each value over the ranks.
enum class Spread { least, mean, largest };
RankPlan::Rank of_all(const RankPlan& plan, Spread which);

/// A row a rank; of more than eight the least, the mean and the largest.
std::string to_text(const RankPlan& plan);
std::string to_json(const RankPlan& plan);

}  // namespace barchan
