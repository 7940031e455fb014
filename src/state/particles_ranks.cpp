// Particles that change their rank, and those of all ranks together.
#include <algorithm>
#include <cstring>
#include <numeric>

#include "base/ranks.hpp"
#include "state/particles.hpp"

namespace barchan {

namespace {

/// Gives back the memory of values that other ranks have now; a little room is left for those that come.
template <class Values>
void give_back(Values& values) {
  const std::size_t room = values.size() + values.size() / 8;
  if (values.capacity() <= room) return;
  Values kept;
  kept.reserve(room);
  kept.assign(values.begin(), values.end());
  values.swap(kept);
}

}  // namespace

void PhaseParticles::keep_range(std::size_t first, std::size_t last) {
  const auto move = [&](auto& values, std::size_t width) {
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(first * width);
    std::copy(from, values.begin() + static_cast<std::ptrdiff_t>(last * width), values.begin());
  };
  move(id_, 1);
  for (auto& columns : columns_)
    for (auto& column : columns) move(column, 1);
  for (OwnValues& v : own_) move(v.values, v.width);
  is_part_ = true;
  resize(last - first);
  std::size_t widest = 0;
  for (auto& columns : columns_)
    for (auto& column : columns) give_back(column);
  for (OwnValues& v : own_) {
    give_back(v.values);
    widest = std::max(widest, v.values.size());
  }
  own_scratch_.resize(widest);
  give_back(own_scratch_);
  give_back(id_);
  give_back(id_scratch_);
  give_back(scratch_);
  order_ = {};
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

PhaseParticles PhaseParticles::gathered() const {
  PhaseParticles whole = *this;
  Communicator* const all = ranks::active();
  if (!all || is_whole_) return whole;
  const std::size_t width = packed_width();
  const std::vector<std::size_t> counts = ranks::each(size_);
  const std::size_t total = all->rank() == 0 ? std::accumulate(counts.begin(), counts.end(), std::size_t{0}) : 0;
  std::vector<std::byte> mine(size_ * width), together(total * width);
  for (std::size_t k = 0; k < size_; ++k) pack(k, mine.data() + k * width);
  all->gather(mine.data(), size_, together.data(), counts, width);
  whole.resize(total);
  for (std::size_t k = 0; k < total; ++k) whole.unpack(k, together.data() + k * width);
  return whole;
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
  return part.gathered();
}

}  // namespace barchan
