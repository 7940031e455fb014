// Spheres against what two of them, or one on a plane, do exactly.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;
using testing::value;

const std::string pair_of = R"toml(
dimensions = 3
spacing = 1e-2
[domain]
size = [1, 1, 1]
[phases.balls]
kind = "grains"
density = 7870
diameter = 1e-2
[interactions]
balls-balls = {}
[[fill]]
phase = "balls"
shape = { points = [[0.49495, 0.5, 0.5]] }
velocity = [0.5, 0, 0]
[[fill]]
phase = "balls"
shape = { points = [[0.50505, 0.5, 0.5]] }
velocity = [-0.5, 0, 0]
[time]
end = 1
largest-speed = 1
)toml";

class Restitution : public ::testing::TestWithParam<std::tuple<std::string, double>> {};
INSTANTIATE_TEST_SUITE_P(Laws, Restitution,
                         ::testing::Combine(::testing::Values("linear", "hertz"),
                                            ::testing::Values(0.1, 0.3, 0.5, 0.7, 0.9, 1.0)));

TEST_P(Restitution, IsTheWrittenOneAtAnySpeed) {
  const auto& [law, e] = GetParam();
  for (const std::string speed : {"0.5", "0.05"}) {
    const auto run = small::simulation(
        pair_of, {"interactions.balls-balls.law=" + law, "phases.balls.restitution=" + std::to_string(e),
                  "fill.0.velocity=[" + speed + ", 0, 0]", "fill.1.velocity=[-" + speed + ", 0, 0]"});
    for (int k = 0; k < 100000 && run->phases()[0].column(Field::position)[0] >= 0.0; ++k) {
      run->step(1.0);
      if (value(*run, "contacts") == 0.0 && value(*run, "contacts_deepest") > 0.0) break;
    }
    const double after = value(*run, "balls_largest_speed [m/s]") / std::stod(speed);
    report(law + ", e = " + std::to_string(e) + ", 2 x " + speed + " m/s", std::abs(after / e - 1.0),
           e < 0.2 ? 1e-2 : 5e-3);
    EXPECT_NEAR(after, e, (e < 0.2 ? 1e-2 : 5e-3) * e);
    const double lost = value(*run, "contacts_lost_energy ["), kinetic = value(*run, "balls_kinetic_energy [");
    const double start = kinetic / (after * after);
    EXPECT_NEAR(kinetic + lost, start, 1e-2 * start) << "the budget of a head-on collision";
  }
}

struct HertzCase {
  const char* name;
  double diameter, density, young, poisson, overlap, duration;  // m, kg/m3, Pa, 1, m, s
};

// Overlap and duration of two equal spheres that meet with 1 m/s: Hertz's theory, delta = (15 m* v^2/(16 E* sqrt
// R*))^(2/5), t = 2.943275 delta/v (Landau & Lifshitz, Theory of elasticity, section 9).
TEST(HertzianSpheres, LastAndOverlapAsInTheory) {
  for (const HertzCase& c : {HertzCase{"steel", 1e-2, 7870, 206e9, 0.3, 10.310e-6, 30.345e-6},
                             HertzCase{"quartz", 2.5e-4, 2650, 70e9, 0.17, 0.26358e-6, 0.77577e-6},
                             HertzCase{"E = 1e8", 2.5e-4, 2650, 1e8, 0.3, 3.5290e-6, 10.387e-6},
                             HertzCase{"E = 1e7", 2.5e-4, 2650, 1e7, 0.3, 8.8645e-6, 26.091e-6}}) {
    const auto text = [](double x) {
      char t[32];
      std::snprintf(t, sizeof t, "%.17g", x);
      return std::string(t);
    };
    const double gap = 0.3 * c.overlap;
    const auto run = small::simulation(
        pair_of, {"interactions.balls-balls.law=hertz", "phases.balls.restitution=1",
                  "phases.balls.diameter=" + text(c.diameter), "phases.balls.density=" + text(c.density),
                  "phases.balls.young=" + text(c.young), "phases.balls.poisson=" + text(c.poisson),
                  "time.step=" + text(c.duration / 2000),
                  "fill.0.shape={ points = [[" + text(0.5 - 0.5 * (c.diameter + gap)) + ", 0.5, 0.5]] }",
                  "fill.1.shape={ points = [[" + text(0.5 + 0.5 * (c.diameter + gap)) + ", 0.5, 0.5]] }"});
    double first = 0.0, last = 0.0;
    for (int k = 0; k < 4000; ++k) {
      run->step(1.0);
      if (value(*run, "contacts") == 0.0) continue;
      if (first == 0.0) first = run->time();
      last = run->time();
    }
    const double overlap = value(*run, "contacts_deepest") * c.diameter, duration = last - first + c.duration / 2000;
    report(std::string(c.name) + ", overlap", std::abs(overlap / c.overlap - 1.0), 5e-3);
    report(std::string(c.name) + ", duration", std::abs(duration / c.duration - 1.0), 5e-3);
    EXPECT_NEAR(overlap, c.overlap, 5e-3 * c.overlap);
    EXPECT_NEAR(duration, c.duration, 5e-3 * c.duration);
  }
}

/// One ball on a floor; gravity leans by the formula of the test.
std::string on_a_floor(int dimensions, const std::string& law) {
  const bool flat = dimensions == 2;
  return std::string("dimensions = ") + (flat ? "2" : "3") + R"toml(
spacing = 1e-2
[domain]
size = )toml" +
         (flat ? "[2, 0.1]" : "[2, 0.1, 0.1]") + R"toml(
periodic = )toml" +
         (flat ? R"(["x"])" : R"(["x", "z"])") + R"toml(
gravity = )toml" +
         (flat ? "[0, -10]" : "[0, -10, 0]") + R"toml(
[phases.ball]
kind = "grains"
density = 2500
diameter = 1e-2
restitution = 0.3
friction = 0.4
[phases.floor]
kind = "wall"
[interactions]
ball-floor = { law = ")toml" +
         law + R"toml(" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"], layers = 1 }
[[fill]]
phase = "ball"
shape = { points = [)toml" +
         (flat ? "[0.5, 0.005]" : "[0.5, 0.005, 0.05]") + R"toml(] }
velocity = )toml" +
         (flat ? "[1, 0]" : "[0.6, 0, 0.8]") + R"toml(
[time]
end = 10
largest-speed = 1
)toml";
}

class OnAFloor : public ::testing::TestWithParam<std::tuple<int, std::string>> {};
INSTANTIATE_TEST_SUITE_P(All, OnAFloor,
                         ::testing::Combine(::testing::Values(2, 3), ::testing::Values("linear", "hertz")));

double speed_along(const Simulation& run) {
  const auto& p = run.phases()[0];
  const double u = p.column(Field::velocity, 0)[0], w = p.dimensions() == 3 ? p.column(Field::velocity, 2)[0] : 0.0;
  return std::hypot(u, w);
}

TEST_P(OnAFloor, SlidesUntilItRollsWithFiveSevenths) {
  const auto& [dimensions, law] = GetParam();
  const auto run = small::simulation(on_a_floor(dimensions, law));
  // It slides with v - mu g t until 2 v/(7 mu g) = 0.0714 s.
  while (run->time() < 0.04) run->step(0.04 - run->time());
  report("speed while it slides", std::abs(speed_along(*run) / 0.84 - 1.0), 0.01);
  EXPECT_NEAR(speed_along(*run), 0.84, 0.0084);
  while (run->time() < 0.12) run->step(0.12 - run->time());
  report("speed when it rolls", std::abs(speed_along(*run) * 1.4 - 1.0), 0.01);
  EXPECT_NEAR(speed_along(*run), 5.0 / 7.0, 0.01 * 5.0 / 7.0);
  const auto& p = run->phases()[0];
  double spin = 0.0;
  for (int d = 0; d < p.components(Field::angular_velocity); ++d)
    spin = std::hypot(spin, p.column(Field::angular_velocity, d)[0]);
  EXPECT_NEAR(spin * 5e-3, 5.0 / 7.0, 0.01) << "it rolls without slip";
  EXPECT_LT(p.column(Field::angular_velocity, dimensions == 2 ? 0 : 2)[0], 0.0) << "to the right: clockwise about z";
}

TEST_P(OnAFloor, RollsSlidesOrStaysOnASlope) {
  const auto& [dimensions, law] = GetParam();
  const double g = 10.0;
  const auto after = [&, dim = dimensions, name = law](double degrees, const std::string& extra) {
    const double t = degrees * std::numbers::pi / 180.0;
    const std::string x = std::to_string(g * std::sin(t)), y = std::to_string(-g * std::cos(t));
    const auto run = small::simulation(on_a_floor(dim, name),
                                       {"domain.gravity=[" + x + ", " + y + (dim == 3 ? ", 0]" : "]"),
                                        std::string("fill.1.velocity=") + (dim == 3 ? "[0, 0, 0]" : "[0, 0]"), extra});
    while (run->time() < 0.2) run->step(0.2 - run->time());
    return run->phases()[0].column(Field::velocity, 0)[0] / 0.2;
  };
  const auto radians = [](double degrees) { return degrees * std::numbers::pi / 180.0; };
  const double rolls = 5.0 / 7.0 * g * std::sin(radians(20.0));
  EXPECT_NEAR(after(20.0, "title=rolls"), rolls, 0.01 * rolls);
  // Above tan a = 7/2 mu it slides.
  const double slides = g * (std::sin(radians(65.0)) - 0.4 * std::cos(radians(65.0)));
  EXPECT_NEAR(after(65.0, "title=slides"), slides, 0.01 * slides);
  // Rolling resistance of 0.2 holds it up to atan 0.2 = 11.3 degrees, and takes 5/7 of its share beyond.
  EXPECT_NEAR(after(10.0, "phases.ball.rolling-friction=0.2"), 0.0, 2e-3);
  const double held = 5.0 / 7.0 * g * (std::sin(radians(20.0)) - 0.2 * std::cos(radians(20.0)));
  EXPECT_NEAR(after(20.0, "phases.ball.rolling-friction=0.2"), held, 0.015 * held);
}

TEST(ObliqueImpact, OfGrossSlidingIsThatOfCoulomb) {
  // A ball meets a floor at 10 degrees from it... it slides throughout where tan(angle of incidence) > 7/2 mu (1 + e):
  // then dv_t = -mu (1 + e) v_n and the spin is 5/2 mu (1 + e) v_n/r (Walton 1993).
  for (const std::string law : {"linear", "hertz"}) {
    const auto run = small::simulation(
        on_a_floor(3, law), {"domain.gravity=[0, 0, 0]", "fill.1.shape={ points = [[0.5, 0.00502, 0.05]] }",
                             "fill.1.velocity=[2, -0.3, 0]", "phases.ball.restitution=0.6", "time.largest-speed=2"});
    for (int k = 0; k < 100000; ++k) {
      run->step(1.0);
      if (value(*run, "contacts_deepest") > 0.0 && value(*run, "contacts") == 0.0) break;
    }
    const double push = 0.4 * 1.6 * 0.3;
    const auto& p = run->phases()[0];
    EXPECT_NEAR(p.column(Field::velocity, 1)[0], 0.18, 0.01 * 0.18);
    EXPECT_NEAR(2.0 - p.column(Field::velocity, 0)[0], push, 0.01 * push);
    EXPECT_NEAR(p.column(Field::angular_velocity, 2)[0], -2.5 * push / 5e-3, 0.01 * 2.5 * push / 5e-3);
  }
}

/// What is left along the surfaces of two balls that meet with 1 m/s along the line of their centres and `along` (m/s)
/// across it: the mean over phases of the first touch.
double along_after(double along, const std::vector<std::string>& material) {
  constexpr int phases = 8;
  double sum = 0.0;
  const auto place = [](double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.12g", x);
    return std::string(text);
  };
  for (int k = 0; k < phases; ++k) {
    const double gap = 1e-8 + 2.5e-7 * (k + 0.5) / phases;  // m, half of it; a step of the contacts goes 5e-7 m
    std::vector<std::string> all{"interactions.balls-balls.law=linear",
                                 "phases.balls.largest-overlap=2e-4",
                                 "fill.0.shape={ points = [[" + place(0.495 - gap) + ", 0.5, 0.5]] }",
                                 "fill.1.shape={ points = [[" + place(0.505 + gap) + ", 0.5, 0.5]] }",
                                 "fill.0.velocity=[0.5, " + std::to_string(0.5 * along) + ", 0]",
                                 "fill.1.velocity=[-0.5, " + std::to_string(-0.5 * along) + ", 0]"};
    all.insert(all.end(), material.begin(), material.end());
    const auto run = small::simulation(pair_of, all);
    for (int n = 0; n < 100000; ++n) {
      run->step(1.0);
      if (value(*run, "contacts_deepest") > 0.0 && value(*run, "contacts") == 0.0) break;
    }
    const auto& p = run->phases()[0];
    const double *v = p.column(Field::velocity, 1), *w = p.column(Field::angular_velocity, 2);
    sum += (v[0] - v[1] + 5e-3 * (w[0] + w[1])) / phases;
  }
  return sum;
}

struct Beads {
  const char* material;
  double restitution, friction, back, scatter;  // e, mu, beta0 and its scatter
};

// Foerster, Louge, Chang & Allia 1994, table II: balls of 3 mm of glass and of 6 mm of cellulose acetate, two of a
// kind. Where they stick, the speed across is turned to -beta0 of it: the slope of a line through their impacts. Where
// they slide, it loses 7/2 mu (1 + e) of the speed along the centres.
TEST(ObliqueImpact, OfGlassAndAcetateIsThatOfFoerster) {
  for (const Beads& b :
       {Beads{"glass-beads", 0.97, 0.092, 0.44, 0.07}, Beads{"cellulose-acetate", 0.87, 0.25, 0.43, 0.06}}) {
    const std::vector<std::string> material{"phases.balls.material=" + std::string(b.material)};
    const double slides = 3.5 * (1.0 + b.restitution) * b.friction / (1.0 + b.back);
    double products = 0.0, squares = 0.0;
    for (const double share : {0.05, 0.1, 0.2, 0.3, 0.4, 0.5}) {
      const double left = along_after(share * slides, material);
      report(std::string(b.material) + ", beta0 at " + std::to_string(share), -left / (share * slides), b.back);
      products -= left * share * slides;
      squares += share * slides * share * slides;
    }
    EXPECT_NEAR(products / squares, b.back, 0.3 * b.scatter) << b.material;
    for (const double along : {2.5 * slides, 4.0 * slides}) {
      const double expected = along - 3.5 * b.friction * (1.0 + b.restitution);
      EXPECT_NEAR(along_after(along, material), expected, 0.02 * expected) << b.material << " " << along;
    }
    const double two_sevenths =
        -along_after(0.1 * slides, {material[0], "phases.balls.tangential-stiffness=0.285714285714"}) / (0.1 * slides);
    report(std::string(b.material) + ", with 2/7", two_sevenths, 1.0);
    EXPECT_GT(two_sevenths, b.back + 5.0 * b.scatter);
  }
}

TEST(ObliqueImpact, ASofterSpringAcrossTurnsLessBack) {
  double before = 1.0;
  for (const char* stiffness : {"0.25", "0.2", "0.15", "0.1"}) {
    const double left = along_after(0.2, {"phases.balls.restitution=0.95", "phases.balls.friction=0.5",
                                          std::string("phases.balls.tangential-stiffness=") + stiffness});
    EXPECT_LT(-left / 0.2, before) << stiffness;
    before = -left / 0.2;
  }
  EXPECT_LT(before, 0.5);
}

/// A set of grains by their places at the start: its mean place follows them, in whatever order memory has them.
TEST(Markers, FollowGrains) {
  std::string points = "[0.1, 0.1, 0.1]";
  for (int k = 1; k < 40; ++k) {
    const double x = 0.1 + 0.02 * k;
    points += ", [" + std::to_string(x) + ", " + std::to_string(0.1 + 0.37 * k - std::floor(0.37 * k)) + ", 0.5]";
  }
  const auto run = small::simulation(
      pair_of + "[[marker]]\nname = \"left\"\nphase = \"balls\"\nbox = { min = [0, 0, 0], max = [0.5, 2, 1] }\n",
      {"domain.size=[1, 2, 1]",
       "fill=[{ phase = \"balls\", shape = { points = [" + points +
           "] }, velocity = [0, 0, 0.2] }, { phase = \"balls\", shape = { points = [[0.9, 0.05, 0.1]] }, velocity = "
           "[0, 0, 5] }]",
       "interactions.balls-balls.law=linear", "time.largest-speed=6"});
  const double start = value(*run, "left_z"), along = value(*run, "left_x");
  EXPECT_LT(along, 0.5);
  testing::run_to(*run, 0.1);
  EXPECT_NEAR(value(*run, "left_z") - start, 0.02, 1e-9);
  EXPECT_NEAR(value(*run, "left_x"), along, 1e-9);
}

TEST(Spheres, KeepMomentumAndAngularMomentum) {
  // A cloud of rough spheres that collide in free space.
  for (const std::string law : {"linear", "hertz"}) {
    const auto run = small::simulation(R"toml(
dimensions = 3
spacing = 1e-3
[domain]
size = [0.1, 0.1, 0.1]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.3 }
friction = 0.5
[interactions]
sand-sand = { law = ")toml" + law + R"toml(" }
[[fill]]
phase = "sand"
shape = { sphere = { centre = [0.05, 0.05, 0.05], radius = 0.008 } }
velocity = ["-80*(x - 0.05) + 100*(y - 0.05)", "-80*(y - 0.05) - 90*(z - 0.05)", "-80*(z - 0.05)"]
[time]
end = 1
largest-speed = 2
)toml");
    const auto momenta = [&] {
      std::array<double, 6> sum{};
      const auto& p = run->phases()[0];
      for (std::size_t k = 0; k < p.size(); ++k) {
        const double m = p.mass_of(k), r = p.column(Field::radius)[k];
        for (int d = 0; d < 3; ++d) {
          const int e = (d + 1) % 3, f = (d + 2) % 3;
          const auto x = [&](int c) { return p.column(Field::position, c)[k] - 0.05; };
          const auto v = [&](int c) { return p.column(Field::velocity, c)[k]; };
          sum[static_cast<std::size_t>(d)] += m * v(d);
          sum[3 + static_cast<std::size_t>(d)] +=
              m * (x(e) * v(f) - x(f) * v(e)) + 0.4 * m * r * r * p.column(Field::angular_velocity, d)[k];
        }
      }
      return sum;
    };
    const auto start = momenta();
    const double energy = value(*run, "sand_kinetic_energy [");
    while (run->time() < 0.008) run->step(0.008 - run->time());
    const auto end = momenta();
    const double left = value(*run, "sand_kinetic_energy [") + value(*run, "rotation_energy [");
    EXPECT_GT(value(*run, "contacts_lost_energy ["), 0.2 * energy);
    report("budget of rough spheres, " + law,
           std::abs((left + value(*run, "contacts_lost_energy [") + value(*run, "contacts_stored_energy [")) / energy -
                    1.0),
           0.01);
    EXPECT_NEAR(left + value(*run, "contacts_lost_energy [") + value(*run, "contacts_stored_energy ["), energy,
                0.01 * energy);
    const double scale = std::sqrt(2.0 * energy * 2650.0 * 2e-6);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(end[k], start[k], 1e-10 * scale);
    for (std::size_t k = 3; k < 6; ++k) EXPECT_NEAR(end[k], start[k], 1e-10 * scale * 0.008);
  }
}

TEST(Spheres, KeepTheirEnergyWithoutFrictionAndLoss) {
  // A periodic gas in which every sphere collides many times. The long run, 10^4 spheres and 10^5 steps, is that of
  // bench/grains.
  for (const std::string law : {"linear", "hertz"}) {
    const auto run = small::simulation(R"toml(
dimensions = 3
spacing = 1e-3
[domain]
size = [0.01, 0.01, 0.01]
periodic = ["x", "y", "z"]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
restitution = 1
[interactions]
sand-sand = { law = ")toml" + law + R"toml(" }
[[fill]]
phase = "sand"
shape = { box = { min = [0, 0, 0], max = [0.01, 0.01, 0.007] } }
velocity = ["sin(2000*x + 1500*y)", "cos(1700*y + 2300*z)", "sin(1900*z + 1300*x)"]
[time]
end = 1

largest-speed = 2
)toml");
    const auto energy_now = [&] {
      return value(*run, "sand_kinetic_energy [") + value(*run, "contacts_stored_energy [");
    };
    const double energy = energy_now();
    for (int k = 0; k < 1000; ++k) run->step(1.0);
    const double now = energy_now();
    report("energy of smooth spheres, " + law, std::abs(now / energy - 1.0), 1e-3);
    EXPECT_NEAR(now, energy, 1e-3 * energy);
    EXPECT_EQ(run->phases()[0].has(Field::angular_velocity), false);
  }
}

/// A free sphere in a field of force.
const std::string forced = R"toml(
spacing = 2e-3
[domain]
size = [0.2, 0.2]
[phases.ball]
kind = "grains"
density = 2500
diameter = 2e-3
stiffness = 20
restitution = 1
[interactions]
ball-ball = { law = "linear" }
[[fill]]
phase = "ball"
shape = { points = [[0.15, 0.1]] }
[[forcing]]
phase = "ball"
acceleration = ["-400*(x - 0.1)", 0]
[time]
end = 1000
largest-speed = 1.2
)toml";

double of_ball(const Simulation& run, Field field, int axis = 0) { return run.phases()[0].column(field, axis)[0]; }

// Ten steps a period, 1,000 periods. Velocity Verlet keeps v^2/2 + w^2 x^2/2 (1 - (w dt)^2/4) of a trap exactly; with a
// force held from the begin of the step the energy grew by exp(w^2 dt t/2), in one period by 7.
TEST(ForcedSpheres, KeepTheEnergyOfATrap) {
  const double w = 20.0, dt = 2.0 * std::numbers::pi / w / 10.0, share = 1.0 - 0.25 * w * w * dt * dt;
  const auto run = small::simulation(forced, {"time.step=" + std::to_string(dt)});
  const auto energy = [&] {
    return 0.5 * std::pow(of_ball(*run, Field::velocity), 2) +
           0.5 * share * std::pow(w * (of_ball(*run, Field::position) - 0.1), 2);
  };
  const double start = energy();
  double worst = 0.0;
  for (int k = 0; k < 10000; ++k) {
    run->step(1e6);
    worst = std::max(worst, std::abs(energy() / start - 1.0));
  }
  report("energy of a trap, 1,000 periods of ten steps", worst, 1e-3);
  EXPECT_LT(worst, 1e-3);
}

// A circle about a centre whose pull falls with the square of the distance, for a hundred turns: the speed stays.
TEST(ForcedSpheres, StayOnACircle) {
  const std::string pull = "/sqrt((x - 0.1)^2 + (y - 0.1)^2)^3";
  const double speed = 1.0, radius = 0.05, turn = 2.0 * std::numbers::pi * radius / speed;
  const auto run = small::simulation(
      forced, {"forcing.0.acceleration=[\"-0.05*(x - 0.1)" + pull + "\", \"-0.05*(y - 0.1)" + pull + "\"]",
               "fill.0.velocity=[0, 1]", "time.step=" + std::to_string(turn / 100.0)});
  double worst = 0.0;
  for (int k = 0; k < 10000; ++k) {
    run->step(1e6);
    worst =
        std::max(worst, std::abs(std::hypot(of_ball(*run, Field::velocity), of_ball(*run, Field::velocity, 1)) - 1));
  }
  report("speed on a circle, 100 turns of 100 steps", worst, 2e-3);
  EXPECT_LT(worst, 2e-3);
}

// A spring that changes with time: half the step, a quarter of the error.
TEST(ForcedSpheres, AreOfSecondOrderInPlaceAndTime) {
  const auto after = [](double dt) {
    const auto run = small::simulation(forced, {"forcing.0.acceleration=[\"-400*(1 + 0.5*sin(7*t))*(x - 0.1)\", 0]",
                                                "time.step=" + std::to_string(dt)});
    while (run->time() < 1.0 - 1e-9) run->step(1.0 - run->time());
    return of_ball(*run, Field::position);
  };
  const double coarse = after(4e-3), fine = after(2e-3), finest = after(1e-3);
  EXPECT_NEAR((coarse - fine) / (fine - finest), 4.0, 0.2);
}

// A trap of 2,000 1/s in steps that its contacts would make 3e-4 s long: the forcing limits them.
TEST(ForcedSpheres, TakeTheStepsOfAStiffForcing) {
  const auto run = small::simulation(
      forced, {"forcing.0.acceleration=[\"-4e6*(x - 0.1)\", 0]", "fill.0.shape={ points = [[0.1001, 0.1]] }"});
  double worst = 0.0;
  while (run->time() < 1.0) {
    run->step(1.0);
    const double v = of_ball(*run, Field::velocity), x = of_ball(*run, Field::position) - 0.1;
    worst = std::max(worst, std::abs((v * v + 4e6 * x * x) / 0.04 - 1.0));
  }
  report("energy of a stiff trap, 320 periods", worst, 2e-3);
  EXPECT_LT(worst, 2e-3);
}

/// Ten balls of 5 mm on each other, that just touch.
std::string stack(const std::string& law, const std::string& e) {
  std::string points;
  for (int k = 0; k < 10; ++k)
    points += (k ? ", " : "") + std::string("[0.025, ") + std::to_string(0.0025 + 5e-3 * k) + ", 0.025]";
  return R"toml(
dimensions = 3
spacing = 5e-3
[domain]
size = [0.05, 0.1, 0.05]
gravity = [0, -9.81, 0]
[phases.ball]
kind = "grains"
density = 2500
diameter = 5e-3
friction = 0.3
restitution = )toml" +
         e + (law == "linear" ? "\nstiffness = 2000" : "\nyoung = 1e7\npoisson = 0.3") + R"toml(
[phases.floor]
kind = "wall"
[interactions]
ball-ball = { law = ")toml" +
         law + R"toml(" }
ball-floor = { law = ")toml" +
         law + R"toml(" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "ball"
shape = { points = [)toml" +
         points + R"toml(] }
[time]
end = 2
largest-speed = 0.1
)toml";
}

class SpheresAtRest : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {};
INSTANTIATE_TEST_SUITE_P(Laws, SpheresAtRest,
                         ::testing::Combine(::testing::Values("linear", "hertz"),
                                            ::testing::Values("0.05", "0.1", "0.5")));

// The dashpots of a stack at rest carry nothing: each overlap is what its load gives by the law, and the lost energy
// stays what it is. With velocities that had their contact's own force alone it fell for ever.
TEST_P(SpheresAtRest, OverlapByTheirLoad) {
  const auto& [law, e] = GetParam();
  const auto run = small::simulation(stack(law, e), {});
  const auto until = [&](double end) {
    while (run->time() < end - 1e-9) run->step(end - run->time());
  };
  until(1.5);
  const double before = value(*run, "contacts_lost_energy [");
  until(2.0);
  const double weight = 2500.0 * std::numbers::pi / 6.0 * std::pow(5e-3, 3) * 9.81,
               stored = value(*run, "contacts_stored_energy [");
  EXPECT_NEAR(value(*run, "contacts_lost_energy ["), before, 0.5e-9 * stored);
  std::vector<double> y;
  for (std::size_t k = 0; k < 10; ++k) y.push_back(run->phases()[0].column(Field::position, 1)[k]);
  std::sort(y.begin(), y.end());
  double sum = 0.0, worst = 0.0;
  for (std::size_t k = 0; k < 10; ++k) {
    const double load = static_cast<double>(10 - k) * weight,
                 overlap = k == 0 ? 2.5e-3 - y[0] : 5e-3 - (y[k] - y[k - 1]),
                 modulus = 4.0 / 3.0 * 0.5 * 1e7 / (1.0 - 0.09), radius = k == 0 ? 2.5e-3 : 1.25e-3,
                 expected = law == "linear" ? load / 2000.0 : std::pow(load / (modulus * std::sqrt(radius)), 2.0 / 3.0);
    worst = std::max(worst, std::abs(overlap / expected - 1.0));
    sum += load * expected * (law == "linear" ? 0.5 : 0.4);
  }
  report("overlaps of a stack, " + law + ", e = " + e, worst, 1e-4);
  EXPECT_LT(worst, 1e-4);
  EXPECT_NEAR(stored, sum, 1e-3 * sum);
}

// Nor do those of a bed that came to rest with spheres of unequal sizes, friction and rolling friction.
TEST(BedAtRest, LosesNoEnergy) {
  const std::string text = R"toml(
spacing = 1e-3
[domain]
size = [0.03, 0.03]
periodic = ["x"]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.15 }
restitution = 0.5
friction = 0.5
rolling-friction = 0.1
stiffness = 2000
[phases.floor]
kind = "wall"
diameter = 1e-3
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "sand"
shape = { bed = 0.01 }
packing = "settled"
[time]
end = 0.6
largest-speed = 0.5
)toml";
  const auto run = small::simulation(text, {});
  const auto until = [&](double end) {
    while (run->time() < end - 1e-9) run->step(end - run->time());
  };
  // What is left of the settling dies away: at 0.1 s it still takes 1e-10 to 6e-7 a second, by the bed.
  until(0.45);
  const double before = value(*run, "contacts_lost_energy ["), stored = value(*run, "contacts_stored_energy [");
  EXPECT_GT(stored, 1e-7);
  until(0.55);
  const double share = std::abs(value(*run, "contacts_lost_energy [") - before) / (0.1 * stored);
  report("lost energy of a bed at rest, of the stored, 1/s", share, 1e-9);
  EXPECT_LT(share, 1e-9);
}

// A run that begins with an overlap has its force from the start: all of the stored energy becomes motion.
TEST(SpheresAtRest, LetGoWithTheForceOfTheStart) {
  const double overlap = 1e-5;
  const auto run =
      small::simulation(pair_of, {"interactions.balls-balls.law=linear", "phases.balls.restitution=1",
                                  "phases.balls.stiffness=1e5", "fill.0.velocity=[0, 0, 0]",
                                  "fill.1.velocity=[0, 0, 0]", "fill.0.shape={ points = [[0.495005, 0.5, 0.5]] }",
                                  "fill.1.shape={ points = [[0.504995, 0.5, 0.5]] }"});
  for (int k = 0; k < 200; ++k) run->step(1.0);
  const double stored = 0.5 * 1e5 * overlap * overlap;
  EXPECT_NEAR(value(*run, "balls_kinetic_energy ["), stored, 5e-3 * stored);
}

}  // namespace
}  // namespace barchan
