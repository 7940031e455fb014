#include "engine/schedule.hpp"

#include <chrono>
#include <ctime>

namespace barchan {

namespace {

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void execute(const Task& task, [[maybe_unused]] const std::string& stage) {
#ifndef NDEBUG
  const FieldSet allowed = task.reads | task.writes;
  const AccessGuard guard(stage.c_str(), task.owner.c_str(), allowed);
#endif
  task.call();
}

}  // namespace

Schedule::Schedule(std::span<const char* const> stages)
    : tasks_(stages.size()), executed_(stages.size(), 0), processor_seconds_(stages.size(), 0.0) {
  for (const char* name : stages) seconds_.emplace_back(name, 0.0);
}

void Schedule::add(Task task) { tasks_[task.stage].push_back(std::move(task)); }

void Schedule::run(std::size_t first, std::size_t last) {
  for (std::size_t stage = first; stage <= last; ++stage) {
    if (tasks_[stage].empty()) continue;
    const auto start = std::chrono::steady_clock::now();
    const double processor = thread_seconds();
    for (const Task& task : tasks_[stage]) execute(task, seconds_[stage].first);
    ++executed_[stage];
    processor_seconds_[stage] += thread_seconds() - processor;
    seconds_[stage].second += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
}

}  // namespace barchan
