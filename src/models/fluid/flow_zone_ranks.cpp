// Of models/fluid/flow_zone.hpp on several ranks: sums of all of them, exact; who makes a particle.
#include <cstring>

#include "engine/exchange.hpp"
#include "models/fluid/flow_zone.hpp"
#include "models/workspace.hpp"

namespace barchan {

namespace {

/// Calls f(address, number of 64-bit whole numbers) with what the ranks add.
template <class T, class F>
void as_numbers(std::vector<T>& sums, F&& f) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(std::int64_t) == 0);
  if (!sums.empty()) f(static_cast<void*>(sums.data()), sums.size() * sizeof(T) / sizeof(std::int64_t));
}

}  // namespace

/// Two calls for all that the zone learns in a step: one for sums, which are whole numbers, one for the largest.
void FlowZone::gather_ranks() {
  counts_of_all_.assign(layer_counts_.begin(), layer_counts_.end());
  counts_of_all_.insert(counts_of_all_.end(), passed_.begin(), passed_.end());
  const auto each = [this](auto&& f) {
    as_numbers(sums_, f);
    as_numbers(layer_sums_, f);
    as_numbers(counts_of_all_, f);
  };
  sums_of_all_.clear();
  each([this](const void* from, std::size_t n) {
    const std::size_t before = sums_of_all_.size();
    sums_of_all_.resize(before + n);
    std::memcpy(sums_of_all_.data() + before, from, n * sizeof(std::int64_t));
  });
  Exchange().reduce(sums_of_all_.data(), sums_of_all_.size(), Exchange::Take::sum);
  std::size_t at = 0;
  each([&](void* to, std::size_t n) {
    std::memcpy(to, sums_of_all_.data() + at, n * sizeof(std::int64_t));
    at += n;
  });
  const std::size_t cells = layer_counts_.size();
  for (std::size_t c = 0; c < cells; ++c) layer_counts_[c] = static_cast<std::int32_t>(counts_of_all_[c]);
  passed_ = {counts_of_all_[cells], counts_of_all_[cells + 1]};

  largest_of_all_.assign(1, fastest_);
  for (const Lane& lane : lane_) largest_of_all_.push_back(lane.outermost);
  Exchange().reduce(largest_of_all_.data(), largest_of_all_.size(), Exchange::Take::largest);
  fastest_ = largest_of_all_.front();
  for (std::size_t k = 0; k < lane_.size(); ++k) lane_[k].outermost = largest_of_all_[k + 1];
}

/// A new particle of the zone, on one of the ranks.
void FlowZone::make_at(const Vec3& x) {
  if (!Exchange().is_first()) {
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
