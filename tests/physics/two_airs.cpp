// Grains in two joined phases of one air: each feels the air once, below the border, on it and above it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::report;

/// Grains that fly at rest in a turbulent wind between 15 and 63 mm; with `joined` the air is coarse above 36 mm.
std::string flying_grains(bool joined) {
  const std::string air =
      "kind = \"fluid\"\ndensity = 1.225\nviscosity = 1.48e-5\nsound-speed = 80\nturbulence = \"mixing-length\"\n";
  const std::string wind = "velocity = { log-profile = { friction-velocity = 0.5, roughness = 4e-4 } }\n";
  std::string text =
      "spacing = 3e-3\n[domain]\nsize = [0.12, 0.096]\nperiodic = [\"x\"]\ngravity = [0, -9.81]\n[phases.air]\n" + air;
  if (joined) text += "[phases.above]\n" + air + "spacing = 6e-3\n";
  text +=
      "[phases.sand]\nkind = \"grains\"\ndensity = 2650\ndiameter = 2.5e-4\nrestitution = 0.7\nfriction = 0.6\n"
      "stiffness = 300\n[phases.ground]\nkind = \"wall\"\nroughness = 3.4e-6\n[phases.lid]\nkind = \"wall\"\n"
      "shear-stress = [0.306, 0]\nspacing = 6e-3\n[interactions]\nair-air = 2.1\nair-ground = 2.1\n"
      "air-sand = { drag = \"duran\" }\nsand-sand = { law = \"linear\" }\nsand-ground = false\n";
  text += joined ? "above-above = 2.1\nair-above = { radius = 2.1, border = \"y - 0.036\" }\nabove-ground = 2.1\n"
                   "above-sand = { drag = \"duran\" }\nabove-lid = 2.1\nair-lid = false\n"
                 : "air-lid = 2.1\n";
  text +=
      "[[fill]]\nphase = \"ground\"\nshape = { bed = 0.003 }\npacking = \"fitted\"\n[[fill]]\nphase = \"lid\"\n"
      "shape = { sides = [\"top\"] }\n[[fill]]\nphase = \"sand\"\nshape = { points = [";
  for (int k = 0; k < 49; ++k)
    text += "[" + std::to_string(0.001 + 0.0024 * k) + ", " + std::to_string(0.015 + 0.001 * k) + "],";
  text += "] }\n";
  if (joined)
    text += "[[fill]]\nphase = \"above\"\nshape = { box = { min = [0, 0.036], max = [0.12, 0.096] } }\n" + wind;
  return text + "[[fill]]\nphase = \"air\"\nshape = \"the-rest\"\npacking = \"fitted\"\n" + wind +
         "[time]\nend = 1e-3\nlargest-speed = 8\n";
}

TEST(TwoAirs, DragAGrainOnceWhereverItIs) {
  const auto one = small::simulation(flying_grains(false)), two = small::simulation(flying_grains(true));
  one->step(1.0);
  two->step(1.0);
  const PhaseParticles &p = one->phases()[1], &q = two->phases()[2];
  ASSERT_EQ(p.size(), 49u);
  ASSERT_EQ(q.size(), 49u);
  double worst = 0.0;
  const auto first_drag = [](const PhaseParticles& grains, std::size_t number) {
    const auto& id = grains.id();
    const auto at = std::find(id.begin(), id.end(), grains.first_id() + static_cast<std::int64_t>(number));
    return grains.column(Field::drag_acceleration, 0)[static_cast<std::size_t>(at - id.begin())];
  };
  for (std::size_t k = 0; k < 49; ++k) {
    const double a = first_drag(p, k), b = first_drag(q, k);
    EXPECT_GT(a, 0.0);
    worst = std::max(worst, std::abs(b / a - 1.0));
  }
  report("largest difference of the drag from that in one air", worst, 0.02);
  EXPECT_LE(worst, 0.02);
  double given = 0.0, taken = 0.0;
  for (std::size_t k = 0; k < q.size(); ++k) given += q.mass_of(k) * q.column(Field::drag_acceleration, 0)[k];
  for (const std::size_t phase : {0, 1}) {
    const PhaseParticles& air = two->phases()[phase];
    double sum = 0.0;
    for (std::size_t k = 0; k < air.size(); ++k) sum += air.mass() * air.column(Field::drag_acceleration, 0)[k];
    EXPECT_LT(sum, 0.0) << "both airs lose momentum";
    taken += sum;
  }
  report("momentum that the airs lose over what grains get, less 1", std::abs(taken / given + 1.0), 1e-12);
  EXPECT_LE(std::abs(taken / given + 1.0), 1e-12);
}

}  // namespace
}  // namespace barchan
