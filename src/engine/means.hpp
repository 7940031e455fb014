// What is subtracted from, or added to, all particles of a fluid alike: means over them and uniform accelerations.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "state/particles.hpp"

namespace barchan {

/// Subtracts the mean from the density rates: mass and volume of an enclosed fluid are given, and the truncation error
/// of the divergence must not change them.
void keep_mean_density(PhaseParticles& fluid);

/// Holds the mean velocity of a fluid along some axes, as a channel flow of constant mass flux is held: adds the
/// uniform acceleration that makes the mean velocity, half a step later, the wanted one.
struct BulkHold {
  std::array<bool, 3> axes{};            // along which
  std::array<std::uint8_t, 5> unused{};  // a checkpoint holds these bytes too: they must not be those of chance
  std::array<double, 3> velocity{};      // m/s, wanted mean
  std::array<double, 3> acceleration{};  // m/s2, what the last step added
  bool any() const { return axes[0] || axes[1] || axes[2]; }
};

/// Adds a uniform acceleration (m/s2) along an axis.
void accelerate(PhaseParticles& fluid, int axis, double amount);

/// Adds to fluids together the uniform acceleration with which their mean acceleration along an axis, by mass, is
/// `wanted` (m/s2).
void keep_momentum(std::span<PhaseParticles* const> fluids, int axis, double wanted);

/// All forces on the fluid must be in its acceleration; its velocities are half a step (dt/2) behind.
void hold_bulk_velocity(PhaseParticles& fluid, BulkHold& hold, double dt);

}  // namespace barchan
