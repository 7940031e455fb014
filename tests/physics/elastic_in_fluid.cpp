// Elastic bodies at whose borders fluids of the consistent scheme end: the pieces of a border, buoyancy, added mass, a
// light plate that comes to rest.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "models/bodies/elastic_border.hpp"
#include "physics/drive.hpp"
#include "physics/flags.hpp"

namespace barchan {
namespace {

using testing::report;
using testing::run_to;
using testing::value;

/// Columns of F.
using Motion = std::array<Vec3, 3>;
Vec3 moved(const Motion& f, const Vec3& x) { return x[0] * f[0] + x[1] * f[1] + x[2] * f[2]; }

/// The pieces of the body of a scene after x = F X, v = G X, against those of the shape itself.
void expect_exact(const std::string& text, std::size_t phase, const Motion& f, const Motion& g, const char* what) {
  const Scene scene = parse_scene(text, "border.toml");
  const auto blocks = generate(scene);
  const Plan plan = make_plan(scene, blocks);
  PhaseParticles body("body", scene.dimensions, blocks[phase].position.size(), 1.0, 0);
  body.add(Field::position);
  body.add(Field::velocity);
  for (std::size_t k = 0; k < body.size(); ++k)
    for (int d = 0; d < scene.dimensions; ++d) {
      const auto c = static_cast<std::size_t>(d);
      body.column(Field::position, d)[k] = moved(f, blocks[phase].position[k])[c];
      body.column(Field::velocity, d)[k] = moved(g, blocks[phase].position[k])[c];
    }
  body.keep_places();
  ElasticBorder border(scene, plan, phase, blocks[phase], 0.025, 0.2);
  border.move(body);
  const auto first = free_border(scene, blocks[phase].parts.front().fill, 0.025);
  ASSERT_EQ(first.size(), border.pieces().size());
  const Motion cofactor{cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])};
  double place = 0.0, normal = 0.0, speed = 0.0, lost = 0.0;
  Vec3 closed{};
  std::vector<Vec3> to(body.size());
  for (std::size_t q = 0; q < first.size(); ++q) {
    const auto& piece = border.pieces()[q];
    place = std::max(place, norm(piece.place - moved(f, first[q].at)));
    speed = std::max(speed, norm(piece.velocity - moved(g, first[q].at)));
    const Vec3 area = first[q].content * moved(cofactor, first[q].normal);
    normal = std::max(normal, norm(piece.content * piece.normal - area) / first[q].content);
    closed = closed + area;
    // a force on the piece has its torque on the particles
    std::fill(to.begin(), to.end(), Vec3{});
    const Vec3 push{1.0, 2.0, scene.dimensions == 3 ? -0.5 : 0.0};
    border.spread(q, push, to);
    Vec3 force{}, torque{};
    for (std::size_t k = 0; k < to.size(); ++k) {
      force = force + to[k];
      torque = torque + cross(moved(f, blocks[phase].position[k]), to[k]);
    }
    lost = std::max({lost, norm(force - push), norm(torque - cross(piece.place, push))});
    const auto near = border.nearest(piece.place + 0.01 * piece.normal);
    ASSERT_TRUE(near) << what;
    EXPECT_GT(near->distance, 0.0) << what;
  }
  report(std::string("places of an affine motion, ") + what, place, 1e-12);
  report(std::string("normals and areas of it, ") + what, normal, 1e-11);
  EXPECT_LT(place, 1e-12) << what;
  EXPECT_LT(speed, 1e-12) << what;
  EXPECT_LT(normal, 1e-11) << what;
  EXPECT_LT(lost, 1e-11) << what;
  EXPECT_LT(norm(closed), 1e-12) << what;
  const Vec3 curl{0, 0, 0.5 * (g[0][1] - g[1][0])};  // of a turn, where F is one
  if (norm(f[0] - Vec3{1, 0, 0}) == 0.0) { EXPECT_NEAR(border.pieces().front().spin[2], curl[2], 1e-11) << what; }
}

TEST(ElasticBorder, IsExactForAffineMotions) {
  const Motion rest{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, spin{Vec3{0, 2, 0}, Vec3{-2, 0, 0}, Vec3{}};
  const Motion sheared{Vec3{1.1, 0.2, 0}, Vec3{-0.4, 0.9, 0}, Vec3{0, 0, 1}};
  expect_exact(small::flag, 2, rest, spin, "disc at rest, turning");
  expect_exact(small::flag, 2, sheared, spin, "disc");
  expect_exact(small::flag, 1, sheared, spin, "plate");
  const Motion bent{Vec3{1.1, 0.2, 0.1}, Vec3{-0.4, 0.9, 0}, Vec3{0.1, -0.2, 1.05}};
  expect_exact(small::jelly, 1, bent, spin, "block in 3D");
}

TEST(ElasticBorder, LeavesOutWhatStandsInAWall) {
  const Scene scene = read_scene(testing::scene_file("verification/turek_hron_fsi2"), {});
  const auto plate = free_border(scene, 0, 0.005);
  double length = 0.0, nearest = 1.0;
  for (const BorderPoint& p : plate) {
    length += p.content;
    nearest = std::min(nearest, p.at[0]);
  }
  EXPECT_NEAR(length, 2 * 0.35 + 0.02, 0.012) << "two sides and the end of 0.35 m x 0.02 m";
  EXPECT_GT(nearest, 0.2465) << "nothing in the slot of the cylinder";
}

constexpr double displaced = 0.6 * 0.4;  // m2

std::string block_in_a_tank(double density, const std::string& more) {
  return "precision = \"double\"\nspacing = 0.04\n[domain]\nsize = [1.6, 1.6]\ngravity = [0, -1]\n"
         "[phases.water]\nkind = \"fluid\"\ndensity = 1\nviscosity = 1e-3\nsound-speed = 20\n"
         "[phases.tank]\nkind = \"wall\"\n[phases.block]\nkind = \"elastic\"\nyoung = 1e3\npoisson = 0.3\ndensity = " +
         std::to_string(density) +
         "\n[interactions]\nwater-water = 2.1\nwater-tank = 2.1\nwater-block = 2.1\nblock-tank = false\n"
         "block-block = { radius = 1.6, kernel = \"wendland-c2\" }\n"
         "[[fill]]\nphase = \"block\"\nshape = { box = { min = [0.52, 0.6], max = [1.12, 1] } }\n"
         "[[fill]]\nphase = \"tank\"\nshape = { sides = [\"left\", \"right\", \"bottom\", \"top\"] }\n"
         "[[fill]]\nphase = \"water\"\nshape = \"the-rest\"\npressure = \"hydrostatic\"\n"
         "[[force]]\nname = \"lift\"\nphase = \"block\"\n[time]\nend = 1\nlargest-speed = 1\n" +
         more;
}

TEST(ElasticInConsistentFluid, AHeldBodyFeelsTheWeightOfWhatItDisplaces) {
  const auto run = small::simulation(block_in_a_tank(2.0, "[[motion]]\nphase = \"block\"\n"));
  run_to(*run, 0.05);
  run->begin_row();
  run_to(*run, 0.2);
  const double error = std::abs(value(*run, "lift_force_y") / displaced - 1.0);
  report("lift over the weight of the liquid displaced", error, 0.01);
  EXPECT_LT(error, 0.01);
  EXPECT_LT(std::abs(value(*run, "lift_force_x")), 0.01 * displaced);
}

TEST(ElasticInConsistentFluid, ABodyOfTheFluidsDensityStays) {
  const auto run = small::simulation(block_in_a_tank(
      1.0, "[[marker]]\nname = \"place\"\nphase = \"block\"\nbox = { min = [0.5, 0.5], max = [1.2, 1.1] }\n"));
  const double start = value(*run, "place_y");
  run_to(*run, 0.3);
  const double way = std::abs(value(*run, "place_y") - start), falls = 0.5 * 0.3 * 0.3;
  report("way over that of a free fall", way / falls, 0.01);
  EXPECT_LT(way / falls, 0.01);
  EXPECT_GT(way, 0.0) << "it is not held";
}

/// As of a rigid disc (rigid_in_consistent.cpp): potential flow in a round tank (Lamb 1932, section 70).
TEST(ElasticInConsistentFluid, AStiffDiscStartsWithItsAddedMass) {
  std::ifstream file(testing::scene_file("verification/sinking_disc"));
  std::string text(std::istreambuf_iterator<char>(file), {});
  text = small::changed(text, "kind    = \"rigid\"", "kind = \"elastic\"\nyoung = 2e3\npoisson = 0.3");
  text = small::changed(text, "scheme      = \"plain\"", "scheme = \"consistent\"");
  text = small::changed(text, "disc-tank = false",
                        "disc-tank = false\ndisc-disc = { radius = 1.6, kernel = \"wendland-c2\" }");
  text += "\n[[marker]]\nname = \"place\"\nphase = \"disc\"\nbox = { min = [-0.5, -0.5], max = [0.5, 0.5] }\n";
  const auto run = small::simulation(
      text, {"interactions.water-water=2.1", "interactions.water-disc=2.1", "interactions.water-tank=2.1"});
  const double start = value(*run, "place_y"), time = 0.4;
  run_to(*run, time);
  const double added = (1.0 + 0.16) / (1.0 - 0.16), exact = -(2.0 - 1.0) / (2.0 + added);
  const double found = 2.0 * (value(*run, "place_y") - start) / (time * time * exact);
  report("acceleration over that with the added mass", std::abs(found - 1.0), 0.05);
  EXPECT_NEAR(found, 1.0, 0.05);
}

/// A wave along a plate of four rows as dense as the water on both sides, rows of water and plate alike. With steps
/// that were a sixth longer waves of three rows grew by 25 a second, and the run ended at 0.26 s.
TEST(ElasticInConsistentFluid, AWaveAlongAPlateKeepsItsEnergy) {
  const std::string c = "(0.00310838*cos(6.2831853*x))", s = "(0.00310838*sin(6.2831853*x))";
  const auto cosh = [](const std::string& y) { return "0.5*(exp(6.2831853*" + y + ")+exp(-6.2831853*" + y + "))"; };
  const auto sinh = [](const std::string& y) { return "0.5*(exp(6.2831853*" + y + ")-exp(-6.2831853*" + y + "))"; };
  const auto layer = [](const char* low, const char* high, const std::string& u, const std::string& v) {
    return std::string("[[fill]]\nphase = \"water\"\nshape = { box = { min = [0, ") + low + "], max = [1, " + high +
           "] } }\nvelocity = [\"" + u + "\", \"" + v + "\"]\n";
  };
  const auto run = small::simulation(
      "spacing = 0.01\n[domain]\nsize = [1, 0.64]\nperiodic = [\"x\"]\n"
      "[phases.plate]\nkind = \"elastic\"\ndensity = 1000\nyoung = 4.08e6\npoisson = 0.3\n"
      "[phases.water]\nkind = \"fluid\"\ndensity = 1000\nsound-speed = 40\n"
      "[phases.wall]\nkind = \"wall\"\nslip = \"free-slip\"\n"
      "[interactions]\nplate-plate = {}\nwater-water = {}\nwater-plate = {}\nwater-wall = {}\nplate-wall = false\n"
      "[[fill]]\nphase = \"plate\"\nshape = { box = { min = [0, 0.3], max = [1, 0.34] } }\n"
      "velocity = [0, \"0.01*sin(6.2831853*x)\"]\n"
      "[[fill]]\nphase = \"wall\"\nshape = { sides = [\"bottom\", \"top\"] }\n" +
      layer("0", "0.3", c + "*" + cosh("y"), s + "*" + sinh("y")) +
      layer("0.34", "0.64", "-" + c + "*" + cosh("(0.64-y)"), s + "*" + sinh("(0.64-y)")) +
      "[time]\nend = 1\nlargest-speed = 0.02\n");
  const auto energy = [&] {
    return value(*run, "plate_kinetic_energy") + value(*run, "plate_strain_energy") +
           value(*run, "plate_hourglass_energy") + value(*run, "water_kinetic_energy");
  };
  const double start = energy();
  run_to(*run, 0.28);
  report("energy of plate and water over that of the start", energy() / start, 1.01);
  EXPECT_LT(energy() / start, 1.01);
  EXPECT_GT(energy() / start, 0.95);
}

/// The pressure follows a border some steps late; without the radiation of sound this plate, as dense as the water,
/// gains energy until it breaks.
TEST(ElasticInConsistentFluid, AShakenPlateComesToRest) {
  const auto run = small::simulation(
      "precision = \"double\"\nspacing = 0.01\n[domain]\nsize = [0.6, 0.3]\nperiodic = [\"x\"]\n"
      "[phases.water]\nkind = \"fluid\"\ndensity = 1000\nviscosity = 1e-3\nsound-speed = 20\n[phases.wall]\nkind = "
      "\"wall\"\n[phases.plate]\nkind = \"elastic\"\nspacing = 0.005\ndensity = 1000\nyoung = 1.4e6\npoisson = 0.4\n"
      "[interactions]\nwater-water = 2.1\nwater-wall = 2.1\nwater-plate = 2.1\nplate-wall = false\nplate-plate = { "
      "radius = 1.6, kernel = \"wendland-c2\" }\n[[fill]]\nphase = \"plate\"\nshape = { box = { min = [0.2, 0.14], max "
      "= [0.4, 0.16] } }\nvelocity = [0, \"x < 0.24 ? 0 : 0.1*(x - 0.24)\"]\n[[fill]]\nphase = \"wall\"\nshape = { "
      "sides = [\"bottom\", \"top\"] }\n[[fill]]\nphase = \"water\"\nshape = \"the-rest\"\n[[motion]]\nphase = "
      "\"plate\"\nbox = { min = [0.2, 0.14], max = [0.24, 0.16] }\n[time]\nend = 1\nlargest-speed = 1\n");
  const double start = value(*run, "plate_kinetic_energy");
  run_to(*run, 0.5);
  const double left = (value(*run, "plate_kinetic_energy") + value(*run, "plate_strain_energy")) / start;
  report("energy of the plate over that of the blow", left, 1.0);
  EXPECT_LT(left, 1.0);
}

/// A plate between two layers of water takes part of the step that its vibration alone would have: a quarter as dense
/// as the water it ended after 3 ms, as dense as the water after 70 ms.
TEST(ElasticInConsistentFluid, ALightPlateKeepsToTheStepOfItsLoad) {
  const auto run = small::simulation(
      "spacing = 0.01\n[domain]\nsize = [0.5, 0.24]\nperiodic = [\"x\"]\n[phases.plate]\nkind = \"elastic\"\ndensity = "
      "250\nyoung = 4.08e6\npoisson = 0.3\n[phases.water]\nkind = \"fluid\"\ndensity = 1000\nsound-speed = 40\n"
      "[phases.wall]\nkind = \"wall\"\nslip = \"free-slip\"\n[interactions]\nplate-plate = {}\nwater-water = {}\n"
      "water-plate = {}\nwater-wall = {}\nplate-wall = false\n[[fill]]\nphase = \"plate\"\nshape = { box = { min = [0, "
      "0.1], max = [0.5, 0.14] } }\nvelocity = [0, \"0.01*sin(4*pi*x)\"]\n[[fill]]\nphase = \"wall\"\nshape = { sides "
      "= "
      "[\"bottom\", \"top\"] }\n[[fill]]\nphase = \"water\"\nshape = \"the-rest\"\n[time]\nend = 0.03\nlargest-speed = "
      "0.02\n");
  run_to(*run, 0.03);
  EXPECT_LT(value(*run, "largest_speed"), 0.01);
}

/// A rubber gate (Antoci, Gallati & Sibilla 2007) bends under a tank of water whose sound is four times as fast as it
/// must be. Water and gate have the energy that the weight gave. The acceleration of single steps, with which the water
/// was continued into the gate, made ten times as much.
TEST(ElasticInConsistentFluid, AGateHasTheEnergyThatTheWeightGave) {
  const auto run = small::simulation(R"(spacing = 5e-3
[domain]
origin = [-0.1, 0]
size = [0.36, 0.16]
gravity = [0, -9.81]
open = ["right"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 68
[phases.floor]
kind = "wall"
[phases.wall]
kind = "wall"
slip = "free-slip"
[phases.gate]
kind = "elastic"
spacing = 1.25e-3
density = 1100
young = 1.2e7
poisson = 0.4
[interactions]
water-water = {}
water-floor = {}
water-wall = {}
water-gate = {}
gate-gate = { radius = 1.6, kernel = "wendland-c2" }
gate-wall = false
gate-floor = false
[[fill]]
phase = "gate"
shape = { box = { min = [0, 0], max = [0.005, 0.085] } }
[[fill]]
phase = "wall"
shape = { box = { min = [0, 0.085], max = [0.005, 0.16] } }
[[fill]]
phase = "floor"
shape = { sides = ["bottom", "left"] }
[[fill]]
phase = "water"
shape = { box = { min = [-0.1, 0], max = [0, 0.14] } }
pressure = "hydrostatic"
[[motion]]
phase = "gate"
box = { min = [0, 0.079], max = [0.005, 0.085] }
[time]
end = 0.02
largest-speed = 1.7
)");
  // J/m: the weight compresses the water at the start, p^2/(2 rho c^2).
  double given = 0.1 * std::pow(9810.0, 2) * std::pow(0.14, 3) / 3.0 / (2.0 * 1000.0 * 68.0 * 68.0), down = 0.0;
  for (double time = 5e-4; time < 0.0201; time += 5e-4) {
    run_to(*run, time);
    const double now = -value(*run, "momentum_y");
    given += 9.81 * 0.5 * (down + now) * 5e-4;
    down = now;
    const double energy = value(*run, "water_kinetic_energy") + value(*run, "gate_kinetic_energy") +
                          value(*run, "gate_strain_energy") + value(*run, "gate_hourglass_energy");
    if (time > 0.01) {
      report("energy over what the weight gave, less 1", energy / given - 1.0, 0.01);
      ASSERT_LT(energy / given, 1.01) << "at " << time << " s";
      ASSERT_GT(energy / given, 0.9) << "at " << time << " s";
    }
  }
}

/// A drop of one particle, and one of four, that meets a free plate without gravity, an elastic or a rigid one: what
/// the drop loses the plate gets, and both have no more energy than before. A border that took each drop for a whole
/// fluid gave the plate 12 times the momentum.
TEST(ElasticInConsistentFluid, ADropGivesAPlateWhatItLoses) {
  const std::string scene = R"(spacing = 2e-3
[domain]
size = [0.08, 0.12]
origin = [-0.03, -0.06]
[phases.water]
kind = "fluid"
density = 1000
sound-speed = 40
enclosed = false
[phases.plate]
KIND
density = 2500
[interactions]
water-water = 2.6
water-plate = 2.6
PAIR
[[fill]]
phase = "plate"
shape = { box = { min = [-0.012, -0.02], max = [0, 0.02] } }
[[fill]]
phase = "water"
shape = DROP
velocity = [-3, 0]
[time]
end = 4e-3
largest-speed = 4
)";
  const std::pair<std::string, double> drops[] = {{"{ points = [[0.008, 0.001]] }", 1e-3},
                                                  {"{ disc = { centre = [0.014, 0.0007], radius = 0.006 } }", 0.9},
                                                  {"{ disc = { centre = [0.02, 0.0007], radius = 0.012 } }", 0.3}};
  const std::string elastic = "kind = \"elastic\"\nyoung = 1e6\npoisson = 0.0";
  for (const std::string& kind : {elastic, std::string("kind = \"rigid\"")})
    for (const auto& [drop, bound] : drops) {
      const bool bends = kind == elastic;
      std::string text = small::changed(scene, "KIND", kind);
      text = small::changed(text, "PAIR", bends ? "plate-plate = { radius = 1.6 }" : "");
      const auto run = small::simulation(small::changed(text, "DROP", drop));
      const auto energy = [&] {
        return value(*run, "water_kinetic_energy") + value(*run, "plate_kinetic_energy") +
               (bends ? value(*run, "plate_strain_energy") : 0.0);
      };
      const double before = value(*run, "momentum_x"), at_first = energy();
      run_to(*run, 4e-3);
      EXPECT_GT(value(*run, "water_mean_vx"), -2.5) << "it has met the plate";
      const double off = std::abs(value(*run, "momentum_x") / before - 1.0), gained = energy() / at_first - 1.0;
      const std::string what = std::string(bends ? "elastic" : "rigid") + ", " + drop;
      report("drop, momentum, " + what, off, bound);
      report("drop, energy gained, " + what, gained, 0.02);
      EXPECT_LT(off, bound) << what;
      EXPECT_LT(gained, 0.02) << what;
    }
}

}  // namespace
}  // namespace barchan
