// When spheres fall asleep and when they wake, by hand: looks are sqrt(d/g)/4 apart, two calm ones in turn are needed.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "checks/reader.hpp"
#include "models/grains/sphere_search.hpp"
#include "models/grains/sphere_sleep.hpp"
#include "plan/plan.hpp"
#include "unit/particle_sets.hpp"
#include "unit/sphere_sets.hpp"

namespace barchan::sphere_sleep_test {
namespace {

constexpr double diameter = 1e-3, gravity = 9.81, wide = 0.05;  // m, m/s2, m
const double interval = 0.25 * std::sqrt(diameter / gravity);   // s
const double bound = std::sqrt(gravity * diameter);             // m/s; slower than a hundredth of it is calm

/// Six grains in a periodic box, whose fields a test sets. Their lasting numbers are 5 4 3 2 1 0.
class SixGrains {
 public:
  explicit SixGrains(const std::function<Vec3(std::size_t)>& place =
                         [](std::size_t k) {
                           return Vec3{0.005 + 0.002 * static_cast<double>(k), 0.01, 0.0};
                         })
      : scene_(parse_scene(text, "sleep.toml")), blocks_(generate(scene_)), plan_(make_plan(scene_, blocks_)) {
    const PlanPhase& sand = plan_.phases[0];
    PhaseParticles p(sand.name, 2, sand.count, sand.mass, 0);
    for (const Field f : sand.fields) p.add(f);
    state_.phases.push_back(std::move(p));
    for (std::size_t k = 0; k < count; ++k) set(Field::position, k, place(k));
    work_ = std::make_unique<Workspace>(scene_, plan_, state_);
    sleep.prepare({{0, 0, count, diameter}}, plan_, gravity);
    sleep.make_room({{0, 0, count, diameter}}, count, count + 2);
  }
  void set(Field f, std::size_t k, const Vec3& value) {
    for (int d = 0; d < 2; ++d) sand().column(f, d)[k] = value[static_cast<std::size_t>(d)];
  }
  PhaseParticles& sand() { return state_.phases[0]; }
  /// A look after so many intervals since the last one.
  bool look(double intervals = 1.001) {
    state_.time += intervals * interval;
    return sleep.look(*work_, numbers.data(), lost);
  }
  std::vector<bool> asleep() const {
    std::vector<bool> of;
    for (std::size_t k = 0; k < count; ++k) of.push_back(sleep.sleeps(numbers[k]));
    return of;
  }

  static constexpr std::size_t count = 6;
  const std::array<std::uint32_t, count + 2> numbers{5, 4, 3, 2, 1, 0, 6, 7};
  SphereSleep sleep;
  double lost = 0.0;  // J

 private:
  inline static const std::string text =
      "dimensions = 2\nspacing = 1e-3\n[domain]\nsize = [0.05, 0.05]\nperiodic = [\"x\"]\ngravity = [0, -9.81]\n"
      "[phases.sand]\nkind = \"grains\"\ndensity = 2650\ndiameter = { mean = 1e-3, spread = 0 }\nfriction = 0.5\n"
      "stiffness = 1000\nsleep = true\n[interactions]\nsand-sand = { law = \"linear\" }\n[[fill]]\nphase = \"sand\"\n"
      "shape = { points = [[0.01, 0.01], [0.012, 0.01], [0.014, 0.01], [0.016, 0.01], [0.018, 0.01], [0.02, 0.01]] }\n"
      "[time]\nend = 1\nlargest-speed = 2\n";
  Scene scene_;
  std::vector<ParticleBlock> blocks_;
  Plan plan_;
  State state_;
  std::unique_ptr<Workspace> work_;
};

using Who = std::vector<bool>;

TEST(SphereSleep, TwoCalmLooksAfterTheFirstPutToSleep) {
  SixGrains grains;
  EXPECT_FALSE(grains.look()) << "the first look only remembers";
  EXPECT_FALSE(grains.look());
  EXPECT_FALSE(grains.look(0.5)) << "too early for a look";
  EXPECT_EQ(grains.sleep.sleeping(), 0u);
  EXPECT_TRUE(grains.look(0.6));
  EXPECT_EQ(grains.sleep.sleeping(), 6u);
  EXPECT_FALSE(grains.look()) << "nobody is left";
}

/// Each bound from both sides: the way between two looks, the speed, the spin, the change of the acceleration.
TEST(SphereSleep, WhoMovesTurnsOrIsPulledStaysAwake) {
  SixGrains grains;
  grains.set(Field::velocity, 1, {0.0, 1.01e-2 * bound, 0.0});
  grains.set(Field::velocity, 2, {0.99e-2 * bound, 0.0, 0.0});
  grains.sand().column(Field::angular_velocity)[3] = 1.01e-2 * bound / (0.5 * diameter);
  for (int k = 0; k < 3; ++k) {
    const double way = 0.2525e-3 * diameter * k, change = 0.101 * gravity * k;
    grains.set(Field::position, 0, {0.005, 0.01 + way, 0.0});
    grains.set(Field::acceleration, 4, {change, -gravity, 0.0});
    grains.set(Field::position, 5, {0.03 + 0.2475e-3 * diameter * k, 0.01, 0.0});
    grains.set(Field::acceleration, 5, {0.099 * gravity * k, 0.0, 0.0});
    grains.look();
  }
  EXPECT_EQ(grains.asleep(), (Who{false, false, true, false, false, true}));
}

TEST(SphereSleep, AWayAcrossAPeriodicSideIsShort) {
  SixGrains grains;
  for (int k = 0; k < 3; ++k) {
    grains.set(Field::position, 0, {k % 2 == 0 ? 1e-7 : wide - 1e-7, 0.01, 0.0});
    grains.look();
  }
  EXPECT_EQ(grains.asleep()[0], true);
}

/// The motion that goes: 1/2 m v^2 and of the spin 1/2 (2/5 m r^2) w^2, m = rho pi/6 d^3. What pulled is balanced by
/// the contacts from then on.
TEST(SphereSleep, RestsAndTellsTheEnergyOfItsMotion) {
  SixGrains grains;
  const double speed = 0.5e-2 * bound, spin = 0.8e-2 * bound / (0.5 * diameter);
  for (int k = 0; k < 3; ++k) {
    grains.set(Field::velocity, 2, {0.0, speed, 0.0});
    grains.sand().column(Field::angular_velocity)[2] = spin;
    grains.set(Field::acceleration, 2, {0.3, -gravity, 0.0});
    grains.look();
  }
  const double mass = 2650.0 * std::numbers::pi / 6.0 * std::pow(diameter, 3);
  const double energy = 0.5 * mass * (speed * speed + 0.4 * std::pow(0.5 * diameter * spin, 2));
  EXPECT_NEAR(grains.lost / energy, 1.0, 1e-12);
  EXPECT_EQ(grains.sand().column(Field::velocity, 1)[2], 0.0);
  EXPECT_EQ(grains.sand().column(Field::angular_velocity)[2], 0.0);
  EXPECT_EQ(grains.sand().column(Field::contact_acceleration, 0)[2], -0.3);
  EXPECT_EQ(grains.sand().column(Field::contact_acceleration, 1)[2], gravity);
}

TEST(SphereSleep, APushOfATenthOfGravityWakesAtOnce) {
  SixGrains grains;
  for (int k = 0; k < 3; ++k) grains.look();
  ASSERT_EQ(grains.sleep.sleeping(), 6u);
  grains.set(Field::acceleration, 1, {0.099 * gravity, 0.0, 0.0});
  EXPECT_FALSE(grains.look(0.01));
  grains.set(Field::acceleration, 1, {0.0, 0.101 * gravity, 0.0});
  EXPECT_TRUE(grains.look(0.01)) << "not at a look only";
  EXPECT_EQ(grains.asleep(), (Who{true, false, true, true, true, true}));
  EXPECT_EQ(grains.sleep.sleeping(), 5u);
  EXPECT_FALSE(grains.look()) << "its next look finds another acceleration than that before";
  EXPECT_FALSE(grains.look());
  EXPECT_TRUE(grains.look()) << "and two calm looks later it sleeps";
}

/// What a step of the contacts marks is awake after it; numbers are those that last, not places in memory.
TEST(SphereSleep, WakesWhomTheContactsDisturbed) {
  SixGrains grains;
  EXPECT_EQ(grains.sleep.step(grains.numbers.data()), nullptr) << "nobody sleeps: a step has nothing to look for";
  for (int k = 0; k < 3; ++k) grains.look();
  grains.sleep.mark(grains.numbers.data());
  grains.sleep.settled();
  const std::uint8_t* rest = grains.sleep.flags();
  ASSERT_NE(rest, nullptr);
  EXPECT_EQ(std::vector<int>(rest, rest + 8), std::vector<int>(8, 1)) << "fixed ones too";
  const SleepStep* step = grains.sleep.step(grains.numbers.data());
  ASSERT_NE(step, nullptr);
  EXPECT_NEAR(step->tolerance, 0.3 * gravity, 1e-15);
  EXPECT_NEAR(step->tolerance * step->lag, 1e-2 * bound, 1e-15) << "an impulse that would give that speed wakes";
  step->wakes[grains.numbers[1]] = 1;
  std::vector<SphereChunk> chunks(2);
  chunks[0].border = {1, 2};
  chunks[1].border = {4};
  chunks[0].wakes = true;
  const auto woken = grains.sleep.wake(chunks, grains.numbers.data(), false);
  EXPECT_EQ(std::vector<std::uint32_t>(woken.begin(), woken.end()), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(grains.asleep(), (Who{true, false, true, true, true, true}));
  EXPECT_EQ(grains.sleep.sleeping(), 5u);
  grains.sleep.mark(grains.numbers.data());
  EXPECT_EQ(grains.sleep.flags()[1], 0);
  EXPECT_TRUE(grains.sleep.changed(1));
  EXPECT_FALSE(grains.sleep.changed(2));
  EXPECT_EQ(step->wakes[grains.numbers[1]], 0) << "told once";
}

/// Where only the last step of the contacts woke some, the flags are those that a look at all gives.
TEST(SphereSleep, MarksThoseWhoWokeAsALookAtAllDoes) {
  SixGrains grains;
  for (int k = 0; k < 3; ++k) grains.look();
  grains.sleep.mark(grains.numbers.data());
  grains.sleep.settled();
  const SleepStep* step = grains.sleep.step(grains.numbers.data());
  std::vector<SphereChunk> chunks(1);
  chunks[0].wakes = true;
  chunks[0].border = {0, 3, 5};
  const auto flags = [&] {
    std::vector<int> all;
    for (std::size_t k = 0; k < 6; ++k) all.push_back(2 * grains.sleep.changed(k) + grains.sleep.flags()[k]);
    return all;
  };
  for (const std::uint32_t k : {3u, 5u}) {
    step->wakes[grains.numbers[k]] = 1;
    grains.sleep.wake(chunks, grains.numbers.data(), false);
    grains.sleep.mark_woken();
    const auto alone = flags();
    EXPECT_EQ(alone[k], 2) << "awake, and changed";
    grains.sleep.mark(grains.numbers.data());
    EXPECT_EQ(flags(), alone);
    grains.sleep.settled();
  }
}

/// Six grains in a row, each near the next one, in two chunks of three, with the lists of a search.
struct SixInARow : SixGrains {
  sets::Uniform random{1};
  sets::SphereCast<2> cast;
  SixInARow()
      : SixGrains(),
        cast(sets::box(2, {wide, wide, 0.0}, {true, false, false}), row(), 0, 0.5e-3, 0.5e-3, 1, 3, random) {
    cast.numbers.assign(numbers.begin(), numbers.end());
    SphereSearch search;
    search.prepare(cast.bounds, cast.reach, 1, cast.laws, {}, 1);
    search.keep(0, cast.set().moving, cast.set().all, cast.chunks, cast.numbers.data());
    search.find(cast.set(), 1.1e-3, cast.chunks);
  }
  static std::vector<Vec3> row() {
    std::vector<Vec3> x;
    for (std::size_t k = 0; k < count; ++k) x.push_back({0.005 + 0.002 * static_cast<double>(k), 0.01, 0.0});
    return x;
  }
  /// Every chunk; who is in a pair of another chunk's with one that changed.
  std::vector<std::uint32_t> sort_out() {
    std::vector<std::uint32_t> beside;
    sleep.mark(numbers.data());
    for (SphereChunk& chunk : cast.chunks)
      sleep.sort_out(cast.set(), chunk, [&](std::uint32_t k) { beside.push_back(k); });
    sleep.settled();
    return beside;
  }
};

/// The bits, who moves and the border against their definitions, for each choice of three sleepers among six.
TEST(SphereSleep, PairsWithOneThatIsAwakeAreEvaluated) {
  for (unsigned choice = 0; choice < 64; ++choice) {
    SixInARow grains;
    for (int k = 0; k < 3; ++k) grains.look();
    std::vector<std::uint32_t> up;
    for (std::uint32_t k = 0; k < 6; ++k)
      if ((choice >> k & 1u) != 0) up.push_back(grains.numbers[k]);
    grains.sleep.wake(up);
    grains.sort_out();
    const auto awake = [&](std::size_t k) { return (choice >> k & 1u) != 0; };
    std::size_t pairs = 0;
    for (const SphereChunk& chunk : grains.cast.chunks) {
      std::vector<std::uint32_t> moves, border;
      for (auto k = static_cast<std::uint32_t>(chunk.begin); k < chunk.end; ++k) {
        const bool beside = (k > 0 && awake(k - 1)) || (k < 5 && awake(k + 1));
        if (awake(k)) moves.push_back(k);
        else if (beside) border.push_back(k);
      }
      EXPECT_EQ(chunk.awake, moves) << choice;
      EXPECT_EQ(chunk.border, border) << choice;
      for (std::size_t at = 0; at < chunk.a.size(); ++at) {
        if (chunk.a[at] >= 6) continue;
        ++pairs;
        EXPECT_EQ((chunk.live_of(at / 8) >> at % 8 & 1u) != 0, awake(chunk.a[at]) || awake(chunk.b[at])) << choice;
      }
    }
    EXPECT_EQ(pairs, 6u) << "five, one of them in two chunks";
  }
}

/// Who sleeps beside one that wakes begins a new balance with what was out of it; others do not.
TEST(SphereSleep, KeepsWhatIsOutOfBalance) {
  SixInARow grains;
  for (int k = 0; k < 3; ++k) grains.look();
  grains.sort_out();
  const SleepStep* step = grains.sleep.step(grains.numbers.data());
  ASSERT_NE(step, nullptr);
  for (std::size_t n = 0; n < 6; ++n) {
    step->fresh[n] = 0;
    for (std::size_t d = 0; d < 3; ++d) step->unrest[3 * n + d] = 0.1 * static_cast<double>(n + d + 1);
  }
  grains.sleep.wake({grains.numbers[2]});
  EXPECT_EQ(grains.sort_out(), (std::vector<std::uint32_t>{3})) << "of the other chunk";
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t n = grains.numbers[k];
    const bool beside = k == 1 || k == 3;
    EXPECT_EQ(step->fresh[n] != 0, beside) << k;
    for (std::size_t d = 0; d < 3 && k != 2; ++d)
      EXPECT_EQ(step->offset[3 * n + d], beside ? step->unrest[3 * n + d] : 0.0) << k;
  }
}

TEST(SphereSleep, GoesOnFromWhatIsSaved) {
  SixGrains one, other;
  for (int k = 0; k < 2; ++k) one.look();
  Archive saved;
  one.sleep.archive(saved);
  Archive loaded(saved.bytes());
  other.sleep.archive(loaded);
  loaded.finish();
  one.look();
  other.look(3.003);
  EXPECT_EQ(other.asleep(), one.asleep());
  EXPECT_EQ(one.sleep.sleeping(), 6u);
}

}  // namespace
}  // namespace barchan::sphere_sleep_test
