// Units that a table or a text may name, and their size in SI. Internal to src/scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace barchan {

enum class Quantity { length, time, speed, density, pressure, viscosity };

/// A unit in SI: value * times / over. Two numbers, so that 100 mm are the same bits as 0.1 m.
struct UnitSize {
  double times = 1.0, over = 1.0;
  double of(double value) const { return value * times / over; }
};

/// The unit of that name ("mm", "km/h", "m s-1"); nothing: it is none of this quantity that we can convert.
std::optional<UnitSize> unit_of(std::string_view name, Quantity quantity);
/// The same of any quantity.
std::optional<UnitSize> unit_of(std::string_view name);

/// "length (m, mm, ...)": what unit_of() takes, for messages.
std::string units_text(Quantity quantity);

}  // namespace barchan
