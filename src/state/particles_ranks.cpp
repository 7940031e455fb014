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
  give_back(id_scratch_);
  give_back(scratch_);
  give_back(own_scratch_);
  give_back(order_);
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

void PhaseParticles::archive_all(bool all) {
  archives_all_ = all;
  if (all && !is_whole_) all_ = ranks::total(size_);
}

void PhaseParticles::load_rows(Archive& a, std::size_t first, std::size_t last) {
  const std::size_t count = last - first;
  const auto make_room = [count](auto& values, std::size_t width) {
    if (values.capacity() >= count * width) return;
    give_back(values);  // nothing of what is there is needed: never both at a time
    values.reserve((count + count / 8) * width);
  };
  make_room(id_, 1);
  make_room(id_scratch_, 1);
  make_room(scratch_, 1);
  for (auto& columns : columns_)
    for (auto& column : columns) make_room(column, 1);
  std::size_t widest = 0;
  for (OwnValues& v : own_) {
    make_room(v.values, v.width);
    widest = std::max(widest, v.width);
  }
  make_room(own_scratch_, widest);
  is_part_ = true;
  resize(count);
  ++changes_;
  const std::uint64_t here = a.place();
  a.go_to(rows_at_);
  archive_columns(a, {first, count, all_});
  a.go_to(here);
  find_places();
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

PhaseParticles PhaseParticles::gathered(const FieldSet& fields, const std::function<bool(std::size_t)>& wanted) const {
  std::vector<std::size_t> from;
  for (std::size_t k = 0; k < size_; ++k)
    if (wanted(k)) from.push_back(k);
  PhaseParticles part(name_, dimensions_, from.size(), mass_, first_id_);
  part.is_whole_ = is_whole_;
  part.mean_radius_ = mean_radius_;
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
