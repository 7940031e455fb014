// What a run on several ranks would be: simulation/measure_ranks.hpp measures it in one process.
#pragma once

#include <string>
#include <vector>

namespace barchan {

struct RankPlan {
  struct Rank {
    double particles = 0;   // those of phases that are whole among them
    double ghosts = 0;      // images of particles of other ranks, and of own ones beyond periodic sides
    double halo_share = 0;  // ghosts over particles
    double memory = 0;      // bytes, the most at any time
  };
  std::vector<Rank> ranks;
  double whole_particles = 0;      // that every rank has
  double start_memory = 0;         // bytes of a rank, until particles are sorted first
  std::string why_start_is_whole;  // every rank makes all particles; empty: a part of those of fluids
  bool frames_in_pieces = false;   // each rank writes its own particles; else the first one has those of all
};

/// The least, mean or largest of each value over the ranks.
enum class Spread { least, mean, largest };
RankPlan::Rank of_all(const RankPlan& plan, Spread which);

/// A row a rank; of more than eight the least, the mean and the largest.
std::string to_text(const RankPlan& plan);
std::string to_json(const RankPlan& plan);

}  // namespace barchan
