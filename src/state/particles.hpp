// The particles of a run: one block a phase, one array a component of a field, and only the planned fields.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/aligned.hpp"
#include "base/fields.hpp"
#include "base/vec3.hpp"
#include "state/access.hpp"
#include "state/archive.hpp"

namespace barchan {

/// The particles of one phase as a structure of arrays. Arrays hold size() values in the current (sorted) order; `id`
/// says which particle stands where.
class PhaseParticles {
 public:
  PhaseParticles(std::string name, int dimensions, std::size_t size, double mass, std::int64_t first_id);

  const std::string& name() const { return name_; }
  int dimensions() const { return dimensions_; }
  std::size_t size() const { return size_; }
  double mass() const { return mass_; }  ///< kg a particle (kg per metre of depth in 2D); of spheres of the mean radius
  /// Ids are from first_id() on, as many as there were particles at the start; some are gone where may_shrink().
  std::int64_t first_id() const { return first_id_; }
  /// kg, of the particle at a place: spheres have their own where the phase has the field radius.
  double mass_of(std::size_t k) const {
    if (!has(Field::radius)) return mass_;
    const double share = columns_[index(Field::radius)][0][k] / mean_radius_;
    return mass_ * share * share * share;
  }
  /// The radius of a sphere of mass() (m).
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

  std::vector<std::int64_t>& id() { return id_; }
  const std::vector<std::int64_t>& id() const { return id_; }

  /// Reorders every array: new[k] = old[order[k]]. Allocates nothing.
  void permute(const std::uint32_t* order);

  /// The first `size` particles of the arrays are there; what a larger size adds has no values yet. At most as many as
  /// at the start.
  void resize(std::size_t size);
  /// Particles may leave: an archive may hold fewer than there were at the start.
  void may_shrink() { may_shrink_ = true; }

  std::size_t bytes() const;  ///< memory of the arrays

  /// Ids and all fields, in the present order. Throws SceneError where an archive has another number of particles and
  /// the phase may not shrink, or more than there were at the start.
  void archive(Archive& a);

 private:
  static void check([[maybe_unused]] Field field) {
#ifndef NDEBUG
    AccessGuard::check(field);
#endif
  }
  static std::size_t index(Field f) { return static_cast<std::size_t>(f); }

  std::string name_;
  int dimensions_;
  std::size_t size_, start_size_;
  bool may_shrink_ = false;
  std::int64_t first_id_;
  double mass_, mean_radius_ = 1.0;
  std::vector<std::int64_t> id_, id_scratch_;
  std::array<std::vector<AlignedVector<double>>, field_count> columns_;
  AlignedVector<double> scratch_;
};

}  // namespace barchan
