#include "scene/controls.hpp"

#include <algorithm>

namespace barchan {

std::vector<Control>& controls() {
  static std::vector<Control> all;
  return all;
}

double* find_control(const std::string& name) {
  const auto found =
      std::find_if(controls().begin(), controls().end(), [&](const Control& c) { return c.name == name; });
  return found == controls().end() ? nullptr : &found->value;
}

double value_of_control(double number, double) {
  const auto k = static_cast<std::size_t>(number);
  return k < controls().size() ? controls()[k].value : 0.0;
}

}  // namespace barchan
