#include "state/particles.hpp"

#include <numeric>

#include "base/errors.hpp"

namespace barchan {

PhaseParticles::PhaseParticles(std::string name, int dimensions, std::size_t size, double mass, std::int64_t first_id)
    : name_(std::move(name)),
      dimensions_(dimensions),
      size_(size),
      start_size_(size),
      first_id_(first_id),
      mass_(mass),
      id_(size),
      id_scratch_(size),
      scratch_(size) {
  std::iota(id_.begin(), id_.end(), first_id);
}

void PhaseParticles::add(Field field) {
  auto& columns = columns_[index(field)];
  if (!columns.empty()) return;
  columns.resize(static_cast<std::size_t>(components(field)));
  for (auto& column : columns) column.assign(size_, 0.0);
}

void PhaseParticles::permute(const std::uint32_t* order) {
  const auto n = static_cast<std::int64_t>(size_);
#pragma omp parallel
  {
    // Each column goes into the memory of the one before, which all threads have read by then.
    double* to = scratch_.data();
    for (auto& columns : columns_)
      for (auto& column : columns) {
        double* from = column.data();
#pragma omp for schedule(static)
        for (std::int64_t k = 0; k < n; ++k) to[k] = from[order[k]];
        to = from;
      }
#pragma omp for schedule(static)
    for (std::int64_t k = 0; k < n; ++k) id_scratch_[static_cast<std::size_t>(k)] = id_[order[k]];
  }
  for (auto& columns : columns_)
    for (auto& column : columns) column.swap(scratch_);
  id_.swap(id_scratch_);
}

void PhaseParticles::resize(std::size_t size) {
  size_ = size;
  id_.resize(size);
  id_scratch_.resize(size);
  scratch_.resize(size);
  for (auto& columns : columns_)
    for (auto& column : columns) column.resize(size);
}

void PhaseParticles::archive(Archive& a) {
  if (may_shrink_) {
    std::uint64_t count = size_;
    a.number("particles of " + name_, count);
    if (count > start_size_)
      throw SceneError("the checkpoint does not fit this scene: it has " + std::to_string(count) + " particles of \"" +
                       name_ + "\", the scene has " + std::to_string(start_size_));
    if (count != size_) resize(static_cast<std::size_t>(count));
  }
  a.values("id of " + name_, id_.data(), id_.size());
  for (std::size_t f = 0; f < field_count; ++f)
    for (auto& column : columns_[f])
      a.values(name_ + "." + std::string(info(static_cast<Field>(f)).name), column.data(), column.size());
}

std::size_t PhaseParticles::bytes() const {
  std::size_t total = (id_.size() + id_scratch_.size()) * sizeof(std::int64_t) + scratch_.size() * sizeof(double);
  for (const auto& columns : columns_)
    for (const auto& column : columns) total += column.size() * sizeof(double);
  return total;
}

}  // namespace barchan
