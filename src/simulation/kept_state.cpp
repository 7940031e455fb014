#include "simulation/kept_state.hpp"

#include <algorithm>

namespace barchan {

KeptState::KeptState(const std::vector<PhaseParticles>& particles, std::vector<Field> fields)
    : fields_(std::move(fields)), ids_(particles.size()), kept_(particles.size()) {
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const PhaseParticles& p = particles[k];
    if (!p.has(Field::acceleration)) continue;  // walls stay where they are
    ids_[k] = p.id();
    kept_[k] = true;
    for (const Field field : fields_)
      for (int c = 0; p.has(field) && c < p.components(field); ++c)
        columns_.push_back({k, field, c, AlignedVector<double>(p.size())});
  }
}

void KeptState::keep(const std::vector<PhaseParticles>& particles, double time, long step) {
  for (auto& column : columns_) {
    column.values.resize(particles[column.phase].size());  // some may have left
    const double* from = particles[column.phase].column(column.field, column.component);
    double* to = column.values.data();
    const auto n = static_cast<std::int64_t>(column.values.size());
#pragma omp parallel for simd schedule(static)
    for (std::int64_t i = 0; i < n; ++i) to[i] = from[i];
  }
  for (std::size_t k = 0; k < ids_.size(); ++k)
    if (kept_[k]) ids_[k].assign(particles[k].id().begin(), particles[k].id().end());
  time_ = time;
  step_ = step;
}

void KeptState::exchange(std::vector<PhaseParticles>& particles) {
  std::vector<std::size_t> now(particles.size()), kept(particles.size());
  for (std::size_t k = 0; k < particles.size(); ++k) {
    now[k] = particles[k].size();
    kept[k] = kept_[k] ? ids_[k].size() : now[k];
    particles[k].resize(std::max(now[k], kept[k]));  // some may have been made or removed since
  }
  for (auto& column : columns_) {
    column.values.resize(std::max(now[column.phase], kept[column.phase]));
    std::swap_ranges(column.values.begin(), column.values.end(),
                     particles[column.phase].column(column.field, column.component));
    column.values.resize(now[column.phase]);
  }
  for (std::size_t k = 0; k < ids_.size(); ++k) {
    if (!kept_[k]) continue;
    particles[k].set_ids(ids_[k]);  // as many as were kept; the ids of the present state go into ids_[k]
    ids_[k].resize(now[k]);
  }
}

std::size_t KeptState::bytes() const {
  std::size_t total = 0;
  for (const auto& c : columns_) total += c.values.size() * sizeof(double);
  for (const auto& i : ids_) total += i.size() * sizeof(std::int64_t);
  return total;
}

}  // namespace barchan
