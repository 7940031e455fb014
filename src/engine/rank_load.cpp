#include "engine/rank_load.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/clock.hpp"
#include "base/ranks.hpp"

namespace barchan {

void RankCosts::add(const std::vector<Measured>& ranks, long steps) {
  busy_.resize(ranks.size(), 0.0);
  work_.resize(ranks.size(), 0.0);
  now_.resize(ranks.size(), 0.0);
  const double kept = std::exp2(-static_cast<double>(steps) / half_life);
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    busy_[r] = kept * busy_[r] + ranks[r].busy;
    work_[r] = kept * work_[r] + ranks[r].work * static_cast<double>(steps);
    now_[r] = ranks[r].work;
  }
}

double RankCosts::mean_cost() const {
  const double busy = std::accumulate(busy_.begin(), busy_.end(), 0.0),
               work = std::accumulate(work_.begin(), work_.end(), 0.0);
  return work > 0.0 ? busy / work : 0.0;
}

double RankCosts::of(std::size_t rank) const {
  const double mean = mean_cost();
  if (!(mean > 0.0) || !(work_[rank] > 0.0)) return 1.0;
  return std::clamp(busy_[rank] / work_[rank] / mean, 0.25, 4.0);
}

double RankCosts::imbalance() const {
  double largest = 0.0, sum = 0.0;
  for (std::size_t r = 0; r < now_.size(); ++r) {
    const double seconds = of(r) * now_[r];
    largest = std::max(largest, seconds);
    sum += seconds;
  }
  return sum > 0.0 ? largest * static_cast<double>(now_.size()) / sum : 1.0;
}

RankLoad::Seconds RankLoad::now() const {
  const Communicator::Waits waits = ranks::available()->waits();
  return {thread_seconds() - waits.processor_seconds, waits.seconds};
}

void RankLoad::begin_step() {
  if (!ranks::active()) return;
  if (steps_ == 0) first_step_ = Clock::now();
  begun_ = now();
  in_step_ = true;
}

void RankLoad::end_step() {
  if (!in_step_) return;
  total_ = seconds();
  in_step_ = false;
  ++steps_;
}

RankLoad::Seconds RankLoad::seconds() const {
  if (!in_step_) return total_;
  const Seconds at = now();
  return {total_.busy + at.busy - begun_.busy, total_.waiting + at.waiting - begun_.waiting};
}

std::optional<double> RankLoad::look(double work) {
  const long steps = steps_ - looked_at_step_;
  if (!ranks::active() || steps < steps_a_look) return std::nullopt;
  struct Told {
    RankCosts::Measured measured;
    double dividing, running;  // s
  };
  const double busy = seconds().busy, running = std::chrono::duration<double>(Clock::now() - first_step_).count();
  const std::vector<Told> all = ranks::each(Told{{busy - busy_before_, work}, dividing_, running});
  look_ = Clock::now();  // before it a rank has waited for those that had more to do
  looked_at_step_ = steps_;
  busy_before_ = busy;
  std::vector<RankCosts::Measured> measured;
  double dividing = 0.0;
  for (const Told& one : all) {
    measured.push_back(one.measured);
    dividing = std::max(dividing, one.dividing);
  }
  costs_.add(measured, steps);
  // The first rank's time, so that all decide the same.
  if (costs_.imbalance() <= most || dividing > most_dividing * all.front().running) return std::nullopt;
  return costs_.of(static_cast<std::size_t>(ranks::active()->rank()));
}

void RankLoad::divided() {
  ++divisions_;
  dividing_ += std::chrono::duration<double>(Clock::now() - look_).count();
}

}  // namespace barchan
