// The particles of a run: one set a phase. Every array by particle is a column of its phase: fields, which all may
// read, and columns of a model's own. Sorting, creation, removal, checkpoint and memory follow from what was registered
// here and are written nowhere else.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/aligned.hpp"
#include "base/fields.hpp"
#include "base/vec3.hpp"
#include "state/access.hpp"
#include "state/archive.hpp"
#include "state/columns.hpp"

namespace barchan {

/// The particles of one phase as a structure of arrays. Columns hold size() values in the current (sorted) order; `id`
/// says which particle stands where.
class PhaseParticles {
 public:
  /// `size` particles at the start, with the ids first_id, first_id + 1, ...
  PhaseParticles(std::string name, int dimensions, std::size_t size, double mass, std::int64_t first_id);

  const std::string& name() const { return name_; }
  int dimensions() const { return dimensions_; }
  std::size_t size() const { return size_; }
  double mass() const { return mass_; }  ///< kg a particle (kg per metre of depth in 2D); of spheres of the mean radius
  /// The ids of the start are from first_id() on.
  std::int64_t first_id() const { return first_id_; }
  /// kg, of the particle at a place: spheres have their own where the phase has the field radius.
  double mass_of(std::size_t k) const {
    if (!has(Field::radius)) return mass_;
    const double share = columns_[index(Field::radius)][0][k] / mean_radius_;
    return mass_ * share * share * share;
  }
  /// The radius of a sphere of mass() (m); 0: the particles are no spheres.
  void set_mean_radius(double radius) { mean_radius_ = radius; }
  double mean_radius() const { return mean_radius_; }

  void add(Field field);  ///< makes the field, zero; does nothing if it is there
  bool has(Field field) const { return !columns_[index(field)].empty(); }
  int components(Field field) const { return barchan::components(info(field).rank, dimensions_); }
  double* column(Field field, int component = 0) {
    check(field);
    return columns_[index(field)][static_cast<std::size_t>(component)].data();
  }
  const double* column(Field field, int component = 0) const {
    check(field);
    return columns_[index(field)][static_cast<std::size_t>(component)].data();
  }

  /// Registers a column of a model's own, which checkpoints hold; all its values are `of_new`. Throws std::logic_error
  /// when the name is there already.
  template <class T>
  OwnColumn<T> add_own(const std::string& name, const T& of_new = T{}) {
    return {add_own_bytes(name, sizeof(T), &of_new)};
  }
  template <class T>
  T* own(OwnColumn<T> column) {
    return reinterpret_cast<T*>(own_[column.number].values.data());
  }
  template <class T>
  const T* own(OwnColumn<T> column) const {
    return reinterpret_cast<const T*>(own_[column.number].values.data());
  }

  const std::vector<std::int64_t>& id() const { return id_; }

  /// Reorders every column: new[k] = old[order[k]]. Allocates nothing.
  void permute(const std::uint32_t* order);

  /// Puts the particles into the order of their ids.
  void sort_by_id();

  /// From now on the phase knows where each of its particles stands. Throws std::logic_error of a phase whose number of
  /// particles may change: its ids have gaps.
  void keep_places();
  /// Where the particle with the id first_id() + n stands, by n; after keep_places(). On several ranks `elsewhere`
  /// where it is another rank's.
  const std::uint32_t* places() const { return places_.data(); }
  static constexpr std::uint32_t elsewhere = 0xffffffffu;
  std::uint32_t arrangements() const { return arrangements_; }  ///< how often places() became others
  bool in_order() const { return in_order_; }  ///< every particle stands at the place of its id; after keep_places()

  /// In Model::begin: particles will be made or removed, so that checkpoints have other numbers than the start.
  void number_may_change();
  bool may_change() const { return may_change_; }
  /// Makes `count` particles behind the last one and returns the place of the first. They have new ids; their fields
  /// are zero, their own columns have the values of new particles. Allocates only where there was never so much room.
  std::size_t create(std::size_t count, IdSource& ids);
  /// Removes the particles for whose place `leaves` is true; the others keep their order. Returns how many were
  /// removed. Allocates nothing once warm.
  std::size_t remove_if(const std::function<bool(std::size_t)>& leaves);
  /// How often particles were made or removed: lists of an older count are not those of these particles.
  long changes() const { return changes_; }

  /// The first `size` particles are there; what a larger size adds has no values yet. For who gives it the values of
  /// another state at once (simulation/kept_state.hpp).
  void resize(std::size_t size);
  /// Swaps the ids with those of another state, as many as there are particles then; the columns are the caller's.
  void set_ids(std::vector<std::int64_t>& ids);

  // Of a run on several ranks: a phase holds the particles of its rank (engine/cell_ranks.cpp).

  /// Every rank holds all particles of the phase, moves them, and has the same bits.
  void be_whole() { is_whole_ = true; }
  bool is_whole() const { return is_whole_; }
  /// The particles of the start that are here are those with the ids first_id() + first, first_id() + first + 1, ...
  void be_piece(std::size_t first);
  /// It holds some of its particles, and other ranks the others.
  bool is_part() const { return is_part_; }
  /// From now on it holds those at the places order[0] .. order[count - 1] alone, in this order. Takes the memory of
  /// one column more.
  void keep(const std::uint32_t* order, std::size_t count);
  /// Bytes of a particle on its way: id, fields, own columns.
  std::size_t packed_width() const;
  void pack(std::size_t k, std::byte* to) const;
  void unpack(std::size_t k, const std::byte* from);
  /// The particles of all ranks at the places for which `wanted` is true, with these fields, no own columns, one rank
  /// after another, on the first rank; none on the others. Of a phase that is whole: its particles.
  PhaseParticles gathered(const FieldSet& fields, const std::function<bool(std::size_t)>& wanted) const;
  /// From now on archive() is of the particles of all ranks, one rank after another, or of those of this rank again.
  /// Each rank saves its own as rows. Loading leaves the particles as they are, until load_rows(). All ranks call it.
  void archive_all(bool all);
  /// Loads the rows first .. last - 1 of what archive() has found: from now on these are the particles of this rank.
  void load_rows(Archive& a, std::size_t first, std::size_t last);

  std::size_t bytes() const;  ///< memory of all columns

  /// Ids, all fields and the own columns that are kept, in the present order. Throws SceneError where an archive has
  /// another number of particles and the number may not change.
  void archive(Archive& a);

 private:
  void check([[maybe_unused]] Field field) const {
#ifndef NDEBUG
    AccessGuard::check(name_, field);
#endif
  }
  static std::size_t index(Field f) { return static_cast<std::size_t>(f); }
  std::size_t add_own_bytes(const std::string& name, std::size_t width, const void* of_new);
  void find_places();
  void archive_columns(Archive& a, const Rows& rows);

  std::string name_;
  int dimensions_;
  std::size_t size_;
  bool may_change_ = false, is_part_ = false, is_whole_ = false, archives_all_ = false, keeps_places_ = false,
       in_order_ = false;
  std::uint32_t arrangements_ = 0;
  long changes_ = 0;
  std::uint64_t all_ = 0, rows_at_ = 0;  // of archive_all(): particles of all ranks; place of their columns
  std::int64_t first_id_;
  double mass_, mean_radius_ = 0.0;
  std::vector<std::int64_t> id_, id_scratch_;
  std::array<std::vector<AlignedVector<double>>, field_count> columns_;
  std::vector<OwnValues> own_;
  AlignedVector<double> scratch_;
  AlignedVector<std::byte> own_scratch_;  // as wide as the widest own column
  std::vector<std::uint32_t> places_, order_;
};

}  // namespace barchan
