#include "scene/units.hpp"

namespace barchan {

namespace {

struct Unit {
  std::string_view name;
  Quantity quantity;
  UnitSize size;
};

constexpr Unit units[] = {
    {"m", Quantity::length, {}},
    {"mm", Quantity::length, {1.0, 1e3}},
    {"cm", Quantity::length, {1.0, 1e2}},
    {"dm", Quantity::length, {1.0, 1e1}},
    {"km", Quantity::length, {1e3, 1.0}},
    {"um", Quantity::length, {1.0, 1e6}},
    {"nm", Quantity::length, {1.0, 1e9}},
    {"s", Quantity::time, {}},
    {"ms", Quantity::time, {1.0, 1e3}},
    {"us", Quantity::time, {1.0, 1e6}},
    {"min", Quantity::time, {60.0, 1.0}},
    {"h", Quantity::time, {3600.0, 1.0}},
    {"m/s", Quantity::speed, {}},
    {"mm/s", Quantity::speed, {1.0, 1e3}},
    {"cm/s", Quantity::speed, {1.0, 1e2}},
    {"km/s", Quantity::speed, {1e3, 1.0}},
    {"km/h", Quantity::speed, {1.0, 3.6}},
    {"m/min", Quantity::speed, {1.0, 60.0}},
    {"m/h", Quantity::speed, {1.0, 3600.0}},
    {"kg/m3", Quantity::density, {}},
    {"g/cm3", Quantity::density, {1e3, 1.0}},
    {"Pa", Quantity::pressure, {}},
    {"hPa", Quantity::pressure, {1e2, 1.0}},
    {"kPa", Quantity::pressure, {1e3, 1.0}},
    {"MPa", Quantity::pressure, {1e6, 1.0}},
    {"GPa", Quantity::pressure, {1e9, 1.0}},
    {"mbar", Quantity::pressure, {1e2, 1.0}},
    {"bar", Quantity::pressure, {1e5, 1.0}},
    {"m2/s", Quantity::viscosity, {}},
    {"mm2/s", Quantity::viscosity, {1.0, 1e6}},
};

/// Without blanks, dots and signs of powers; the micro sign of either code point is a u; "ms-1" is "m/s".
std::string plain(std::string_view name) {
  std::string text;
  for (std::size_t k = 0; k < name.size(); ++k) {
    const std::string_view rest = name.substr(k);
    if (rest.starts_with("\xC2\xB5") || rest.starts_with("\xCE\xBC")) {
      text += 'u';
      ++k;
    } else if (std::string_view(" \t^*").find(name[k]) == std::string_view::npos) {
      text += name[k];
    }
  }
  for (const std::string_view power : {"s-1", "h-1", "min-1"})
    if (text.size() > power.size() && text.ends_with(power)) {
      const std::string unit(power.substr(0, power.size() - 2));
      text.resize(text.size() - power.size());
      if (text.ends_with('.')) text.pop_back();
      return text + "/" + unit;
    }
  return text == "kmh" || text == "kph" ? "km/h" : text;
}

const char* name_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::length: return "length";
    case Quantity::time: return "time";
    case Quantity::speed: return "speed";
    case Quantity::density: return "density";
    case Quantity::pressure: return "pressure";
    case Quantity::viscosity: return "kinematic viscosity";
  }
  return "";
}

}  // namespace

std::optional<UnitSize> unit_of(std::string_view name, Quantity quantity) {
  const std::string text = plain(name);
  for (const Unit& unit : units)
    if (unit.quantity == quantity && unit.name == text) return unit.size;
  return std::nullopt;
}

std::optional<UnitSize> unit_of(std::string_view name) {
  for (const Unit& unit : units)
    if (const auto size = unit_of(name, unit.quantity)) return size;
  return std::nullopt;
}

std::string units_text(Quantity quantity) {
  std::string text;
  for (const Unit& unit : units)
    if (unit.quantity == quantity) text += (text.empty() ? "" : ", ") + std::string(unit.name);
  return std::string(name_of(quantity)) + " (" + text + ")";
}

}  // namespace barchan
