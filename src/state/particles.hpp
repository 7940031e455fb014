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
  double mass() const { return mass_; }  ///< kg a particle (kg per metre of depth in 2D)

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

  std::size_t bytes() const;  ///< memory of the arrays

  void archive(Archive& a);  ///< ids and all fields, in the present order

 private:
  static void check([[maybe_unused]] Field field) {
#ifndef NDEBUG
    AccessGuard::check(field);
#endif
  }
  static std::size_t index(Field f) { return static_cast<std::size_t>(f); }

  std::string name_;
  int dimensions_;
  std::size_t size_;
  double mass_;
  std::vector<std::int64_t> id_, id_scratch_;
  std::array<std::vector<AlignedVector<double>>, field_count> columns_;
  AlignedVector<double> scratch_;
};

}  // namespace barchan
