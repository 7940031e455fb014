#include "state/particles.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "base/errors.hpp"
#include "base/ranks.hpp"

namespace barchan {

PhaseParticles::PhaseParticles(std::string name, int dimensions, std::size_t size, double mass, std::int64_t first_id)
    : name_(std::move(name)),
      dimensions_(dimensions),
      size_(size),
      first_id_(first_id),
      mass_(mass),
      id_(size),
      id_scratch_(ranks::available() ? 0 : size),  // on several ranks only a part of the particles stays
      scratch_(id_scratch_.size()) {
  std::iota(id_.begin(), id_.end(), first_id);
}

void PhaseParticles::add(Field field) {
  auto& columns = columns_[index(field)];
  if (!columns.empty()) return;
  columns.resize(static_cast<std::size_t>(components(field)));
  for (auto& column : columns) column.assign(size_, 0.0);
}

std::size_t PhaseParticles::add_own_bytes(const std::string& name, std::size_t width, const void* of_new) {
  if (std::any_of(own_.begin(), own_.end(), [&](const OwnValues& v) { return v.name == name; }))
    throw std::logic_error("the phase \"" + name_ + "\" has a column \"" + name + "\" already");
  OwnValues& v = own_.emplace_back();
  v.name = name;
  v.width = width;
  v.of_new.resize(width);
  std::memcpy(v.of_new.data(), of_new, width);
  v.values.resize(size_ * width);
  for (std::size_t k = 0; k < size_; ++k) std::memcpy(v.values.data() + k * width, of_new, width);
  if (own_scratch_.size() < v.values.size()) own_scratch_.resize(v.values.size());
  return own_.size() - 1;
}

namespace {

/// to[k] = from[order[k]] for values of `width` bytes. All threads of a team call it.
template <class T>
void gather(const void* from, void* to, const std::uint32_t* order, std::int64_t n) {
  const T* source = static_cast<const T*>(from);
  T* target = static_cast<T*>(to);
#pragma omp for schedule(static)
  for (std::int64_t k = 0; k < n; ++k) target[k] = source[order[k]];
}

void gather_bytes(const std::byte* from, std::byte* to, std::size_t width, const std::uint32_t* order, std::int64_t n) {
  if (width == 8) return gather<std::uint64_t>(from, to, order, n);
  if (width == 4) return gather<std::uint32_t>(from, to, order, n);
#pragma omp for schedule(static)
  for (std::int64_t k = 0; k < n; ++k)
    std::memcpy(to + static_cast<std::size_t>(k) * width, from + order[k] * width, width);
}

}  // namespace

void PhaseParticles::permute(const std::uint32_t* order) {
  const auto n = static_cast<std::int64_t>(size_);
  if (scratch_.size() != size_) scratch_.resize(size_);  // the first time
  if (id_scratch_.size() != size_) id_scratch_.resize(size_);
#pragma omp parallel
  {
    // Each column goes into the memory of the one before, which all threads have read by then.
    double* to = scratch_.data();
    for (auto& columns : columns_)
      for (auto& column : columns) {
        gather<double>(column.data(), to, order, n);
        to = column.data();
      }
    gather<std::int64_t>(id_.data(), id_scratch_.data(), order, n);
  }
  for (auto& columns : columns_)
    for (auto& column : columns) column.swap(scratch_);
  id_.swap(id_scratch_);
  for (OwnValues& v : own_) {
#pragma omp parallel
    gather_bytes(v.values.data(), own_scratch_.data(), v.width, order, n);
    if (own_scratch_.size() == v.values.size()) v.values.swap(own_scratch_);
    else std::memcpy(v.values.data(), own_scratch_.data(), v.values.size());
  }
  find_places();
}

void PhaseParticles::sort_by_id() {
  if (std::is_sorted(id_.begin(), id_.end())) return;
  std::vector<std::uint32_t> order(size_);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) { return id_[a] < id_[b]; });
  permute(order.data());
}

void PhaseParticles::set_ids(std::vector<std::int64_t>& ids) {
  id_.swap(ids);
  resize(id_.size());
  find_places();
}

void PhaseParticles::keep_places() {
  if (may_change_)
    throw std::logic_error("the particles of \"" + name_ + "\" may change in number: their ids have gaps");
  keeps_places_ = true;
  places_.resize(size_);
  find_places();
}

void PhaseParticles::find_places() {
  if (!keeps_places_) return;
  ++arrangements_;
  const auto n = static_cast<std::int64_t>(size_);
  bool in_order = true;
  if (is_part_) std::fill(places_.begin(), places_.end(), elsewhere);
#pragma omp parallel for schedule(static) reduction(&& : in_order)
  for (std::int64_t k = 0; k < n; ++k) {
    const std::int64_t number = id_[static_cast<std::size_t>(k)] - first_id_;
    places_[static_cast<std::size_t>(number)] = static_cast<std::uint32_t>(k);
    in_order = in_order && number == k;
  }
  in_order_ = in_order;
}

void PhaseParticles::number_may_change() {
  if (keeps_places_)
    throw std::logic_error("the places of the particles of \"" + name_ + "\" are kept: their number may not change");
  may_change_ = true;
}

std::size_t PhaseParticles::create(std::size_t count, IdSource& ids) {
  if (!may_change_) throw std::logic_error("nobody said that the number of \"" + name_ + "\" may change");
  const std::size_t first = size_;
  resize(size_ + count);
  for (std::size_t k = first; k < size_; ++k) id_[k] = ids.next++;
  for (auto& columns : columns_)
    for (auto& column : columns) std::fill(column.begin() + static_cast<std::ptrdiff_t>(first), column.end(), 0.0);
  for (OwnValues& v : own_)
    for (std::size_t k = first; k < size_; ++k) std::memcpy(v.values.data() + k * v.width, v.of_new.data(), v.width);
  if (count > 0) ++changes_;
  return first;
}

std::size_t PhaseParticles::remove_if(const std::function<bool(std::size_t)>& leaves) {
  if (!may_change_) throw std::logic_error("nobody said that the number of \"" + name_ + "\" may change");
  if (order_.size() < size_) order_.resize(size_);
  std::size_t kept = 0, last = size_;
  for (std::size_t k = 0; k < size_; ++k) order_[leaves(k) ? --last : kept++] = static_cast<std::uint32_t>(k);
  const std::size_t removed = size_ - kept;
  if (removed == 0) return 0;
  permute(order_.data());
  resize(kept);
  ++changes_;
  return removed;
}

void PhaseParticles::resize(std::size_t size) {
  size_ = size;
  const auto fit = [size](auto& values, std::size_t width) {
    // Room grows by half, so that a phase that grows steadily allocates seldom.
    if (values.capacity() < size * width) values.reserve(std::max(size, size + size / 2) * width);
    values.resize(size * width);
  };
  fit(id_, 1);
  fit(id_scratch_, 1);
  fit(scratch_, 1);
  for (auto& columns : columns_)
    for (auto& column : columns) fit(column, 1);
  for (OwnValues& v : own_) {
    fit(v.values, v.width);
    if (own_scratch_.size() < v.values.size()) fit(own_scratch_, v.width);
  }
}

void PhaseParticles::archive(Archive& a) {
  const bool all = archives_all_ && !is_whole_;
  const std::uint64_t expected = all ? all_ : size_;
  std::uint64_t count = expected;
  a.number("particles of " + name_, count);
  if (count != expected && !may_change_ && (all || !is_part_))
    throw SceneError("the checkpoint does not fit this scene: it has " + std::to_string(count) + " particles of \"" +
                     name_ + "\", the scene has " + std::to_string(expected));
  if (all && a.loads()) {
    all_ = count;
    rows_at_ = a.place();
    return archive_columns(a, {0, 0, count});
  }
  if (!all && count != size_) {
    resize(static_cast<std::size_t>(count));
    ++changes_;
  }
  archive_columns(a, {0, size_, count});
  if (a.loads()) find_places();
}

namespace {

/// Fields that output.fields adds for frames alone. No step starts from them, so a checkpoint may have others
/// than the scene that goes on: what it lacks is made before the next frame. Updated Lagrangian bodies always have
/// their stress and velocity gradient, a fluid with two equations its shear rate.
constexpr bool may_be_for_frames_alone(Field f) {
  return f == Field::stress || f == Field::von_mises_stress || f == Field::principal_stress || f == Field::strain ||
         f == Field::contact_force || f == Field::velocity_gradient || f == Field::shear_rate;
}

/// Of an archive that loads: whether its next item has this name and holds numbers.
bool comes_next(Archive& a, const std::string& name) {
  const std::uint64_t here = a.place();
  bool comes = true;
  try {
    a.parts<double>(name, [](std::uint64_t, auto&&) {});
  } catch (const SceneError&) { comes = false; }
  a.go_to(here);
  return comes;
}

}  // namespace

/// Ids, fields and own columns that are kept; `rows`: those that are here. What every rank has whole is no rows.
void PhaseParticles::archive_columns(Archive& a, const Rows& rows) {
  const bool shared = archives_all_ && !is_whole_;
  const auto item = [&](const std::string& name, auto* own, std::size_t width) {
    if (shared) a.rows(name, own, {rows.first * width, rows.count * width, rows.all * width});
    else a.values(name, own, rows.all * width);
  };
  item("id of " + name_, id_.data(), 1);
  for (std::size_t f = 0; f < field_count; ++f) {
    const std::string name = name_ + "." + std::string(info(static_cast<Field>(f)).name);
    if (a.loads() && may_be_for_frames_alone(static_cast<Field>(f))) {
      const bool comes = comes_next(a, name);
      while (columns_[f].empty() && comes_next(a, name)) a.parts<double>(name, [](std::uint64_t, auto&&) {});
      if (!comes) continue;
    }
    for (auto& column : columns_[f]) item(name, column.data(), 1);
  }
  for (OwnValues& v : own_) item(name_ + "." + v.name, v.values.data(), v.width);
}

std::size_t PhaseParticles::bytes() const {
  std::size_t total = (id_.capacity() + id_scratch_.capacity()) * sizeof(std::int64_t) +
                      scratch_.capacity() * sizeof(double) + own_scratch_.capacity() +
                      (places_.capacity() + order_.capacity()) * sizeof(std::uint32_t);
  for (const auto& columns : columns_)
    for (const auto& column : columns) total += column.capacity() * sizeof(double);
  for (const OwnValues& v : own_) total += v.values.capacity();
  return total;
}

}  // namespace barchan
