#include "start/velocity_profile.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "base/errors.hpp"
#include "base/input_file.hpp"
#include "scene/text_table.hpp"
#include "scene/text_words.hpp"

namespace barchan {

namespace {

constexpr std::uint64_t most = 64'000'000;  // bytes

/// A column by its name; nothing: there is none.
struct Column {
  std::size_t number;
  UnitSize unit;
};

}  // namespace

VelocityProfile::VelocityProfile(std::string_view text, const std::string& what) {
  const auto refuse = [&](const std::string& why) { throw SceneError(what + why); };
  if (const std::string why = why_no_text(text); !why.empty()) refuse(why);
  mesh::Lines lines(without_mark(text));
  const auto fields = [&] {
    auto found = fields_of(lines.line(), false);
    if (!found) refuse("line " + std::to_string(lines.number()) + " has a field whose quote is not closed");
    return *found;
  };
  if (!lines.next_with_words()) refuse("is empty; expected a table with the names of its columns in the first line");
  const std::vector<std::string> names = fields();
  const auto column = [&](const std::string& name, Quantity quantity) {
    std::optional<Column> found;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const ColumnHead head = head_of(names[k], quantity);
      if (head.name != name) continue;
      if (found) refuse("has two columns " + name + "; expected one");
      const auto unit = head.unit ? unit_of(*head.unit, quantity) : UnitSize{};
      if (!unit)
        refuse("has the column " + name + " in " + mesh::in_quotes(*head.unit) + "; expected a unit of " +
               units_text(quantity));
      found = Column{k, *unit};
    }
    return found;
  };
  const std::optional<Column> y = column("y", Quantity::length);
  std::array<std::optional<Column>, 3> v;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::string axis(1, "xyz"[d]);
    v[d] = column("velocity_mean_" + axis, Quantity::speed);
    if (!v[d]) v[d] = column("velocity_" + axis, Quantity::speed);
  }
  if (!y || !v[0])
    refuse("has no column y and velocity_mean_x (or velocity_x); expected profile_NAME.csv of a [[profile]]");
  while (lines.next_with_words()) {
    const std::vector<std::string> row_fields = fields();
    const std::string line = "line " + std::to_string(lines.number());
    if (row_fields.size() != names.size())
      refuse(line + " has " + std::to_string(row_fields.size()) + " fields; expected " + std::to_string(names.size()) +
             ", as many as names of columns");
    const auto value = [&](const Column& from) {
      const std::string& field = row_fields[from.number];
      const auto number = mesh::coordinate_of(field);
      if (!number) refuse(line + ": " + no_number(field));
      return from.unit.of(*number);
    };
    Row row{value(*y), {}};
    for (std::size_t d = 0; d < 3; ++d)
      if (v[d]) row.velocity[d] = value(*v[d]);
    if (!rows_.empty() && !(row.y > rows_.back().y))
      refuse(line + " is not higher than the one before; expected heights y that grow");
    rows_.push_back(row);
  }
  if (rows_.size() < 2) refuse("has fewer than two rows; expected a profile by height");
}

Vec3 VelocityProfile::operator()(double y) const {
  const auto above =
      std::upper_bound(rows_.begin(), rows_.end(), y, [](double at, const Row& row) { return at < row.y; });
  if (above == rows_.begin()) return rows_.front().velocity;
  if (above == rows_.end()) return rows_.back().velocity;
  const Row &low = *(above - 1), &high = *above;
  const double share = (y - low.y) / (high.y - low.y);
  return (1.0 - share) * low.velocity + share * high.velocity;
}

VelocityProfile read_velocity_profile(const std::string& path, const std::string& what) {
  try {
    return {read_input(path, most), what};
  } catch (const InputError& e) { throw SceneError(what + e.what() + "; expected a profile by height"); }
}

}  // namespace barchan
