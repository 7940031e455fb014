// Hops of grains against parabolas, by size, on any number of threads and from a checkpoint.
#include "models/grains/hops.hpp"
#include "physics/drive.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>

#include "output/whole_file.hpp"
#include "physics/small_scenes.hpp"

namespace barchan {
namespace {

using testing::run_to;

constexpr double gravity = 9.81, height = 0.02, along = 0.7;  // m/s2; m over the place of the bounce; m/s

/// Grains without air that fall on a floor and bounce without loss.
std::string bouncing(const std::string& points, const std::string& diameter = "1e-3", bool solid = false,
                     const std::string& keys = "") {
  return std::string("dimensions = ") + (solid ? "3" : "2") + R"toml(
spacing = 1e-3
[domain]
size = )toml" +
         (solid ? "[0.1, 0.05, 0.03]\nperiodic = [\"x\", \"z\"]\ngravity = [0, -9.81, 0]"
                : "[0.1, 0.05]\nperiodic = [\"x\"]\ngravity = [0, -9.81]") +
         R"toml(
[phases.sand]
kind = "grains"
density = 2650
restitution = 1
stiffness = 300
diameter = )toml" +
         diameter + R"toml(
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
         points + " }\nvelocity = " + (solid ? "[0.7, 0, 0.2]" : "[0.7, 0]") + R"toml(
[[saltation]]
name = "s"
phase = "sand"
)toml" + keys +
         R"toml(
[time]
end = 1
largest-speed = 1
)toml";
}

/// A table of hops: its rows by column.
using Rows = std::vector<std::map<std::string, double>>;

std::string text_of(const Simulation& run) {
  const auto folder = std::filesystem::temp_directory_path() /
                      (std::string("barchan_hops_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
  std::filesystem::create_directories(folder);
  run.write_results(folder.string(), run.time());
  std::string text = read_text(folder / "hops_s.csv");
  std::filesystem::remove_all(folder);
  return text;
}

Rows rows_of(const std::string& text) {
  std::istringstream lines(text);
  std::string line, cell;
  std::getline(lines, line);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');)
    names.push_back(cell.substr(0, cell.find(" [")));
  Rows rows;
  while (std::getline(lines, line)) {
    rows.emplace_back();
    std::size_t column = 0;
    for (std::istringstream cells(line); std::getline(cells, cell, ',');)
      rows.back()[names[column++]] = std::stod(cell);
  }
  return rows;
}

class Hops : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, Hops, ::testing::Bool());

/// A parabola: length 2 u v/g, apex v^2/(2 g), time 2 v/g, both angles atan(v/u). Launch and impact are known to a
/// step.
TEST_P(Hops, OfAGrainWithoutAirAreParabolas) {
  const bool solid = GetParam();
  const auto run = small::simulation(bouncing(solid ? "[[0.09, 0.0205, 0.01]]" : "[[0.09, 0.0205]]", "1e-3", solid));
  const double up = std::sqrt(2.0 * gravity * height), time = 2.0 * up / gravity;  // 0.626 m/s, 0.128 s
  run_to(*run, 4.7 * time);  // the fall, four whole hops over the periodic side, and a part of a fifth
  const auto all = rows_of(text_of(*run)).at(0);
  const double step = run->last_step(), ground_speed = std::hypot(along, solid ? 0.2 : 0.0);
  const double angle = 180.0 / std::numbers::pi * std::atan2(up, ground_speed);
  EXPECT_EQ(all.at("hops"), 4.0);
  EXPECT_NEAR(all.at("length_mean"), along * time, 2.0 * along * step);
  EXPECT_NEAR(all.at("apex_mean"), height, 2.0 * up * step);
  EXPECT_NEAR(all.at("flight_time_mean"), time, 2.0 * step);
  for (const char* end : {"launch", "impact"}) {
    EXPECT_NEAR(all.at(end + std::string("_speed_mean")), std::hypot(up, ground_speed), gravity * step) << end;
    EXPECT_NEAR(all.at(end + std::string("_angle_mean")), angle, 100.0 * gravity * step) << end;
  }
  EXPECT_LT(all.at("length_std"), 2.0 * along * step);
  EXPECT_DOUBLE_EQ(all.at("diameter_mean"), 1e-3);
}

/// Flights that rise less than `flight` diameters are none, and those that end before `start` are not counted.
TEST(Hops, CountFromAHeightAndATime) {
  const double time = 2.0 * std::sqrt(2.0 * height / gravity);
  const std::string place = "[[0.05, 0.0205]]";
  for (const auto& [keys, expected] :
       {std::pair{"flight = 19.5", 3.0}, std::pair{"flight = 20.5", 0.0}, std::pair{"flight = 5\nstart = 0.25", 2.0}}) {
    const auto run = small::simulation(bouncing(place, "1e-3", false, keys));
    run_to(*run, 3.7 * time);  // impacts at 0.19, 0.32 and 0.45 s
    const auto all = rows_of(text_of(*run)).at(0);
    EXPECT_EQ(all.at("hops"), expected) << keys;
    EXPECT_EQ(std::isnan(all.at("length_mean")), expected == 0.0);
  }
}

const std::string many =
    "[[0.01, 0.02], [0.02, 0.03], [0.03, 0.01], [0.04, 0.02], [0.05, 0.04], [0.06, 0.025], [0.07, 0.03], [0.08, "
    "0.015]]";
const std::string sizes = "{ mean = 1e-3, spread = 0.3 }";

TEST(Hops, AreCountedByThirdsOfTheDiameters) {
  const auto run = small::simulation(bouncing(many, sizes));
  run_to(*run, 0.6);
  const Rows rows = rows_of(text_of(*run));
  ASSERT_EQ(rows.size(), 4u);
  double hops = 0.0, lengths = 0.0;
  for (std::size_t k = 1; k < 4; ++k) {
    EXPECT_NEAR(rows[k].at("diameter_low"), 0.7e-3 + 0.2e-3 * (static_cast<double>(k) - 1.0), 1e-12);
    if (rows[k].at("hops") == 0.0) continue;
    EXPECT_GE(rows[k].at("diameter_mean"), rows[k].at("diameter_low"));
    EXPECT_LE(rows[k].at("diameter_mean"), rows[k].at("diameter_high"));
    hops += rows[k].at("hops");
    lengths += rows[k].at("hops") * rows[k].at("length_mean");
  }
  EXPECT_GT(hops, 16.0);
  EXPECT_EQ(hops, rows[0].at("hops"));
  EXPECT_NEAR(lengths / hops, rows[0].at("length_mean"), 1e-7);
}

TEST(Hops, HaveTheSameBitsOnTwoThreadsAndFromACheckpoint) {
  const int threads = omp_get_max_threads();
  const auto bytes_of = [](Simulation& run) {
    Archive a;
    run.archive(a);
    return a.bytes();
  };
  omp_set_num_threads(1);
  const auto straight = small::simulation(bouncing(many, sizes));
  run_to(*straight, 0.24);
  const auto bytes = bytes_of(*straight);
  run_to(*straight, 0.25);
  omp_set_num_threads(2);
  const auto again = small::simulation(bouncing(many, sizes));
  Archive from(bytes);
  again->archive(from);
  run_to(*again, 0.25);
  omp_set_num_threads(threads);
  EXPECT_EQ(text_of(*straight), text_of(*again));
  EXPECT_EQ(bytes_of(*straight), bytes_of(*again));
  EXPECT_GT(rows_of(text_of(*straight)).at(0).at("hops"), 4.0);
}

/// Who does not ask has no column of flights.
TEST(Hops, CostNothingWhereNobodyAsks) {
  const std::string with = bouncing(many, sizes);
  std::string without = with;
  const auto from = without.find("[[saltation]]");
  without.erase(from, without.find("[time]") - from);
  const auto asked = small::simulation(with), plain = small::simulation(without);
  EXPECT_GE(asked->phases()[0].bytes(), plain->phases()[0].bytes() + sizeof(Flight) * plain->phases()[0].size());
  run_to(*asked, 0.1);
  run_to(*plain, 0.1);
  for (std::size_t k = 0; k < plain->phases().size(); ++k)
    for (std::size_t i = 0; i < plain->phases()[k].size(); ++i)
      EXPECT_EQ(asked->phases()[k].column(Field::position, 1)[i], plain->phases()[k].column(Field::position, 1)[i]);
}

}  // namespace
}  // namespace barchan
