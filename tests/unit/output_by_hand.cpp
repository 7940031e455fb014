// What a run tells: names of components, errors of fits, the wind of a layer, dunes across a periodic side.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "measure/decay.hpp"
#include "measure/measurements.hpp"
#include "output/series.hpp"
#include "physics/small_scenes.hpp"
#include "start/ground.hpp"
#include "unit/output_example.hpp"

namespace barchan {
namespace {

// VTK and ParaView take the components of a symmetric tensor in this order, and show their names.
TEST(ResultsByHand, ComponentsOfAStressHaveTheNamesOfVtksOrder) {
  for (const FrameFormat format : {FrameFormat::vtp, FrameFormat::vtu}) {
    const example::TemporaryDirectory directory;
    const auto file = directory / (format == FrameFormat::vtp ? "frame.vtp" : "frame.vtu");
    Frame frame;
    frame.points = {0, 0, 0};
    frame.id = {0};
    frame.phase = {0};
    frame.phase_names = {"body"};
    frame.phase_kinds = {"elastic"};
    frame.fields = {{"stress", "Pa", 6, {1, 2, 3, 4, 5, 6}}};
    write_frame(file, frame, format, true);
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const char* const names[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    for (std::size_t c = 0; c < 6; ++c)
      EXPECT_NE(text.find("ComponentName" + std::to_string(c) + "=\"" + names[c] + "\""), std::string::npos)
          << names[c];
  }
}

// Four values of the same relative error about a line of ln q: slope and its standard error by the textbook, the sum of
// squares over n - 2.
TEST(ResultsByHand, TheErrorOfADecayIsThatOfALineThroughItsLogarithms) {
  const std::vector<double> y{0.0, 1.0, 2.0, 3.0}, l{1.0, 0.4, -0.3, -0.7};
  std::vector<double> q, errors;
  for (const double log_q : l) {
    q.push_back(std::exp(log_q));
    errors.push_back(0.1 * q.back());
  }
  const double middle = 1.5, mean = 0.1, spread = 5.0;
  double slope = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < 4; ++k) slope += (y[k] - middle) * (l[k] - mean) / spread;
  for (std::size_t k = 0; k < 4; ++k) squares += std::pow(l[k] - mean - slope * (y[k] - middle), 2);
  const Decay d = decay(y, q, errors);
  EXPECT_EQ(d.used, 4);
  EXPECT_NEAR(d.height, -1.0 / slope, 1e-12);
  EXPECT_NEAR(d.error, std::sqrt(squares / 2.0 / spread) / (slope * slope), 1e-12);
}

const std::string layer = R"toml(
spacing = 2.5e-4
[domain]
size = [0.01, 0.02]
periodic = ["x"]
gravity = [0, -9.81]
[phases.air]
kind = "column"
density = 1.2
viscosity = 1.5e-5
friction-velocity = 0.5
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 2.5e-4, spread = 0 }
stiffness = 150
[interactions]
air-sand = { drag = "duran" }
sand-sand = { law = "linear" }
[[fill]]
phase = "sand"
shape = { points = [[0.002, 0.005], [0.006, 0.005]] }
velocity = ["x < 0.004 ? 1 : 3", -0.5]
[[saltation]]
name = "sand"
phase = "sand"
count = 40
[time]
end = 1e-3
largest-speed = 10
)toml";

// Of the slices of a layer: the wind of the cell in which the middle of a slice is, and what the grains carry.
TEST(ResultsByHand, ALayerHasTheWindOfItsHeightAndWhatItsGrainsCarry) {
  const auto run = small::simulation(layer);
  State state = run->state();
  ASSERT_EQ(state.air.size(), 1u);
  AirProfile& air = state.air[0];
  for (std::size_t k = 0; k < air.cells(); ++k) air.speed[k] = 1.0 + static_cast<double>(k);
  Measurements measurements(run->plan().instruments, run->plan().bounds, {1.2, 2650});
  measurements.sample(state);
  const Table table = measurements.table(0);
  const auto column = [&](const std::string& name) {
    for (const FrameField& field : table.fields)
      if (field.name == name) return field.values;
    throw std::runtime_error("no field " + name);
  };
  const auto wind = column("air_speed"), flux = column("flux"), stress = column("grain_stress");
  ASSERT_EQ(table.places.size(), 40u);
  double carried = 0.0, pressed = 0.0;
  for (std::size_t row = 0; row < 40; ++row) {
    const double y = table.places[row][1];
    double expected = 0.0;
    for (std::size_t k = 0; k < air.cells(); ++k)
      if (y >= air.face[k] && y < air.face[k + 1]) expected = air.speed[k];
    EXPECT_EQ(wind[row], expected) << y;
    carried += flux[row] * 0.02 / 40;
    pressed += stress[row] * 0.02 / 40;
  }
  const double mass = state.phases[1].mass();  // of one grain, by metre of depth, over 0.01 m of ground
  EXPECT_NEAR(carried, mass * (1.0 + 3.0) / 0.01, 1e-9 * carried);
  EXPECT_NEAR(pressed, mass * 0.5 * (1.0 + 3.0) / 0.01, 1e-9 * pressed);
}

// A dune that is longer than half of a periodic domain: at every place the highest of its images, and nothing jumps.
TEST(ResultsByHand, ALongDuneGoesOnBeyondAPeriodicSide) {
  Domain domain;
  domain.size = {1.0, 0.5, 0.0};
  domain.periodic = {true, false, false};
  BedShape bed;
  bed.depth = 0.1;
  bed.dune = DuneShape{};
  bed.dune->form = DuneShape::Form::asymmetric;
  bed.dune->height = 0.1;
  bed.dune->length = 0.9;
  bed.dune->at = 0.2;
  bed.dune->slip_face_angle = 45.0;  // lee 0.1 m, windward 0.8 m
  const Ground once(bed, [&] {
    Domain open = domain;
    open.periodic = {false, false, false};
    return open;
  }());
  const Ground ground(bed, domain);
  for (int k = 0; k < 200; ++k) {
    const double x = 0.005 * k;
    EXPECT_NEAR(ground.height(x, 0.0),
                std::max({once.height(x - 1.0, 0.0), once.height(x, 0.0), once.height(x + 1.0, 0.0)}), 1e-14)
        << x;
    EXPECT_NEAR(ground.height(x, 0.0), ground.height(x + 0.002, 0.0), 2.1e-3) << x;
  }
  EXPECT_GT(ground.height(0.6, 0.0), 0.11) << "the tail of the image beyond the side";
}

}  // namespace
}  // namespace barchan
