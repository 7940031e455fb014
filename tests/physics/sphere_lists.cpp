// Lists of pairs of spheres where sizes differ much, and on periodic axes that are narrower than two spheres.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "physics/drive.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::value;

/// Grains in a row across a period; `size`: of the domain, `points` of the grains.
std::string row_across(const std::string& size, const std::string& points, const std::string& keys = "") {
  return R"toml(
spacing = 1e-3
[domain]
size = )toml" +
         size + R"toml(
periodic = ["x"]
)toml" + keys +
         R"toml(
[phases.sand]
kind = "grains"
density = 2650
diameter = 1.02e-3
stiffness = 500
friction = 0.5
rolling-friction = 0.2
restitution = 0.6
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "sand"
shape = { points = )toml" +
         points + R"toml( }
velocity = [0.3, 0]
[time]
end = 1
largest-speed = 0.5
)toml";
}

// Two grains that fill a period touch on both sides, as four do in a domain twice as wide.
TEST(NarrowPeriod, BothSidesOfAGrainTouch) {
  const auto narrow = small::simulation(row_across("[0.002, 0.03]", "[[0.0005, 0.01], [0.0015, 0.01]]"));
  const auto wide = small::simulation(
      row_across("[0.004, 0.03]", "[[0.0005, 0.01], [0.0015, 0.01], [0.0025, 0.01], [0.0035, 0.01]]"));
  for (auto* run : {narrow.get(), wide.get()}) run->step(1e-6);
  EXPECT_EQ(value(*narrow, "contacts"), 2.0);
  EXPECT_EQ(value(*wide, "contacts"), 4.0);
  // 1/2 K (20 um)^2 in each contact
  const double stored = value(*narrow, "contacts_stored_energy [");
  EXPECT_GT(stored, 0.0);
  EXPECT_NEAR(stored, 0.5 * value(*wide, "contacts_stored_energy ["), 1e-9 * stored);
}

// A heap that slides across the periodic side again and again, in a period of a diameter and a half, moves as each half
// of the same heap does in a domain twice as wide, whose axis has room for two spheres: contacts keep their friction.
TEST(NarrowPeriod, MovesAsInADomainTwiceAsWide) {
  const std::string weight = "gravity = [0, -9.81]";
  std::string once, twice;
  for (int k = 0; k < 10; ++k) {
    const double x = 1e-4 + 7.3e-4 * (k % 2) + 2e-5 * k, y = 0.52e-3 + 0.76e-3 * k;
    for (const int copy : {0, 1}) {
      char place[80];
      std::snprintf(place, sizeof place, "[%.9g, %.9g]", x + 1.5e-3 * copy, y);
      if (copy == 0) once += (once.empty() ? "" : ", ") + std::string(place);
      twice += (twice.empty() ? "" : ", ") + std::string(place);
    }
  }
  const std::string same = "spacing=1.5e-3";
  const auto narrow = small::simulation(row_across("[0.0015, 0.03]", "[" + once + "]", weight), {same});
  const auto wide = small::simulation(row_across("[0.003, 0.03]", "[" + twice + "]", weight), {same});
  double most_contacts = 0.0;
  while (narrow->time() < 0.02) {
    narrow->step(4e-5);
    wide->step(4e-5);
    most_contacts = std::max(most_contacts, value(*narrow, "contacts"));
  }
  EXPECT_GE(most_contacts, 8.0);
  const PhaseParticles &a = narrow->phases()[0], &b = wide->phases()[0];
  ASSERT_EQ(2 * a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (2 * (a.id()[k] - a.first_id()) != b.id()[j] - b.first_id()) continue;
      double x = a.column(Field::position, 0)[k] - b.column(Field::position, 0)[j];
      x -= 1.5e-3 * std::round(x / 1.5e-3);
      EXPECT_NEAR(x, 0.0, 1e-8);
      EXPECT_NEAR(a.column(Field::position, 1)[k], b.column(Field::position, 1)[j], 1e-8);
      EXPECT_NEAR(a.column(Field::angular_velocity)[k], b.column(Field::angular_velocity)[j], 1e-2);
    }
}

TEST(NarrowPeriod, BelowOneDiameterIsRefusedWithTheRemedy) {
  try {
    parse_scene(row_across("[0.001, 0.03]", "[[0.0005, 0.01]]"), "row.toml", {});
    FAIL() << "a grain that overlaps itself is accepted";
  } catch (const SceneError& e) {
    const std::string told = e.what();
    EXPECT_NE(told.find("domain.size: 0.001 m along the periodic axis x is less than the largest diameter of \"sand\""),
              std::string::npos)
        << told;
    EXPECT_NE(told.find("expected at least 0.00102 m"), std::string::npos) << told;
  }
  EXPECT_NO_THROW(parse_scene(row_across("[0.002, 0.03]", "[[0.0005, 0.01]]"), "row.toml", {}));
}

// A grain on a row of grains along a narrow z: it rests on two images of the one below it.
TEST(NarrowPeriod, AGrainRestsOnTwoImagesOfAnother) {
  const auto run = small::simulation(R"toml(
dimensions = 3
spacing = 2e-4
[domain]
size = [0.02, 0.02, 0.003]
periodic = ["z"]
gravity = [0, -9.81, 0]
[phases.a]
kind = "grains"
density = 2500
diameter = 2e-3
restitution = 0.5
friction = 0.0
stiffness = 500
spacing = 2e-4
[phases.floor]
kind = "wall"
[interactions]
a-a = { law = "linear" }
a-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "a"
shape = { points = [[0.01, 0.001, 0.00075], [0.01, 0.0023228756555322954, 0.00225]] }
[time]
end = 1
largest-speed = 0.3
)toml");
  while (run->time() < 0.1) run->step(1e-3);
  EXPECT_EQ(value(*run, "contacts"), 3.0);
  EXPECT_NEAR(run->phases()[0].column(Field::position, 1)[1], 2.3228756e-3, 2e-6);
  EXPECT_NEAR(run->phases()[0].column(Field::position, 2)[1], 2.25e-3, 1e-9);
}

/// A box of small grains with one of another phase above it.
std::string bed_under_one(int dimensions, const std::string& diameter) {
  const bool flat = dimensions == 2;
  return std::string("dimensions = ") + (flat ? "2" : "3") + R"toml(
spacing = 1e-3
[domain]
size = )toml" +
         (flat ? "[0.08, 0.16]" : "[0.02, 0.09, 0.02]") + R"toml(
gravity = )toml" +
         (flat ? "[0, -9.81]" : "[0, -9.81, 0]") + R"toml(
[phases.small]
kind = "grains"
density = 2500
diameter = 1e-3
restitution = 0.5
friction = 0.3
stiffness = 1000
[phases.big]
kind = "grains"
density = 2500
diameter = )toml" +
         diameter + R"toml(
restitution = 0.5
friction = 0.3
stiffness = 1000
[interactions]
small-small = { law = "linear" }
small-big = { law = "linear" }
[[fill]]
phase = "small"
shape = { box = { min = )toml" +
         (flat ? "[0, 0], max = [0.08, 0.05]" : "[0, 0, 0], max = [0.02, 0.02, 0.02]") + R"toml( } }
[[fill]]
phase = "big"
shape = { points = )toml" +
         (flat ? "[[0.04, 0.0755]]" : "[[0.01, 0.0455, 0.01]]") + R"toml( }
velocity = )toml" +
         (flat ? "[0, -1]" : "[0, -1, 0]") + R"toml(
[time]
end = 1
largest-speed = 1.2
)toml";
}

// One grain of fifty diameters adds its own pairs to the lists and no others.
TEST(SphereSizes, ALargeGrainLeavesThePairsOfTheSmallOnesAlone) {
  for (const int dimensions : {2, 3}) {
    std::array<std::uint64_t, 2> of_small{}, of_large{};
    for (const bool large : {false, true}) {
      const auto run = small::simulation(bed_under_one(dimensions, large ? "5e-2" : "1e-3"));
      for (int k = 0; k < 40; ++k) run->step(2e-5);
      for (const PlanEntry& e : run->plan().entries) (e.a == e.b ? of_small : of_large)[large ? 1 : 0] += run->pairs(e);
    }
    EXPECT_LE(static_cast<double>(of_small[1]), 1.1 * static_cast<double>(of_small[0])) << dimensions;
    EXPECT_LE(of_large[1], dimensions == 2 ? 60u : 500u) << dimensions;
    EXPECT_GT(of_large[1], 0u);
  }
}

/// The values of the field radius in a frame, of a phase.
std::vector<double> radii_of(const std::string& phase, const std::string& sand, const std::string& stone) {
  const auto run = small::simulation(R"toml(
spacing = 1e-3
[domain]
size = [0.02, 0.02]
[phases.sand]
kind = "grains"
density = 2500
stiffness = 100
diameter = )toml" + sand + R"toml(
[phases.stone]
kind = "wall"
diameter = )toml" + stone + R"toml(
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 10
[interactions]
sand-sand = { law = "linear" }
sand-stone = { law = "linear" }
water-water = 2.1
[[fill]]
phase = "stone"
shape = { points = [[0.003, 0.003], [0.006, 0.003]] }
[[fill]]
phase = "sand"
shape = { points = [[0.005, 0.005], [0.008, 0.008], [0.008, 0.006]] }
[[fill]]
phase = "water"
shape = { box = { min = [0.01, 0.01], max = [0.02, 0.02] } }
[time]
end = 1
largest-speed = 0.1
[output]
fields = ["radius"]
)toml");
  const Frame frame = run->frame(0);
  std::vector<double> radii;
  for (const FrameField& field : frame.fields)
    for (std::size_t k = 0; field.name == "radius" && k < frame.size(); ++k)
      if (frame.phase_names[static_cast<std::size_t>(frame.phase[k])] == phase) radii.push_back(field.values[k]);
  return radii;
}

// Grains of one diameter have a radius too, and so have walls of spheres.
TEST(FieldRadius, IsThatOfEachSphere) {
  for (const char* phase : {"sand", "stone"}) {
    const std::vector<double> one = radii_of(phase, "1e-3", "1e-3");
    ASSERT_FALSE(one.empty());
    for (const double radius : one) EXPECT_EQ(radius, 0.5e-3) << phase;
    const std::string sizes = "{ mean = 1e-3, spread = 0.2 }";
    const std::vector<double> many = radii_of(phase, sizes, sizes);
    EXPECT_NE(many[0], many[1]) << phase;
    for (const double radius : many) EXPECT_NEAR(radius, 0.5e-3, 0.1e-3) << phase;
  }
  for (const double radius : radii_of("water", "1e-3", "1e-3")) EXPECT_EQ(radius, 0.0);
}

/// What a step starts from goes into the archive, whatever the sizes and the images.
void expect_same_after_restart(const std::string& text, const std::vector<std::string>& keys) {
  const auto run = small::simulation(text, keys), other = small::simulation(text, keys);
  for (int k = 0; k < 60; ++k) run->step(2e-5);
  Archive saved;
  run->archive(saved);
  Archive loaded(saved.bytes());
  other->archive(loaded);
  omp_set_num_threads(2);
  for (int k = 0; k < 60; ++k) other->step(2e-5);
  omp_set_num_threads(1);
  for (int k = 0; k < 60; ++k) run->step(2e-5);
  EXPECT_EQ(run->history_row(), other->history_row());
  for (std::size_t p = 0; p < run->phases().size(); ++p)
    for (const Field field : {Field::position, Field::velocity, Field::angular_velocity})
      for (int d = 0; run->phases()[p].has(field) && d < run->phases()[p].components(field); ++d)
        for (std::size_t k = 0; k < run->phases()[p].size(); ++k)
          ASSERT_EQ(run->phases()[p].column(field, d)[k], other->phases()[p].column(field, d)[k]);
}

TEST(SphereSizes, GoOnWithTheSameBitsAfterARestart) { expect_same_after_restart(bed_under_one(2, "2e-2"), {}); }

TEST(NarrowPeriod, GoesOnWithTheSameBitsAfterARestart) {
  expect_same_after_restart(
      row_across("[0.0015, 0.03]", "[[0.0003, 0.00052], [0.0009, 0.0015], [0.0002, 0.0025], [0.001, 0.0035]]",
                 "gravity = [0, -9.81]"),
      {"spacing=1.5e-3"});
}

}  // namespace
}  // namespace barchan
