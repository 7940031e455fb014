// Bodies: the restitution that a scene writes is the one that two particles have; bars and plates against exact
// solutions.
#include <algorithm>
#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

struct Meeting {
  double restitution, young, speed;  // -, Pa, m/s
  double density_b = 7870.0;         // kg/m3
  std::string formulation = "total-lagrangian";
};

/// The share of their relative speed that two single particles keep.
double restitution_of(const Meeting& m, int start) {
  const std::string young = number(m.young);
  std::vector<std::string> set{
      "interactions={ kernel = \"cubic-spline\", a-b = { restitution = " + number(m.restitution) + " } }",
      "phases.a.young=" + young,
      "phases.b.young=" + young,
      "phases.b.density=" + number(m.density_b),
      "phases.a.formulation=" + m.formulation,
      "phases.b.formulation=" + m.formulation,
      "fill.0.velocity=[" + number(m.speed) + ", 0, 0]",
      "time.largest-speed=" + number(m.speed),
      "time.end=1"};
  // Where the contact begins within a step is different for each start.
  const double wave = std::sqrt(m.young * 0.7 / (1.3 * 0.4 * 7870.0));
  set.push_back("fill.1.shape.points=[[" + number(0.003 + 1e-4 * 1e-3 * m.speed / wave * start) + ", 0.002, 0.002]]");
  Drive drive("verification/two_particle_impact", set);
  auto& s = drive.simulation();
  const auto apart = [&] {
    return drive.phase(1).column(Field::position)[0] - drive.phase(0).column(Field::position)[0];
  };
  const auto parting = [&] {
    return drive.phase(1).column(Field::velocity)[0] - drive.phase(0).column(Field::velocity)[0];
  };
  for (int k = 0; k < 20000 && !(parting() > 0.0 && apart() > 1e-3); ++k) s.step(1.0);
  return parting() / m.speed;
}

TEST(BodyContact, TwoParticlesKeepTheWrittenShareOfTheirSpeed) {
  double worst = 0.0, elastic = 0.0;
  std::vector<Meeting> meetings;
  for (const double e : {0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 1.0}) meetings.push_back({e, 206e9, 10.0});
  for (const double young : {206e6, 206e7, 206e8, 206e10, 206e11, 206e12}) {
    meetings.push_back({0.5, young, 10.0});
    meetings.push_back({1.0, young, 10.0});
  }
  for (const double speed : {0.1, 1.0, 100.0}) {
    meetings.push_back({0.2, 206e9, speed});
    meetings.push_back({1.0, 206e9, speed});
  }
  meetings.push_back({0.5, 206e9, 10.0, 787.0});
  meetings.push_back({1.0, 206e9, 10.0, 787.0});
  meetings.push_back({0.5, 206e9, 10.0, 7870.0, "updated-lagrangian"});
  for (const Meeting& m : meetings)
    for (const int start : {1, 17, 40}) {
      const double error = std::abs(restitution_of(m, start) - m.restitution);
      EXPECT_LE(error, m.restitution == 1.0 ? 1e-4 : 0.01)
          << "restitution " << m.restitution << ", E " << m.young << ", V " << m.speed << ", start " << start;
      double& most = m.restitution == 1.0 ? elastic : worst;
      most = std::max(most, error);
    }
  report("restitution 0.05 to 0.95, largest error", worst, 0.01);
  report("restitution 1, largest error", elastic, 1e-4);
}

TEST(BodyContact, FrictionStopsWhatSlides) {
  // A block slides on a floor: it stops after V^2/(2 mu g), and without friction it does not.
  const char* const scene = R"(dimensions = 2
spacing = 0.01
[domain]
size = [1.0, 0.2]
gravity = [0, -10]
[phases.block]
kind = "elastic"
density = 1000
young = 1e6
poisson = 0.2
retardation = 3e-4
[phases.floor]
kind = "wall"
[interactions]
block-block = 2.1
block-floor = { friction = 0.4, restitution = 0.2 }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "block"
shape = { box = { min = [0.1, 0.0], max = [0.2, 0.05] } }
velocity = [0.8, 0]
[time]
end = 0.4
)";
  Scene s = parse_scene(scene, "block.toml");
  const auto blocks = generate(s);
  Simulation simulation(s, make_plan(s, blocks), blocks);
  const auto mean = [&] {
    const auto& p = simulation.phases()[0];
    double sum = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k) sum += p.column(Field::position)[k];
    return sum / static_cast<double>(p.size());
  };
  const double start = mean();
  while (simulation.time() < 0.4) simulation.step(0.4 - simulation.time() + 1e-12);
  report("way over V^2/(2 mu g) - 1", (mean() - start) / 0.08 - 1.0, 0.05);
  EXPECT_NEAR(mean() - start, 0.08, 0.004);
}

TEST(TotalLagrangianBodies, APlateSwingsWithItsPeriodAndKeepsItsEnergy) {
  Drive drive("verification/cantilever", {"time.end=0.3"});
  auto& s = drive.simulation();
  const auto names = s.history_columns();
  const auto sum_of = [&](const std::vector<std::string>& wanted) {
    const auto row = s.history_row();
    double sum = 0.0;
    for (std::size_t k = 0; k < names.size(); ++k)
      if (std::any_of(wanted.begin(), wanted.end(),
                      [&](const std::string& name) { return names[k].starts_with(name); }))
        sum += row[k];
    return sum;
  };
  const auto energy = [&] {
    return sum_of({"plate_kinetic_energy [", "plate_strain_energy [", "plate_hourglass_energy ["});
  };
  const auto tip = [&] { return sum_of({"tip_y [m]"}) - 0.1; };
  const double start = energy();
  // Zeros of the tip's motion: half a period and a whole one. It starts at zero.
  std::vector<double> zeros;
  double y = 0.0, t = 0.0;
  int looked = 0;
  while (s.time() < 0.3) {
    s.step(0.3 - s.time() + 1e-12);
    if (++looked % 20 != 0) continue;
    const double now = tip();
    if (y * now < 0.0) zeros.push_back(t + (s.time() - t) * (y / (y - now)));
    y = now;
    t = s.time();
  }
  ASSERT_GE(zeros.size(), 2u);
  const double period = zeros[1];
  report("period over Timoshenko's 0.2565 s - 1", period / 0.2565 - 1.0, 0.015);
  report("energy kept", energy() / start - 1.0, 1e-4);
  EXPECT_NEAR(period / 0.2565, 1.0, 0.015);
  EXPECT_NEAR(energy() / start, 1.0, 1e-4);
}

/// The sum of the columns with these names.
double sum_of(const Simulation& run, const std::vector<std::string>& wanted) {
  const auto names = run.history_columns();
  const auto row = run.history_row();
  double sum = 0.0;
  std::size_t found = 0;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (std::any_of(wanted.begin(), wanted.end(),
                    [&](const std::string& name) { return names[k].starts_with(name); })) {
      sum += row[k];
      ++found;
    }
  EXPECT_EQ(found, wanted.size());
  return sum;
}

std::vector<std::string> energies_of(const std::string& body) {
  return {body + "_kinetic_energy [", body + "_strain_energy [", body + "_hourglass_energy ["};
}

TEST(TotalLagrangianBodies, RubberRingsBounceAndKeepMomentumAndEnergy) {
  Drive drive("rings", {"spacing=2e-3"});
  const Simulation& s = drive.simulation();
  const auto energy = [&] { return sum_of(s, energies_of("a")) + sum_of(s, energies_of("b")); };
  const auto momentum = [&] { return sum_of(s, {"momentum_x ["}); };
  const double energy_before = energy(), momentum_before = momentum();
  const double scale =
      sum_of(s, {"a_mean_vx [m/s]"}) * drive.phase(0).mass() * static_cast<double>(drive.phase(0).size());
  double drift = 0.0, stored = 0.0;
  for (int k = 1; k <= 16; ++k) {
    drive.to(1e-3 * k);
    drift = std::max(drift, std::abs(momentum() - momentum_before) / scale);
    stored = std::max(stored, sum_of(s, {"a_strain_energy [", "b_strain_energy ["}) / energy_before);
  }
  const double kept = sum_of(s, {"b_mean_vx [m/s]"}) / 6.95;
  report("momentum over that of a ring", drift, 1e-12);
  report("energy after the bounce over that before - 1", energy() / energy_before - 1.0, 0.01);
  report("speed kept, the rest vibrates", kept, 0.7);
  EXPECT_LT(drift, 1e-12);
  EXPECT_NEAR(energy() / energy_before, 1.0, 0.01);
  EXPECT_GT(stored, 0.5) << "they are strained";
  EXPECT_GT(kept, 0.7) << "they bounce";
  EXPECT_LT(kept, 0.95) << "and vibrate";
}

// Eq. (13): what stress and viscosity take from the motion, the internal energy has; of it the strain stores what the
// stress says.
TEST(UpdatedLagrangianBodies, AnImpactWithViscosityKeepsMotionAndInternalEnergy) {
  std::vector<std::string> sets{"interactions={ kernel = \"cubic-spline\", a-a = 2.4, b-b = 2.4, a-b = 1.0 }"};
  for (const std::string body : {"phases.a", "phases.b"})
    sets.push_back(
        body +
        "={ kind = \"elastic\", formulation = \"updated-lagrangian\", density = 7870, young = 206e9, poisson = 0.3, "
        "artificial-viscosity = 0.2, energy = true }");
  Drive viscous("verification/two_bars", sets);
  sets.emplace_back("phases.a.artificial-viscosity=0");
  sets.emplace_back("phases.b.artificial-viscosity=0");
  Drive plain("verification/two_bars", sets);
  const auto of = [](Drive& drive, const std::string& what) {
    return sum_of(drive.simulation(), {"a_" + what + "_energy [", "b_" + what + "_energy ["});
  };
  const double before = of(viscous, "kinetic");
  double worst = 0.0, strained = 0.0, apart = 0.0;
  for (int k = 1; k <= 27; ++k) {
    viscous.to(1e-6 * k);
    plain.to(1e-6 * k);
    worst = std::max(worst, std::abs(of(viscous, "kinetic") + of(viscous, "internal") - before) / before);
    strained = std::max(strained, of(plain, "strain") / before);
    apart = std::max(apart, std::abs(of(plain, "internal") - of(plain, "strain")) / before);
  }
  const double heat = (of(viscous, "internal") - of(viscous, "strain")) / before;
  report("kinetic + internal energy, largest change", worst, 1e-4);
  report("heat of the viscosity over the energy at the start", heat, 0.05);
  report("without viscosity: internal - strain energy", apart, 1e-3);
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(heat, 0.05);
  EXPECT_GT(strained, 0.2) << "they are strained";
  EXPECT_LT(apart, 1e-3);
}

/// The least distance of two particles of a phase (m).
double least_distance(const PhaseParticles& p) {
  const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1);
  double least = 1e300;
  for (std::size_t k = 0; k < p.size(); ++k)
    for (std::size_t j = 0; j < k; ++j) least = std::min(least, std::hypot(x[k] - x[j], y[k] - y[j]));
  return least;
}

// Swegle's instability: without artificial stress the particles of what is pulled meet, and the ring tears.
TEST(UpdatedLagrangianBodies, ArtificialStressKeepsARubberRingWhole) {
  const std::string coarse = "spacing=2e-3";
  const double spacing = 2e-3;
  Drive with("verification/rings_updated", {coarse}),
      without("verification/rings_updated", {coarse, "phases.a.artificial-stress=0", "phases.b.artificial-stress=0"});
  with.to(5e-3);
  without.to(5e-3);
  const double apart = least_distance(with.phase(0)) / spacing, torn = least_distance(without.phase(0)) / spacing;
  report("least distance of two particles with artificial stress", apart, 0.5);
  report("without", torn, 0.3);
  EXPECT_GT(apart, 0.5);
  EXPECT_LT(torn, 0.3);
  with.to(0.016);
  const Simulation& s = with.simulation();
  const double scale = 6.95 * with.phase(0).mass() * static_cast<double>(with.phase(0).size());
  report("speed of the ring afterwards over that before", sum_of(s, {"b_mean_vx [m/s]"}) / 6.95, 0.7);
  EXPECT_LT(std::abs(sum_of(s, {"momentum_x ["})) / scale, 1e-12);
  EXPECT_GT(sum_of(s, {"b_mean_vx [m/s]"}) / 6.95, 0.7) << "they bounce";
}

TEST(TotalLagrangianBodies, ABlockThatBouncesKeepsItsEnergy) {
  Drive drive("bouncing_block");
  const Simulation& s = drive.simulation();
  const double mass = drive.phase(0).mass() * static_cast<double>(drive.phase(0).size());
  const auto energy = [&] { return sum_of(s, energies_of("block")) + mass * 9.81 * sum_of(s, {"middle_y [m]"}); };
  const double fall = mass * 9.81 * 0.2, before = energy();
  drive.to(0.18);
  const double analytic = 0.25 - 0.5 * 9.81 * 0.18 * 0.18;
  EXPECT_NEAR(sum_of(s, {"middle_y [m]"}), analytic, 1e-6);
  drive.to(0.372);  // at the top again
  const double height = sum_of(s, {"middle_y [m]"}) - 0.05, change = std::abs(energy() - before) / fall;
  report("energy after the bounce, change over that of the fall", change, 0.01);
  report("height over that of the start, the rest vibrates", height / 0.2, 0.5);
  EXPECT_LT(change, 0.01);
  EXPECT_GT(height / 0.2, 0.5);
  EXPECT_LT(height / 0.2, 0.95);
}

/// Component d of the sum of contact_force over a phase, N, with the sum of mass times acceleration beside it.
std::pair<double, double> felt(const PhaseParticles& p, int d) {
  double force = 0.0, motion = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    force += p.column(Field::contact_force, d)[k];
    motion += p.mass() * p.column(Field::acceleration, d)[k];
  }
  return {force, motion};
}

// Disturbed, the block turns as it vibrates, and its third bounce is on a corner: one particle holds it.
TEST(TotalLagrangianBodies, ABlockThatFallsOnItsCornerDoesNotPassTheFloor) {
  double lowest = 1.0, change = 0.0;
  for (const char* seed : {"2", "15", "20"}) {
    Drive drive("bouncing_block", {"fill.1.perturb=0.001", std::string("fill.1.seed=") + seed});
    const Simulation& s = drive.simulation();
    auto& block = drive.phase(0);
    const double* y = block.column(Field::position, 1);
    const auto energy = [&] {
      double height = 0.0;
      for (std::size_t k = 0; k < block.size(); ++k) height += y[k];
      return sum_of(s, energies_of("block")) + 9.81 * block.mass() * height;
    };
    const double before = energy();
    for (int k = 1; k <= 600; ++k) {
      drive.to(2e-3 * k);
      lowest = std::min(lowest, *std::min_element(y, y + block.size()));
    }
    change = std::max(change, std::abs(energy() / before - 1.0));
  }
  report("lowest particle over the floor, spacings", lowest / 5e-3, 0.0);
  report("energy after three bounces over that before - 1", change, 0.01);
  EXPECT_GT(lowest, 0.0);
  EXPECT_LT(change, 0.01);
}

/// A plate of so many cells of 4 mm in a domain of 50 along a periodic axis, from a cell on; its marker's place.
double marked(int first, int cells, double time) {
  const auto place = [](int cell) { return number(0.004 * cell); };
  const std::string text =
      "spacing = 4e-3\n[domain]\nsize = [0.2, 0.04]\nperiodic = [\"x\"]\n[phases.plate]\nkind = \"elastic\"\n"
      "density = 1000\nyoung = 2e6\npoisson = 0.3\n[interactions]\nplate-plate = 1.6\n[[fill]]\nphase = \"plate\"\n"
      "shape = { formula = \"fmod(x - " +
      place(first) + " + 0.4, 0.2) < " + place(cells) +
      " && abs(y - 0.02) < 0.01 ? 1 : 0\" }\nvelocity = [1, 0]\n[[marker]]\nname = \"m\"\nphase = "
      "\"plate\"\n[time]\nend "
      "= 1\n";
  const Scene scene = parse_scene(text, "marked.toml");
  const auto blocks = generate(scene);
  Simulation run(scene, make_plan(scene, blocks), blocks);
  while (run.time() < time * (1.0 - 1e-12)) run.step(time - run.time());
  const auto names = run.history_columns();
  const auto at = std::find(names.begin(), names.end(), "m_x [m]");
  return run.history_row()[static_cast<std::size_t>(at - names.begin())];
}

TEST(Markers, AreInTheMiddleOfABodyThatLiesAcrossAPeriodicSide) {
  double worst = 0.0;
  for (const int cells : {3, 10, 20, 40})
    for (const int first : {0, 5, 20, 31, 40, 44, 48}) {
      const double middle = 0.004 * (first + 0.5 * cells);
      for (const double time : {0.0, 2e-3}) {
        const double off = marked(first, cells, time) - middle - time;
        worst = std::max(worst, std::abs(off - 0.2 * std::round(off / 0.2)));
      }
    }
  report("place of a marker, images of the domain apart, m", worst, 1e-9);
  EXPECT_LT(worst, 1e-9);
}

TEST(BodyContact, ContactForceIsWhatMovesABody) {
  const std::string field = "output.fields=[\"contact_force\"]";
  Drive bars("verification/two_bars", {field, "precision=\"double\""});
  bars.to(5e-6);
  const auto [on_b, of_b] = felt(bars.phase(1), 0);
  const double on_a = felt(bars.phase(0), 0).first;
  EXPECT_GT(on_b, 0.0);
  EXPECT_NEAR(on_b / of_b, 1.0, 1e-10);
  EXPECT_NEAR(on_a / on_b, -1.0, 1e-10);
  report("of two bars, over mass times acceleration - 1", on_b / of_b - 1.0, 1e-10);

  Drive block("bouncing_block", {field, "spacing=0.01", "fill.1.velocity=[0, -1]",
                                 "fill.1.shape.box={ min = [0.15, 0.001], max = [0.25, 0.101] }"});
  block.to(4e-3);
  const auto [from_floor, of_block] = felt(block.phase(0), 1);
  const double weight = 1000.0 * 0.1 * 0.1 * 9.81;
  EXPECT_GT(from_floor, 10.0 * weight);
  EXPECT_NEAR(from_floor / (of_block + weight), 1.0, 1e-10);
  report("of a block on the floor, the same", from_floor / (of_block + weight) - 1.0, 1e-10);
}

/// Particles of the disc that touch: x and the contact's push along y, m and N, from left to right; means over frames.
std::vector<std::array<double, 2>> touching(const std::vector<std::array<double, 2>>& sums, double times) {
  std::vector<std::array<double, 2>> rows;
  for (const auto& [x, push] : sums)
    if (push > 0.0) rows.push_back({x / times, push / times});
  std::sort(rows.begin(), rows.end());
  return rows;
}

TEST(TotalLagrangianBodies, DiscsPressedTogetherHaveThePressureOfHertz) {
  Drive drive("verification/hertz");
  const PhaseParticles& upper = drive.phase(0);
  std::vector<std::array<double, 2>> sums(upper.size());
  double load = 0.0, on_lower = 0.0, held = 0.0;
  constexpr int times = 16;
  drive.to(0.02);
  for (int time = 1; time <= times; ++time) {
    drive.simulation().begin_row();
    drive.to(0.02 + 2.5e-4 * time);
    for (std::size_t k = 0; k < upper.size(); ++k) {
      sums[static_cast<std::size_t>(upper.id()[k])][0] += upper.column(Field::position, 0)[k];
      sums[static_cast<std::size_t>(upper.id()[k])][1] += upper.column(Field::contact_force, 1)[k];
    }
    load += felt(upper, 1).first / times;
    on_lower += felt(drive.phase(1), 1).first / times;
    const HistoryRow row = drive.simulation().history();
    for (std::size_t c = 0; c < row.names.size(); ++c)
      if (row.names[c].starts_with("motion_0_force_y [")) held += row.values[c] / times;
  }
  EXPECT_NEAR(on_lower / load, -1.0, 1e-10);
  report("force on what holds the disc over P - 1", held / load - 1.0, 0.03);
  EXPECT_NEAR(held / load, 1.0, 0.03);

  // Hertz (1882): R* = R/2, E* = E/(2 (1 - nu^2)).
  const double pi = 3.14159265358979, b = std::sqrt(4.0 * load * 0.01 / (pi * 1e6 / (2.0 * 0.91)));
  const double peak = 2.0 * load / (pi * b);
  const auto rows = touching(sums, times);
  ASSERT_GT(rows.size(), 4U);
  double centre = 0.0, square = 0.0, highest = 0.0;
  for (const auto& [x, push] : rows) centre += x * push / load;
  for (const auto& [x, push] : rows) square += (x - centre) * (x - centre) * push / load;
  for (std::size_t k = 1; k + 1 < rows.size(); ++k)
    highest = std::max(highest, 2.0 * rows[k][1] / (rows[k + 1][0] - rows[k - 1][0]));
  report("width of the contact over b - 1", 2.0 * std::sqrt(square) / b - 1.0, 0.07);
  report("peak of the pressure over p_0 - 1", highest / peak - 1.0, 0.07);
  EXPECT_NEAR(2.0 * std::sqrt(square) / b, 1.0, 0.07);
  EXPECT_NEAR(highest / peak, 1.0, 0.07);
}

}  // namespace
}  // namespace barchan
