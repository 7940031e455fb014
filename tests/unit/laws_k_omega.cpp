// Two equations of turbulence: what is known of their solutions in closed form.
#include "laws/k_omega.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace barchan {
namespace {

/// In the logarithmic layer G grad l is constant, grad k = 0 and |S| = u*/(kappa d). What is left of domega/dt is what
/// kappa = 0.4 differs by from the one of the constants, 0.4005.
TEST(KOmega, ALogarithmicLayerStays) {
  const double u = 0.4;
  for (const double d : {1e-3, 1e-2, 0.1}) {
    const double omega = log_layer_omega(u, d), energy = energy_of_friction_velocity(u), shear = u / (karman * d);
    EXPECT_NEAR(energy / limited_omega(omega, shear), karman * u * d, 1e-12) << "the limiter is silent";
    const KOmegaPlace place{energy, omega, shear, 0.0, 0.0, 0.0, 0.0, 1.0 / (d * d)};
    double k = 0.0, w = 0.0;
    step_k_omega(place, 1e-6 / omega, k, w);
    EXPECT_NEAR((k / energy - 1.0) / 1e-6, 0.0, 1e-6);
    EXPECT_NEAR((w / omega - 1.0) / 1e-6, 0.0, 2e-4);
  }
}

/// dk/dt = -beta* k omega, domega/dt = -beta omega^2: omega = omega0/(1 + beta omega0 t), k ~ omega^(beta*/beta).
TEST(KOmega, HomogeneousTurbulenceDecays) {
  double k = 1.0, omega = 100.0;
  const double dt = 1e-5, end = 0.5;
  for (int step = 0; step < static_cast<int>(std::lround(end / dt)); ++step) {
    const KOmegaPlace place{k, omega, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    step_k_omega(place, dt, k, omega);
  }
  const double exact = 100.0 / (1.0 + 0.0708 * 100.0 * end);
  EXPECT_NEAR(omega / exact, 1.0, 1e-3);
  EXPECT_NEAR(k / std::pow(exact / 100.0, 0.09 / 0.0708), 1.0, 1e-3);
}

TEST(KOmega, StaysPositiveWhateverTheStep) {
  for (const double dt : {1e-6, 1.0, 1e6}) {
    const KOmegaPlace place{1e-3, 50.0, 10.0, 1e-5, -1e3, -1e3, 0.0, 0.0};
    double k = 0.0, omega = 0.0;
    step_k_omega(place, dt, k, omega);
    EXPECT_GT(k, 0.0) << dt;
    EXPECT_GT(omega, 0.0) << dt;
  }
}

/// Beside the ground omega is that of the layer, or what the equation makes up to twice that: air that slows down
/// behind a crest has more.
TEST(KOmega, OmegaBesideTheGround) {
  const double u = 0.3, d = 5e-3, layer = log_layer_omega(u, d);
  EXPECT_EQ(omega_beside_ground(0.5 * layer, u, d), layer);
  EXPECT_EQ(omega_beside_ground(1.5 * layer, u, d), 1.5 * layer);
  EXPECT_EQ(omega_beside_ground(9.0 * layer, u, d), 2.0 * layer);
}

/// Heavy grains take k as exp(-2 s t), and 0.35 of that exponent of omega; grains that follow every eddy take nothing.
TEST(KOmega, GrainsTakeOfTheTurbulence) {
  const double rate = 10.0, dt = 1e-5, end = 0.05;
  double k = 1.0, omega = 300.0;
  for (int step = 0; step < static_cast<int>(std::lround(end / dt)); ++step)
    slow_eddies({rate, 0.2}, dt, k, omega);  // St = 32 and more
  EXPECT_NEAR(std::log(k) / (-2.0 * rate * end), 1.0, 2e-3);
  EXPECT_NEAR(std::log(omega / 300.0) / (-0.7 * rate * end), 1.0, 2e-3);
  k = 1.0;
  slow_eddies({rate, 1.0 / (6.0 * 0.09 * 300.0)}, dt, k, omega = 300.0);  // St = 1
  EXPECT_NEAR((1.0 - k) / (2.0 * rate * dt * (1.0 - std::exp(-0.25))), 1.0, 1e-3);
  k = 1.0;
  slow_eddies({rate, 0.0}, dt, k, omega);
  EXPECT_EQ(k, 1.0);
}

/// Where shear is fast the stress is at most sqrt(beta*)/(7/8) k.
TEST(KOmega, TheStressIsLimited) {
  const double k = 0.5, shear = 1e4;
  EXPECT_NEAR(k / limited_omega(1.0, shear) * shear, 0.3 / 0.875 * k, 1e-12);
}

/// A particle loses k by diffusion to those with less only, whatever the corrected operator says.
TEST(KOmega, DiffusionTakesNothingOfTheLeast) {
  EXPECT_EQ(diffused(-3.0, 5.0, 0.0), 0.0) << "all others have more";
  EXPECT_EQ(diffused(-3.0, 0.0, 5.0), 0.0) << "in either part";
  EXPECT_EQ(diffused(-3.0, 5.0, -1.0), -1.0);
  EXPECT_EQ(diffused(-3.0, 5.0, -4.0), -3.0) << "the corrected operator";
  EXPECT_EQ(diffused(2.0, 5.0, -1.0), 2.0);
}

/// A shift through a spacing carries away at most what is there.
TEST(KOmega, ShiftsCarryAwayNoMoreThanThereIs) {
  EXPECT_EQ(carried_at_most(-100.0, 0.5, 0.02, 1e-3), -10.0);
  EXPECT_EQ(carried_at_most(-1.0, 0.5, 0.02, 1e-3), -1.0);
  EXPECT_EQ(carried_at_most(100.0, 0.5, 0.02, 1e-3), 100.0);
}

/// In a logarithmic layer, from a quarter of a spacing over the ground on, the gradient of a flux is that of the
/// particle's own eddies: G grows as the distance, and the pairs' mean is at most 2.5 times it.
TEST(KOmega, FluxesAreDividedByOwnEddies) {
  for (const double d : {0.25, 0.5, 1.0, 3.0}) {
    double sum = 0.0, weights = 0.0;
    for (int row = 0; row <= 2; ++row) {
      const double weight = row == 0   ? 1.0
                            : row == 1 ? 2.0
                                       : 0.5,
                   pair = pair_viscosity(std::sqrt(d), std::sqrt(d + row));
      sum += weight * pair;
      weights += weight;
    }
    EXPECT_EQ(eddy_of_flux(d, sum / weights), d) << d;
  }
  EXPECT_EQ(eddy_of_flux(1e-30, 4.0), 1.0);
}

}  // namespace
}  // namespace barchan
