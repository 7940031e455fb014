// Whether a fluid is shut in, seen from the particles. Internal to models/fluid.
#pragma once

#include <string>

#include "models/layout.hpp"
#include "start/generate.hpp"

namespace barchan {

struct Enclosure {
  bool shut_in = false;
  bool open = false;            // it ends somewhere with nothing beyond: a free surface
  std::string why;              // in a few words, for the plan
  std::string free_space = "";  // the place of a free space beside the fluid; empty: there is none
};

/// A fluid is shut in when it feels a wall, no free space is next to it, it comes to no side of the domain that is
/// neither periodic nor closed by a wall that it feels, and no other fluid that it feels can give way. Free space: a
/// cell of a spacing such that neither it nor its neighbours hold a particle; thinner gaps are not seen.
Enclosure find_enclosure(const Scene& scene, const Layout& layout, const std::vector<ParticleBlock>& blocks,
                         std::size_t fluid);

}  // namespace barchan
