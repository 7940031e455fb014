// Controls: numbers of formulas that may change while a run goes on ([controls]). They belong to the process: one
// process steers one run.
#pragma once

#include <string>
#include <vector>

namespace barchan {

struct Control {
  std::string name;
  double value = 0.0;
};

/// Those of the scene that was read last, in the order of their names. Formulas call them control(number, t): they are
/// functions of time for everybody who asks what a formula depends on.
std::vector<Control>& controls();
/// The value of one by its name; null: there is none.
double* find_control(const std::string& name);
/// muParser's function.
double value_of_control(double number, double t);

}  // namespace barchan
