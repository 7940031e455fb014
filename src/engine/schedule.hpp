// The schedule of a step: tasks in order, each with the fields that it may touch. The plan makes it and prints it, the
// step executes it, timers and run.json are filled by the execution.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "state/access.hpp"

namespace barchan {

/// One call of a step.
struct Task {
  std::size_t stage = 0;  // place in the step, a number of the schedule's stages
  std::string owner;      // whose work it is: a phase or an entry of the matrix
  FieldSet reads, writes;
  std::function<void()> call;  // allocates nothing
};

class Schedule {
 public:
  /// `stages`: names of the parts of a step, in order. Tasks of one stage run in the order in which they were added.
  explicit Schedule(std::span<const char* const> stages);

  void add(Task task);
  bool has(std::size_t stage) const { return !tasks_[stage].empty(); }
  const std::vector<Task>& tasks(std::size_t stage) const { return tasks_[stage]; }
  std::size_t stages() const { return tasks_.size(); }
  const std::string& name(std::size_t stage) const { return seconds_[stage].first; }

  /// Executes the stages first .. last, both included; those without tasks cost nothing. In a build with assertions a
  /// task that touches a field that it did not declare throws std::logic_error (state/access.hpp).
  void run(std::size_t first, std::size_t last);

  /// By stage: how often it was executed, wall time, and processor time of the calling thread (s).
  const std::vector<long>& executed() const { return executed_; }
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }
  const std::vector<double>& processor_seconds() const { return processor_seconds_; }

 private:
  std::vector<std::vector<Task>> tasks_;
  std::vector<long> executed_;
  std::vector<std::pair<std::string, double>> seconds_;
  std::vector<double> processor_seconds_;
};

}  // namespace barchan
