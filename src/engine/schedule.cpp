#include "engine/schedule.hpp"

#include <chrono>
#include <ctime>

namespace barchan {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t once = static_cast<std::size_t>(-1);

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void execute(const Task& task, [[maybe_unused]] const std::string& stage) {
#ifndef NDEBUG
  const AccessGuard guard(stage.c_str(), task.owner.c_str(), task.touches);
#endif
  task.call();
}

}  // namespace

Schedule::Schedule(std::span<const char* const> stages)
    : tasks_(stages.size()),
      repeat_of_(stages.size()),
      executed_(stages.size(), 0),
      processor_seconds_(stages.size(), 0.0) {
  for (const char* name : stages) seconds_.emplace_back(name, 0.0);
}

void Schedule::add(Task task) {
  repeat_of_[task.stage].push_back(task.repeat ? repeats_.size() : once);
  if (task.repeat) repeats_.push_back({task.repeat->name, task.owner, task.stage, task.repeat->interval});
  tasks_[task.stage].push_back(std::move(task));
}

void Schedule::repeat(const Task& task, RepeatCount& count) {
  const auto start = Clock::now();
  const long times = task.repeat->times();
  for (long k = 0; k < times; ++k) execute(task, seconds_[task.stage].first);
  count.calls += times;
  count.seconds += since(start);
}

void Schedule::run(std::size_t first, std::size_t last) {
  for (std::size_t stage = first; stage <= last; ++stage) {
    if (tasks_[stage].empty()) continue;
    const auto start = Clock::now();
    const double processor = measures_processor_time_ ? thread_seconds() : 0.0;
    for (std::size_t k = 0; k < tasks_[stage].size(); ++k) {
      const Task& task = tasks_[stage][k];
      if (const std::size_t number = repeat_of_[stage][k]; number != once) repeat(task, repeats_[number]);
      else execute(task, seconds_[stage].first);
    }
    ++executed_[stage];
    if (measures_processor_time_) processor_seconds_[stage] += thread_seconds() - processor;
    seconds_[stage].second += since(start);
  }
}

}  // namespace barchan
