#include "models/grains/sphere_shares.hpp"
#include "engine/exchange.hpp"

#include <algorithm>

namespace barchan {

namespace {

/// The numbers of a record that others need: places and velocities, then spins.
template <class F>
void each_told_number(int dimensions, bool turn, bool places_alone, F&& f) {
  const auto axes = static_cast<std::size_t>(dimensions);
  for (std::size_t d = 0; d < axes; ++d) f(d);
  if (places_alone) return;
  for (std::size_t d = 0; d < axes; ++d) f(SphereRecord<2>::velocity + d);
  if (!turn) return;
  if (dimensions == 2) return f(SphereRecord<2>::spin);
  for (std::size_t d = 0; d < SphereRecord<3>::spins; ++d) f(SphereRecord<3>::spin + d);
}
static_assert(SphereRecord<2>::velocity == SphereRecord<3>::velocity);

std::size_t stride_of(int dimensions) { return dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size; }

void add_to(std::vector<std::uint32_t>& ordered, std::uint32_t sphere) {
  const auto at = std::lower_bound(ordered.begin(), ordered.end(), sphere);
  if (at == ordered.end() || *at != sphere) ordered.insert(at, sphere);
}

}  // namespace

void SphereShares::divide(std::span<const SphereChunk> chunks, Exchange::Share own) {
  if (chunks.size() < own.count) own = {};
  own_ = own.number;
  chunks_.assign(own.count + 1, 0);
  spheres_.assign(own.count + 1, 0);
  for (std::size_t r = 0; r < own.count; ++r) {
    chunks_[r + 1] = Exchange::Share{r, own.count}.end(chunks.size());
    spheres_[r + 1] = chunks_[r + 1] > 0 ? chunks[chunks_[r + 1] - 1].end : 0;
  }
  meetings_.clear();
  tells_.assign(own.count, {});
  hears_.assign(own.count, {});
  count();
}

std::vector<std::size_t> SphereShares::chunks_of_ranks() const {
  std::vector<std::size_t> counts;
  for (std::size_t r = 0; r + 1 < chunks_.size(); ++r) counts.push_back(chunks_[r + 1] - chunks_[r]);
  return counts;
}

std::vector<std::size_t> SphereShares::spheres_of_ranks(std::size_t first, std::size_t end) const {
  std::vector<std::size_t> counts;
  for (std::size_t r = 0; r + 1 < spheres_.size(); ++r)
    counts.push_back(std::clamp(spheres_[r + 1], first, end) - std::clamp(spheres_[r], first, end));
  return counts;
}

std::size_t SphereShares::rank_of(std::size_t sphere) const {
  return static_cast<std::size_t>(std::upper_bound(spheres_.begin() + 1, spheres_.end(), sphere) - spheres_.begin()) -
         1;
}

void SphereShares::find(std::span<const SphereChunk> chunks) {
  constexpr std::size_t batch = SphereChunk::batch;
  meetings_.clear();
  for (auto* spheres : {&tells_, &hears_})
    for (auto& of_rank : *spheres) of_rank.clear();
  if (!on()) return;
  found_.clear();
  for (std::size_t c = chunks_[own_]; c < chunks_[own_ + 1]; ++c)
    for (const SphereChunk::Group& group : chunks[c].groups) {
      if (group.weight == 1.0) continue;  // of the chunk alone, or with what no step of contacts moves
      for (std::size_t k = group.first * batch; k < group.end * batch; ++k) {
        const std::uint32_t a = chunks[c].a[k], b = chunks[c].b[k];
        if (a >= spheres_.back() || (has(a) && has(b))) continue;
        const std::uint32_t other = has(a) ? b : a, own = has(a) ? a : b;
        meetings_.push_back({other, static_cast<std::uint32_t>(c)});
        found_.emplace_back(static_cast<std::uint32_t>(rank_of(other)), own);
      }
    }
  std::sort(meetings_.begin(), meetings_.end());
  meetings_.erase(std::unique(meetings_.begin(), meetings_.end()), meetings_.end());
  std::sort(found_.begin(), found_.end());
  found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
  for (const auto& [rank, own] : found_) tells_[rank].push_back(own);
  for (const Meeting& m : meetings_) {
    auto& heard = hears_[rank_of(m.other)];
    if (heard.empty() || heard.back() != m.other) heard.push_back(m.other);
  }
  count();
}

void SphereShares::meet(std::uint32_t own, std::uint32_t other, std::size_t chunk) {
  const Meeting meeting{other, static_cast<std::uint32_t>(chunk)};
  const auto at = std::lower_bound(meetings_.begin(), meetings_.end(), meeting);
  if (at == meetings_.end() || *at != meeting) meetings_.insert(at, meeting);
  const std::size_t rank = rank_of(other);
  add_to(tells_[rank], own);
  add_to(hears_[rank], other);
  count();
}

void SphereShares::count() {
  send_counts_.resize(tells_.size());
  receive_counts_.resize(hears_.size());
  for (std::size_t r = 0; r < tells_.size(); ++r) {
    send_counts_[r] = tells_[r].size();
    receive_counts_[r] = hears_[r].size();
  }
}

std::vector<std::size_t> SphereShares::told() const { return send_counts_; }

void SphereShares::tell(int dimensions, bool turn, double* records) {
  if (!on()) return;
  const std::size_t stride = stride_of(dimensions), each = width(dimensions, turn);
  std::size_t tell = 0, hear = 0;
  for (std::size_t r = 0; r < send_counts_.size(); ++r) {
    tell += send_counts_[r];
    hear += receive_counts_[r];
  }
  fit(sent_, tell * each);
  fit(come_, hear * each);
  double* to = sent_.data();
  for (const auto& spheres : tells_)
    for (const std::uint32_t k : spheres)
      each_told_number(dimensions, turn, false, [&](std::size_t n) { *to++ = records[k * stride + n]; });
  Exchange().exchange(sent_.data(), send_counts_, come_.data(), receive_counts_, each * sizeof(double));
  const double* from = come_.data();
  each_told([&](std::size_t k) {
    each_told_number(dimensions, turn, false, [&](std::size_t n) { records[k * stride + n] = *from++; });
  });
}

void SphereShares::tell_all(int dimensions, bool turn, bool places_alone, double* records) {
  if (!on()) return;
  const std::size_t stride = stride_of(dimensions), moving = spheres_.back(),
                    each = places_alone ? static_cast<std::size_t>(dimensions) : width(dimensions, turn);
  fit(come_, moving * each);
  double* to = come_.data() + begin() * each;
  for (std::size_t k = begin(); k < end(); ++k)
    each_told_number(dimensions, turn, places_alone, [&](std::size_t n) { *to++ = records[k * stride + n]; });
  Exchange().gather_in_place(come_.data(), spheres_of_ranks(0, moving), each * sizeof(double));
  for (std::size_t k = 0; k < moving; ++k) {
    if (has(k)) continue;
    const double* from = come_.data() + k * each;
    each_told_number(dimensions, turn, places_alone, [&](std::size_t n) { records[k * stride + n] = *from++; });
  }
}

void SphereShares::gather_together(std::span<double* const> columns, const std::vector<std::size_t>& counts) {
  std::size_t all = 0;
  for (const std::size_t n : counts) all += n;
  fit(come_, all * columns.size());
  // The columns of a rank, one after another, then those of the next.
  const auto each_piece = [&](auto&& copy) {
    std::size_t first = 0;
    for (std::size_t r = 0; r < counts.size(); first += counts[r++])
      for (std::size_t c = 0; c < columns.size(); ++c)
        copy(r, columns[c] + first, come_.data() + first * columns.size() + c * counts[r], counts[r]);
  };
  each_piece([this](std::size_t rank, const double* column, double* piece, std::size_t n) {
    if (rank == own_) std::copy_n(column, n, piece);
  });
  Exchange().gather_in_place(come_.data(), counts, columns.size() * sizeof(double));
  each_piece([this](std::size_t rank, double* column, const double* piece, std::size_t n) {
    if (rank != own_) std::copy_n(piece, n, column);
  });
}

}  // namespace barchan
