// The plan asks for what a scene needs and for nothing else: passes that are skipped, fields that do not exist,
// directions in which nobody looks, and the limits of the step that follow from the phases.
#include "plan/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "simulation/simulation.hpp"
#include "unit/scene_texts.hpp"

namespace barchan {
namespace {

const std::string air = R"(
[phases.air]
kind = "fluid"
density = 1.2
viscosity = 1e-3
)";
const std::string sand = R"(
[phases.sand]
kind = "grains"
density = 2650
)";
const std::string steel = R"(
[phases.steel]
kind = "elastic"
formulation = "updated-lagrangian"
density = 7870
young = 206e9
poisson = 0.3
)";

/// A unit square, ten spacings wide; each phase in a column of its own.
Scene scene(const std::string& phases, const std::string& interactions, const std::vector<std::string>& columns,
            const std::string& more = "") {
  std::string text = "spacing = 0.1\n[domain]\nsize = [1, 1]\nperiodic = [\"y\"]\ngravity = [0, -10]\n" + phases +
                     "[interactions]\nkernel = \"wendland-c2\"\n" + interactions + more;
  double left = 0.0;
  for (const auto& name : columns) {
    const double right = left + 0.3;
    text += "[[fill]]\nphase = \"" + name + "\"\nshape = { box = { min = [" + std::to_string(left) + ", 0], max = [" +
            std::to_string(right) + ", 1] } }\n";
    left = right;
  }
  return parse_scene(text + "[time]\nend = 1\n", "test.toml");
}

Plan plan_of(const Scene& s) { return make_plan(s, generate(s)); }

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}
void expect_runs(const Plan& plan, const std::vector<std::string>& passes) {
  for (const auto& p : passes) EXPECT_TRUE(has(plan.passes, p) && !has(plan.skipped, p)) << p;
}
void expect_skips(const Plan& plan, const std::vector<std::string>& passes) {
  for (const auto& p : passes) EXPECT_TRUE(has(plan.skipped, p) && !has(plan.passes, p)) << p;
}

const PlanEntry& entry(const Plan& plan, const std::string& name) {
  for (const auto& e : plan.entries)
    if (e.name == name) return e;
  throw std::runtime_error("no entry " + name);
}

TEST(Plan, AirAloneIsOnlyAFluid) {
  const Scene s = scene(air + "scheme = \"plain\"\n", "air-air = 3.0\n", {"air"});
  const Plan plan = plan_of(s);
  expect_runs(plan, {"kick and drift", "neighbours", "pack", "fluid rates", "kick"});
  expect_skips(plan, {"elastic strain", "wall motion", "extension into walls", "extension into solids",
                      "wall repulsion", "elastic forces", "contacts", "reaction on solids"});
  const Simulation run(s, plan, generate(s));
  const PhaseParticles& p = run.phases()[0];
  for (const Field f : {Field::position, Field::velocity, Field::density, Field::pressure, Field::acceleration,
                        Field::density_rate, Field::shift_velocity})
    EXPECT_TRUE(p.has(f)) << info(f).name;
  for (const Field f : {Field::stress, Field::velocity_gradient, Field::energy, Field::anisotropy, Field::wall_normal,
                        Field::wall_depth, Field::smoothing_length})
    EXPECT_FALSE(p.has(f)) << info(f).name;
}

TEST(Plan, WarnsOfFieldsForFramesThatNoPhaseHas) {
  Scene s = scene(air, "air-air = 3.0\n", {"air"});
  const std::size_t others = plan_of(s).warnings.size();
  s.output.fields = {"smoothing_length", "shift_velocity", "id"};
  EXPECT_EQ(plan_of(s).warnings.size(), others);
  s.output.fields = {"shift_velocity", "strain", "radius"};
  std::string all;
  for (const std::string& text : plan_of(s).warnings) all += text;
  EXPECT_NE(all.find("no phase of this scene has \"strain\""), std::string::npos) << all;
  EXPECT_NE(all.find("no phase of this scene has \"radius\""), std::string::npos) << all;
  EXPECT_EQ(all.find("\"shift_velocity\""), std::string::npos) << all;
}

TEST(Plan, ModelsThatAreOffHaveNoFields) {
  const auto fields = [](const std::string& more) {
    return plan_of(scene(air + more, "air-air = 3.0\n", {"air"})).phases[0].fields;
  };
  const auto in = [](const std::vector<Field>& f, Field field) {
    return std::find(f.begin(), f.end(), field) != f.end();
  };
  EXPECT_FALSE(in(fields("shifting = 0\n"), Field::shift_velocity));
  EXPECT_FALSE(in(fields("scheme = \"plain\"\n"), Field::anisotropy));
  EXPECT_TRUE(in(fields(""), Field::anisotropy)) << "the default is consistent";
}

TEST(Plan, GrainsAloneHaveContactsAndNoDensity) {
  const Plan plan = plan_of(scene(sand, "sand-sand = { radius = 1.1, kernel = \"cubic-spline\" }\n", {"sand"}));
  expect_runs(plan, {"contacts"});
  expect_skips(plan,
               {"fluid rates", "elastic strain", "elastic forces", "extension into solids", "reaction on solids"});
  const auto& fields = plan.phases[0].fields;
  EXPECT_EQ(std::find(fields.begin(), fields.end(), Field::density), fields.end());
  EXPECT_EQ(std::find(fields.begin(), fields.end(), Field::pressure), fields.end());
}

TEST(Plan, BodiesHaveStress) {
  const Plan plan = plan_of(scene(steel, "steel-steel = 2.4\n", {"steel"}));
  expect_runs(plan, {"elastic strain", "elastic forces"});
  expect_skips(plan, {"fluid rates", "contacts", "extension into walls", "reaction on solids"});
  const auto& fields = plan.phases[0].fields;
  EXPECT_NE(std::find(fields.begin(), fields.end(), Field::stress), fields.end());
  EXPECT_NEAR(plan.phases[0].sound_speed, 5936.0, 0.5) << "compression waves in steel";
}

TEST(Plan, AnEntryThatIsNotThereCostsNothing) {
  const auto both = [](const std::string& entries) { return plan_of(scene(air + sand, entries, {"air", "sand"})); };
  const Plan coupled = both("air-air = 3.0\nair-sand = 2.5\n"), apart = both("air-air = 3.0\n");
  EXPECT_EQ(coupled.directions.size(), 3u);
  expect_runs(coupled, {"extension into solids", "reaction on solids"});
  ASSERT_EQ(apart.directions.size(), 1u);
  EXPECT_EQ(apart.directions[0].a, 0u);
  EXPECT_EQ(apart.directions[0].b, 0u);
  expect_skips(apart, {"extension into solids", "reaction on solids", "contacts"});
  const Scene s = scene(air + sand, "air-air = 3.0\n", {"air", "sand"});
  const Simulation run(s, apart, generate(s));
  EXPECT_TRUE(run.neighbours().has_grid(0));
  EXPECT_FALSE(run.neighbours().has_grid(1)) << "sand without entries is neither sorted nor searched";
}

TEST(Plan, LawsFollowFromTheKinds) {
  const std::string wall = "[phases.floor]\nkind = \"wall\"\n", ghosts = wall + "law = \"repulsive\"\n";
  const Scene s = scene(air + sand + steel + wall,
                        "air-air = 3.0\nair-sand = 2.5\nair-floor = 3.0\nair-steel = 2.5\nsand-sand = 1.1\n"
                        "sand-steel = 1.1\nsteel-steel = 2.4\n",
                        {"air", "sand", "steel"}, "[[fill]]\nphase = \"floor\"\nshape = { sides = [\"left\"] }\n");
  const Plan plan = plan_of(s);
  const std::vector<std::pair<std::string, std::string>> laws{
      {"air-air", "fluid"},     {"air-sand", "coupling"},  {"air-floor", "boundary"}, {"air-steel", "coupling"},
      {"sand-sand", "contact"}, {"sand-steel", "contact"}, {"steel-steel", "elastic"}};
  for (const auto& [name, law] : laws) EXPECT_EQ(entry(plan, name).law, law) << name;
  EXPECT_NEAR(entry(plan, "air-sand").radius, 0.25, 1e-15) << "2.5 spacings";
  const Plan repelled = plan_of(scene(air + ghosts, "air-air = 3.0\nair-floor = 1.5\n", {"air"},
                                      "[[fill]]\nphase = \"floor\"\nshape = { sides = [\"left\"], layers = 1 }\n"));
  EXPECT_EQ(entry(repelled, "air-floor").law, "repulsive");
  expect_runs(repelled, {"wall repulsion"});
  expect_skips(repelled, {"extension into walls"});
}

TEST(Plan, WallsLookOnlyWhereTheyMust) {
  const std::string wall = "[phases.floor]\nkind = \"wall\"\n";
  const Scene s = scene(air + sand + wall, "air-air = 3.0\nair-floor = 3.0\nsand-sand = 1.1\nsand-floor = 1.1\n",
                        {"air", "sand"}, "[[fill]]\nphase = \"floor\"\nshape = { sides = [\"left\"] }\n");
  const Plan plan = plan_of(s);
  EXPECT_GE(entry(plan, "air-floor").backward, 0) << "the wall looks for the fluid that it continues";
  EXPECT_LT(entry(plan, "sand-floor").backward, 0) << "it feels no grain";
  EXPECT_EQ(plan.directions.size(), 5u);
}

TEST(Plan, EveryPhaseBringsItsLimits) {
  const auto limits = [](const Plan& plan) {
    std::vector<std::string> names;
    for (const auto& l : plan.limits) {
      EXPECT_GT(l.value, 0.0);
      EXPECT_FALSE(l.reason.empty());
      names.push_back(l.name);
    }
    return names;
  };
  const std::string entries = "air-air = 3.0\nsand-sand = 1.1\nsteel-steel = 2.4\n";
  const Plan plan = plan_of(scene(air + sand + steel, entries, {"air", "sand", "steel"}));
  for (const char* name : {"acoustic air", "viscous air", "contact sand", "elastic steel"})
    EXPECT_TRUE(has(limits(plan), name)) << name;
  double smallest = 1e300;
  for (const auto& l : plan.limits) smallest = std::min(smallest, l.value);
  EXPECT_EQ(plan.step(), smallest);
  Scene careful = scene(air, "air-air = 3.0\n", {"air"});
  const double step = plan_of(careful).step();
  careful.time.safety = 0.5;
  EXPECT_NEAR(plan_of(careful).step(), 0.5 * step, 1e-15);
  careful.time.fixed_step = 1e-7;
  EXPECT_EQ(plan_of(careful).step(), 1e-7);
}

TEST(Plan, SaysWhichEntriesAreConsistent) {
  const Scene s = parse_scene(testing::dune_text, "dune.toml");
  std::vector<ParticleBlock> blocks(2);  // one particle each will do
  for (auto& b : blocks) b = {{{0.1, 0.05, 0}}, {{0, 0, 0}}, {}};
  Scene silent = s;
  silent.time.largest_speed = 10.0;
  std::get<FluidKeys>(silent.phases[0].own).turbulence = Turbulence::none;
  const Plan plan = make_plan(silent, blocks);
  EXPECT_TRUE(entry(plan, "air-air").consistency.consistent());
  EXPECT_TRUE(entry(plan, "air-air").corrected);
  EXPECT_FALSE(entry(plan, "sand-sand").consistency.consistent());
  EXPECT_FALSE(entry(plan, "sand-sand").corrected);
  const std::string text = to_text(plan, silent);
  EXPECT_NE(text.find("a contact law, not an approximation"), std::string::npos);
  EXPECT_NE(text.find("skipped"), std::string::npos);
}

/// Wendland C2 at 2.1 spacings: sum V W is 3 % off on the lattice, which the consistent scheme divides out.
TEST(Plan, SaysThatTheConsistentSchemeCorrectsItsSums) {
  const auto line = [](const std::string& scheme) {
    const Scene s = scene(air + scheme, "air-air = 2.1\n", {"air"});
    const std::string text = to_text(plan_of(s), s);
    const std::size_t at = text.find("air-air");
    return text.substr(at, text.find('\n', at) - at);
  };
  EXPECT_TRUE(line("").ends_with("corrected to first order by the consistent scheme")) << line("");
  const std::string plain = line("scheme = \"plain\"\n");
  EXPECT_TRUE(plain.ends_with("off by more than 3 %, and nothing corrects it")) << plain;
}

TEST(Plan, EddiesAreThereOnlyIfAsked) {
  const std::string floor = "[phases.floor]\nkind = \"wall\"\ndensity = 1\n";
  const std::string below = "[[fill]]\nphase = \"floor\"\nshape = { sides = [\"left\"] }\n";
  const std::string entries = "air-air = 3.0\nair-floor = 3.0\n";
  const auto eddies = [](const Plan& plan) {
    const auto& f = plan.phases[0].fields;
    const bool fields = std::find(f.begin(), f.end(), Field::eddy_viscosity) != f.end();
    EXPECT_EQ(fields, plan.phases[0].eddies);
    EXPECT_EQ(fields, has(plan.passes, "eddies"));
    return fields;
  };
  EXPECT_FALSE(eddies(plan_of(scene(air + floor, entries, {"air"}, below))));
  EXPECT_TRUE(eddies(plan_of(scene(air + "turbulence = \"mixing-length\"\n" + floor, entries, {"air"}, below))));
  EXPECT_TRUE(eddies(plan_of(scene(air + floor + "roughness = 1e-3\n", entries, {"air"}, below))));
  EXPECT_TRUE(eddies(plan_of(scene(air + floor + "shear-stress = [0, 1]\n", entries, {"air"}, below))));
}

// Only a fluid that ends somewhere has a free surface: its fields and its pass. Walls below, periodic above.
TEST(Plan, FreeSurfacesAreOfFluidsThatEnd) {
  const auto surface = [](const std::string& lower, const std::string& key, const std::string& box) {
    const Scene s = parse_scene("spacing = 0.1\n[domain]\nsize = [2, 2]\nperiodic = [\"x\"" + lower + "]\n" + air +
                                    key + "[interactions]\nair-air = 2.6\n[[fill]]\nphase = \"air\"\nshape = " + box +
                                    "\n[time]\nend = 1\nlargest-speed = 1\n",
                                "test.toml");
    const Plan plan = plan_of(s);
    const auto& fields = plan.phases[0].fields;
    const auto owned = [&](Field f) { return std::find(fields.begin(), fields.end(), f) != fields.end(); };
    EXPECT_EQ(owned(Field::wholeness), plan.phases[0].free_surface);
    EXPECT_EQ(owned(Field::surface_normal), plan.phases[0].free_surface);
    EXPECT_EQ(has(plan.passes, "free surface"), plan.phases[0].free_surface);
    EXPECT_NE(has(plan.skipped, "free surface"), plan.phases[0].free_surface);
    const Simulation run(s, plan, generate(s));
    EXPECT_EQ(run.phases()[0].has(Field::wholeness), plan.phases[0].free_surface);
    for (std::size_t k = 0; k < run.seconds().size(); ++k)
      if (run.seconds()[k].first == "free surface") { EXPECT_EQ(run.executed()[k] > 0, plan.phases[0].free_surface); }
    return plan.phases[0].free_surface;
  };
  const std::string half = "{ box = { min = [0, 0], max = [2, 1] } }";
  EXPECT_FALSE(surface(", \"y\"", "", "\"the-rest\""));
  EXPECT_TRUE(surface(", \"y\"", "", half));
  EXPECT_TRUE(surface("", "", half));
  EXPECT_FALSE(surface("", "enclosed = true\n", half)) << "a void in it closes";
  for (const std::string scheme : {"scheme = \"plain\"\n", "scheme = \"consistent\"\n"}) {
    EXPECT_TRUE(surface("", scheme, half));
    EXPECT_FALSE(surface(", \"y\"", scheme, "\"the-rest\""));
  }
}

// In mixed precision a fluid has compact records only, unless somebody asks for others: here its neighbour.
TEST(Plan, TheEnergyOfOneFluidReadsTheRecordsOfTheOther) {
  const std::string plain = "scheme = \"plain\"\n";
  const Scene s = scene(air + plain + "energy = true\n" + "[phases.water]\nkind = \"fluid\"\ndensity = 2\n" + plain,
                        "air-air = 2.1\nair-water = 2.1\nwater-water = 2.1\n", {"air", "water"});
  const auto blocks = generate(s);
  Simulation run(s, make_plan(s, blocks), blocks);
  for (int k = 0; k < 3; ++k) run.step(1.0);
  const PhaseParticles& fluid = run.phases()[0];
  for (std::size_t k = 0; k < fluid.size(); ++k) EXPECT_TRUE(std::isfinite(fluid.column(Field::energy)[k]));
  EXPECT_FALSE(run.phases()[1].has(Field::energy));
}

TEST(Plan, RefusesWhatNoLawCanDo) {
  const std::string wall = "[phases.floor]\nkind = \"wall\"\ndensity = 1\n";
  EXPECT_THROW(plan_of(scene(air + sand, "air-sand = 2.5\nsand-sand = 1.1\n", {"air", "sand"})), SceneError);
  EXPECT_THROW(plan_of(scene(air + wall, "air-air = 3.0\nfloor-floor = 3.0\n", {"air"},
                             "[[fill]]\nphase = \"floor\"\nshape = { sides = [\"left\"] }\n")),
               SceneError);
  const std::string turbulent = air + "turbulence = \"smagorinsky\"\n";
  const std::string water = "[phases.water]\nkind = \"fluid\"\ndensity = 1000\n";
  const std::string own = "air-air = 3.0\nwater-water = 3.0\n";
  EXPECT_NO_THROW(plan_of(scene(turbulent + water, own, {"air", "water"})));
  EXPECT_THROW(plan_of(scene(turbulent + water, own + "air-water = 3.0\n", {"air", "water"})), SceneError);
}

}  // namespace
}  // namespace barchan
