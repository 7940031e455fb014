// Water beside walls and bodies whose outlines lie across its rows: none of it comes in.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;

/// A dam of 0.25 m x 0.4 m, `spacing` 0.01 m, before a ridge 0.06 m high.
std::string dam_over_ridge(const std::string& slip, const std::string& packing) {
  return R"(spacing = 0.01
[domain]
size = [1, 0.8]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 28
[phases.tank]
kind = "wall"
slip = ")" +
         slip + R"("
[phases.ridge]
kind = "wall"
slip = ")" +
         slip + R"("
[interactions]
water-water = 2.6
water-tank = 2.6
water-ridge = 2.6
[[fill]]
phase = "tank"
shape = { sides = ["bottom", "left", "right"] }
[[fill]]
phase = "ridge"
shape = { polygon = [[0.35, 0], [0.5, 0.06], [0.65, 0]] }
)" + packing +
         R"([[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [0.25, 0.4] } }
pressure = "hydrostatic"
[time]
end = 1
largest-speed = 2.8
)";
}

// Where the ridge and the floor meet the ridge is thinner than a spacing: its particles hold no water back there.
TEST(SlantedWalls, ADamRunsOverARidge) {
  for (const char* packing : {"", "packing = \"relaxed\"\n"})
    for (const char* slip : {"no-slip", "free-slip"}) {
      const auto run = small::simulation(dam_over_ridge(slip, packing));
      double deepest = 0.0;
      while (run->time() < 0.3) {
        run->step(1.0);
        const PhaseParticles& p = run->phases()[0];
        for (std::size_t k = 0; k < p.size(); ++k) {
          const double below = 0.06 - 0.4 * std::abs(p.column(Field::position, 0)[k] - 0.5);
          deepest = std::max(deepest, below - p.column(Field::position, 1)[k]);
        }
      }
      report("the deepest place of water in the ridge (m)", deepest, 1e-9);
      EXPECT_LE(deepest, 1e-9) << slip << " " << packing;
    }
}

/// A tank of 0.3 m of water and `more`, which stands in it or swings to and fro.
std::string tank_with(const std::string& scheme, const std::string& slip, const std::string& more,
                      const std::string& begin = "0") {
  const std::string radius = scheme == "plain" ? "3" : "2.6";
  return R"(spacing = 0.01
[domain]
size = [0.6, 0.5]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 20
scheme = ")" +
         scheme + R"("
[phases.tank]
kind = "wall"
slip = ")" +
         slip + "\"\n[interactions]\nwater-water = " + radius + "\nwater-tank = " + radius +
         "\nwater-solid = " + radius + "\n" + more + R"([[fill]]
phase = "tank"
shape = { sides = ["bottom", "left", "right"] }
[[fill]]
phase = "water"
shape = { box = { min = [)" +
         begin + R"(, 0], max = [0.6, 0.3] } }
pressure = "hydrostatic"
leave-out = "earlier-fills"
[time]
end = 0.4
largest-speed = 2
)";
}

/// The largest error of the density until this time (s).
double worst_density(const std::string& scene, double until) {
  const auto run = small::simulation(scene);
  double worst = 0.0;
  while (run->time() < until) {
    run->step(1.0);
    const PhaseParticles& p = run->phases()[0];
    for (std::size_t k = 0; k < p.size(); ++k)
      worst = std::max(worst, std::abs(p.column(Field::density)[k] / 1000.0 - 1.0));
  }
  return worst;
}

// The first row of the water stands on the outline of the paddle, or is cut by that of a disc: of these eight tanks six
// ended before 0.4 s, in both schemes.
TEST(SlantedWalls, WaterOnTheOutlineOfAWallThatMovesStaysOutside) {
  for (const char* scheme : {"consistent", "plain"})
    for (const char* shape : {"polygon = [[0.05, 0], [0.105, 0], [0.105, 0.4], [0.05, 0.4]]",
                              "disc = { centre = [0.3, 0.15], radius = 0.06 }"})
      for (const char* slip : {"no-slip", "free-slip"}) {
        const double worst =
            worst_density(tank_with(scheme, slip,
                                    std::string("[phases.solid]\nkind = \"wall\"\nslip = \"") + slip +
                                        "\"\n[[fill]]\nphase = \"solid\"\nshape = { " + shape +
                                        " }\n[[motion]]\nphase = \"solid\"\nvelocity = [\"0.1*sin(6*t)\", 0]\n",
                                    shape[0] == 'p' ? "0.1" : "0"),
                          0.4);
        report("largest error of the density", worst, 0.1);
        EXPECT_LT(worst, 0.1) << scheme << " " << shape << " " << slip;
      }
}

// Without any friction of the water: the disc ended the run of the plain scheme at 0.1 s. It lands at 0.3 s.
TEST(SlantedWalls, ADiscThatSinksLetsNoWaterIn) {
  for (const char* scheme : {"consistent", "plain"}) {
    const double worst = worst_density(
        tank_with(scheme, "no-slip",
                  "solid-tank = {}\n[phases.solid]\nkind = \"rigid\"\ndensity = 2650\n[[fill]]\nphase = \"solid\"\n"
                  "shape = { disc = { centre = [0.3, 0.2], radius = 0.06 } }\n"),
        0.25);
    report("largest error of the density", worst, 0.05);
    EXPECT_LT(worst, 0.05) << scheme;
  }
}

// Sides of 60 degrees. Where the wall's particles ended across the wall at the shore, not on the level, the particle
// there moved at 0.06 sqrt(gH) for seconds.
TEST(SlantedWalls, WaterBetweenThemRests) {
  const auto run = small::simulation(R"(spacing = 0.02
[domain]
origin = [-0.7, -0.14]
size = [1.4, 0.58]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 34.3
[phases.tank]
kind = "wall"
[interactions]
water-water = 2.6
water-tank = 2.6
[[fill]]
phase = "tank"
shape = { polygon = [[-0.3, 0], [0.3, 0], [0.54249, 0.42], [0.62909, 0.37], [0.35774, -0.1],
  [-0.35774, -0.1], [-0.62909, 0.37], [-0.54249, 0.42]] }
packing = "relaxed"
[[fill]]
phase = "water"
shape = { polygon = [[-0.3, 0], [0.3, 0], [0.47321, 0.3], [-0.47321, 0.3]] }
pressure = "hydrostatic"
packing = "relaxed"
[time]
end = 1
largest-speed = 0.2
)");
  double fastest = 0.0;
  while (run->time() < 1.0) {
    run->step(1.0);
    const PhaseParticles& p = run->phases()[0];
    for (std::size_t k = 0; run->time() > 0.5 && k < p.size(); ++k)
      fastest = std::max(fastest, std::hypot(p.column(Field::velocity, 0)[k], p.column(Field::velocity, 1)[k]));
  }
  report("fastest particle over sqrt(gH)", fastest / std::sqrt(9.81 * 0.3), 5e-3);
  EXPECT_LT(fastest / std::sqrt(9.81 * 0.3), 5e-3);
}

}  // namespace
}  // namespace barchan
