#include "scene/formulas_of.hpp"

#include <algorithm>

#include "scene/formula_keys.hpp"
#include "scene/scene.hpp"

namespace barchan {
namespace {

class Collector {
 public:
  void section(const toml::table& table, std::string_view section, const std::string& dotted) {
    for (const auto& [name, node] : table) {
      const bool pair = section == "interactions" && node.is_table();
      const Key* key = find_key(section, name.str());
      if (!key && !pair) continue;
      const std::string here = dotted + std::string(name.str());
      if (const toml::table* inner = node.as_table())
        pair ? this->section(*inner, "interactions.pair", here + ".") : entries(*key, *inner, here);
      else if (const toml::array* array = node.as_array()) entries(*key, *array, here);
      else take(*key, node, here);
    }
  }

  std::vector<KeyedFormula> found;

 private:
  void entries(const Key& key, const toml::table& table, const std::string& here) {
    if (!(key.slot.accepts & as_named_sections)) return section(table, path_of(key), here + ".");
    for (const auto& [name, node] : table)
      if (const toml::table* inner = node.as_table())
        section(*inner, path_of(key), here + "." + std::string(name.str()) + ".");
  }

  void entries(const Key& key, const toml::array& array, const std::string& here) {
    std::size_t number = 0;
    for (const toml::node& node : array) {
      if (const toml::table* inner = node.as_table())
        section(*inner, path_of(key), here + "." + std::to_string(number) + ".");
      else take(key, node, here);
      ++number;
    }
  }

  void take(const Key& key, const toml::node& node, const std::string& here) {
    const auto* text = node.as_string();
    if (!text || !(key.slot.accepts & (as_formula | as_formulas | as_axial))) return;
    const std::vector<std::string> words = choices(key);
    if (std::find(words.begin(), words.end(), text->get()) == words.end()) found.push_back({&key, here, text->get()});
  }
};

}  // namespace

std::vector<KeyedFormula> formulas_of(const toml::table& document) {
  Collector collector;
  collector.section(document, "", "");
  return std::move(collector.found);
}

std::string keys_of_formula(const Scene& scene, const std::string& formula) {
  std::string keys;
  try {
    for (const KeyedFormula& one : formulas_of(toml::parse(scene.identity)))
      if (one.text == formula && keys.find(one.dotted) == std::string::npos)
        keys += (keys.empty() ? "" : " and ") + one.dotted;
  } catch (const toml::parse_error&) { return ""; }
  return keys;
}

}  // namespace barchan
