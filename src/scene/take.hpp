// Values out of a document, lenient: what is absent or wrong keeps its default. Internal to src/scene.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/scene.hpp"
#include "scene/toml.hpp"

namespace barchan {

void take_number(const toml::table& table, std::string_view name, double& value);
Vec3 take_vector(const toml::table& table, std::string_view name);
Vec3 take_vector(const toml::array& array);
std::vector<std::string> take_words(const toml::table& table, std::string_view name);
Expression take_expression(const toml::node* node);  ///< null: zero
VectorExpression take_vector_expression(const toml::table& table, std::string_view name);
Fill take_fill(const toml::table& table);
Measuring take_measuring(const toml::table& document);

template <class Enum>
Enum take_choice(const toml::table& table, std::string_view name, Enum otherwise,
                 std::initializer_list<std::pair<std::string_view, Enum>> words) {
  const auto text = table[name].value<std::string_view>();
  for (const auto& [word, meaning] : words)
    if (text == word) return meaning;
  return otherwise;
}

}  // namespace barchan
