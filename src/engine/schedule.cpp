#include "engine/schedule.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "base/clock.hpp"

namespace barchan {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t once = static_cast<std::size_t>(-1);

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

Schedule::Schedule(std::span<const char* const> stages)
    : tasks_(stages.size()), repeat_of_(stages.size()), images_(stages.size()), executed_(stages.size(), 0) {
  for (const char* name : stages) seconds_.emplace_back(name, 0.0);
}

void Schedule::add(Task task) {
  repeat_of_[task.stage].push_back(task.repeat ? repeats_.size() : once);
  if (task.repeat) repeats_.push_back({task.repeat->name, task.owner, task.stage, task.repeat->interval});
  images_[task.stage].emplace_back();
  tasks_[task.stage].push_back(std::move(task));
}

void Schedule::use(Halo& halo, const std::vector<std::string>& phases) {
  halo_ = &halo;
  for (std::size_t stage = 0; stage < tasks_.size(); ++stage)
    for (std::size_t k = 0; k < tasks_[stage].size(); ++k) {
      Images& images = images_[stage][k] = {};
      for (const Touch& t : tasks_[stage][k].touches)
        for (std::size_t r = 0; r < record_count; ++r) {
          const auto record = static_cast<Record>(r);
          if (!t.records.ghosts.has(record) && !t.records.writes.has(record)) continue;
          const auto found = std::find(phases.begin(), phases.end(), t.phase);
          if (found == phases.end()) throw std::logic_error("a task has records of \"" + t.phase + "\", no phase");
          const auto number = static_cast<std::size_t>(found - phases.begin());
          if (t.records.ghosts.has(record)) images.read.emplace_back(number, record);
          if (t.records.writes.has(record)) images.written.emplace_back(number, record);
        }
    }
}

void Schedule::execute(const Task& task, const Images& images) {
  if (halo_)
    for (const auto& [phase, record] : images.read) halo_->fill_images(phase, record);
  {
#ifndef NDEBUG
    const AccessGuard guard(name(task.stage).c_str(), task.owner.c_str(), task.touches);
#endif
    task.call();
  }
  if (halo_)
    for (const auto& [phase, record] : images.written) halo_->outdate_images(phase, record);
}

void Schedule::repeat(const Task& task, const Images& images, RepeatCount& count) {
  const auto start = Clock::now();
  const long times = task.repeat->times();
  for (long k = 0; k < times; ++k) execute(task, images);
  count.calls += times;
  count.seconds += since(start);
}

void Schedule::run(std::size_t first, std::size_t last) {
  for (std::size_t stage = first; stage <= last; ++stage) {
    if (tasks_[stage].empty()) continue;
    const auto start = Clock::now();
    for (std::size_t k = 0; k < tasks_[stage].size(); ++k) {
      const Task& task = tasks_[stage][k];
      const Images& images = images_[stage][k];
      if (const std::size_t number = repeat_of_[stage][k]; number != once) repeat(task, images, repeats_[number]);
      else execute(task, images);
    }
    ++executed_[stage];
    seconds_[stage].second += since(start);
  }
}

}  // namespace barchan
