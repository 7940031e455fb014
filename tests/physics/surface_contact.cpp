// Elastic bodies that touch by their surfaces (docs/method.md, contact of bodies).
#include <omp.h>

#include <cmath>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::report;

/// A scene of two total Lagrangian bodies of rubber, 2D, spacing of 1 mm.
class Pair {
 public:
  Pair(const std::string& upper, const std::string& lower, const std::string& touch, const std::string& rest = "",
       const std::string& inner = "radius = 2, kernel = \"wendland-c2\"")
      : scene_(parse_scene(
            "dimensions = 2\nspacing = 1e-3\nprecision = \"double\"\n[domain]\norigin = [-0.05, -0.05]\nsize = [0.1, "
            "0.1]\n" +
                rubber("upper") + rubber("lower") + "[interactions]\nupper-upper = { " + inner +
                " }\nlower-lower = { " + inner + " }\nupper-lower = { restitution = 1" + touch +
                " }\n[[fill]]\nphase = \"upper\"\n" + upper + "\n[[fill]]\nphase = \"lower\"\n" + lower +
                "\n[time]\nend = 1\nlargest-speed = 2\n[output]\nfields = [\"contact_force\"]\n" + rest,
            "pair.toml")) {
    const auto blocks = generate(scene_);
    run_ = std::make_unique<Simulation>(scene_, make_plan(scene_, blocks), blocks);
  }
  Simulation& run() { return *run_; }
  PhaseParticles& phase(std::size_t k) { return run_->phases()[k]; }
  void to(double time) {
    while (run_->time() < time * (1.0 - 1e-12)) run_->step(time - run_->time());
  }
  /// N/m, what the lower body gives the upper one (k = 0), or the other way round.
  std::array<double, 2> force(std::size_t k) {
    std::array<double, 2> sum{};
    for (std::size_t i = 0; i < phase(k).size(); ++i)
      for (int d = 0; d < 2; ++d)
        sum[static_cast<std::size_t>(d)] += std::as_const(phase(k)).column(Field::contact_force, d)[i];
    return sum;
  }
  double history(const std::string& begin) {
    double sum = 0.0;
    const auto names = run_->history_columns();
    const auto row = run_->history_row();
    for (std::size_t k = 0; k < names.size(); ++k)
      if (names[k].starts_with(begin)) sum += row[k];
    return sum;
  }
  double energy() {
    double sum = 0.0;
    for (const char* body : {"upper_", "lower_"})
      for (const char* kind : {"kinetic_energy", "strain_energy", "hourglass_energy"})
        sum += history(std::string(body) + kind);
    return sum;
  }
  /// kg m2/s of a metre, about the origin.
  double spin() {
    double sum = 0.0;
    for (const std::size_t k : {0u, 1u}) {
      const PhaseParticles& p = phase(k);
      for (std::size_t i = 0; i < p.size(); ++i)
        sum += p.mass() * (p.column(Field::position)[i] * p.column(Field::velocity, 1)[i] -
                           p.column(Field::position, 1)[i] * p.column(Field::velocity)[i]);
    }
    return sum;
  }

 private:
  static std::string rubber(const std::string& name) {
    return "[phases." + name + "]\nkind = \"elastic\"\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n";
  }
  Scene scene_;
  std::unique_ptr<Simulation> run_;
};

constexpr const char *by_surfaces = ", surfaces = true", *by_particles = "";

/// A box of particles from the corner (x, y) on.
std::string box(double x, double y, double wide, double high) {
  std::string points = "shape = { points = [";
  for (double j = 0.5e-3; j < high; j += 1e-3)
    for (double i = 0.5e-3; i < wide; i += 1e-3) {
      char text[60];
      std::snprintf(text, sizeof text, "[%.7f, %.7f], ", x + i, y + j);
      points += text;
    }
  return points + "] }";
}

/// Forces of a block that stands `share` of a spacing aside on another and overlaps by a twentieth.
Pair block_on_block(double share, const std::string& touch) {
  return Pair(box(-0.01 + 1e-3 * share, -5e-5, 0.02, 0.006), box(-0.03, -0.008, 0.06, 0.008), touch);
}

// Particle on particle, faces whose particles stand half a spacing aside do not even meet.
TEST(SurfaceContact, FlatFacesPressAlikeWhereverTheyStand) {
  const double facing = block_on_block(0.0, by_particles).force(0)[1];
  EXPECT_GT(facing, 0.0);
  EXPECT_EQ(block_on_block(0.5, by_particles).force(0)[1], 0.0);
  double worst = 0.0, aside = 0.0;
  for (const double share : {0.0, 0.2, 0.35, 0.5, 0.7}) {
    const auto f = block_on_block(share, by_surfaces).force(0);
    worst = std::max(worst, std::abs(f[1] / (facing * 0.4 / 0.25) - 1.0));  // both springs: docs/method.md
    aside = std::max(aside, std::abs(f[0]) / facing);
  }
  report("force over that of particles that face each other", worst, 0.03);
  report("force along the face over that across it", aside, 0.01);
  EXPECT_LT(worst, 0.03);
  EXPECT_LT(aside, 0.01);
}

TEST(SurfaceContact, ObliqueDiscsKeepMomentumAndEnergy) {
  const auto disc = [](double x, double y, double v) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "shape = { disc = { centre = [%.4f, %.4f], radius = 0.01 } }\npacking = \"relaxed\"\nvelocity = [0, "
                  "%.3f]",
                  x, y, v);
    return std::string(text);
  };
  Pair discs(disc(-0.004, 0.01, -0.5), disc(0.004, -0.01, 0.5), by_surfaces);
  const double energy = discs.energy(), spin = discs.spin();
  const double scale = 0.5 * discs.phase(0).mass() * static_cast<double>(discs.phase(0).size());
  double drift = 0.0, unequal = 0.0, largest = 0.0, turned = 0.0;
  for (int k = 1; k <= 40; ++k) {
    discs.to(5e-4 * k);
    const auto one = discs.force(0), other = discs.force(1);
    for (std::size_t d = 0; d < 2; ++d) unequal = std::max(unequal, std::abs(one[d] + other[d]));
    largest = std::max(largest, std::hypot(one[0], one[1]));
    drift =
        std::max({drift, std::abs(discs.history("momentum_x")) / scale, std::abs(discs.history("momentum_y")) / scale});
    turned = std::max(turned, std::abs(discs.spin() / spin - 1.0));
  }
  EXPECT_EQ(discs.force(0)[1], 0.0) << "they have parted";
  EXPECT_GT(largest, 0.0);
  report("sum of both forces over the largest", unequal / largest, 1e-13);
  report("momentum over that of a disc", drift, 1e-12);
  report("angular momentum over that of the start - 1", turned, 0.02);
  report("energy over that of the start - 1", discs.energy() / energy - 1.0, 0.005);
  EXPECT_LT(unequal / largest, 1e-13);
  EXPECT_LT(drift, 1e-12);
  EXPECT_LT(turned, 0.02);
  EXPECT_LT(std::abs(discs.energy() / energy - 1.0), 0.005);
}

// Over a washboard of particles a block without friction is braked; over a surface it goes on.
TEST(SurfaceContact, ABlockSlidesSmoothly) {
  const auto kept = [](const std::string& touch) {
    Pair blocks(box(-0.02, 1e-5, 0.01, 0.005) + "\nvelocity = [1, -0.05]", box(-0.04, -0.008, 0.08, 0.008), touch);
    blocks.to(6e-3);
    double speed = 0.0;
    const PhaseParticles& p = blocks.phase(0);
    for (std::size_t k = 0; k < p.size(); ++k) speed += p.column(Field::velocity)[k];
    return speed / static_cast<double>(p.size());
  };
  const double smooth = kept(by_surfaces), rough = kept(by_particles);
  report("speed kept by surfaces", smooth, 0.99);
  report("speed kept particle by particle", rough, 1.0);
  EXPECT_GT(smooth, 0.99);
  EXPECT_LT(std::abs(smooth - 1.0), std::abs(rough - 1.0));
}

TEST(SurfaceContact, KeepsItsBitsOnOtherThreadsAndAfterARestart) {
  const auto make = [] {
    return Pair(box(-0.01, 3e-4, 0.02, 0.006) + "\nvelocity = [0.4, -0.5]", box(-0.03, -0.008, 0.06, 0.008),
                ", surfaces = true, friction = 0.3");
  };
  Pair run = make(), other = make();
  run.to(1e-3);
  EXPECT_GT(run.force(0)[1], 0.0) << "they touch";
  Archive written;
  run.run().archive(written);
  Archive saved(written.bytes());
  other.run().archive(saved);
  saved.finish();
  const int threads = omp_get_max_threads();
  const auto go_on = [](Pair& pair, int on) {
    omp_set_num_threads(on);
    for (int k = 0; k < 200; ++k) pair.run().step(1.0);
  };
  go_on(run, 1);
  go_on(other, 2);
  omp_set_num_threads(threads);
  EXPECT_EQ(run.run().history_row(), other.run().history_row());
  EXPECT_EQ(run.force(0), other.force(0));
}

}  // namespace
}  // namespace barchan
