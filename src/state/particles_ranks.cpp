// Particles that change their rank, and those of all ranks together.
#include <algorithm>
#include <cstring>
#include <numeric>
#include <type_traits>

#include "base/ranks.hpp"
#include "state/particles.hpp"

namespace barchan {

void PhaseParticles::be_piece(std::size_t first) {
  is_part_ = true;
  std::iota(id_.begin(), id_.end(), first_id_ + static_cast<std::int64_t>(first));
}

void PhaseParticles::keep(const std::uint32_t* order, std::size_t count) {
  const auto pick = [&](auto& values, std::size_t width) {
    std::remove_reference_t<decltype(values)> kept;
    kept.reserve((count + count / 8) * width);
    kept.resize(count * width);
    const auto n = static_cast<std::int64_t>(count);
    auto* const to = kept.data();
    const auto* const from = values.data();
#pragma omp parallel for schedule(static)
    for (std::int64_t k = 0; k < n; ++k)
      std::copy_n(from + std::size_t{order[k]} * width, width, to + static_cast<std::size_t>(k) * width);
    values.swap(kept);
  };
  id_scratch_ = {};
  scratch_ = {};
  own_scratch_ = {};
  order_ = {};
  pick(id_, 1);
  for (auto& columns : columns_)
    for (auto& column : columns) pick(column, 1);
  for (OwnValues& v : own_) pick(v.values, v.width);
  id_scratch_.reserve(id_.capacity());
  scratch_.reserve(id_.capacity());
  std::size_t widest = 0;
  for (const OwnValues& v : own_) widest = std::max(widest, v.values.capacity());
  own_scratch_.reserve(widest);
  is_part_ = true;
  resize(count);
  find_places();
}

void PhaseParticles::keep_range(std::size_t first, std::size_t last) {
  std::vector<std::uint32_t> order(last - first);
  std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(first));
  keep(order.data(), order.size());
}

std::size_t PhaseParticles::packed_width() const {
  std::size_t width = sizeof(std::int64_t);
  for (const auto& columns : columns_) width += columns.size() * sizeof(double);
  for (const OwnValues& v : own_) width += v.width;
  return width;
}

void PhaseParticles::pack(std::size_t k, std::byte* to) const {
  std::memcpy(to, &id_[k], sizeof id_[k]);
  to += sizeof id_[k];
  for (const auto& columns : columns_)
    for (const auto& column : columns) {
      std::memcpy(to, &column[k], sizeof column[k]);
      to += sizeof column[k];
    }
  for (const OwnValues& v : own_) {
    std::memcpy(to, v.values.data() + k * v.width, v.width);
    to += v.width;
  }
}

void PhaseParticles::unpack(std::size_t k, const std::byte* from) {
  std::memcpy(&id_[k], from, sizeof id_[k]);
  from += sizeof id_[k];
  for (auto& columns : columns_)
    for (auto& column : columns) {
      std::memcpy(&column[k], from, sizeof column[k]);
      from += sizeof column[k];
    }
  for (OwnValues& v : own_) {
    std::memcpy(v.values.data() + k * v.width, from, v.width);
    from += v.width;
  }
}

namespace {

/// Items of `width` values of all ranks, one rank after another, on the first rank. `counts`: of items of each.
template <class Values>
Values on_first(const Values& mine, const std::vector<std::size_t>& counts, std::size_t width = 1) {
  Communicator& all = *ranks::active();
  const auto rank = static_cast<std::size_t>(all.rank());
  Values together;
  if (rank == 0) together.resize(std::accumulate(counts.begin(), counts.end(), std::size_t{0}) * width);
  all.gather(mine.data(), counts[rank], together.data(), counts, width * sizeof(typename Values::value_type));
  return together;
}

}  // namespace

void PhaseParticles::send_to_archive() const {
  if (!is_whole_) save_all(nullptr);
}

/// What archive() saves, of all ranks. `a` of the first rank; null on the others.
void PhaseParticles::save_all(Archive* a) const {
  const std::vector<std::size_t> counts = ranks::each(size_);
  std::uint64_t count = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  if (a) a->number("particles of " + name_, count);
  const auto save = [&](const std::string& name, const auto& values, std::size_t width) {
    auto all = on_first(values, counts, width);
    if (a) a->values(name, all.data(), all.size());
  };
  save("id of " + name_, id_, 1);
  for (std::size_t f = 0; f < field_count; ++f)
    for (const auto& column : columns_[f]) save(name_ + "." + std::string(info(static_cast<Field>(f)).name), column, 1);
  for (const OwnValues& v : own_)
    if (v.kept == Kept::state) save(name_ + "." + v.name, v.values, v.width);
}

PhaseParticles PhaseParticles::gathered(const FieldSet& fields, const std::function<bool(std::size_t)>& wanted) const {
  std::vector<std::size_t> from;
  for (std::size_t k = 0; k < size_; ++k)
    if (wanted(k)) from.push_back(k);
  PhaseParticles part(name_, dimensions_, from.size(), mass_, first_id_);
  part.is_whole_ = is_whole_;
  for (std::size_t k = 0; k < from.size(); ++k) part.id_[k] = id_[from[k]];
  for (std::size_t f = 0; f < field_count; ++f) {
    const auto field = static_cast<Field>(f);
    if (!fields.has(field) || !has(field)) continue;
    part.add(field);
    for (int c = 0; c < components(field); ++c)
      for (std::size_t k = 0; k < from.size(); ++k) part.column(field, c)[k] = column(field, c)[from[k]];
  }
  if (!ranks::active() || is_whole_) return part;
  const std::vector<std::size_t> counts = ranks::each(part.size_);
  part.id_ = on_first(part.id_, counts);
  for (auto& columns : part.columns_)
    for (auto& column : columns) column = on_first(column, counts);
  part.size_ = part.id_.size();
  return part;
}

}  // namespace barchan
