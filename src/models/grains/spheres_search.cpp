// Between the state and the records of spheres, and the lists of pairs: when they are made anew.
#include <algorithm>
#include <cmath>

#include "models/grains/spheres.hpp"

namespace barchan {

/// Both records of a sphere that sleeps: where it is, at rest.
template <int Dim>
static void rest_in(double* one, double* other, const SphereColumns& c, std::size_t k, double radius) {
  using R = SphereRecord<Dim>;
  std::array<float, Dim> way{};
  for (std::size_t d = 0; d < Dim; ++d) way[d] = way_of<Dim>(one, d);
  for (double* record : {one, other}) {
    std::fill_n(record, R::size, 0.0);
    for (std::size_t d = 0; d < Dim; ++d) record[d] = c.position[d][k];
    for (std::size_t d = 0; d < Dim; ++d) set_way<Dim>(record, d, way[d]);
    record[R::radius] = radius;
  }
}

/// Which spheres of a part a rank packs: before a search of all spheres, and where bodies touch them, all of them; else
/// its own, and then those that its own meet.
std::vector<std::uint32_t> Spheres::others_to_pack(const Part& part) const {
  std::vector<std::uint32_t> others;
  if (!packs_all())
    shares_.each_told([&](std::size_t k) {
      if (k >= part.first && k < part.first + part.count) others.push_back(static_cast<std::uint32_t>(k - part.first));
    });
  return others;
}

/// The state into the records; half a kick and the first drift.
template <int Dim>
void Spheres::pack(double dt) {
  using R = SphereRecord<Dim>;
  const double half = 0.5 * dt;
  double* records = records_[now_].data();
  double* passive = passive_.data();
  float farthest = 0.0f;
  double fastest2 = 0.0;
  const float* tightness = strays_.tightness();
  for (const Part& part : parts_) {
    const PhaseParticles& p = w_->particles(part.phase);
    const SphereColumns& c = columns_[part.phase];
    const double* radius = p.has(Field::radius) ? p.column(Field::radius) : nullptr;
    std::array<const double*, Dim> a{};
    for (int d = 0; d < Dim; ++d) a[static_cast<std::size_t>(d)] = p.column(Field::acceleration, d);
    const double inverse_mass = 1.0 / (p.mass() * layout_.slab);
    const std::size_t end = part.first + part.count,
                      first = packs_all() ? 0 : std::clamp(shares_.begin(), part.first, end) - part.first,
                      own = packs_all() ? part.count : std::clamp(shares_.end(), part.first, end) - part.first - first;
    const std::vector<std::uint32_t> met = others_to_pack(part);
    const auto n = static_cast<std::int64_t>(own + met.size());
    const bool fresh = must_search_;
    double* others = records_[1 - now_].data();
#pragma omp parallel for schedule(static) reduction(max : farthest, fastest2)
    for (std::int64_t i = 0; i < n; ++i) {
      const auto of = static_cast<std::size_t>(i), k = of < own ? first + of : std::size_t{met[of - own]};
      double* r = records + (part.first + k) * R::size;
      double* q = passive + (part.first + k) * passive_size;
      if (sleep_.sleeps(numbers_[part.first + k])) {
        for (std::size_t d = 0; d < Dim; ++d) q[d] = a[d][k];
        if (!rest_anew_) continue;
        const double size = radius ? radius[k] : part.mean_radius;
        rest_in<Dim>(r, others + (part.first + k) * R::size, c, k, size);
        q[passive_mass] = inverse_mass * std::pow(part.mean_radius / size, 3);
        continue;
      }
      double v2 = 0.0;
      for (std::size_t d = 0; d < Dim; ++d) {
        const double v = c.velocity[d][k] + half * (c.acceleration[d][k] + a[d][k]);
        r[d] = c.position[d][k] + dt * v;
        r[R::velocity + d] = v;
        q[d] = a[d][k];
        set_way<Dim>(r, d, fresh ? 0.0f : way_of<Dim>(r, d) + static_cast<float>(dt * v));
        v2 += v * v;
      }
      r[R::radius] = radius ? radius[k] : part.mean_radius;
      const double share = part.mean_radius / r[R::radius];
      q[passive_mass] = inverse_mass * share * share * share;
      for (std::size_t d = 0; d < R::spins; ++d)
        r[R::spin + d] = c.spin[d] ? c.spin[d][k] + half * c.spin_rate[d][k] : 0.0;
      farthest = std::max(farthest, next_way2<Dim>(r, dt) * tightness[part.first + k]);
      fastest2 = std::max(fastest2, v2);
    }
  }
  renew_lists(of_all_ranks({std::sqrt(fastest2), static_cast<double>(farthest), 0.0}), dt);
}

/// After records are packed: the lists that the next step of contacts needs.
void Spheres::renew_lists(const Extremes& found, double dt) {
  loaded_ = false;
  fastest_ = found.fastest;
  for (SphereChunk& chunk : own_chunks()) chunk.fastest = fastest_;
  if (must_search_ || walls_left_) return search();
  if (others_sleep_) sort_out_sleepers(false);
  if (found.farthest < SphereChunk::used_up) return;
  if (!search_strays(dt, false)) tell_records();
}

SphereSet Spheres::set() {
  return {layout_.dimensions, records_[now_].data(), moving_,          all(),           numbers_.data(),
          kinds_.data(),      sleep_.flags(),        strays_.places(), search_.images()};
}

/// Fills the lists from the present records.
void Spheres::search() {
  // A search costs about four steps of all pairs and a step (1 + s)^D pairs of the slack s (see
  // Neighbours::choose_skin).
  if (searches_ > 0) {
    const double per_slack = static_cast<double>(kept_ + 1) / slack_;
    slack_ = std::clamp(std::sqrt(4.0 / (layout_.dimensions * per_slack)), std::max(0.02, 0.5 * slack_),
                        std::min(0.4, 1.5 * slack_));
  }
  if (!must_search_ && !bodies_.any()) tell_places();
  if (!kept_memory_) keep_memory(must_search_);
  strays_.begin(set(), slack());
  if (must_search_) share_memory();
  kept_memory_ = false;
  search_.find(set(), slack(), own_chunks());
  if (solid_walls_.any()) {
    for (SphereChunk& chunk : own_chunks()) solid_walls_.find(set(), slack(), chunk);
    solid_walls_.list();
  }
  rest_.recall(step_, set(), own_chunks());
  strays_.take_cells(search_.cells());
  shares_.find(chunks_);
  if (sleep_.on()) sort_out_sleepers(true);
  cells_loaded_ = false;
  listed_numbers_ = numbers_;
  for (auto& records : {&records_[0], &records_[1]})
    for (std::size_t k = 0; k < moving_; ++k)
      for (int d = 0; d < layout_.dimensions; ++d)
        layout_.dimensions == 2
            ? set_way<2>(records->data() + k * SphereRecord<2>::size, static_cast<std::size_t>(d), 0.0f)
            : set_way<3>(records->data() + k * SphereRecord<3>::size, static_cast<std::size_t>(d), 0.0f);
  copy_radii();
  if (!must_search_) tell_records();
  must_search_ = walls_left_ = false;
  kept_ = 0;
  ++searches_;
  ++since_sort_;
}

/// Whose way is longer than its allowance. `stepped`: the chunks know them.
template <int Dim>
void Spheres::list_strays(double dt, bool stepped) {
  gone_.clear();
  for (const SphereChunk& chunk : own_chunks()) {
    if (stepped) {
      gone_.insert(gone_.end(), chunk.gone.begin(), chunk.gone.end());
      continue;
    }
    chunk.each_moving([&](std::size_t k) {
      const float way2 = next_way2<Dim>(records_[now_].data() + k * SphereRecord<Dim>::size, dt);
      if (static_cast<double>(way2 * strays_.tightness()[k]) >= SphereChunk::used_up)
        gone_.push_back(static_cast<std::uint32_t>(k));
    });
  }
}

/// Whether a sphere is so many periods outside the domain that it must be put back before pair_image cannot count them.
bool Spheres::is_far_outside(std::size_t sphere) const {
  bool far = false;
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    const double x = strays_.places()[sphere * static_cast<std::size_t>(layout_.dimensions) + d];
    const double most = 0.25 * pair_image::most_periods * step_.period[d];
    far = far || (most > 0.0 && std::abs(x - layout_.bounds.low[d]) > most);
  }
  return far;
}

/// Searches those anew who have used up their allowances, or all.
bool Spheres::search_strays(double dt, bool stepped) {
  layout_.dimensions == 2 ? list_strays<2>(dt, stepped) : list_strays<3>(dt, stepped);
  tell_strays();
  if (!strays_.few(gone_.size())) {
    search();
    return true;
  }
  const SphereSet s = set();
  if (cells_loaded_) {
    search_.sort(s, strays_.slack());
    strays_.take_cells(search_.cells());
    cells_loaded_ = false;
  }
  for (const std::uint32_t k : gone_) {
    strays_.renew(s, k, dt, search_.sides(), chunks_, shares_);
    if (solid_walls_.any() && shares_.has(k))
      solid_walls_.find_anew(s, k, strays_.allowance() + strays_.allowance_of(k), chunks_[strays_.chunk_of(k)]);
    if (s.images && is_far_outside(k)) since_sort_ = searches_a_sort;
    for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d)
      layout_.dimensions == 2 ? set_way<2>(records_[now_].data() + k * SphereRecord<2>::size, d, 0.0f)
                              : set_way<3>(records_[now_].data() + k * SphereRecord<3>::size, d, 0.0f);
  }
  return false;
}

template void Spheres::pack<2>(double);
template void Spheres::pack<3>(double);

}  // namespace barchan
