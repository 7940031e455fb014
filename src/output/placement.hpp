// Where the ranks of a run compute: on which machine, on which of its cores, with how many threads.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "output/run_report.hpp"

namespace barchan {

/// Cores that this process may use; none where the system does not say.
std::set<int> cores_of_process();

/// Numbers of cores as a list: "0-3,8".
std::string list_of_cores(const std::set<int>& cores);
/// The numbers in such a list, as a launcher gives them.
std::set<int> cores_of_list(const std::string& list);

/// Of all ranks, one after another; neighbours that say the same are one entry. `threads`: of this rank. Every rank
/// calls it. Without ranks none.
std::vector<RunReport::Placement> placements_of_ranks(int threads);

/// How many threads a rank takes by itself: an equal part of its cores, which ranks of the same machine may use too,
/// and no more than `most`, but one. `placements`: of all ranks.
int threads_of_placement(const std::vector<RunReport::Placement>& placements, int rank, int most);

/// A line for each entry.
std::string to_text(const std::vector<RunReport::Placement>& placements);

/// What a user should know of them: more threads than cores on a machine.
std::vector<std::string> warnings_of(const std::vector<RunReport::Placement>& placements);

}  // namespace barchan
