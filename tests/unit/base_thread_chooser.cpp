// The number of threads, chosen from the times of steps: machines that are quiet, busy, and both in turn, in numbers.
#include "base/thread_chooser.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace barchan {
namespace {

/// Runs `steps` steps on a machine that says how long a step takes with so many threads (s); returns all of it.
double run(ThreadChooser& chooser, long steps, const std::function<double(int threads, double now)>& machine,
           double begin = 0.0) {
  double now = begin;
  for (long k = 0; k < steps; ++k) {
    const double seconds = machine(chooser.threads(), now);
    chooser.took(seconds);
    now += seconds;
  }
  return now - begin;
}

/// Steps of `alone` seconds with one thread, which vary by a tenth and are three times as long now and then.
class Steps {
 public:
  explicit Steps(double alone) : alone_(alone) {}
  double operator()() {
    ++number_;
    return alone_ * (number_ % 17 == 0 ? 3.0 : 1.0) * std::uniform_real_distribution<double>(0.9, 1.1)(random_);
  }

 private:
  double alone_;
  long number_ = 0;
  std::mt19937 random_{7};
};

TEST(ThreadChooser, OneThreadIsNoChoice) {
  ThreadChooser chooser(1);
  run(chooser, 100, [](int threads, double) { return threads == 1 ? 1e-3 : 1e9; });
  EXPECT_EQ(chooser.threads(), 1);
  EXPECT_EQ(chooser.switches(), 0);
}

TEST(ThreadChooser, TakesAllOfAQuietMachine) {
  for (const int most : {2, 3, 8}) {
    ThreadChooser chooser(most);
    Steps alone(5e-3);
    const double used = run(chooser, 4000, [&](int threads, double) { return alone() / threads; });
    EXPECT_EQ(chooser.threads(), most);
    Steps again(5e-3);
    double best = 0.0;
    for (int k = 0; k < 4000; ++k) best += again() / most;
    EXPECT_LT(used, 1.03 * best) << most;
  }
}

// Every sixth step has more than twice as much to do: with two threads it takes longer than a usual step with one. Now
// and then all have half as much more.
TEST(ThreadChooser, TakesATeamWhoseStepsDiffer) {
  ThreadChooser chooser(2);
  long number = 0;
  run(chooser, 20000, [&](int threads, double) {
    ++number;
    return 5e-3 * (number % 6 == 0 ? 2.4 : 1.0) * (number % 200 < 5 ? 1.5 : 1.0) * (threads > 1 ? 0.62 : 1.0);
  });
  EXPECT_GT(static_cast<double>(chooser.uses()[1].steps), 0.95 * 20000.0);
}

// A team takes a slice of time of other processes at every barrier: sixty times as long as one thread.
TEST(ThreadChooser, LosesLittleOnABusyMachine) {
  for (const double step : {1e-4, 5e-4, 5e-3}) {
    ThreadChooser chooser(2);
    Steps alone(step);
    const long steps = std::lround(3.0 / step);
    const double used = run(chooser, steps, [&](int threads, double) { return alone() + (threads > 1 ? 0.03 : 0.0); });
    Steps again(step);
    double one = 0.0;
    for (long k = 0; k < steps; ++k) one += again();
    EXPECT_LT(used, 1.12 * one) << step;
  }
}

// Also a run of half a second is not three tenths longer.
TEST(ThreadChooser, LosesLittleInAShortRun) {
  ThreadChooser chooser(2);
  const double used = run(chooser, 1000, [&](int threads, double) { return 5e-4 + (threads > 1 ? 0.03 : 0.0); });
  EXPECT_LT(used, 1.2 * 0.5);
}

TEST(ThreadChooser, FollowsAMachineThatBecomesBusyAndQuietAgain) {
  ThreadChooser chooser(2);
  Steps alone(2e-3);
  const auto busy = [](double now) { return now > 4.0 && now < 12.0; };
  double in_busy = 0.0, alone_in_busy = 0.0, now = 0.0;
  long late = 0, late_in_team = 0;
  while (now < 60.0) {
    const double one = alone();
    const double seconds = chooser.threads() == 1 ? one : busy(now) ? one + 0.03 : 0.52 * one;
    if (busy(now)) in_busy += seconds, alone_in_busy += one;
    if (now > 40.0) ++late, late_in_team += chooser.threads() == 2;
    chooser.took(seconds);
    now += seconds;
  }
  EXPECT_LT(in_busy, 1.1 * alone_in_busy);
  EXPECT_GT(static_cast<double>(late_in_team), 0.95 * static_cast<double>(late));
}

// A team that gains nothing is left alone, and so is one whose steps became slower for a while.
TEST(ThreadChooser, KeepsOneThreadWhereMoreGainNothing) {
  ThreadChooser chooser(4);
  Steps alone(1e-3);
  run(chooser, 20000, [&](int threads, double) { return alone() * (threads > 1 ? 0.97 : 1.0); });
  EXPECT_EQ(chooser.threads(), 1);
  long in_teams = 0;
  for (const auto& use : chooser.uses())
    if (use.threads > 1) in_teams += use.steps;
  EXPECT_LT(in_teams, 200);
}

// A number that was asked for: every step of a machine that gives its cores has it, also where one thread is as fast.
TEST(ThreadChooser, KeepsATeamThatWasAskedFor) {
  for (const double gain : {0.5, 1.0, 1.4}) {
    ThreadChooser chooser(3, ThreadChooser::Begin::all);
    Steps alone(5e-3);
    run(chooser, 10000, [&](int threads, double) { return alone() * (threads > 1 ? gain : 1.0); });
    EXPECT_EQ(chooser.switches(), 0);
    EXPECT_EQ(chooser.uses().back().steps, 10000);
    EXPECT_EQ(chooser.uses().back().threads, 3);
  }
}

// Where the machine withholds its cores one thread goes on; the team comes back when it has them again.
TEST(ThreadChooser, ATeamThatWasAskedForGivesWayToOthers) {
  ThreadChooser chooser(2, ThreadChooser::Begin::all);
  const double alone = 4e-4;
  double now = 0.0, busy_steps = 0.0;
  int withheld = 0;
  const auto step = [&](bool busy) {
    const bool team = chooser.threads() == 2;
    const double seconds = !team ? alone : busy ? 0.03 : 0.55 * alone;
    withheld = team && busy ? withheld + 1 : 0;
    chooser.took(seconds, withheld >= 3 ? 0.03 : 0.0);
    now += seconds;
    busy_steps += busy ? 1.0 : 0.0;
  };
  while (busy_steps < 1500) step(true);
  EXPECT_LT(now, 1.5 * 1500 * alone);
  while (busy_steps < 50000) step(true);
  EXPECT_LT(now, 1.1 * 50000 * alone);
  while (now < 80.0) step(false);
  EXPECT_EQ(chooser.threads(), 2);
}

// A team that is faster than one thread although others take a part of its cores stays.
TEST(ThreadChooser, ATeamThatGainsOnABusyMachineStays) {
  ThreadChooser chooser(2, ThreadChooser::Begin::all);
  run(chooser, 20000, [&](int threads, double) { return threads == 2 ? 6e-3 : 1e-2; });
  EXPECT_EQ(chooser.switches(), 0);
  ThreadChooser doubted(2, ThreadChooser::Begin::all);
  for (int k = 0; k < 20000; ++k) {
    const bool team = doubted.threads() == 2;
    doubted.took(team ? 6e-3 : 1e-2, team ? 6e-3 : 0.0);
  }
  EXPECT_GT(static_cast<double>(doubted.uses().back().steps), 0.98 * 20000);
}

}  // namespace
}  // namespace barchan
