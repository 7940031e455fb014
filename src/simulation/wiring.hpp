// How a Simulation's phases are joined: what each verb walks over, made once from the plan.
#pragma once

#include "engine/means.hpp"
#include "models/air/surface.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

/// Closes the sides of the domain that the wall stands behind.
void close_sides(Sides& sides, const PhaseParticles& wall, const Bounds& bounds, double spacing);

/// A fluid phase: its entries and parameters.
struct Simulation::Fluid {
  std::size_t phase = 0;
  std::vector<FluidNeighbour> neighbours;
  FluidParameters parameters{};
  Sides held;                              // the domain's sides that a wall closes
  Relief relief;                           // curved ground
  std::unique_ptr<SurfaceFinder> surface;  // null: no free surface

  BlockMean mean;  // of an enclosed fluid's density rates, of a held fluid's velocity
  BulkHold hold;

  // a fluid with eddies
  std::vector<EddyNeighbour> eddy_neighbours;  // empty: none
  EddyParameters eddies;
  std::vector<const PhaseParticles*> ground_phases;
  std::unique_ptr<GroundDistance> ground;
  double largest_viscosity = 0;  // m2/s
  std::string viscous_limit;     // its name
};

/// A solid that some fluid sees: the fluids about it, and whether it feels them.
struct Simulation::Extension {
  std::size_t phase = 0;
  std::vector<ExtensionSource> sources;
  std::vector<FluidNeighbour> felt;  // for the reaction; empty for walls
  std::vector<std::size_t> felt_fluids;
  SurfaceBend bend;  // of a curved wall
};

/// One direction of a contact entry.
struct Simulation::Contact {
  std::size_t a = 0, b = 0;
  const PairList* list = nullptr;
  KernelKind kernel{};
  double radius = 0;
  KernelContact law{};
  bool is_repulsion = false;  // the paper's repulsive wall for a fluid
};

/// One direction of a fluid-grains entry with drag.
struct Simulation::Drag {
  std::size_t a = 0, b = 0;
  const PairList* list = nullptr;
  DragEntry entry{};
  bool a_is_fluid = false;
};

/// An elastic phase.
struct Simulation::Body {
  std::size_t phase = 0;
  std::vector<ElasticNeighbour> neighbours;
  ElasticParameters parameters{};
};

}  // namespace barchan
