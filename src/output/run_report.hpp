// run.json: what ran, how fast, and how well the conserved quantities were kept.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/thread_chooser.hpp"
#include "engine/schedule.hpp"

namespace barchan {

struct RunReport {
  // the program
  std::string version, commit, compiler, instruction_set, vtk;
  int threads = 1;                              // at most
  std::vector<ThreadChooser::Use> thread_uses;  // by number of threads
  long thread_switches = 0;                     // how often the number changed
  /// Where ranks compute: so many, one after another, that say the same.
  struct Placement {
    int ranks = 1;
    std::string host, cores;  // the machine, and the numbers of its cores that they may use: "0-3,8"
    int threads = 1;          // of each
    bool is_like(const Placement& o) const { return host == o.host && cores == o.cores && threads == o.threads; }
  };
  struct Ranks {
    int count = 1;
    std::vector<Placement> placements;
    std::int64_t messages = 0, bytes = 0;  // from rank to rank, of all
    std::int64_t collectives = 0;          // reductions, broadcasts and the like, once for all
    std::int64_t ghosts = 0;               // at the end, of all ranks
    std::int64_t most_particles = 0;       // at the end, of a rank
    // Bytes that a rank has held at the most, shared libraries included: of the first one, which has frames and
    // checkpoints, and the most of the others.
    double memory_of_first = 0, most_memory_of_others = 0;
    // Of each rank in all steps, s: processor time without that of waiting, and wall time of waiting.
    std::vector<double> busy_seconds, waiting_seconds;
    std::string division;  // of cells: "time" or "particles"
    long divisions = 0;    // anew, by time
    double dividing_seconds = 0;
  } ranks;

  // the scene and the plan
  std::string scene_title, scene_file, scene_state;
  std::string scene_sha256;               // of the text of its file
  std::vector<std::string> overrides;     // of the command line
  double scene_spacing = 0;               // m
  std::array<double, 3> scene_gravity{};  // m/s2
  std::map<std::string, long> particles;  // by phase
  std::map<std::string, long> pairs;      // by matrix entry, "air-sand": directed pairs of the last list
  std::map<std::string, std::vector<std::string>> fields;  // by phase
  std::vector<std::string> passes;                         // that were executed, in the order of the step

  // the run
  long steps = 0;
  double simulated_time = 0;                            // s
  std::vector<std::pair<std::string, double>> seconds;  // s of wall time by pass, in the order of the step
  std::vector<RepeatCount> repeats;                     // tasks that steps do not call once
  double wall_seconds = 0, cpu_seconds = 0;             // s, in all
  double particle_steps_per_second = 0;
  double pair_interactions_per_second = 0;       // directed pairs
  std::map<std::string, long> time_step_limits;  // limit -> steps that it ruled
  std::map<std::string, double> budgets;         // momentum drift, largest density error, ...
  struct Measured {
    std::string kind, name;
    std::vector<std::string> files;  // relative to the run's folder
    long samples = 0;                // moments at which was measured
  };
  std::vector<Measured> measured;
  std::vector<std::string> warnings;  // what a user should know before the results are used
  struct Retreat {
    double time = 0, back_to = 0;  // s
    long step = 0;                 // that failed
    double share = 1;              // of the step from then on
    std::string reason;
  };
  long retreat_count = 0;         // with those before the last restart
  std::vector<Retreat> retreats;  // of this process
  std::string end_reason;         // "running", "end", "breakdown: ...", "output failed: ...", "SIGINT", ...
  long process = 0;               // that runs it or ran it,
  std::string host;               // and where
};

/// The document that write_run_report writes. What is not finite becomes null.
std::string to_json(const RunReport& report);

/// Replaces `file` by rename. Throws OutputError.
void write_run_report(const std::filesystem::path& file, const RunReport& report);

/// For a disk without room for another file: writes the few words that matter most into the place of the report that is
/// there. Returns whether it could.
bool overwrite_run_report(const std::filesystem::path& file, const RunReport& report);

/// Who writes into a folder, for comparison: process and host; of the report in a file, "" where there is none.
std::string run_of_report(long process, const std::string& host);
std::string run_of_report(const std::filesystem::path& file);

/// The files of instruments that the report of an earlier run names; none when there is no such report.
std::vector<std::string> measured_files(const std::filesystem::path& file);

}  // namespace barchan
