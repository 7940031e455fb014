// Of models/fluid/flow_zone.hpp on several ranks: sums of all of them, exact; who makes a particle.
#include <cstring>

#include "base/ranks.hpp"
#include "models/fluid/flow_zone.hpp"
#include "models/workspace.hpp"

namespace barchan {

namespace {

/// Adds what all ranks have; T: whole numbers of 64 bits alone.
template <class T>
void add_ranks(std::vector<T>& sums) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(std::int64_t) == 0);
  if (sums.empty()) return;  // on all ranks
  std::vector<std::int64_t> numbers(sums.size() * sizeof(T) / sizeof(std::int64_t));
  std::memcpy(numbers.data(), sums.data(), sums.size() * sizeof(T));
  ranks::active()->reduce(numbers.data(), numbers.size(), Communicator::Take::sum);
  std::memcpy(static_cast<void*>(sums.data()), numbers.data(), sums.size() * sizeof(T));
}

}  // namespace

void FlowZone::gather_ranks() {
  std::vector<double> outermost;
  for (const Lane& lane : lane_) outermost.push_back(lane.outermost);
  ranks::active()->reduce(outermost.data(), outermost.size(), Communicator::Take::largest);
  for (std::size_t k = 0; k < lane_.size(); ++k) lane_[k].outermost = outermost[k];
  add_ranks(sums_);
  add_ranks(layer_sums_);
  std::vector<std::int64_t> counts(layer_counts_.begin(), layer_counts_.end());
  add_ranks(counts);
  for (std::size_t c = 0; c < counts.size(); ++c) layer_counts_[c] = static_cast<std::int32_t>(counts[c]);
}

/// A new particle of the zone, on one of the ranks.
void FlowZone::make_at(const Vec3& x) {
  if (!ranks::makes_particles()) {
    ++w_->state.ids.next;
    return;
  }
  PhaseParticles& p = w_->particles(fluid_);
  const std::size_t k = p.create(1, w_->state.ids);
  for (int d = 0; d < p.dimensions(); ++d) p.column(Field::position, d)[k] = x[static_cast<std::size_t>(d)];
  p.own(where_)[k] = beyond;
  members_.push_back(static_cast<std::uint32_t>(k));
}

}  // namespace barchan
