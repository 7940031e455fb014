#include "scene/constants.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/errors.hpp"
#include "scene/controls.hpp"
#include "scene/formula.hpp"
#include "scene/keys.hpp"
#include "scene/nearest.hpp"

namespace barchan {
namespace {

constexpr unsigned formulas = as_formula | as_formulas | as_axial;
constexpr unsigned numbers = as_number | as_integer | as_vector | as_points | as_corners;

bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool in_name(char c) { return begins_name(c) || std::isdigit(static_cast<unsigned char>(c)); }

/// Fifteen digits: a product of short decimal numbers is then the decimal number that a person would write.
double rounded(double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 15).ptr;
  double result = value;
  std::from_chars(text, end, result);
  return result;
}

std::string exact(double value) {
  char text[40];
  return "(" + std::string(text, std::to_chars(text, text + sizeof text, value).ptr) + ")";
}

/// The formula with each name that `replacement` knows replaced; it returns "" for any other. Functions (a name before
/// a bracket) and the e of 1e-3 are no names.
std::string replaced(const std::string& formula, const std::function<std::string(const std::string&)>& replacement) {
  std::string text;
  for (std::size_t k = 0; k < formula.size();) {
    std::size_t end = k + 1;
    if (std::isdigit(static_cast<unsigned char>(formula[k])) || formula[k] == '.') {
      while (end < formula.size() &&
             (in_name(formula[end]) || formula[end] == '.' ||
              ((formula[end] == '-' || formula[end] == '+') && std::tolower(formula[end - 1]) == 'e')))
        ++end;
      text += formula.substr(k, end - k);
    } else if (begins_name(formula[k])) {
      while (end < formula.size() && in_name(formula[end])) ++end;
      const std::string name = formula.substr(k, end - k);
      const std::size_t next = formula.find_first_not_of(' ', end);
      const std::string value = next != std::string::npos && formula[next] == '(' ? "" : replacement(name);
      text += value.empty() ? name : value;
    } else {
      text += formula[k];
    }
    k = end;
  }
  return text;
}

class Constants {
 public:
  explicit Constants(Problems& problems) : problems_(problems) {}

  /// Each constant is evaluated once, after those that it needs: a walk through what needs what, depth first.
  void read(const toml::table& table) {
    std::map<std::string, Definition> definitions;
    for (const auto& [name, node] : table)
      if (is_name("constants", std::string(name.str()), name.source()))
        definitions[std::string(name.str())].node = &node;
    tell_names(definitions);
    for (auto& [first, definition] : definitions) {
      if (definition.state != Definition::untouched) continue;
      std::vector<std::pair<const std::string, Definition>*> path{&*definitions.find(first)};
      while (!path.empty()) {
        auto& [name, top] = *path.back();
        if (top.state == Definition::untouched) begin(top, definitions);
        if (top.next < top.needs.size()) {
          auto& needed = *definitions.find(top.needs[top.next++]);
          if (needed.second.state == Definition::untouched) path.push_back(&needed);
          else if (needed.second.state == Definition::open && top.circle.empty()) top.circle = needed.first;
          continue;
        }
        define(name, top);
        path.pop_back();
      }
    }
  }

  /// Numbers that stay names: formulas of time call them.
  void read_controls(const toml::table& table) {
    for (const auto& [name, node] : table) {
      const std::string word(name.str()), here = "controls." + word;
      if (!is_name("controls", word, name.source())) continue;
      if (values_.contains(word)) problems_.add(name.source(), here, "a constant has this name; expected another one");
      else if (!node.is_number()) problems_.add(name.source(), here, "expected a number: its value at the start");
      else controls_[word] = node.value_or(0.0);
    }
    controls().clear();
    for (const auto& [name, value] : controls_) controls().push_back({name, value});
  }

  void section(toml::table& table, const std::string& section, const std::string& dotted) {
    for (auto&& [name, node] : table) {
      const std::string here = dotted + std::string(name.str());
      const Key* key = find_key(section, name.str());
      if (!key && section == "interactions") key = find_key("interactions.pair", "radius");
      if (!key) continue;  // who checks the document names it
      const bool of_pair = section == "interactions" && node.is_table();
      if (auto* inner = node.as_table()) inner_table(*key, of_pair ? "interactions.pair" : path_of(*key), *inner, here);
      else if (auto* array = node.as_array()) entries(*key, *array, here);
      else if (auto* text = node.as_string(); text && value(*key, *text, here))
        put([&table, &at = name](auto&& number) {
          table.insert_or_assign(at, std::forward<decltype(number)>(number));
        });
    }
  }

  /// Every constant was used; a misspelt one of --set would change nothing in silence.
  void look_for_unused(const toml::table& table, const std::string& section) const {
    constexpr int most = 50;  // that get the name of the nearest other one, which takes as long as there are names
    int told = 0;
    for (const auto& [name, node] : table) {
      const std::string word(name.str());
      if (!(values_.contains(word) || controls_.contains(word)) || used_.contains(word)) continue;
      std::vector<std::string> others;
      if (told++ < most)
        for (const auto& [other, _] : values_)
          if (other != word) others.push_back(other);
      problems_.add(
          name.source(), section + "." + word,
          "nothing uses it; expected " +
              std::string(section == "controls" ? "a control that a formula of time" : "a constant that a value") +
              " of the scene names" + did_you_mean(nearest(word, others)));
    }
  }

 private:
  struct Definition {
    enum State { untouched, open, done };
    const toml::node* node = nullptr;
    State state = untouched;
    std::vector<std::string> needs;  // other constants
    std::size_t next = 0;            // of these, not looked at yet
    std::string circle;              // one that needs this one again
  };

  /// For messages: not more names than a person reads.
  void tell_names(const std::map<std::string, Definition>& definitions) {
    constexpr std::size_t most = 20;
    std::size_t count = 0;
    for (const auto& [name, _] : definitions)
      if (count++ < most) all_ += (all_.empty() ? "" : ", ") + name;
    if (count > most) all_ += " and " + std::to_string(count - most) + " more";
  }

  static void begin(Definition& definition, const std::map<std::string, Definition>& all) {
    definition.state = Definition::open;
    if (const auto* text = definition.node->as_string())
      replaced(text->get(), [&](const std::string& word) {
        if (all.contains(word)) definition.needs.push_back(word);
        return std::string();
      });
  }

  bool is_name(const std::string& section, const std::string& name, const toml::source_region& place) {
    static const std::set<std::string> taken{"x", "y", "z", "t", "pi", "e", "control"};
    if (taken.contains(name)) {
      problems_.add(place, section + "." + name,
                    "the name stands for something else in formulas; expected another one");
      return false;
    }
    const bool good = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) &&
                      std::all_of(name.begin(), name.end(), in_name);
    if (!good)
      problems_.add(
          place, section + "." + name,
          "not a name of a constant or a control; expected a letter followed by letters, digits and underscores");
    return good;
  }

  /// Those that it needs have their values, but where a circle is.
  void define(const std::string& name, Definition& definition) {
    definition.state = Definition::done;
    const std::string here = "constants." + name;
    const toml::node& node = *definition.node;
    const auto* text = node.as_string();
    if (node.is_number()) values_[name] = node.value_or(0.0);
    else if (!text) problems_.add(node.source(), here, "expected a number or a formula of other constants");
    else if (!definition.circle.empty())
      problems_.add(node.source(), here,
                    "needs \"" + definition.circle + "\", which needs it; expected a formula without a circle");
    else if (const auto number = evaluate(*text, here)) values_[name] = *number;
  }

  std::string value_of(const std::string& name) {
    if (const auto control = controls_.find(name); control != controls_.end()) {
      used_.insert(name);
      return "control(" + std::to_string(std::distance(controls_.begin(), control)) + ",t)";
    }
    const auto found = values_.find(name);
    if (found == values_.end()) return "";
    used_.insert(name);
    return exact(found->second);
  }

  /// The first control that a text names; "".
  std::string control_in(const std::string& text) const {
    std::string found;
    replaced(text, [&](const std::string& name) {
      if (found.empty() && controls_.contains(name)) found = name;
      return std::string();
    });
    return found;
  }

  std::optional<double> evaluate(const toml::value<std::string>& text, const std::string& here) {
    if (const std::string control = control_in(text.get()); !control.empty()) {
      problems_.add(text.source(), here,
                    "\"" + control +
                        "\" is a control, which may change in time; expected a number, or a key that takes a "
                        "function of time");
      return std::nullopt;
    }
    const std::string formula = replaced(text.get(), [&](const std::string& name) { return value_of(name); });
    const std::string problem = formula_problem(formula, "");
    double number = std::nan("");
    if (problem.empty()) number = rounded(Formula(Expression{.formula = formula})({}));
    if (std::isfinite(number)) return number;
    problems_.add(text.source(), here,
                  (problem.empty() ? "\"" + shortened(text.get()) + "\" has no finite value" : problem) +
                      "; expected a number, or a formula of the constants " + all_);
    return std::nullopt;
  }

  bool uses_constants(const std::string& text) const {
    bool uses = false;
    replaced(text, [&](const std::string& name) {
      uses = uses || values_.contains(name);
      return std::string();
    });
    return uses;
  }

  void inner_table(const Key& key, const std::string& path, toml::table& table, const std::string& here) {
    if (!(key.slot.accepts & as_named_sections)) return section(table, path, here + ".");
    for (auto&& [name, node] : table)
      if (auto* inner = node.as_table()) section(*inner, path, here + "." + std::string(name.str()) + ".");
  }

  void entries(const Key& key, toml::array& array, const std::string& here) {
    for (std::size_t k = 0; k < array.size(); ++k) {
      toml::node& node = *array.get(k);
      if (auto* inner = node.as_table()) section(*inner, path_of(key), here + "." + std::to_string(k) + ".");
      else if (auto* point = node.as_array()) entries(key, *point, here);
      else if (auto* text = node.as_string(); text && value(key, *text, here))
        put([&](auto&& number) {
          array.replace(array.cbegin() + static_cast<std::ptrdiff_t>(k), std::forward<decltype(number)>(number));
        });
    }
  }

  /// True: made_ is the number that takes the place of the text. A formula in x, y, z, t is changed where it stands.
  bool value(const Key& key, toml::value<std::string>& text, const std::string& here) {
    const unsigned accepts = key.slot.accepts;
    const auto words = choices(key);
    const bool word = (accepts & as_text) || std::find(words.begin(), words.end(), text.get()) != words.end();
    if (word || !(accepts & (formulas | numbers))) return false;
    if (accepts & formulas) {
      if (key.variables.find('t') == std::string_view::npos)
        if (const std::string control = control_in(text.get()); !control.empty()) {
          problems_.add(text.source(), here,
                        "\"" + control +
                            "\" is a control, and this is read at the start only; expected a formula without "
                            "it");
          return false;
        }
      text.get() = replaced(text.get(), [&](const std::string& name) { return value_of(name); });
      return false;
    }
    if ((accepts & as_word) && !uses_constants(text.get()) && control_in(text.get()).empty()) return false;
    const auto number = evaluate(text, here);
    if (!number) return false;
    const bool whole = (accepts & as_integer) && *number == std::floor(*number) && std::abs(*number) < 1e9;
    made_ = *number;
    whole_ = whole;
    place_ = text.source();
    return true;
  }

  template <class Place>
  void put(Place&& place) const {
    const auto at_its_place = [&](auto number) {
      // Nodes of toml++ have their place from the parser only. This number gets that of the formula; it is not const
      // itself.
      const_cast<toml::source_region&>(number.source()) = place_;
      place(std::move(number));
    };
    if (whole_) at_its_place(toml::value<std::int64_t>(static_cast<std::int64_t>(made_)));
    else at_its_place(toml::value<double>(made_));
  }

  Problems& problems_;
  std::map<std::string, double> values_, controls_;
  std::set<std::string> used_;
  std::string all_;
  double made_ = 0.0;  // what value() made, its type and its place
  bool whole_ = false;
  toml::source_region place_;
};

}  // namespace

void replace_constants(toml::table& document, Problems& problems) {
  Constants constants(problems);
  std::map<std::string, toml::table> sections;
  for (const char* name : {"constants", "controls"}) {
    const toml::node* node = document.get(name);
    if (node && !node->is_table()) problems.fail(node->source(), name, "expected a section of names and numbers");
    if (node) sections[name] = *node->as_table();
    document.erase(name);
  }
  if (sections.contains("constants")) constants.read(sections["constants"]);
  constants.read_controls(sections.contains("controls") ? sections["controls"] : toml::table());
  if (sections.empty()) return;
  constants.section(document, "", "");
  problems.throw_if_any();
  for (const auto& [name, table] : sections) constants.look_for_unused(table, name);
}

}  // namespace barchan
