// How far a run is: a bar on a terminal, a plain line now and then elsewhere.
#pragma once

#include <chrono>
#include <string>

#include "simulation/simulation.hpp"

namespace barchan {

class Progress {
 public:
  Progress(double end, double particles, bool quiet);
  void step(const Simulation& simulation);  ///< after every step; prints ten times a second at most
  void end(const std::string& reason);
  void back(const Simulation& simulation) {
    last_steps_ = simulation.steps();
  }                        ///< the run went back to an earlier step
  double seconds() const;  ///< s since the beginning

 private:
  using Clock = std::chrono::steady_clock;
  double end_, particles_;
  bool quiet_, terminal_;
  Clock::time_point start_, last_;
  long last_steps_ = 0, steps_ = 0;
  double time_ = 0;
};

}  // namespace barchan
