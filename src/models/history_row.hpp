// A row of history.csv. Who adds a column says its name and its value in one place, so that the two cannot disagree.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace barchan {

class HistoryRow {
 public:
  /// Adds a column behind the others: "air_mean_pressure [Pa]" and its value now.
  void add(std::string name, double value) {
    names.push_back(std::move(name));
    values.push_back(value);
  }
  /// In two dimensions all that belongs to a mass is of a metre of depth: "kg" becomes "kg/m", "N m" becomes "N".
  void count_by_metre() {
    constexpr std::pair<std::string_view, std::string_view> units[] = {
        {" [kg]", " [kg/m]"},   {" [J]", " [J/m]"},       {" [N]", " [N/m]"},         {" [N m]", " [N]"},
        {" [N s]", " [N s/m]"}, {" [kg m/s]", " [kg/s]"}, {" [kg m2/s]", " [kg m/s]"}};
    for (std::string& name : names)
      for (const auto& [of_all, of_a_metre] : units)
        if (name.ends_with(of_all)) {
          name.replace(name.size() - of_all.size(), of_all.size(), of_a_metre);
          break;
        }
  }
  /// Raises the value of a column that was added before, of which each phase knows its own largest value.
  void raise(std::size_t column, double value) { values[column] = std::max(values[column], value); }

  /// The columns that every row begins with.
  enum Common : std::size_t {
    time,
    step,
    dt,
    momentum_x,
    momentum_y,
    momentum_z,
    largest_speed,
    largest_density_error
  };

  std::vector<std::string> names;
  std::vector<double> values;
};

}  // namespace barchan
