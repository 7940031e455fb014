// An entry of the matrix as a pass over pairs sees it (engine/pair_pass.hpp).
#pragma once

#include "base/instructions.hpp"
#include "engine/pair_list.hpp"
#include "engine/records.hpp"
#include "kernels/kernel_kind.hpp"

namespace barchan {

/// At most this many entries a phase.
inline constexpr std::size_t most_entries = 16;

template <class Law>
struct PairEntry {
  const PairList* list;
  const RecordArray* records;  // motion records of the neighbours
  KernelKind kernel;
  double radius;  // m
  Law law;
  const double* beside = nullptr;        // by record; of laws that read it
  const RecordArray* carried = nullptr;  // carried records of the neighbours; of laws that read them
};

}  // namespace barchan
