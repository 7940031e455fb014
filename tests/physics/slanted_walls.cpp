// Water beside walls that stand slanted: it rests, and a wedge between two walls lets none of it in.
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

}  // namespace
}  // namespace barchan
