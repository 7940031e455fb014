// The steps of contacts on several ranks: what each of them has, and what they tell each other.
#include <algorithm>

#include "engine/exchange.hpp"
#include "models/grains/spheres.hpp"

namespace barchan {

/// Anew, where there are other chunks or the ranks have begun to share.
void Spheres::divide() {
  divided_ = Exchange().is_shared();
  shares_.divide(chunks_, Exchange().share());
  drop_other_chunks();
}

/// Lists of other ranks' chunks take no memory.
void Spheres::drop_other_chunks() {
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    if (shares_.has_chunk(c)) continue;
    SphereChunk empty;
    empty.begin = chunks_[c].begin;
    empty.end = chunks_[c].end;
    empty.phase = chunks_[c].phase;
    chunks_[c] = std::move(empty);
  }
}

Spheres::Extremes Spheres::of_all_ranks(Extremes own) const {
  if (!shares_.on()) return own;
  double values[] = {own.fastest, own.farthest, own.wakes};
  Exchange().reduce(values, 3, Exchange::Take::largest);
  return {values[0], values[1], values[2]};
}

/// Before lists are made anew: what the pairs remember. `moved`: the spheres have other places in memory, so that they
/// may be of another rank.
void Spheres::keep_memory(bool moved) {
  memory_was_shared_ = shares_.on();
  const std::size_t begin = moved ? 0 : shares_.begin(), end = moved ? moving_ : shares_.end();
  search_.keep(begin, end, all(), own_chunks(), listed_numbers_.data(), strays_.places());
  if (moved) sleep_.share(shares_, listed_numbers_.data());
}

/// What pairs remember goes to the ranks that have their spheres now.
void Spheres::share_memory() {
  if (!memory_was_shared_) return;  // then every rank has all of it
  std::vector<std::uint32_t> rank_of(moving_);
  for (std::size_t k = 0; k < moving_; ++k) rank_of[numbers_[k]] = static_cast<std::uint32_t>(shares_.rank_of(k));
  shares_.on() ? search_.share(rank_of) : search_.join();
}

/// Chunks of other ranks may have to be sorted out too. `more`: becomes whether any of all ranks has to.
void Spheres::share_flags(bool& more) {
  if (!shares_.on()) return;
  shared_flags_.assign(sorted_out_.begin(), sorted_out_.end());
  Exchange().reduce(shared_flags_.data(), shared_flags_.size(), Exchange::Take::largest);
  more = false;
  for (std::size_t c = 0; c < sorted_out_.size(); ++c) {
    sorted_out_[c] = static_cast<std::uint8_t>(shared_flags_[c]);
    more = more || sorted_out_[c] == 1;
  }
}

/// After a bundle: every rank gets the state of all spheres.
void Spheres::share_columns() {
  if (!shares_.on()) return;
  if (solid_walls_.any()) share_wall_touches();
  for (const Part& part : parts_) {
    const std::vector<std::size_t> counts = shares_.spheres_of_ranks(part.first, part.first + part.count);
    const std::vector<double*> columns = shared_columns(part);
    if (go_together(part)) shares_.gather_together(columns, counts);
    else
      for (double* const column : columns) Exchange().gather_in_place(column, counts, sizeof(double));
  }
}

/// After a bundle: every rank gets what all spheres remember of walls.
void Spheres::share_wall_touches() {
  struct Remembers {
    std::uint64_t part, sphere;
    SolidTouches touches;
  };
  std::vector<Remembers> all;
  for (std::size_t q = 0; q < parts_.size(); ++q) {
    const SphereColumns& c = columns_[parts_[q].phase];
    for (std::size_t k = 0; k < parts_[q].count; ++k) {
      if (c.walls[k].of[0].with == 0) continue;
      if (shares_.has(parts_[q].first + k)) all.push_back({q, k, c.walls[k]});
      else c.walls[k] = {};
    }
  }
  Exchange().join(all);
  for (const Remembers& one : all) columns_[parts_[one.part].phase].walls[one.sphere] = one.touches;
}

/// The columns of a part that all ranks get after a bundle.
std::vector<double*> Spheres::shared_columns(const Part& part) const {
  std::vector<double*> all;
  const SphereColumns& c = columns_[part.phase];
  for (const auto* columns : {&c.position, &c.velocity, &c.acceleration, &c.spin, &c.spin_rate})
    for (double* const column : *columns)
      if (column && part.count > 0) all.push_back(column);
  return all;
}

/// Whether they are one message: of few spheres a message costs more than to copy the columns side by side.
bool Spheres::go_together(const Part& part) { return part.count * sizeof(double) < (std::size_t{1} << 18); }

/// A search reads the radii of all spheres in the present set of records.
void Spheres::copy_radii() {
  if (!shares_.on()) return;
  const std::size_t stride = layout_.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size,
                    radius = layout_.dimensions == 2 ? SphereRecord<2>::radius : SphereRecord<3>::radius;
  for (std::size_t k = 0; k < moving_; ++k)
    records_[1 - now_][k * stride + radius] = records_[now_][k * stride + radius];
}

void Spheres::tell_places() { shares_.tell_all(layout_.dimensions, laws_.parts().rubs, true, records_[now_].data()); }

void Spheres::tell_records() {
  if (!bodies_.any()) shares_.tell(layout_.dimensions, laws_.parts().rubs, records_[now_].data());
}

void Spheres::tell_all_records() {
  shares_.tell_all(layout_.dimensions, laws_.parts().rubs, false, records_[now_].data());
}

/// Strays of all ranks, in the order of one process, with their records.
void Spheres::tell_strays() {
  if (!shares_.on()) return;
  struct Stray {
    std::uint64_t sphere;
    double record[SphereRecord<3>::size];
  };
  const std::size_t stride = layout_.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size;
  std::vector<Stray> strays;
  for (const std::uint32_t k : gone_) {
    Stray& stray = strays.emplace_back();
    stray.sphere = k;
    std::copy_n(records_[now_].data() + k * stride, stride, stray.record);
  }
  Exchange().join(strays);
  gone_.clear();
  for (const Stray& stray : strays) {
    gone_.push_back(static_cast<std::uint32_t>(stray.sphere));
    if (!shares_.has(stray.sphere)) std::copy_n(stray.record, stride, records_[now_].data() + stray.sphere * stride);
  }
}

/// Adds what a step of contacts sums up, chunk after chunk. `lost` (J), `deepest`: of contacts with bodies; `time` (s):
/// for which forces on walls act; `of`: the sums of a chunk, by its number.
template <class Of>
void Spheres::add_sums(double lost, double deepest, double time, Of&& of) {
  if (!watched_.empty()) {
    std::fill(pushing_.begin(), pushing_.end(), std::array<double, 6>{});
    for (std::size_t c = 0; c < chunks_.size(); ++c)
      for (std::size_t k = 0; k < watched_.size(); ++k)
        for (std::size_t q = 0; q < 6; ++q) pushing_[k][q] += of(c).pushed[k][q];
    sum_pushes(time);
  }
  stored_ = bodies_.stored();
  contacts_ = bodies_.contacts();
  lost_ += lost;
  deepest_ = std::max(deepest_, deepest);
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    const ChunkSums sums = of(c);
    lost_ += sums.lost;
    stored_ += sums.stored;
    contacts_ += sums.contacts;
    deepest_ = std::max(deepest_, sums.deepest);
  }
}

/// Takes the sums of the step of contacts. On several ranks they are kept until some steps are told together.
void Spheres::sum_up(bool last) {
  const auto of = [](const SphereChunk& chunk) {
    return ChunkSums{chunk.lost, chunk.stored, chunk.deepest, chunk.contacts + chunk.resting, chunk.pushed.data()};
  };
  kept_of_bodies_.push_back({bodies_.lost(), bodies_.deepest()});
  if (!shares_.on())
    add_sums(bodies_.lost(), bodies_.deepest(), last ? 0.5 * each_ : each_,
             [&](std::size_t c) { return of(chunks_[c]); });
  else
    for (const SphereChunk& chunk : own_chunks()) {
      const ChunkSums sums = of(chunk);
      kept_sums_.insert(kept_sums_.end(), {sums.lost, sums.stored, sums.deepest, sums.contacts});
      for (std::size_t k = 0; k < watched_.size(); ++k)
        kept_sums_.insert(kept_sums_.end(), sums.pushed[k].begin(), sums.pushed[k].end());
    }
  if (!last && kept_of_bodies_.size() < steps_told_together) return;
  if (shares_.on()) add_kept_sums(last);
  kept_of_bodies_.clear();
  kept_sums_.clear();
}

/// The sums of all ranks, step after step. `last`: the last of these steps is that of a bundle.
void Spheres::add_kept_sums(bool last) {
  const std::size_t steps = kept_of_bodies_.size(), width = 4 + 6 * watched_.size();
  const std::vector<std::size_t> chunks = shares_.chunks_of_ranks();
  std::vector<std::size_t> counts, first_of_chunk(chunks_.size());
  std::size_t first = 0, c = 0;
  for (const std::size_t n : chunks) {
    counts.push_back(n * steps);
    for (std::size_t k = 0; k < n; ++k) first_of_chunk[c++] = (first * steps + k) * width;
    first += n;
  }
  std::vector<double> all(chunks_.size() * steps * width);
  std::copy(kept_sums_.begin(), kept_sums_.end(),
            all.begin() + static_cast<std::ptrdiff_t>(shares_.first_chunk() * steps * width));
  Exchange().gather_in_place(all.data(), counts, width * sizeof(double));
  std::vector<std::size_t> a_step;  // numbers of a step of its rank, by chunk
  for (const std::size_t n : chunks) a_step.insert(a_step.end(), n, n * width);
  std::vector<std::array<double, 6>> pushed(watched_.size());
  for (std::size_t s = 0; s < steps; ++s)
    add_sums(kept_of_bodies_[s][0], kept_of_bodies_[s][1], last && s + 1 == steps ? 0.5 * each_ : each_,
             [&](std::size_t chunk) {
               const double* const from = all.data() + first_of_chunk[chunk] + s * a_step[chunk];
               for (std::size_t k = 0; k < pushed.size(); ++k) std::copy_n(from + 4 + 6 * k, 6, pushed[k].begin());
               return ChunkSums{from[0], from[1], from[2], from[3], pushed.data()};
             });
}

void Spheres::gather_to_save() {
  if (!shares_.on()) return;
  const Exchange all;
  sleep_.share(shares_, listed_numbers_.data());
  const std::size_t stride = layout_.dimensions == 2 ? SphereRecord<2>::size : SphereRecord<3>::size;
  all.gather_in_place(records_[now_].data(), shares_.spheres_of_ranks(0, moving_), stride * sizeof(double));
  Archive lists;
  lists.save([this](Archive& a) {
    for (SphereChunk& chunk : own_chunks()) archive_chunk(a, chunk);
  });
  std::vector<char> bytes = lists.bytes();
  bytes.resize((bytes.size() + sizeof(double) - 1) / sizeof(double) * sizeof(double));
  const std::vector<std::size_t> counts = Exchange().each(bytes.size() / sizeof(double));
  std::size_t total = 0;
  for (const std::size_t n : counts) total += n * sizeof(double);
  std::vector<char> come(Exchange::is_first_process() ? total : 0);
  all.gather(bytes.data(), bytes.size() / sizeof(double), come.data(), counts, sizeof(double));
  if (!Exchange::is_first_process()) return;
  const std::vector<std::size_t> chunks = shares_.chunks_of_ranks();
  std::size_t c = chunks[0], at = counts[0] * sizeof(double);
  for (std::size_t r = 1; r < chunks.size(); at += counts[r++] * sizeof(double)) {
    Archive of_rank(std::vector<char>(come.begin() + static_cast<std::ptrdiff_t>(at),
                                      come.begin() + static_cast<std::ptrdiff_t>(at + counts[r] * sizeof(double))));
    for (const std::size_t end = c + chunks[r]; c < end; ++c) archive_chunk(of_rank, chunks_[c]);
  }
}

}  // namespace barchan
