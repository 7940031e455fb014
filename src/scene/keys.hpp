// The one table of the keys of a scene file. The reader checks against it, the schema and docs/scenes.md are made from
// it.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace barchan {

/// What a key's value may be; several may hold at once.
enum Accepts : unsigned {
  as_number = 1u << 0,
  as_integer = 1u << 1,
  as_boolean = 1u << 2,
  as_text = 1u << 3,
  as_word = 1u << 4,             // one of Key::words
  as_words = 1u << 5,            // an array of them
  as_vector = 1u << 6,           // as many numbers as the scene has dimensions
  as_formula = 1u << 7,          // a number or a formula in Key::variables
  as_formulas = 1u << 8,         // as many of these as the scene has dimensions
  as_points = 1u << 9,           // an array of vectors
  as_corners = 1u << 10,         // an array of [x, y], at least three
  as_section = 1u << 11,         // a table; its keys are those of the section SECTION.NAME
  as_sections = 1u << 12,        // an array of tables
  as_named_sections = 1u << 13,  // a table of tables whose names the user chooses
};

/// NumberBounds of a number; `above` and `below` exclude the bound itself.
struct NumberBounds {
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
  double above = -std::numeric_limits<double>::infinity();
  double below = std::numeric_limits<double>::infinity();
  bool hold(double value) const { return value >= at_least && value <= at_most && value > above && value < below; }
};

struct Key {
  std::string_view section;  // "" for the top of the file; "phases", "fill.shape.disc", ...
  std::string_view name;
  unsigned accepts = 0;
  std::string_view unit = "";       // SI; "" for a pure number or a word
  std::string_view otherwise = "";  // the default in words; "required" when there is none
  std::string_view meaning = "";
  NumberBounds bounds{};
  std::string_view words = "";      // choices, '|' between them; "@fields": the names of base/fields.hpp
  std::string_view variables = "";  // of a formula
  std::string_view kinds = "";      // phases only: the kinds that have this key; "" for all
  std::string_view spared = "";     // phases only: kinds that may leave out what the others must give
  bool required() const { return otherwise == "required" || !spared.empty(); }
};

std::span<const Key> all_keys();
const Key* find_key(std::string_view section, std::string_view name);  ///< null when there is none
std::vector<const Key*> keys_of(std::string_view section);             ///< in the order of the table
std::vector<std::string> choices(const Key& key);
bool belongs_to_kind(const Key& key, std::string_view kind);

/// What the key takes, for messages: `a number > 0 (m)`, `"rows", "staggered" or "random"`, `an array of 2 numbers
/// (m)`.
std::string expected(const Key& key, int dimensions);

}  // namespace barchan
