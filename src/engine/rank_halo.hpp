// How a number of ranks would share the particles of a run: who would own them, and whose ghosts each would have.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace barchan {

/// What a rank has of a phase that is shared out.
struct RankHalo {
  std::size_t particles = 0, ghosts = 0;   // ghosts: images of own particles beyond periodic sides among them
  std::map<std::int32_t, std::size_t> to;  // own particles that another rank has as ghosts, by that rank
};

/// Blocks whose displacements a rank sends another one, and those that it receives from it; both in ascending order.
struct SharedBlocks {
  std::vector<std::size_t> sends, receives;
};

}  // namespace barchan
