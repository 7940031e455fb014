// What the plan makes of a scene's probes, profiles, grids and wall shear: places, intervals, files.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "models/layout.hpp"
#include "scene/scene.hpp"

namespace barchan {

enum class InstrumentKind { probe, gauge, line, slices, grid, wall_shear, saltation };

/// What says the shear stress of a wall.
enum class ShearOf {
  slope,   // the slope of the velocity at the wall
  rough,   // the logarithmic law of the wall's roughness, as the fluid's own pass applies it
  layers,  // the layers of the wind over sand (models/coupling/sand_layer.hpp)
};

/// One instrument. It has rows: places for which it keeps averages, one line each in its files.
///
/// Fluids are interpolated at `points`, `points_per_row` consecutive ones a row, whose mean is the row's sample. Slices
/// have no points: the particles in [low, high), cut into rows along `axis`, are samples themselves.
struct Instrument {
  InstrumentKind kind = InstrumentKind::probe;
  std::string name;
  std::string stem;       // of its files: "profile_NAME"
  std::size_t phase = 0;  // number of the phase that is measured
  std::string phase_name;
  double every = 0, start = 0;  // s
  int dimensions = 2;
  bool has_pressure = true;  // grains have none
  std::vector<Vec3> rows;    // m: place of each row
  std::vector<Vec3> points;  // m
  std::size_t points_per_row = 1;

  // interpolation
  KernelKind kernel = KernelKind::wendland_c2;
  double radius = 0;  // m, of the phase with itself; at a wall half as much again

  // slices; of a gauge the axis of heights, along which its points stand, lowest first
  std::size_t axis = 1;
  Vec3 low{}, high{};  // m

  // grid
  std::array<std::size_t, 3> count{1, 1, 1};
  Vec3 step{};  // m

  // wall shear
  ShearOf shear = ShearOf::slope;
  std::size_t wall = 0;       // number of the wall's phase
  std::vector<Vec3> normals;  // by point: of the surface, into the fluid
  double viscosity = 0;       // Pa s, dynamic; with what artificial viscosity adds
  double density = 0;         // kg/m3, at rest
  double roughness = 0;       // m, z0 of the wall
  double spacing = 0;         // m, of the fluid
  Bounds domain{};            // along which the layers of a wind over sand stand
  double bed = 0;             // m over the ground, where the wind's layers have the stress that reaches the bed

  // saltation: slices of the domain's height
  double diameter = 0, flight = 0;      // m, mean; what is higher over the bed is in flight
  bool hops = false;                    // a model counts the hops of its grains (models/grains/hops.hpp)
  double area = 0;                      // m2, of the ground (2D: of a metre of depth)
  int air = -1;                         // number of the phase of air without particles around the grains; -1: none
  std::optional<LogProfile> held_wind;  // of that air, where its logarithmic profile is held: the speed at any height

  /// Numbers that a sample of a row has: velocity (or shear stress) by component, pressure; slices have the distance
  /// from the row's place before them.
  std::size_t quantities() const {
    if (kind == InstrumentKind::gauge) return 1;      // the height of the surface
    if (kind == InstrumentKind::saltation) return 5;  // measurements_saltation.cpp
    if (over_sand()) return 2;                        // measurements_ground.cpp
    return static_cast<std::size_t>(dimensions) + (kind == InstrumentKind::slices ? 2 : 1);
  }
  /// Followed in time, row by row, in a file of its own.
  bool in_time() const { return kind == InstrumentKind::probe || kind == InstrumentKind::gauge; }
  /// Wall shear that the layers of a wind over sand say.
  bool over_sand() const { return kind == InstrumentKind::wall_shear && shear == ShearOf::layers; }
  /// Slices of grains: their flux is summed by row.
  bool has_flux() const { return kind == InstrumentKind::slices && !has_pressure; }
  std::vector<std::string> files() const;
};

/// Carries a checked scene's requests out: only here is decided where and when is measured. The phases' sound speeds
/// are what artificial viscosity needs.
std::vector<Instrument> make_instruments(const Scene& scene, const Layout& layout);

std::string kind_name(InstrumentKind kind);  ///< the scene's word, "wall-shear"
/// "profile mid (air, 41 rows, every 0.001 s from 0.02 s)".
std::string to_text(const Instrument& instrument);
/// Kinds of instrument that the scene does not ask for, by their words.
std::vector<std::string> not_measured(const std::vector<Instrument>& instruments);

}  // namespace barchan
