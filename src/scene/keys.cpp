#include "scene/keys.hpp"

#include <algorithm>
#include <cstdio>

#include "base/fields.hpp"
#include "scene/nearest.hpp"

namespace barchan {
namespace {

/// `fluid`
std::string_view kind_word(PhaseKind kind) {
  return find_key("phases", "kind")->slot.words[static_cast<std::size_t>(kind)].word;
}

std::string bounds_text(const NumberBounds& b) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::string text;
  const auto add = [&](const char* sign, double value, double absent) {
    if (value != absent) text += (text.empty() ? " " : " and ") + std::string(sign) + " " + number_text(value);
  };
  add(">", b.above, -infinity);
  add(">=", b.at_least, -infinity);
  add("<", b.below, infinity);
  add("<=", b.at_most, infinity);
  return text;
}

}  // namespace

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

const Key* find_key(std::string_view section, std::string_view name) {
  for (const Key& key : all_keys())
    if (key.section == section && key.name == name) return &key;
  return nullptr;
}

std::vector<const Key*> keys_of(std::string_view section) {
  std::vector<const Key*> keys;
  for (const Key& key : all_keys())
    if (key.section == section) keys.push_back(&key);
  return keys;
}

std::string path_of(const Key& key) {
  return key.section.empty() ? std::string(key.name) : std::string(key.section) + "." + std::string(key.name);
}

std::vector<std::string> choices(const Key& key) {
  std::vector<std::string> words;
  for (const Word& word : key.slot.words) words.emplace_back(word.word);
  if (key.slot.fields) {
    for (const FieldInfo& field : field_table) words.emplace_back(field.name);
    words.insert(words.end(), {"id", "phase"});
  }
  return words;
}

std::string default_text(const Key& key) {
  const Default& otherwise = key.slot.otherwise;
  if (!otherwise.in_words.empty()) return std::string(otherwise.in_words);
  if (const bool* truth = std::get_if<bool>(&otherwise.value)) return *truth ? "true" : "false";
  if (const double* number = std::get_if<double>(&otherwise.value)) return number_text(*number);
  const int* whole = std::get_if<int>(&otherwise.value);
  if (whole)
    for (const Word& word : key.slot.words)
      if (word.meaning == *whole) return std::string(word.word);
  return whole ? std::to_string(*whole) : "";
}

bool belongs_to_kind(const Key& key, std::string_view kind) {
  const std::span<const PhaseKind> kinds = key.slot.kinds;
  return kinds.empty() || std::any_of(kinds.begin(), kinds.end(), [&](PhaseKind k) { return kind_word(k) == kind; });
}

std::string kinds_text(const Key& key, std::string_view between) {
  std::string text;
  for (const PhaseKind kind : key.slot.kinds)
    text += (text.empty() ? "" : std::string(between)) + std::string(kind_word(kind));
  return text;
}

std::string expected(const Key& key, int dimensions, bool with_unit) {
  const std::string bounds = bounds_text(key.bounds);
  const std::string unit = key.unit.empty() || !with_unit ? "" : " (" + std::string(key.unit) + ")";
  const std::string count = std::to_string(dimensions);
  std::string variables;
  for (const char c : key.variables) variables += c == ' ' ? std::string(", ") : std::string(1, c);
  const std::string formula = variables.empty() ? "a formula" : "a formula in " + variables;
  std::vector<std::string> ways;
  if (key.slot.accepts & as_axial)
    ways.push_back(dimensions == 2 ? "a number" + unit + " or " + formula
                                   : "an array of 3 numbers" + unit + " or formulas");
  if (key.slot.accepts & as_number) ways.push_back("a number" + bounds + unit);
  if (key.slot.accepts & as_integer) ways.push_back("a whole number" + bounds + unit);
  if (key.slot.accepts & as_boolean) ways.emplace_back("true or false");
  if (key.slot.accepts & as_text) ways.emplace_back("a string");
  if (key.slot.accepts & as_vector) ways.push_back("an array of " + count + " numbers" + bounds + unit);
  if (key.slot.accepts & as_formula) ways.push_back("a number" + unit + " or a formula in " + variables);
  if (key.slot.accepts & as_formulas)
    ways.push_back("an array of " + count + " numbers" + unit + " or formulas in " + variables);
  if (key.slot.accepts & as_points) ways.push_back("an array of points of " + count + " numbers" + unit);
  if (key.slot.accepts & as_corners) ways.push_back("an array of three or more corners [x, y]" + unit);
  if (key.slot.accepts & as_words) ways.push_back("an array of " + one_of(choices(key)));
  if (key.slot.accepts & as_word) ways.push_back(one_of(choices(key)));
  if (key.slot.accepts & (as_section | as_named_sections)) {
    const auto inner = ways.empty() ? std::vector<const Key*>{} : keys_of(path_of(key));
    if (inner.empty()) ways.emplace_back("a section");
    else
      ways.push_back("{ " + std::string(inner.front()->name) + " = ... }" + (inner.size() > 1 ? " and the like" : ""));
  }
  if (key.slot.accepts & as_sections) ways.push_back("sections [[" + std::string(key.name) + "]]");
  std::string text;
  for (const std::string& way : ways) text += (text.empty() ? "" : " or ") + way;
  return text;
}

}  // namespace barchan
