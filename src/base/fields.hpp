// The one table of fields. Writers, readers, the checkpoint and the documentation all use it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace barchan {

enum class Field : int {
  position,
  velocity,
  density,
  pressure,
  acceleration,
  density_rate,
  velocity_gradient,
  stress,
  energy,
  energy_rate,
  shift_velocity,
  anisotropy,
  wholeness,
  surface_normal,
  eddy_viscosity,
  ground_distance,
  wall_normal,
  wall_depth,
  drag_acceleration,
  smoothing_length,
  radius,
  angular_velocity,
  contact_acceleration,
  angular_acceleration,
  von_mises_stress,
  principal_stress,
  strain,
  count
};
inline constexpr std::size_t field_count = static_cast<std::size_t>(Field::count);

/// deviator: symmetric, traceless (2 or 6 numbers); axial: about an axis (1 number in 2D, about z, or 3);
/// principal: three values.
enum class Rank { scalar, vector, deviator, symmetric, matrix, axial, principal };

struct FieldInfo {
  Field id;
  std::string_view name;  // as written to files and in a scene's output.fields
  std::string_view symbol;
  std::string_view unit;
  Rank rank;
  bool is_state;  // a step starts from it; false: a pass derives it anew (for a reader: nothing is chosen by it yet)
  std::string_view meaning;
};

inline constexpr std::array<FieldInfo, field_count> field_table{{
    {Field::position, "position", "x", "m", Rank::vector, true, "place of the particle"},
    {Field::velocity, "velocity", "v", "m/s", Rank::vector, true,
     "velocity; between steps half a step behind the position"},
    {Field::density, "density", "rho", "kg/m3", Rank::scalar, true, "density"},
    {Field::pressure, "pressure", "p", "Pa", Rank::scalar, true, "pressure from the equation of state"},
    {Field::acceleration, "acceleration", "a", "m/s2", Rank::vector, true, "total acceleration of the last pass"},
    {Field::density_rate, "density_rate", "drho/dt", "kg/m3/s", Rank::scalar, true, "rate of change of the density"},
    {Field::velocity_gradient, "velocity_gradient", "grad v", "1/s", Rank::matrix, false,
     "velocity gradient, row-major"},
    {Field::stress, "stress", "s", "Pa", Rank::symmetric, true, "deviatoric stress, xx yy zz xy yz xz"},
    {Field::energy, "energy", "e", "J/kg", Rank::scalar, true, "specific internal energy"},
    {Field::energy_rate, "energy_rate", "de/dt", "W/kg", Rank::scalar, false, "rate of change of the internal energy"},
    {Field::shift_velocity, "shift_velocity", "du", "m/s", Rank::vector, true,
     "transport velocity less the velocity (particle shifting)"},
    {Field::anisotropy, "anisotropy", "A", "1", Rank::deviator, true,
     "weights that make the last step's Laplacian isotropic; 2D: xx xy, 3D: xx yy zz xy yz xz"},
    {Field::wholeness, "wholeness", "chi", "1", Rank::scalar, true,
     "of a fluid with a free surface: about 1 inside, below 0.33 (plain scheme 0.55) at its surface"},
    {Field::surface_normal, "surface_normal", "n", "1/m", Rank::vector, true,
     "of a fluid with a free surface: direction inwards near the surface, zero elsewhere"},
    {Field::eddy_viscosity, "eddy_viscosity", "nu_t", "m2/s", Rank::scalar, true,
     "kinematic viscosity of the unresolved turbulence"},
    {Field::ground_distance, "ground_distance", "d", "m", Rank::scalar, false,
     "distance to the surface of the nearest wall or grain at rest"},
    {Field::wall_normal, "wall_normal", "n", "1", Rank::vector, true, "unit normal of a wall particle, into the fluid"},
    {Field::wall_depth, "wall_depth", "phi", "m", Rank::scalar, true,
     "distance of a wall particle behind the wall's surface, 0: unknown"},
    {Field::drag_acceleration, "drag_acceleration", "a_d", "m/s2", Rank::vector, true,
     "acceleration of a grain by the drag of a column of air"},
    {Field::smoothing_length, "smoothing_length", "h", "m", Rank::scalar, false,
     "half the kernel radius of the phase with itself"},
    {Field::radius, "radius", "r", "m", Rank::scalar, true, "of a sphere whose phase has sizes"},
    {Field::angular_velocity, "angular_velocity", "w", "1/s", Rank::axial, true,
     "of a sphere that rubs; in 2D about z"},
    {Field::contact_acceleration, "contact_acceleration", "a_c", "m/s2", Rank::vector, true,
     "of a sphere: what its contacts gave in their last step; acceleration holds all the rest"},
    {Field::angular_acceleration, "angular_acceleration", "dw/dt", "1/s2", Rank::axial, true,
     "of a sphere that rubs, in the last step of its contacts"},
    {Field::von_mises_stress, "von_mises_stress", "s_v", "Pa", Rank::scalar, false,
     "of a body: the stress in one direction that distorts as much (von Mises)"},
    {Field::principal_stress, "principal_stress", "s_1 s_2 s_3", "Pa", Rank::principal, false,
     "of a body: principal values of Cauchy's stress, the largest first; positive pulls"},
    {Field::strain, "strain", "E", "1", Rank::symmetric, false,
     "of a total Lagrangian body: strain of Green and Lagrange, xx yy zz xy yz xz"},
}};

constexpr const FieldInfo& info(Field f) { return field_table[static_cast<std::size_t>(f)]; }

constexpr int components(Rank rank, int dimensions) {
  switch (rank) {
    case Rank::scalar: return 1;
    case Rank::vector: return dimensions;
    case Rank::deviator: return dimensions == 2 ? 2 : 6;
    case Rank::symmetric: return 6;
    case Rank::matrix: return dimensions * dimensions;
    case Rank::axial: return dimensions == 2 ? 1 : 3;
    case Rank::principal: return 3;
  }
  return 0;
}

/// The field of this name, if there is one.
constexpr std::optional<Field> find_field(std::string_view name) {
  for (const auto& f : field_table)
    if (f.name == name) return f.id;
  return std::nullopt;
}

constexpr bool table_is_in_order() {
  for (std::size_t k = 0; k < field_count; ++k)
    if (static_cast<std::size_t>(field_table[k].id) != k) return false;
  return true;
}
static_assert(table_is_in_order(), "the table of fields must be in the order of enum Field");

}  // namespace barchan
