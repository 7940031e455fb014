// The tables of docs/scenes.md, from the table of keys: unit, range, default, an example and the meaning of every key.
#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "scene/keys.hpp"
#include "scene/schema.hpp"

namespace barchan {
namespace {

/// Values by the name of a key, whatever its section.
constexpr std::pair<std::string_view, std::string_view> by_name[] = {
    {"phase", "\"air\""},
    {"wall", "\"ground\""},
    {"name", "\"crest\""},
    {"file", "\"out/bed/bed_000010.vtp\""},
    {"profile", "\"profile_inlet.csv\""},
    {"min", "[0, 0]"},
    {"max", "[0.1, 0.2]"},
    {"from", "[0.15, 0.03]"},
    {"to", "[0.15, 0.1]"},
    {"centre", "[0.1, 0.1]"},
    {"about", "[0.1, 0.1]"},
    {"friction-velocity", "0.4"},
    {"roughness", "8.3e-6"},
    {"count", "50"},
    {"seed", "7"},
    {"restitution", "0.9"},
    {"every", "1e-3"},
    {"start", "0.05"},
};

/// Values by the unit of a key: of a number, or of the first component of a vector.
constexpr std::pair<std::string_view, std::string_view> by_unit[] = {{"m", "0.02"},   {"s", "0.01"},     {"m/s", "0.5"},
                                                                     {"1/s", "10"},   {"degrees", "15"}, {"Pa", "100"},
                                                                     {"N m", "0.02"}, {"", "0.1"}};

template <std::size_t size>
std::string_view value_in(const std::pair<std::string_view, std::string_view> (&table)[size], std::string_view name) {
  const auto* row = std::find_if(table, table + size, [&](const auto& entry) { return entry.first == name; });
  return row == table + size ? "" : row->second;
}

/// The first choice that is not the default: an example of what a scene says to change something.
std::string other_word(const Key& key) {
  const std::string otherwise = default_text(key);
  for (const std::string& word : choices(key))
    if (word != otherwise) return '"' + word + '"';
  return "";
}

/// `key = value` of every key that the section requires, or of its first one.
std::vector<std::string> lines_of(std::string_view section) {
  std::vector<std::string> lines;
  const std::vector<const Key*> keys = keys_of(section);
  for (const Key* key : keys)
    if (key->required() && key->slot.kinds.empty()) lines.push_back(example_of(*key));
  if (lines.empty() && !keys.empty()) lines.push_back(example_of(*keys.front()));
  return lines;
}

std::string joined(const std::vector<std::string>& lines, std::string_view between) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : std::string(between)) + line;
  return text;
}

/// A value in TOML by the rules of this file; "" when none fits.
std::string value_of(const Key& key) {
  const unsigned accepts = key.slot.accepts;
  if (!key.slot.example.empty()) return std::string(key.slot.example);
  if (accepts & as_word) return other_word(key);
  if (accepts & as_words) return "[" + other_word(key) + "]";
  if (accepts & as_boolean) return default_text(key) == "true" ? "false" : "true";
  if (key.section == "saltation" && key.name == "phase") return "\"sand\"";
  if (const std::string_view value = value_in(by_name, key.name); !value.empty()) return std::string(value);
  if (accepts & as_section) return "{ " + joined(lines_of(path_of(key)), ", ") + " }";
  const double* number = std::get_if<double>(&key.slot.otherwise.value);
  if (number && *number != 0.0) return number_text(*number);
  const std::string value(value_in(by_unit, key.unit));
  if (accepts & (as_vector | as_formulas)) return "[" + value + (key.bounds.hold(0.0) ? ", 0]" : ", " + value + "]");
  return accepts & (as_number | as_formula | as_axial) ? value : "";
}

/// The lines of a section at the top of the file: `[time]`, `[phases.air]` or `[[fill]]` and what it requires.
std::string section_example(const Key& key) {
  const std::string name = std::string(key.name) + (key.slot.accepts & as_named_sections ? ".air" : "");
  const std::string heading = key.slot.accepts & as_sections ? "[[" + name + "]]\n" : "[" + name + "]\n";
  const std::string_view given = key.slot.example;
  return heading + (given.empty() ? joined(lines_of(path_of(key)), "\n") : std::string(given));
}

/// As it stands in a cell of a table.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.replace(at, 1, "\\|");
  return text;
}

/// `density = 1` becomes `` `density = 1` ``; lines follow each other with a break.
std::string code(const std::string& text) {
  std::string marked = "`";
  for (const char c : text) marked += c == '\n' ? std::string("`<br>`") : std::string(1, c);
  return cell(marked + "`");
}

std::string table_row(const Key& key) {
  std::string value = expected(key, 2, false);
  for (std::size_t at; (at = value.find("of 2 ")) != std::string::npos;) value.erase(at, 5).insert(at, "of ");
  std::string meaning(key.meaning);
  if (!key.slot.kinds.empty()) meaning += " (" + kinds_text(key, ", ") + ")";
  const bool measures = (key.slot.accepts & (as_number | as_integer | as_vector | as_formula | as_formulas | as_points |
                                             as_corners | as_axial)) != 0;
  const std::string unit = !key.unit.empty() ? std::string(key.unit) : measures ? "1" : "-";
  const std::string otherwise = default_text(key);
  return "| `" + std::string(key.name) + "` | " + cell(value) + " | " + unit + " | " +
         (otherwise.empty() ? "none" : otherwise) + " | " + code(example_of(key)) + " | " + cell(meaning) + " |\n";
}

constexpr std::pair<std::string_view, std::string_view> sections[] = {
    {"", "Top of the file"},
    {"domain", "`[domain]`"},
    {"phases", "`[phases.NAME]`"},
    {"phases.log-profile", "`log-profile = { ... }` of a column"},
    {"phases.diameter", "`diameter = { ... }` of grains and walls"},
    {"interactions", "`[interactions]`"},
    {"interactions.pair", "`[interactions]` `a-b = { ... }`"},
    {"fill", "`[[fill]]`"},
    {"fill.shape", "`shape = { ... }` of a fill"},
    {"fill.shape.dune", "`dune = { ... }` of a bed"},
    {"fill.shape.box", "`box = { ... }`"},
    {"fill.shape.disc", "`disc = { ... }`"},
    {"fill.shape.sphere", "`sphere = { ... }`"},
    {"fill.shape.ring", "`ring = { ... }`"},
    {"fill.shape.cube", "`cube = { ... }`"},
    {"fill.velocity", "`velocity = { ... }` of a fill"},
    {"fill.velocity.log-profile", "`log-profile = { ... }`"},
    {"forcing", "`[[forcing]]`"},
    {"forcing.box", "`forcing.box`"},
    {"inflow", "`[[inflow]]`"},
    {"inflow.velocity", "`velocity = { ... }` of an inflow"},
    {"inflow.velocity.log-profile", "`log-profile = { ... }`"},
    {"inflow.fluctuations", "`fluctuations = { ... }` of an inflow"},
    {"outflow", "`[[outflow]]`"},
    {"influx", "`[[influx]]`"},
    {"influx.box", "`box = { ... }` of an influx"},
    {"motion", "`[[motion]]`"},
    {"motion.box", "`motion.box`"},
    {"marker", "`[[marker]]`"},
    {"marker.box", "`marker.box`"},
    {"force", "`[[force]]`"},
    {"force.box", "`force.box`"},
    {"probe", "`[[probe]]`"},
    {"gauge", "`[[gauge]]`"},
    {"profile", "`[[profile]]`"},
    {"profile.box", "`box = { ... }` of a profile"},
    {"grid", "`[[grid]]`"},
    {"wall-shear", "`[[wall-shear]]`"},
    {"saltation", "`[[saltation]]`"},
    {"time", "`[time]`"},
    {"output", "`[output]`"}};

}  // namespace

std::string example_of(const Key& key) {
  const bool at_the_top = key.section.empty() && (key.slot.accepts & (as_section | as_sections | as_named_sections));
  if (at_the_top) return section_example(key);
  const std::string value = value_of(key);
  if (value.empty()) throw std::logic_error("no example of the key " + path_of(key) + ": give its row one with like()");
  return std::string(key.name) + " = " + value;
}

std::string scene_tables() {
  std::string text;
  for (const auto& [section, heading] : sections) {
    text +=
        "\n### " + std::string(heading) +
        "\n\n| key | value and range | unit | default | example | meaning |\n| --- | --- | --- | --- | --- | --- |\n";
    for (const Key* key : keys_of(section)) text += table_row(*key);
  }
  return text;
}

}  // namespace barchan
