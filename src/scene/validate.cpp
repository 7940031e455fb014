#include "scene/validate.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/errors.hpp"
#include "scene/formula.hpp"
#include "scene/keys.hpp"
#include "scene/nearest.hpp"
#include "scene/other_words.hpp"
#include "scene/units.hpp"

namespace barchan {
namespace {

/// What a person sees in the file, shortened: for "found ...".
std::string shown(const toml::node& node) {
  if (const auto* text = node.as_string()) return '"' + shortened(text->get()) + '"';
  if (const auto number = node.as_integer()) return std::to_string(number->get());
  if (const auto number = node.as_floating_point()) return number_text(number->get());
  if (const auto truth = node.as_boolean()) return truth->get() ? "true" : "false";
  if (const auto* array = node.as_array()) return "an array of " + std::to_string(array->size());
  if (node.is_table()) return "a section";
  return "a date or time";
}

/// For a text in the place of a number: "0.1" in quotes, a decimal comma, a unit of SI. Empty: it is none of these.
std::string meant_number(const std::string& text) {
  std::string plain = text;
  if (const std::size_t comma = plain.find(','); comma != std::string::npos) plain[comma] = '.';
  double number = 0.0;
  const auto [rest, error] = std::from_chars(plain.data(), plain.data() + plain.size(), number);
  if (error != std::errc()) return "";
  std::string_view unit(rest, static_cast<std::size_t>(plain.data() + plain.size() - rest));
  unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
  if (unit.empty()) return number_text(number);
  const auto size = unit_of(unit);
  return size ? number_text(size->of(number)) : "";
}

/// The entry of a table of scene/other_words.hpp for a word of a section; null: it has none.
template <class Table>
const OtherWord* find_other(const Table& table, std::string_view section, std::string_view word) {
  std::string plain(word);
  for (char& c : plain) c = c == '_' || c == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const OtherWord& o) { return o.section == section && o.word == plain; });
  return found == table.end() ? nullptr : &*found;
}

bool is_kind(std::string_view word) {
  const std::vector<std::string> kinds = choices(*find_key("phases", "kind"));
  return std::find(kinds.begin(), kinds.end(), word) != kinds.end();
}

class Validator {
 public:
  /// `stated`: the document says how many dimensions the scene has.
  Validator(int dimensions, bool stated, Problems& problems)
      : dimensions_(dimensions), stated_(stated), problems_(problems) {}

  void section(const toml::table& table, const std::string& section, const std::string& dotted) {
    const std::string kind = section == "phases" ? table["kind"].value_or(std::string()) : "";
    std::vector<std::string> misspelt;  // keys that an unknown key probably means: not missing as well
    for (const auto& [name, node] : table) {
      const std::string here = dotted.empty() ? std::string(name.str()) : dotted + "." + std::string(name.str());
      if (section == "interactions" && name.str() != "kernel") pair(node, here);
      else if (const Key* key = find_key(section, name.str())) value(*key, node, here);
      else misspelt.push_back(unknown(name, table, section, kind, dotted, here));
    }
    for (const Key* key : keys_of(section)) {
      if (!key->required() || table.contains(key->name)) continue;
      if (!kind.empty() && !is_kind(kind)) continue;  // what it needs is not known
      const bool of_this_kind = key->slot.kinds.empty() || (!kind.empty() && belongs_to_kind(*key, kind));
      const bool from_material = key->name == "density" && table.contains("material") &&
                                 table["material"].value_or(std::string_view()) != words_of<Material>[0].word;
      const bool spared = from_material || (!kind.empty() && key->spared == kind);
      const bool meant = std::find(misspelt.begin(), misspelt.end(), key->name) != misspelt.end();
      if (of_this_kind && !spared && !meant)
        problems_.add(table.source(), dotted.empty() ? std::string(key->name) : dotted + "." + std::string(key->name),
                      "missing; expected " + expected(*key, dimensions_));
    }
  }

 private:
  /// Returns the key of the same section that was probably meant, if any.
  std::string unknown(const toml::key& name, const toml::table& table, const std::string& section,
                      const std::string& kind, const std::string& dotted, const std::string& here) {
    std::vector<std::string> names;
    for (const Key* key : keys_of(section))
      if (!is_kind(kind) || belongs_to_kind(*key, kind)) names.emplace_back(key->name);
    if (const auto* inner = table[name.str()].as_table(); section.empty() && inner && inner->contains("kind")) {
      problems_.add(name.source(), here,
                    "no section of a scene; expected [phases." + here + "], since a phase has a kind");
      return "";
    }
    const OtherWord* other = kind.empty() ? nullptr : find_other(other_keys, section + ":" + kind, name.str());
    if (!other) other = find_other(other_keys, section, name.str());
    const bool of_kind = !other || other->ours.empty() || section.empty() ||
                         std::find(names.begin(), names.end(), other->ours) != names.end();
    if (other && (!of_kind || table.contains(other->ours))) other = nullptr;  // of another kind, or said already
    if (other && other->ours.empty()) {
      problems_.add(name.source(), here, "unknown key: " + std::string(other->remark));
      return "";
    }
    std::string near = other ? std::string(other->ours) : nearest(name.str(), names);
    std::string meant = near;
    if (meant.empty())
      for (const Key& key : all_keys())
        if (key.name == name.str() && key.section.find('.') == std::string_view::npos) {
          meant = key.section.empty()
                      ? std::string(key.name)
                      : std::string(key.section) + (key.section == "phases" ? ".NAME." : ".") + std::string(key.name);
          break;
        }
    std::string all;
    for (const std::string& candidate : names) all += (all.empty() ? "" : ", ") + candidate;
    problems_.add(
        name.source(), here,
        "unknown key; expected " +
            (meant.empty() ? "one of " + all : "a key of " + (dotted.empty() ? "the scene" : "[" + dotted + "]")) +
            did_you_mean(meant, other ? other->remark : std::string_view()));
    return near;
  }

  void pair(const toml::node& node, const std::string& here) {
    static const Key& radius = *find_key("interactions.pair", "radius");
    if (const auto* table = node.as_table()) section(*table, "interactions.pair", here);
    else if (const auto* truth = node.as_boolean(); !truth) value(radius, node, here);
    else if (truth->get())
      problems_.add(node.source(), here,
                    "found true; expected " + expected(radius, dimensions_) +
                        ", a section, or false where the two do not interact");
  }

  /// True when the value has one of the forms that the key accepts; then its contents were checked too.
  void value(const Key& key, const toml::node& node, const std::string& here) {
    const std::string path = path_of(key);
    unsigned a = key.slot.accepts;
    if (a & as_axial) a |= dimensions_ == 2 ? as_formula : as_formulas;
    if (const auto* table = node.as_table()) {
      if (a & as_section) return section(*table, path, here);
      if (a & as_named_sections) return named_sections(*table, path, here);
    } else if (const auto* array = node.as_array()) {
      if (a & as_sections) return sections(key, *array, path, here);
      if (a & (as_vector | as_formulas)) return vector(key, *array, here, dimensions_);
      if (a & as_points) return points(key, *array, here, dimensions_, 1);
      if (a & as_corners) return points(key, *array, here, 2, 3);
      if (a & as_words) return words(key, *array, here);
    } else if (const auto* text = node.as_string()) {
      if (a & as_text) return;
      if ((a & as_word) && word_fits(key, text->get())) return;
      if (a & as_formula) return formula(key, *text, here);
      if (a & as_word) return unknown_word(key, *text, here);
    } else if (node.is_number()) {
      if (a & (as_number | as_formula)) return number(key, node, here);
      if ((a & as_integer) && node.is_integer()) return number(key, node, here);
    } else if (node.is_boolean() && (a & as_boolean)) {
      return;
    }
    std::string hint;
    if (const auto* text = node.as_string(); text && (a & (as_number | as_integer)))
      if (const std::string number = meant_number(text->get()); !number.empty())
        hint = "; did you mean " + number + ", without quotes or a unit?";
    problems_.add(node.source(), here, "found " + shown(node) + "; expected " + expected(key, dimensions_) + hint);
  }

  void named_sections(const toml::table& table, const std::string& path, const std::string& here) {
    for (const auto& [name, node] : table) {
      const std::string inner = here + "." + std::string(name.str());
      const std::string_view text = name.str();
      const bool letter_first = !text.empty() && std::isalpha(static_cast<unsigned char>(text[0]));
      bool good = letter_first;
      for (const char c : text) good = good && (std::isalnum(static_cast<unsigned char>(c)) || c == '_');
      if (!good)
        problems_.add(name.source(), inner,
                      "not a name of a phase; expected a letter followed by letters, digits and underscores");
      const auto* entry = node.as_table();
      const bool from_override = name.source().path && name.source().path->starts_with("--set ");
      const Key* const section_of_scene = find_key("", name.str());
      if (entry && from_override && !entry->contains("kind") && table.size() > 1) no_such_name(table, name, inner);
      else if (entry && section_of_scene && !entry->contains("kind"))
        problems_.add(name.source(), inner,
                      "a section of the scene, and no phase; expected [" + std::string(text) + "] in its place");
      else if (entry) section(*entry, path, inner);
      else problems_.add(node.source(), inner, "found " + shown(node) + "; expected a section");
    }
  }

  /// An override of a phase that the scene does not have, and that it does not make either.
  void no_such_name(const toml::table& table, const toml::key& name, const std::string& here) {
    std::vector<std::string> others;
    for (const auto& [other, _] : table)
      if (other.str() != name.str()) others.emplace_back(other.str());
    problems_.add(
        name.source(), here,
        "there is no such phase in the file; expected " + one_of(others) + did_you_mean(nearest(name.str(), others)));
  }

  void sections(const Key& key, const toml::array& array, const std::string& path, const std::string& here) {
    std::size_t index = 0;
    for (const toml::node& node : array) {
      const std::string inner = here + "." + std::to_string(index++);
      if (const auto* entry = node.as_table()) section(*entry, path, inner);
      else problems_.add(node.source(), inner, "found " + shown(node) + "; expected " + expected(key, dimensions_));
    }
  }

  void number(const Key& key, const toml::node& node, const std::string& here) {
    const double number = node.value_or(0.0);
    if (!std::isfinite(number))
      problems_.add(node.source(), here, "found " + shown(node) + "; expected a finite number");
    else if (!key.bounds.hold(number))
      problems_.add(node.source(), here,
                    shown(node) + " is out of range; expected " + expected(key, dimensions_) +
                        (key.name == "friction" && number > 0.0 && number < 90.0
                             ? "; of " + shown(node) + " degrees it is " +
                                   number_text(std::round(1e3 * std::tan(number * std::numbers::pi / 180.0)) / 1e3)
                             : ""));
  }

  void vector(const Key& key, const toml::array& array, const std::string& here, int components) {
    if (array.size() != static_cast<std::size_t>(components))
      return problems_.add(array.source(), here,
                           "found " + std::to_string(array.size()) +
                               (array.size() == 1 ? " component" : " components") + "; expected " +
                               expected(key, dimensions_) +
                               (array.size() == 3 && !stated_ ? "; did you mean dimensions = 3 at the top?" : ""));
    for (const toml::node& node : array) {
      if (node.is_number()) number(key, node, here);
      else if (const auto* text = node.as_string(); text && (key.slot.accepts & (as_formulas | as_axial)))
        formula(key, *text, here);
      else problems_.add(node.source(), here, "found " + shown(node) + "; expected " + expected(key, dimensions_));
    }
  }

  void points(const Key& key, const toml::array& array, const std::string& here, int components, std::size_t least) {
    if (array.size() < least)
      return problems_.add(array.source(), here, "found " + shown(array) + "; expected " + expected(key, dimensions_));
    for (const toml::node& node : array) {
      if (const auto* point = node.as_array()) vector(key, *point, here, components);
      else problems_.add(node.source(), here, "found " + shown(node) + "; expected " + expected(key, dimensions_));
    }
  }

  static bool word_fits(const Key& key, const std::string& word) {
    for (const std::string& choice : choices(key))
      if (choice == word) return true;
    return false;
  }

  void unknown_word(const Key& key, const toml::value<std::string>& text, const std::string& here) {
    const std::vector<std::string> words = choices(key);
    const OtherWord* other = find_other(other_values, path_of(key), text.get());
    const bool side = std::find(words.begin(), words.end(), "bottom") != words.end();
    if (!other && side) other = find_other(other_values, "", text.get());
    const std::string what = "\"" + shortened(text.get()) + "\" is not known";
    if (other && other->ours.empty())
      return problems_.add(text.source(), here, what + ": " + std::string(other->remark));
    problems_.add(
        text.source(), here,
        what + "; expected " + expected(key, dimensions_) +
            (other ? did_you_mean(std::string(other->ours), other->remark) : did_you_mean(nearest(text.get(), words))));
  }

  void words(const Key& key, const toml::array& array, const std::string& here) {
    std::vector<std::string> seen;
    for (const toml::node& node : array) {
      const auto* text = node.as_string();
      if (!text)
        problems_.add(node.source(), here, "found " + shown(node) + "; expected " + expected(key, dimensions_));
      else if (!word_fits(key, text->get())) unknown_word(key, *text, here);
      else if (std::find(seen.begin(), seen.end(), text->get()) != seen.end())
        problems_.add(node.source(), here, "\"" + shortened(text->get()) + "\" is given twice");
      else seen.push_back(text->get());
    }
  }

  void formula(const Key& key, const toml::value<std::string>& text, const std::string& here) {
    const std::string problem = formula_problem(text.get(), key.variables);
    if (problem.empty()) return;
    std::string hint;
    if (key.slot.accepts & as_word) hint = did_you_mean(nearest(text.get(), choices(key)));
    problems_.add(text.source(), here, problem + "; expected " + expected(key, dimensions_) + hint);
  }

  int dimensions_;
  bool stated_;
  Problems& problems_;
};

}  // namespace

int dimensions_of(const toml::table& document) { return document["dimensions"].value_or(2) == 3 ? 3 : 2; }

void validate(const toml::table& document, Problems& problems) {
  Validator(dimensions_of(document), document.contains("dimensions"), problems).section(document, "", "");
}

}  // namespace barchan
