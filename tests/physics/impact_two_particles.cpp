// Two particles collide: against the exact motion.
//
// With eq. (12) of Halik et al. 2015, rho(r) = rho0 + m (W(r) - W(r0)) is an exact integral of the continuity equation,
// and with p = (K/rho0)(rho - rho0) and Hooke's law (2G) the stress along the line of centres is a function of rho
// alone:
//   sigma = -[(K/rho0)(rho - rho0) + (4G/3) ln(rho/rho0)].
// So the motion is conservative: whatever E and h, A stops and B goes on with V. Turning point and duration follow by
// quadrature of  1/4 m V^2 = 2 m int (-sigma)/rho^2 drho.
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

constexpr double dx = 1e-3, speed = 10.0;  // m, m/s: as the scene has them

struct Impact {
  const char* name;
  double young;     // Pa
  double radius;    // of a-b, in spacings
  double nearest;   // r_min/dx, exact
  double duration;  // contact time V/dx, exact
};
void PrintTo(const Impact& impact, std::ostream* out) { *out << impact.name; }

/// What was seen of a collision.
struct Seen {
  double nearest = 1e300, duration = 0, restitution = 0, momentum_drift = 0;
  long steps = 0;  // in contact
};

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

/// Lets them collide. B starts 0.02 spacings beyond the kernel, so that little time goes by before they meet.
Seen collide(const Impact& impact, std::vector<std::string> overrides = {}) {
  const double young = impact.young, gap = impact.radius + 0.02;
  for (const char* body : {"a", "b"}) overrides.push_back(std::string("phases.") + body + ".young=" + number(young));
  overrides.push_back("interactions.a-b=" + number(impact.radius));
  overrides.push_back("fill.1.shape.points=[[" + number(0.002 + gap * dx) + ", 0.002, 0.002]]");
  Drive drive("verification/two_particle_impact", overrides);
  auto& simulation = drive.simulation();
  const auto& a = drive.phase(0);
  const auto& b = drive.phase(1);
  const auto distance = [&] { return b.column(Field::position)[0] - a.column(Field::position)[0]; };
  const auto momentum = [&] { return a.column(Field::velocity)[0] + b.column(Field::velocity)[0]; };
  const double edge = impact.radius * dx, before = momentum();
  Seen seen;
  double entered = -1;
  for (double r = distance(), t = 0; entered < 0 || r < edge;) {
    simulation.step(1.0);
    const double r_new = distance(), t_new = simulation.time();
    const double crossing = t + (t_new - t) * (r - edge) / (r - r_new);
    if (r >= edge && r_new < edge) entered = crossing;
    if (r < edge && r_new >= edge) seen.duration = (crossing - entered) * speed / dx;
    if (entered >= 0) ++seen.steps;
    seen.nearest = std::min(seen.nearest, r_new / dx);
    seen.momentum_drift = std::max(seen.momentum_drift, std::abs(momentum() / before - 1));
    r = r_new;
    t = t_new;
    if (t > 3 * dx / speed) break;
  }
  seen.restitution = (b.column(Field::velocity)[0] - a.column(Field::velocity)[0]) / speed;
  return seen;
}

class TwoParticles : public ::testing::TestWithParam<Impact> {};

TEST_P(TwoParticles, TurnRoundWhereAndWhenTheExactMotionDoes) {
  const Impact& exact = GetParam();
  const Seen seen = collide(exact);
  report("nearest, relative error", seen.nearest / exact.nearest - 1, 0.01);
  report("contact time, relative error", seen.duration / exact.duration - 1, 0.01);
  report("restitution - 1", seen.restitution - 1, 1e-3);
  report("momentum drift", seen.momentum_drift, 1e-12);
  EXPECT_NEAR(seen.nearest, exact.nearest, 0.01 * exact.nearest);
  // The depth of the contact is a sharper measure than the distance: stiff bodies overlap by a hundredth of a spacing.
  EXPECT_NEAR(exact.radius - seen.nearest, exact.radius - exact.nearest, 0.01 * (exact.radius - exact.nearest));
  EXPECT_NEAR(seen.duration, exact.duration, 0.01 * exact.duration);
  EXPECT_NEAR(seen.restitution, 1.0, 1e-3);
  EXPECT_LE(seen.momentum_drift, 1e-12);
}

const Impact impacts[] = {
    {"Steel_17a", 206e9, 2.4, 2.0838, 0.7681},
    {"Steel_17b", 206e9, 1.0, 0.9452, 0.1334},
    {"Rigid_17a", 206e12, 2.4, 2.3002, 0.2428},
    {"Rigid_17b", 206e12, 1.0, 0.9827, 0.0422},
};
INSTANTIATE_TEST_SUITE_P(Section5, TwoParticles, ::testing::ValuesIn(impacts),
                         [](const auto& test) { return std::string(test.param.name); });

/// What restitution misses comes from the volumes in the strain, which are those of the step's beginning: of first
/// order.
TEST(TwoParticlesConvergence, RestitutionErrorFallsWithTheStep) {
  double error[3];
  const char* const safety[] = {"time.safety=4", "time.safety=2", "time.safety=1"};
  for (int k = 0; k < 3; ++k) error[k] = std::abs(collide(impacts[1], {safety[k]}).restitution - 1);
  report("restitution - 1 at four times the step", error[0], 1e-3);
  report("at twice the step", error[1], 1e-3);
  report("at the step", error[2], 1e-3);
  EXPECT_LT(error[2], 0.6 * error[1]);
  EXPECT_LT(error[1], 0.6 * error[0]);
}

/// Monaghan's viscosity on approach lowers the restitution to a value that depends on alpha alone.
TEST(TwoParticlesDamped, RestitutionFollowsMonaghansAlpha) {
  const struct {
    const char* alpha;
    double low, high;
  } cases[] = {{"0.5", 0.855, 0.863}, {"1", 0.743, 0.757}, {"5", 0.355, 0.366}, {"20", 0.116, 0.119}};
  for (const auto& c : cases)
    for (const Impact& impact : impacts) {
      const auto key = [&](const char* body) {
        return std::string("phases.") + body + ".artificial-viscosity=" + c.alpha;
      };
      const Seen seen = collide(impact, {key("a"), key("b")});
      report(std::string("restitution at alpha = ") + c.alpha, seen.restitution, 0.5 * (c.low + c.high));
      EXPECT_GT(seen.restitution, c.low - 0.01);
      EXPECT_LT(seen.restitution, c.high + 0.01);
      EXPECT_LE(seen.momentum_drift, 1e-12);
    }
}

}  // namespace
}  // namespace barchan
