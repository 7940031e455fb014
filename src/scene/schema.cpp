// The JSON schema of a scene file, from the table of keys. reference.cpp makes the tables of docs/scenes.md.
#include <cmath>
#include <nlohmann/json.hpp>

#include "scene/keys.hpp"
#include "scene/schema.hpp"

namespace barchan {
namespace {

using Json = nlohmann::ordered_json;

Json section_schema(const std::string& section);

/// In draft 4 a bound that is not allowed itself is a bound with a mark.
void add_bounds(Json& number, const NumberBounds& bounds) {
  if (std::isfinite(bounds.above)) number.update({{"minimum", bounds.above}, {"exclusiveMinimum", true}});
  if (std::isfinite(bounds.at_least)) number["minimum"] = bounds.at_least;
  if (std::isfinite(bounds.below)) number.update({{"maximum", bounds.below}, {"exclusiveMaximum", true}});
  if (std::isfinite(bounds.at_most)) number["maximum"] = bounds.at_most;
}

Json array_of(Json items, int least, int most) {
  Json array{{"type", "array"}, {"items", std::move(items)}};
  if (least > 0) array["minItems"] = least;
  if (most > 0) array["maxItems"] = most;
  return array;
}

/// One schema for each form that the key's value may have.
std::vector<Json> forms(const Key& key) {
  const std::string path = path_of(key);
  Json number{{"type", Json::array({"number", "string"})}};  // a string: a formula of [constants]
  add_bounds(number, key.bounds);
  Json formula{{"type", Json::array({"number", "string"})}};
  Json words{{"enum", choices(key)}};
  std::vector<Json> all;
  if (key.slot.accepts & as_number) all.push_back(number);
  if (key.slot.accepts & as_axial) {
    all.push_back(formula);
    all.push_back(array_of(formula, 3, 3));
  }
  if (key.slot.accepts & as_integer) {
    all.push_back(number);
    all.back()["type"] = Json::array({"integer", "string"});
  }
  if (key.slot.accepts & as_boolean) all.push_back({{"type", "boolean"}});
  if (key.slot.accepts & as_text) all.push_back({{"type", "string"}});
  if (key.slot.accepts & as_word) all.push_back(words);
  if (key.slot.accepts & as_words) {
    all.push_back(array_of(words, 0, 0));
    all.back()["uniqueItems"] = true;
  }
  if (key.slot.accepts & as_vector) all.push_back(array_of(number, 2, 3));
  if (key.slot.accepts & as_formula) all.push_back(formula);
  if (key.slot.accepts & as_formulas) all.push_back(array_of(formula, 2, 3));
  if (key.slot.accepts & as_points) all.push_back(array_of(array_of(number, 2, 3), 1, 0));
  if (key.slot.accepts & as_corners) all.push_back(array_of(array_of(number, 2, 2), 3, 0));
  if (path == "constants" || path == "controls")
    all.push_back({{"type", "object"}, {"additionalProperties", {{"type", Json::array({"number", "string"})}}}});
  else if (key.slot.accepts & as_section) all.push_back(section_schema(path));
  if (key.slot.accepts & as_sections) all.push_back(array_of(section_schema(path), 0, 0));
  if (key.slot.accepts & as_named_sections)
    all.push_back({{"type", "object"},
                   {"patternProperties", {{"^[A-Za-z][A-Za-z0-9_]*$", section_schema(path)}}},
                   {"additionalProperties", false}});
  return all;
}

/// Meaning, unit, kinds of phases and default in one sentence or two.
std::string description(const Key& key) {
  std::string text(key.meaning);
  if (!key.unit.empty()) text += " Unit: " + std::string(key.unit) + ".";
  if (!key.variables.empty()) text += " Formulas in " + std::string(key.variables) + ".";
  if (!key.slot.kinds.empty()) text += " Phases of kind " + kinds_text(key, ", ") + ".";
  const std::string otherwise = default_text(key);
  if (!otherwise.empty() && !key.required()) text += " Default: " + otherwise + ".";
  return text;
}

Json key_schema(const Key& key) {
  std::vector<Json> all = forms(key);
  Json schema{{"description", description(key)}};
  if (all.size() == 1) schema.update(all.front());
  else schema["anyOf"] = all;
  return schema;
}

Json section_schema(const std::string& section) {
  Json schema{{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
  Json required = Json::array();
  for (const Key* key : keys_of(section)) {
    schema["properties"][std::string(key->name)] = key_schema(*key);
    if (key->required() && key->slot.kinds.empty() && key->spared.empty()) required.push_back(key->name);
  }
  if (!required.empty()) schema["required"] = required;
  if (section == "interactions") {
    const Key& radius = *find_key("interactions.pair", "radius");
    schema.erase("additionalProperties");
    schema["patternProperties"]["^[A-Za-z][A-Za-z0-9_]*-[A-Za-z][A-Za-z0-9_]*$"] = {
        {"description", description(radius)},
        {"anyOf",
         Json::array({forms(radius).front(), section_schema("interactions.pair"), {{"enum", Json::array({false})}}})}};
    schema["additionalProperties"] = false;
  }
  return schema;
}

}  // namespace

std::string scene_schema() {
  Json schema{{"$schema", "http://json-schema.org/draft-04/schema#"},
              {"title", "Barchan scene"},
              {"description", "A scene of the SPH simulator Barchan; SI units."}};
  schema.update(section_schema(""));
  return schema.dump(2) + "\n";
}

}  // namespace barchan
