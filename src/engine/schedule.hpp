// The schedule of a step: tasks in order, each with the fields of each phase that it may touch. The plan makes it and
// prints it, the step executes it, timers and run.json are filled by the execution. A task may be a repeat: a model's
// own steps, of which a step of the scene holds several, or what comes only every so often.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/halo.hpp"
#include "state/access.hpp"

namespace barchan {

/// Why a step does not call a task once.
struct Repeat {
  std::string name;             // what it is, in the plural: "steps of contacts"
  double interval = 0;          // s, from one call to the next, as the plan knows it
  std::function<long()> times;  // calls in the present step, 0 too; asked right before them
};

/// One call of a step.
struct Task {
  std::size_t stage = 0;       // place in the step, a number of the schedule's stages
  std::string owner;           // whose work it is: a phase or an entry of the matrix
  Touches touches;             // one for each phase; of a phase that is not named it may touch nothing
  std::function<void()> call;  // allocates nothing
  std::optional<Repeat> repeat{};
};

/// What a repeat has done so far.
struct RepeatCount {
  std::string name, owner;
  std::size_t stage = 0;
  double interval = 0;  // s
  long calls = 0;
  double seconds = 0;  // s of wall time
};

class Schedule {
 public:
  /// `stages`: names of the parts of a step, in order. Tasks of one stage run in the order in which they were added.
  explicit Schedule(std::span<const char* const> stages);

  void add(Task task);
  /// From now on the halo makes the images that a task reads right before it. `phases`: their names, by number. Throws
  /// std::logic_error of a task with records of another phase. The halo must outlive the schedule's runs.
  void use(Halo& halo, const std::vector<std::string>& phases);
  bool has(std::size_t stage) const { return !tasks_[stage].empty(); }
  const std::vector<Task>& tasks(std::size_t stage) const { return tasks_[stage]; }
  std::size_t stages() const { return tasks_.size(); }
  const std::string& name(std::size_t stage) const { return seconds_[stage].first; }

  /// Executes the stages first .. last, both included; those without tasks cost nothing. In a build with assertions a
  /// task that touches a field that it did not declare throws std::logic_error (state/access.hpp).
  void run(std::size_t first, std::size_t last);

  /// By stage: how often it was executed, and wall time (s).
  const std::vector<long>& executed() const { return executed_; }
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }
  /// The repeats in the order in which they were added.
  const std::vector<RepeatCount>& repeats() const { return repeats_; }

 private:
  /// Records of phases by number.
  struct Images {
    std::vector<std::pair<std::size_t, Record>> read, written;
  };
  void repeat(const Task& task, const Images& images, RepeatCount& count);
  void execute(const Task& task, const Images& images);

  std::vector<std::vector<Task>> tasks_;
  std::vector<std::vector<std::size_t>> repeat_of_;  // by stage and task: number of its repeat, `once`
  std::vector<RepeatCount> repeats_;
  std::vector<std::vector<Images>> images_;  // by stage and task
  Halo* halo_ = nullptr;
  std::vector<long> executed_;
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace barchan
