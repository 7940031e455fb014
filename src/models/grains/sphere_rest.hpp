// Contacts of a bed that settled before the run: the slips with which they carry what they carried there.
//
// A contact of friction holds F = k_t xi with a slip xi that grew while the bed came to rest. A run that began with
// xi = 0 would let the grains go until the slips are there again, and a slope as steep as friction allows would run.
// The forces are kept, not the slips, so that a bed rests as well under a law of another stiffness.
#pragma once

#include <span>
#include <vector>

#include "models/grains/sphere_pairs.hpp"
#include "start/generate.hpp"
#include "state/archive.hpp"

namespace barchan {

class SphereRest {
 public:
  /// Adds contacts of a phase whose first sphere has the number `first`.
  void add(std::size_t first, const std::vector<RestingContact>& contacts);
  /// Gives the pairs that were listed for the first time their slips, and forgets the contacts. A contact whose other
  /// sphere or side is no longer there is left out.
  void recall(const SphereStep& step, const SphereSet& spheres, std::span<SphereChunk> chunks);
  /// As ContactMemory::renumber().
  void renumber(const std::vector<std::uint32_t>& to);
  void archive(Archive& a) { a.array("contacts at the begin", contacts_); }

 private:
  std::vector<RestingContact> contacts_;
};

/// The contacts of `count` spheres from the number `first` on, each once: those of two by the one with the lower
/// number.
std::vector<RestingContact> contacts_at_rest(const SphereStep& step, const SphereSet& spheres,
                                             const std::vector<SphereChunk>& chunks, std::size_t first,
                                             std::size_t count);

}  // namespace barchan
