// The one table of fields. Writers, readers, the checkpoint and the documentation all use it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace barchan {

/// The rows, one a field: name, symbol, unit, rank, meaning. A name is also that of the enumerator and of the field in
/// files and in a scene's output.fields.
// clang-format off
#define BARCHAN_FIELDS(row) \
  row(position, "x", "m", vector, "place of the particle") \
  row(velocity, "v", "m/s", vector, "velocity; between steps half a step behind the position") \
  row(density, "rho", "kg/m3", scalar, "density") \
  row(pressure, "p", "Pa", scalar, "pressure from the equation of state") \
  row(acceleration, "a", "m/s2", vector, "total acceleration of the last pass") \
  row(density_rate, "drho/dt", "kg/m3/s", scalar, "rate of change of the density") \
  row(velocity_gradient, "grad v", "1/s", matrix, "velocity gradient, row-major: of a fluid on request, corrected to first order; of an updated Lagrangian body") \
  row(stress, "s", "Pa", symmetric, "deviatoric stress, xx yy zz xy yz xz") \
  row(energy, "e", "J/kg", scalar, "specific internal energy") \
  row(energy_rate, "de/dt", "W/kg", scalar, "rate of change of the internal energy") \
  row(shift_velocity, "du", "m/s", vector, "transport velocity less the velocity (particle shifting)") \
  row(anisotropy, "A", "1", deviator, "weights that make the last step's Laplacian isotropic; 2D: xx xy, 3D: xx yy zz xy yz xz") \
  row(wholeness, "chi", "1", scalar, "of a fluid with a free surface: about 1 inside, below 0.33 (plain scheme 0.55) at its surface") \
  row(surface_normal, "n", "1/m", vector, "of a fluid with a free surface: direction inwards near the surface, zero elsewhere") \
  row(near_void, "n_v", "1", scalar, "of a fluid of the consistent scheme that fills its space: steps for which the particle counts as next to a void, 0 in whole fluid") \
  row(eddy_viscosity, "nu_t", "m2/s", scalar, "kinematic viscosity of the unresolved turbulence") \
  row(turbulent_kinetic_energy, "k", "m2/s2", scalar, "of a fluid with turbulence = \"k-omega\": kinetic energy of the unresolved turbulence") \
  row(specific_dissipation_rate, "omega", "1/s", scalar, "of a fluid with turbulence = \"k-omega\": dissipation of its turbulence over 0.09 k") \
  row(shear_rate, "|S|", "1/s", scalar, "of a fluid: root of 2 S:S, S the rate of strain") \
  row(ground_distance, "d", "m", scalar, "distance to the surface of the nearest wall or grain at rest") \
  row(wall_normal, "n", "1", vector, "unit normal of a wall particle, into the fluid") \
  row(wall_depth, "phi", "m", scalar, "distance of a wall particle behind the wall's surface, 0: unknown") \
  row(surface_velocity, "v_s", "m/s", vector, "of a particle of a rigid body in a fluid: velocity of the nearest place of the body's surface") \
  row(surface_acceleration, "a_s", "m/s2", vector, "of a particle of a rigid body in a fluid: the acceleration that the fluid's pressure follows") \
  row(drag_acceleration, "a_d", "m/s2", vector, "acceleration of a grain by the drag of a column of air") \
  row(smoothing_length, "h", "m", scalar, "half the kernel radius of the phase with itself") \
  row(radius, "r", "m", scalar, "of a sphere whose phase has sizes") \
  row(angular_velocity, "w", "1/s", axial, "of a sphere that rubs; in 2D about z") \
  row(contact_acceleration, "a_c", "m/s2", vector, "of a sphere: what its contacts gave in their last step; acceleration holds all the rest") \
  row(angular_acceleration, "dw/dt", "1/s2", axial, "of a sphere that rubs, in the last step of its contacts") \
  row(von_mises_stress, "s_v", "Pa", scalar, "of a body: the stress in one direction that distorts as much (von Mises)") \
  row(principal_stress, "s_1 s_2 s_3", "Pa", principal, "of a body: principal values of Cauchy's stress, the largest first; positive pulls") \
  row(strain, "E", "1", symmetric, "of a total Lagrangian body: strain of Green and Lagrange, xx yy zz xy yz xz") \
  row(contact_force, "F_c", "N", vector, "of an elastic body that touches bodies or walls by its particles: force of them on the particle in the last step; in 2D per metre of depth")
// clang-format on

#define BARCHAN_NAME(name, symbol, unit, rank, meaning) name,
enum class Field : int { BARCHAN_FIELDS(BARCHAN_NAME) count };
#undef BARCHAN_NAME
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
  std::string_view meaning;
};

#define BARCHAN_ROW(name, symbol, unit, rank, meaning) {Field::name, #name, symbol, unit, Rank::rank, meaning},
inline constexpr std::array<FieldInfo, field_count> field_table{{BARCHAN_FIELDS(BARCHAN_ROW)}};
#undef BARCHAN_ROW

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

}  // namespace barchan
