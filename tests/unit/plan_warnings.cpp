// What the plan sees for itself and what it warns of: fluids that are shut in, kernels under which particles pair,
// walls that hold nobody.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "plan/plan.hpp"
#include "plan/run_cost.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

using testing::with;

/// A closed box of water, full up to `top` (m), with one thing changed.
Plan box(const std::string& from = "", const std::string& to = "", const std::string& top = "1") {
  const std::string text = R"(spacing = 0.05
[domain]
size = [1, 1]
gravity = [0, -10]
[phases.water]
kind = "fluid"
density = 1000
[phases.wall]
kind = "wall"
[interactions]
water-water = 2.1
water-wall = 2.1
[[fill]]
phase = "wall"
shape = { sides = ["bottom", "top", "left", "right"] }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [1, )" +
                           top + R"(] } }
[time]
end = 1
)";
  const Scene scene = parse_scene(from.empty() ? text : with(text, from, to), "box.toml");
  return make_plan(scene, generate(scene));
}

bool warns(const Plan& plan, const std::string& of) {
  return std::any_of(plan.warnings.begin(), plan.warnings.end(),
                     [&](const std::string& w) { return w.find(of) != std::string::npos; });
}

TEST(PlanSees, AFluidThatIsShutIn) {
  EXPECT_TRUE(box().phases[0].enclosed);
  EXPECT_TRUE(box("shape = { box", "perturb = 0.5\nshape = { box").phases[0].enclosed) << "disturbed as far as may be";
  const Plan staggered =
      box("[[fill]]\nphase = \"water\"\nshape = { box = { min = [0, 0]",
          "[[fill]]\nphase = \"wall\"\npacking = \"staggered\"\nshape = { disc = { centre = [0.5, 0.5], "
          "radius = 0.22 } }\n[[fill]]\nphase = \"water\"\nshape = \"the-rest\" #");
  EXPECT_TRUE(staggered.phases[0].enclosed) << staggered.phases[0].enclosure;
  EXPECT_TRUE(box().warnings.empty()) << box().warnings.front();
  const Scene periodic =
      parse_scene(with(testing::square_text, "size = [1, 1]", "size = [1, 1]\nperiodic = [\"x\", \"y\"]"), "p.toml");
  EXPECT_TRUE(make_plan(periodic, generate(periodic)).phases[0].enclosed) << "every side periodic";
}

TEST(PlanSees, AFluidThatIsNotShutIn) {
  EXPECT_FALSE(box("", "", "0.8").phases[0].enclosed) << "a pool";
  EXPECT_NE(box("", "", "0.8").phases[0].enclosure.find("free space at"), std::string::npos);
  EXPECT_FALSE(box("max = [1,", "max = [0.4,").phases[0].enclosed) << "a dam";
  const Plan open = box("\"bottom\", \"top\"", "\"bottom\"");
  EXPECT_FALSE(open.phases[0].enclosed) << "no lid";
  EXPECT_NE(open.phases[0].enclosure.find("no wall that it interacts with beyond"), std::string::npos)
      << open.phases[0].enclosure;
  const Plan oil = box("[[fill]]\nphase = \"water\"\nshape = { box = { min = [0, 0], max = [1, 1] } }",
                       "[[fill]]\nphase = \"water\"\nshape = { box = { min = [0, 0], max = [1, 0.5] } }\n"
                       "[[fill]]\nphase = \"oil\"\nshape = \"the-rest\"\n"
                       "[phases.oil]\nkind = \"fluid\"\ndensity = 900\n[interactions.oil-oil]\nradius = 2.1\n"
                       "[interactions.water-oil]\nradius = 2.1\n[interactions.oil-wall]\nradius = 2.1");
  EXPECT_FALSE(oil.phases[0].enclosed) << "each must give way to the other";
}

TEST(PlanSees, WhatTheSceneSaysGoesFirst) {
  EXPECT_FALSE(box("density = 1000", "density = 1000\nenclosed = false").phases[0].enclosed);
  EXPECT_EQ(box("density = 1000", "density = 1000\nenclosed = false").phases[0].enclosure, "as the scene says");
  const Plan pool = box("density = 1000", "density = 1000\nenclosed = true", "0.8");
  EXPECT_TRUE(pool.phases[0].enclosed);
  EXPECT_TRUE(warns(pool, "phases.water.enclosed: there is free space at"));
}

TEST(PlanWarns, OfKernelsUnderWhichParticlesPair) {
  const auto plan = [](const std::string& entry) { return box("water-water = 2.1", "water-water = " + entry); };
  const std::string plain = "density = 1000\nscheme = \"plain\"";
  const auto cubic = [&](const std::string& radius) {
    return box("density = 1000\n[phases.wall]\nkind = \"wall\"\n[interactions]\nwater-water = 2.1",
               plain + "\n[phases.wall]\nkind = \"wall\"\n[interactions]\nwater-water = { radius = " + radius +
                   ", kernel = \"cubic-spline\" }");
  };
  EXPECT_TRUE(warns(cubic("3.0"), "interactions.water-water: under the cubic spline particles pair"));
  EXPECT_TRUE(warns(cubic("2.6"), "particles pair"));
  EXPECT_FALSE(warns(cubic("2.4"), "particles pair"));
  EXPECT_FALSE(warns(plan("3.0"), "particles pair")) << "Wendland C2";
  const Scene scene =
      parse_scene(testing::square_text, "s.toml", {"phases.air.scheme=plain", "interactions.kernel=cubic-spline"});
  const Plan square = make_plan(scene, generate(scene));
  EXPECT_NE(to_text(square, scene).find("warning: " + square.warnings.front()), std::string::npos);
}

TEST(PlanWarns, OfAPressureThatBlowsASurfaceAway) {
  const std::string pressed = "density = 1000\nbackground-pressure = 0.01", plain = pressed + "\nscheme = \"plain\"";
  EXPECT_TRUE(warns(box("density = 1000", plain, "0.8"), "phases.water.background-pressure: it blows"));
  EXPECT_FALSE(warns(box("density = 1000", pressed, "0.8"), "background-pressure")) << "the consistent scheme";
  EXPECT_FALSE(warns(box("density = 1000", plain), "background-pressure")) << "no free surface";
}

TEST(PlanWarns, OfSuctionInAPlainFluidThatChangesItsSpeed) {
  const auto tide = [](const std::string& keys, const std::string& speed) {
    const Scene scene = parse_scene(
        "spacing = 0.05\n[domain]\nsize = [1, 0.5]\nperiodic = [\"y\"]\n[phases.air]\nkind = \"fluid\"\ndensity = 1\n" +
            keys +
            "\n[interactions]\nair-air = 3.0\n[[fill]]\nphase = \"air\"\nshape = \"the-rest\"\n[[inflow]]\nphase = "
            "\"air\"\n"
            "side = \"left\"\nvelocity = [" +
            speed + ", 0]\n[[outflow]]\nphase = \"air\"\nside = \"right\"\n[time]\nend = 1\nlargest-speed = 1\n",
        "s.toml");
    return make_plan(scene, generate(scene));
  };
  const std::string key = "phases.air.scheme: a flow";
  EXPECT_TRUE(warns(tide("scheme = \"plain\"", "\"sin(t)\""), key));
  EXPECT_FALSE(warns(tide("scheme = \"plain\"\nbackground-pressure = 0.05", "\"sin(t)\""), key));
  EXPECT_FALSE(warns(tide("scheme = \"plain\"", "1"), key));
  EXPECT_FALSE(warns(tide("", "\"sin(t)\""), key));
}

TEST(PlanWarns, OfWallsThatHoldNobody) {
  const std::string sand = R"(spacing = 0.05
[domain]
size = [1, 1]
gravity = [0, -10]
[phases.sand]
kind = "grains"
density = 2650
[phases.floor]
kind = "wall"
[phases.lid]
kind = "wall"
[phases.air]
kind = "fluid"
density = 1
[interactions]
air-air = {}
air-sand = {}
air-lid = {}
air-floor = {}
sand-sand = {}
sand-floor = {}
sand-lid = {}
[[fill]]
phase = "floor"
shape = { box = { min = [0, 0], max = [1, 0.1] } }
[[fill]]
phase = "lid"
shape = { sides = ["top", "left", "right"] }
[[fill]]
phase = "sand"
shape = { bed = 0.5, from = 0.1 }
[[fill]]
phase = "air"
shape = "the-rest"
[time]
end = 1
)";
  const auto plan = [&](const std::string& without) {
    const Scene scene = parse_scene(without.empty() ? sand : with(sand, without + " = {}\n", ""), "sand.toml");
    return make_plan(scene, generate(scene));
  };
  EXPECT_TRUE(plan("").warnings.empty()) << plan("").warnings.front();
  EXPECT_TRUE(warns(plan("sand-lid"), "no entry sand-lid"));
  EXPECT_TRUE(warns(plan("sand-floor"), "no entry sand-floor"));
  EXPECT_TRUE(warns(plan("air-lid"), "no entry air-lid"));
  EXPECT_EQ(plan("sand-lid").warnings.size(), 1u);
}

TEST(PlanWarns, OfRowsThatMissTheMassOfTheirShape) {
  EXPECT_FALSE(warns(box("", "", "0.8"), "the mass of its"));
  const Plan low = box("", "", "0.83");
  EXPECT_TRUE(warns(low, "phases.water: the mass of its 340 particles of 0.05 m is +2.41 % off"))
      << low.warnings.front();
  EXPECT_TRUE(warns(box("max = [1, 1]", "max = [0.975, 1]"), "a spacing of 0.025 m fits"));
  EXPECT_TRUE(warns(box("box = { min = [0, 0], max = [1, 1] }", "disc = { centre = [0.5, 0.5], radius = 0.13 }"),
                    "packing = \"relaxed\" misses less"));
  const std::string spheres =
      "[phases.sand]\nkind = \"grains\"\ndensity = 2650\ndiameter = 0.05\nstiffness = "
      "1e4\n[interactions.sand-sand]\nlaw = "
      "\"linear\"\n[[fill]]\nphase = \"sand\"\nshape = { points = [[0.5, 0.95]] }\n";
  EXPECT_TRUE(warns(box("[time]\n", spheres + "[time]\n", "0.83"), "the mass of its 340 particles"))
      << "grains above it";
}

TEST(PlanWarns, OfTheMassOfASmallShapeInALargeDomain) {
  const Scene scene = parse_scene(R"(spacing = 0.13
[domain]
size = [400, 400]
[phases.water]
kind = "fluid"
density = 1000
sound-speed = 10
[interactions]
water-water = 2.1
[[fill]]
phase = "water"
shape = { formula = "0.25 - (x - 131.3)^2 - (y - 230.1)^2" }
[time]
end = 1
largest-speed = 1
)",
                                  "small.toml");
  const Plan plan = make_plan(scene, generate(scene));
  EXPECT_TRUE(warns(plan, "phases.water: the mass of its"));
}

/// Two pools with a wall of some rows between them; with `right`, water on both sides.
Plan pools(int rows, bool right, const std::string& more = "") {
  const std::string edge = std::to_string(0.5 + 0.05 * rows);
  std::string walls = "[[fill]]\nphase = \"gate\"\nshape = { box = { min = [0.5, 0], max = [" + edge +
                      ", 1] } }\n[[fill]]\nphase = \"water\"\nshape = { box = { min = [0, 0], max = [0.5, 0.8] } }\n";
  if (right) walls += "[[fill]]\nphase = \"water\"\nshape = { box = { min = [" + edge + ", 0], max = [1, 0.8] } }\n";
  return box("[[fill]]\nphase = \"water\"\nshape = { box = { min = [0, 0], max = [1, 1] } }\n",
             walls + "[phases.gate]\nkind = \"wall\"\n[interactions.water-gate]\nradius = 2.6\n" + more);
}

TEST(PlanWarns, OfWallsThatAFluidReachesThrough) {
  EXPECT_TRUE(warns(pools(2, false), "the wall \"gate\" is 2 rows of 0.05 m thick"));
  EXPECT_TRUE(warns(pools(2, false), "the fluid misses a part of it; expected a wall of 0.105 m"));
  EXPECT_FALSE(warns(pools(3, false), "rows of 0.05 m thick")) << "the wall of a vessel";
  const std::string rises = "[[motion]]\nphase = \"gate\"\nvelocity = [0, 1]\n";
  const auto refused = [](int rows, bool right, const std::string& more, const std::string& words) {
    try {
      pools(rows, right, more);
      ADD_FAILURE() << rows << " rows" << more;
    } catch (const SceneError& e) { EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what(); }
  };
  refused(1, false, "", "the fluid would fall through it");
  for (const int rows : {1, 2, 3}) {
    refused(rows, true, "", "presses the fluid on the other; expected a wall of 0.21 m");
    refused(rows, false, rises, "comes to both sides of a wall that moves acts on itself");
  }
  for (const int rows : {4, 5}) {
    EXPECT_FALSE(warns(pools(rows, true), "rows of 0.05 m thick")) << rows;
    EXPECT_FALSE(warns(pools(rows, false, rises), "rows of 0.05 m thick")) << rows;
  }
}

TEST(PlanWarns, OfAPlainFluidWithASmallRadius) {
  const std::string says = "the plain scheme presses about 11 % less on walls";
  const auto warned = [&](const std::string& radius, const std::string& scheme, bool walled = true) {
    const std::string air = "kind = \"fluid\"\nscheme = \"" + scheme + "\"",
                      wall =
                          "\nair-floor = 2.1\n[phases.floor]\nkind = \"wall\"\n[[fill]]\nphase = \"floor\"\n"
                          "shape = { sides = [\"bottom\"] }";
    const Scene scene = parse_scene(with(with(testing::square_text, "kind = \"fluid\"", air), "air-air = 3.0",
                                         "air-air = " + radius + (walled ? wall : "")),
                                    "air.toml");
    return warns(make_plan(scene, generate(scene)), says);
  };
  EXPECT_TRUE(warned("1.7", "plain"));
  EXPECT_FALSE(warned("1.8", "plain"));
  EXPECT_FALSE(warned("1.7", "consistent"));
  EXPECT_FALSE(warned("1.7", "plain", false)) << "it presses on nothing";
}

TEST(PlanWarns, OfABodyThatNothingHoldsTogether) {
  const std::string body =
      with(with(testing::square_text, "kind = \"fluid\"", "kind = \"elastic\"\nyoung = 1e6"), "air-air = 3.0",
           "air-dust = 1.1\ndust-dust = 1.1") +
      "[[fill]]\nphase = \"dust\"\nshape = { points = [[2, 2]] }\n[phases.dust]\nkind = \"grains\"\n"
      "density = 1\n";
  const Scene scene = parse_scene(with(with(body, "size = [1, 1]", "size = [3, 3]"), "shape = \"the-rest\"",
                                       "shape = { box = { min = [0, 0], max = [1, 1] } }"),
                                  "body.toml");
  EXPECT_TRUE(warns(make_plan(scene, generate(scene)), "nothing holds the body \"air\" together"));
}

TEST(PlanWarns, OfWhatTheAtlasFoundUnstable) {
  const std::string atlas = "the stability atlas";
  EXPECT_FALSE(warns(box(), atlas));
  EXPECT_TRUE(warns(box("end = 1", "end = 1\nsafety = 9"), "time.safety: 9 is outside what " + atlas));
  EXPECT_FALSE(warns(box("end = 1", "end = 1\nstep = 1e-4"), atlas));
  EXPECT_TRUE(warns(box("end = 1", "end = 1\nstep = 1e-2"), "time.step: ")) << "a fixed step beside the limit";
}

// What is meant is not told: a-b = false.
TEST(PlanWarns, OfPairsThatMeetNobodyUnlessTheyAreMeant) {
  const std::string two =
      "[phases.oil]\nkind = \"fluid\"\ndensity = 800\n[interactions]\noil-oil = 2.1\noil-wall = 2.1\n";
  const std::string fill = "[[fill]]\nphase = \"oil\"\nshape = { box = { min = [0, 0.5], max = [1, 0.7] } }\n[time]";
  const auto plan = [&](const std::string& entry) {
    const std::string text = R"(spacing = 0.05
[domain]
size = [1, 1]
gravity = [0, -10]
[phases.water]
kind = "fluid"
density = 1000
[phases.wall]
kind = "wall"
)" + two + entry + R"(water-water = 2.1
water-wall = 2.1
[[fill]]
phase = "wall"
shape = { sides = ["bottom", "top", "left", "right"] }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [1, 0.5] } }
)" + fill + "\nend = 1\n";
    const Scene scene = parse_scene(text, "box.toml");
    return make_plan(scene, generate(scene));
  };
  EXPECT_TRUE(warns(plan(""), "the fluids \"water\" and \"oil\" do not interact"));
  EXPECT_FALSE(warns(plan("water-oil = false\n"), "do not interact"));
  EXPECT_FALSE(warns(plan("water-oil = 2.1\n"), "do not interact"));
}

TEST(PlanWarns, OfFramesBeyondTheEndOfWeightUpwardsAndOfRadiiInMetres) {
  EXPECT_TRUE(warns(box("end = 1", "end = 1\n[output]\nevery = 2"), "is beyond time.end"));
  EXPECT_TRUE(
      warns(box("end = 1", "end = 1\n[output]\nevery = 1e-5"), "output.every: 1e-05 s is shorter than the first step"));
  EXPECT_FALSE(warns(box("end = 1", "end = 1\n[output]\nevery = 0.1"), "output.every"));
  EXPECT_TRUE(warns(box("[0, -10]", "[0, 10]"), "it points upwards"));
  EXPECT_TRUE(
      warns(box("water-wall = 2.1", "water-wall = 0.1"), "interactions.water-wall: a radius below one spacing"));
}

/// A bar of rubber in a box of this height (m), rows of 1.6 mm; which warnings it has.
std::vector<std::string> bar(const std::string& height) {
  const Scene scene = parse_scene(R"(spacing = 0.0016
[domain]
size = [0.4, 0.2]
[phases.bar]
kind = "elastic"
density = 1100
young = 1e6
poisson = 0.4
[interactions]
bar-bar = 1.6
[[fill]]
phase = "bar"
shape = { box = { min = [0.08, 0.08], max = [0.24, )" +
                                      height +
                                      R"(] } }
[time]
end = 1
)",
                                  "bar.toml");
  return make_plan(scene, generate(scene)).warnings;
}

TEST(PlanWarns, OfABarThatIsNotWholeRowsThick) {
  ASSERT_EQ(bar("0.1").size(), 2U);
  EXPECT_NE(bar("0.1").front().find("along y the box is 0.02 m and the body 12 rows of 0.0016 m, 0.0192 m (-4.0 %)"),
            std::string::npos)
      << bar("0.1").front();
  EXPECT_NE(bar("0.1").back().find("phases.bar: the mass of its 1200 particles of 0.0016 m is -4.00 % off"),
            std::string::npos)
      << bar("0.1").back();
  EXPECT_TRUE(bar("0.0992").empty()) << bar("0.0992").front() << ": twelve rows";
}

TEST(PlanWarns, OfABarOfTwoParticlesAcross) {
  ASSERT_EQ(bar("0.0832").size(), 1U);
  EXPECT_NE(bar("0.0832").front().find("phases.bar: 2 particles across along y"), std::string::npos)
      << bar("0.0832").front();
  EXPECT_TRUE(bar("0.0864").empty()) << "four";
}

/// A block on a floor of this shape, in three dimensions.
Scene block_on(const std::string& floor, const std::string& contact = "{ restitution = 0.3 }") {
  return parse_scene(R"(dimensions = 3
spacing = 0.01
[domain]
size = [0.2, 0.2, 0.2]
[phases.block]
kind = "elastic"
density = 1000
young = 1e6
poisson = 0.3
[phases.floor]
kind = "wall"
[interactions]
block-block = 1.6
block-floor = )" + contact +
                         "\n[[fill]]\nphase = \"floor\"\nshape = " + floor + R"(
[[fill]]
phase = "block"
shape = { box = { min = [0.05, 0.1, 0.05], max = [0.1, 0.15, 0.1] } }
velocity = [0, -1, 0]
[time]
end = 0.01
)",
                     "block.toml");
}

/// Bodies feel the lattice of a wall that has no outline, and are thrown sideways; a prism has one.
TEST(PlanWarns, OfWallsWithoutAnOutline) {
  const auto plan = [](const std::string& floor) {
    const Scene scene = block_on(floor);
    return make_plan(scene, generate(scene));
  };
  EXPECT_TRUE(warns(plan("{ formula = \"0.05 + 0.1*x - y\" }"), "bodies touch the lattice of its particles"));
  EXPECT_FALSE(warns(plan("{ polygon = [[0, 0], [0.2, 0], [0.2, 0.07], [0, 0.05]] }"), "touch the lattice"));
  EXPECT_FALSE(warns(plan("{ box = { min = [0, 0, 0], max = [0.2, 0.05, 0.2] } }"), "touch the lattice"));
}

TEST(PlanWarns, OfPrismsThatMoveAmongGrains) {
  const auto plan = [](const std::string& shape, const std::string& keys = "") {
    const Scene scene = parse_scene(R"(dimensions = 3
spacing = 0.002
[domain]
size = [0.05, 0.05, 0.02]
[phases.sand]
kind = "grains"
density = 2650
diameter = 0.001
stiffness = 500
[phases.drum]
kind = "wall"
)" + keys + R"([interactions]
sand-sand = { law = "linear" }
sand-drum = { law = "linear" }
[[fill]]
phase = "drum"
shape = { )" + shape + R"( }
[[motion]]
phase = "drum"
angular-velocity = [0, 0, 1.5]
[[fill]]
phase = "sand"
shape = { points = [[0.025, 0.045, 0.01]] }
[time]
end = 0.01
largest-speed = 1
)",
                                    "drum.toml");
    return make_plan(scene, generate(scene));
  };
  const std::string ring = "ring = { centre = [0.025, 0.025, 0], inner = 0.012, outer = 0.017 }";
  EXPECT_TRUE(warns(plan(ring), "fill.0.shape: in 3D a disc, a ring or a polygon that moves is rows of spheres"));
  EXPECT_FALSE(warns(plan(ring, "diameter = 0.002\n"), "rows of spheres")) << "the scene asks for spheres";
  EXPECT_FALSE(warns(plan("box = { min = [0.01, 0.01, 0.004], max = [0.03, 0.03, 0.016] }"), "rows of spheres"));
}

/// The written restitution is that of two particles.
TEST(PlanTells, WhatBodiesOfManyParticlesKeep) {
  const auto told = [](const std::string& contact) {
    const Scene scene = block_on("{ sides = [\"bottom\"] }", contact);
    return to_text(make_plan(scene, generate(scene)), scene);
  };
  EXPECT_NE(told("{ restitution = 0.3 }").find("restitution 0.3 is of two particles, bodies of many keep more"),
            std::string::npos);
  EXPECT_EQ(told("{ restitution = 1 }").find("bodies of many keep more"), std::string::npos);
}

TEST(PlanTells, HowLongItTakesToBeginAndToEnd) {
  Estimate e;
  e.measured = true;
  e.steps = 1e6;
  e.seconds = 3000;
  e.start_seconds = 22;
  EXPECT_NE(to_text(e).find("start   22 s to make the particles, beds that settle included"), std::string::npos);
  EXPECT_EQ(to_text(e).find("warning"), std::string::npos);
  e.start_seconds = 4200;
  EXPECT_NE(to_text(e).find("warning: the run takes about 2.0 hours"), std::string::npos) << to_text(e);
}

}  // namespace
}  // namespace barchan
