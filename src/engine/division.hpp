// What decides how many particles each rank of a run has.
#pragma once

namespace barchan {

/// What is about the same for all ranks: the number of particles of each phase, or the time that steps take.
enum class Division { particles, time };
inline const char* name_of(Division division) { return division == Division::time ? "time" : "particles"; }

}  // namespace barchan
