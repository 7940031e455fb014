// A run that another program steers (python/barchan/simulation.py): before its steps it waits for requests, one JSON
// object a line, and answers each with a JSON object on a line, behind which the bytes of an array may follow.
//
//   {"do": "steps", "count": 10}              goes on; the answer comes when it waits again
//   {"do": "until", "time": 0.5}              the same: the first step that ends there or later, no step is cut
//   {"do": "state"}                           time, steps, whether it has ended, phases with fields, controls
//   {"do": "array", "phase": "sand", "field": "velocity"}   float64 (id: int64), particles in the order of their ids
//   {"do": "history"}                         the row of history.csv of now
//   {"do": "control", "name": "pull", "value": 0.5}
//   {"do": "stop"}                            or the end of the requests: the run ends as by a signal
#pragma once

#include <string>

#include "simulation/simulation.hpp"

namespace barchan {

class Steering {
 public:
  /// Reads requests and writes answers through these open files of the process.
  Steering(int requests, int answers) : requests_(requests), answers_(answers) {}

  /// Before a step, or at the end of the run: waits for requests unless steps are left. False: the run shall stop.
  bool goes_on(const Simulation& simulation, bool ended);

 private:
  enum class Asked { more, go, stop };
  Asked carry_out(const std::string& request, const Simulation& simulation, bool ended);
  bool read_line(std::string& line);
  void write(const std::string& bytes) const;

  int requests_, answers_;
  std::string come_;         // and not read yet
  bool waits_ = false;       // for an answer: who asked for steps
  long until_step_ = 0;      // goes on below it
  double until_time_ = 0.0;  // s, or below this
};

}  // namespace barchan
