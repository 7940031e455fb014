// The table of the keys of a scene file: one row a key. Reading a document into a Scene (read.cpp), checking it
// (validate.cpp), `barchan schema` and the tables of docs/scenes.md (schema.cpp) are made from the rows (rows.cpp).
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/scene.hpp"

namespace barchan {

/// What a key's value may be; several may hold at once.
enum Accepts : unsigned {
  as_number = 1u << 0,
  as_integer = 1u << 1,
  as_boolean = 1u << 2,
  as_text = 1u << 3,
  as_word = 1u << 4,             // one of Slot::words
  as_words = 1u << 5,            // an array of them
  as_vector = 1u << 6,           // as many numbers as the scene has dimensions
  as_formula = 1u << 7,          // a number or a formula in Key::variables
  as_formulas = 1u << 8,         // as many of these as the scene has dimensions
  as_points = 1u << 9,           // an array of vectors
  as_corners = 1u << 10,         // an array of [x, y], at least three
  as_section = 1u << 11,         // a table; its keys are those of the section SECTION.NAME
  as_sections = 1u << 12,        // an array of tables
  as_named_sections = 1u << 13,  // a table of tables whose names the user chooses
  as_axial = 1u << 14,           // about an axis: in 2D a number or a formula, in 3D an array of three
};

/// Bounds of a number; `above` and `below` exclude the bound itself.
struct NumberBounds {
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
  double above = -std::numeric_limits<double>::infinity();
  double below = std::numeric_limits<double>::infinity();
  bool hold(double value) const { return value >= at_least && value <= at_most && value > above && value < below; }
};

/// The member of the scene that a value is written to. Monostate: the section that was read has no such member, as a
/// disc has no layers.
using Target = std::variant<std::monostate, bool*, std::optional<bool>*, int*, unsigned*, double*,
                            std::optional<double>*, std::string*, Vec3*, std::optional<Vec3>*, Expression*,
                            VectorExpression*, std::optional<AxialExpression>*, std::vector<std::string>*,
                            std::vector<Vec3>*, std::vector<std::array<double, 2>>*>;

/// What a key is when the document does not give it. Without a value the member stays empty or zero.
struct Default {
  std::variant<std::monostate, bool, int, double> value{};  // int: also the meaning of a word
  std::string_view in_words = "";                           // in place of the value, for the documentation
  bool required = false;
};

/// Where a key's value goes. Every function takes the object of the key's section: of "domain" a Domain, of
/// "fill.shape" a Shape. Those that the key does not need are null. rows.cpp makes them from a pointer to a member.
struct Slot {
  unsigned accepts = 0;  // of Accepts
  Default otherwise{};
  std::span<const Word> words{};
  Target (*member)(void* object) = nullptr;             // of numbers, strings, formulas, arrays
  void (*choose)(void* object, int meaning) = nullptr;  // of words
  void* (*open)(void* object) = nullptr;  // of sections: the object of the inner section; null: there is none
  bool always = false;                    // the inner section is there without the document: its defaults count
  bool fields = false;                    // its words are the names of base/fields.hpp
  std::span<const PhaseKind> kinds{};     // of phases: the kinds whose type has the member; empty: all
  std::string_view example = "";          // a value in TOML, where example_of (reference.cpp) makes no good one

  constexpr Slot like(std::string_view value) const {
    Slot slot = *this;
    slot.example = value;
    return slot;
  }
};

struct Key {
  std::string_view section;  // "" for the top of the file; "phases", "fill.shape.disc", ...
  std::string_view name;
  Slot slot;                   // member that it is read into, type, default
  std::string_view unit = "";  // SI; "" for a pure number or a word
  std::string_view meaning = "";
  NumberBounds bounds{};
  std::string_view variables = "";  // of a formula
  std::string_view spared = "";     // phases only: kinds that may leave out what the others must give
  bool required() const { return slot.otherwise.required; }
};

/// What [interactions] says for all of its pairs; the object of that section.
struct MatrixDefaults {
  std::optional<KernelKind> kernel;
};

std::string number_text(double value);  ///< ten digits at most
std::span<const Key> all_keys();
const Key* find_key(std::string_view section, std::string_view name);  ///< null when there is none
std::vector<const Key*> keys_of(std::string_view section);             ///< in the order of the table
std::string path_of(const Key& key);                                   ///< SECTION.NAME: the section of its inner keys
std::vector<std::string> choices(const Key& key);
bool belongs_to_kind(const Key& key, std::string_view kind);
std::string kinds_text(const Key& key, std::string_view between);  ///< `fluid, elastic`; "" for all

/// The default for the documentation: `0.05`, `linear`, `10 times the largest speed`, `required`; "" when there is
/// none.
std::string default_text(const Key& key);

/// An example of the key as a document has it, in 2D: `density = 1.225`, or a section with the keys that it requires,
/// in lines: `[[probe]]`, `name = "one"`, ... Throws std::logic_error when neither the row nor a rule has one.
std::string example_of(const Key& key);

/// What the key takes, for messages: `a number > 0 (m)`, `"rows", "staggered" or "random"`, `an array of 2 numbers
/// (m)`. Without `with_unit` the unit is left out.
std::string expected(const Key& key, int dimensions, bool with_unit = true);

}  // namespace barchan
