#include "scene/velocity_profile.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/errors.hpp"
#include "scene/mesh_words.hpp"

namespace barchan {

namespace {

constexpr std::uintmax_t most = std::uintmax_t{1} << 26;  // bytes

/// Between commas, without blanks about them.
std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view field = line.substr(begin, end - begin);
    const std::size_t first = std::min(field.find_first_not_of(mesh::blanks), field.size());
    field.remove_prefix(first);
    field = field.substr(0, field.find_last_not_of(mesh::blanks) + 1);
    fields.push_back(field);
    begin = end + 1;
  }
  return fields;
}

/// The number of a column by its name, a unit in brackets or not; -1: there is none.
int column_of(const std::vector<std::string_view>& names, std::string_view name) {
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name || (names[k].starts_with(name) && names[k].substr(name.size()).starts_with(" [")))
      return static_cast<int>(k);
  return -1;
}

}  // namespace

VelocityProfile::VelocityProfile(std::string_view text, const std::string& what) {
  const auto refuse = [&](const std::string& why) { throw SceneError(what + why); };
  mesh::Lines lines(text);
  if (!lines.next_with_words()) refuse("is empty; expected a table with the names of its columns in the first line");
  const auto names = cells_of(lines.line());
  const int y = column_of(names, "y");
  std::array<int, 3> v{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::string axis(1, "xyz"[d]);
    v[d] = column_of(names, "velocity_mean_" + axis);
    if (v[d] < 0) v[d] = column_of(names, "velocity_" + axis);
  }
  if (y < 0 || v[0] < 0)
    refuse("has no column y and velocity_mean_x (or velocity_x); expected profile_NAME.csv of a [[profile]]");
  while (lines.next_with_words()) {
    const auto fields = cells_of(lines.line());
    const std::string line = "line " + std::to_string(lines.number());
    if (fields.size() != names.size())
      refuse(line + " has " + std::to_string(fields.size()) + " fields; expected " + std::to_string(names.size()) +
             ", as many as names of columns");
    const auto value = [&](int column) {
      const auto number = mesh::coordinate_of(fields[static_cast<std::size_t>(column)]);
      if (!number)
        refuse(line + ": " + mesh::in_quotes(fields[static_cast<std::size_t>(column)]) + " is no finite number");
      return *number;
    };
    Row row{value(y), {}};
    for (std::size_t d = 0; d < 3; ++d)
      if (v[d] >= 0) row.velocity[d] = value(v[d]);
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
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw SceneError(what + "cannot be read: it is no file");
  if (std::filesystem::file_size(path, error) > most)
    throw SceneError(what + "is larger than 64 MB; expected a profile by height");
  std::ifstream stream(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (!stream.is_open() || stream.bad()) throw SceneError(what + "cannot be read");
  return {text, what};
}

}  // namespace barchan
