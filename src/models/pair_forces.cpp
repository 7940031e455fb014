#include "models/pair_forces.hpp"

#include "engine/pair_pass.hpp"

namespace barchan::BARCHAN_TARGET {

#define BARCHAN_FORCES_OF(Law)                                                               \
  void pair_forces(PhaseParticles& a, const RecordArray& own, const PairEntry<Law>& entry) { \
    accelerate(a, own, entry);                                                               \
  }
BARCHAN_FORCE_LAWS(BARCHAN_FORCES_OF)
#undef BARCHAN_FORCES_OF

}  // namespace barchan::BARCHAN_TARGET
