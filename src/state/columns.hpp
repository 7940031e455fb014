// Columns by particle that belong to a model: registered once, moved, saved and counted by nobody but
// the particles of the phase (state/particles.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "base/aligned.hpp"

namespace barchan {

/// Which column of a phase it is, and of which type.
template <class T>
struct OwnColumn {
  static_assert(std::is_trivially_copyable_v<T>);
  std::size_t number = 0;
};

/// The values of one such column as bytes: all that sorting, creation, removal and saving need to know of it.
struct OwnValues {
  std::string name;                 // "owner.column": stands once in a phase
  std::size_t width = 0;            // bytes of a value
  std::vector<std::byte> of_new;    // the value of a particle that is made
  AlignedVector<std::byte> values;  // width bytes a particle
};

/// Where the ids of new particles come from. One of a run: an id is never used twice, and which ids a maker gets
/// follows from the order of the makers in the schedule.
struct IdSource {
  std::int64_t next = 0;
};

}  // namespace barchan
