// What the scene of Poiseuille's flow measures, against the exact profile and the exact shear at the end.
#include <cmath>

#include "measure/measurements.hpp"
#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

constexpr double length = 1e-3, top_speed = 1.25e-5, wall_stress = 5e-5;  // m, m/s, Pa = F L rho/2

const std::vector<double>& values(const Table& table, const std::string& name) {
  for (const auto& f : table.fields)
    if (f.name == name) return f.values;
  throw std::out_of_range(name);
}

/// Largest |u - u_exact|/u_max of the mean velocity.
double profile_error(const Table& table) {
  double worst = 0;
  for (std::size_t k = 0; k < table.places.size(); ++k) {
    const double s = table.places[k][1] / length;
    worst = std::max(worst, std::abs(values(table, "velocity_mean")[3 * k] / top_speed - 4 * s * (1 - s)));
  }
  return worst;
}

double shear_error(const Table& table) {
  double worst = 0;
  for (std::size_t k = 0; k < table.places.size(); ++k)
    worst = std::max(worst, std::abs(values(table, "shear_stress_mean")[3 * k] / wall_stress - 1));
  return worst;
}

/// Nothing is tuned to these bounds: 1 % is asked. Measured: 0.0070 on the line (at the wall, where a linear fit meets
/// a parabola from one side), 0.0022 in the slices (the slip that the scheme leaves), 0.001 in the shear.
void measure(const std::vector<std::string>& overrides) {
  Drive drive("verification/poiseuille", overrides);
  Measurements measurements(drive.plan().instruments, drive.plan().bounds, {drive.scene().phases[0].density, 0.0});
  auto& simulation = drive.simulation();
  measurements.sample(simulation.state());
  while (simulation.time() < 1.0 * (1 - 1e-12)) {
    simulation.step(1.0 - simulation.time());
    measurements.sample(simulation.state());
  }
  for (std::size_t k = 0; k < measurements.instruments().size(); ++k) {
    const Instrument& i = measurements.instruments()[k];
    const Table t = measurements.table(k);
    if (i.kind == InstrumentKind::probe) continue;
    const double error = i.kind == InstrumentKind::wall_shear ? shear_error(t) : profile_error(t);
    report("largest error of " + i.stem, error, 0.01);
    EXPECT_LE(error, 0.01) << i.stem;
    EXPECT_GE(t.moments, 10) << i.stem;
  }
}

TEST(Measuring, PoiseuilleFlowAndItsShear) { measure({}); }
TEST(Measuring, PoiseuilleFlowOfDisturbedParticles) { measure({"fill.1.perturb=0.2"}); }

}  // namespace
}  // namespace barchan
