// The formulas of a document, by the keys that have them. Internal to src/scene, and for messages of a run.
#pragma once

#include <string>
#include <vector>

#include "scene/keys.hpp"
#include "scene/toml.hpp"

namespace barchan {

struct KeyedFormula {
  const Key* key;
  std::string dotted;  // "motion.0.velocity", also of a component
  std::string text;
};

/// Of a document whose constants are replaced; in the order of its keys.
std::vector<KeyedFormula> formulas_of(const toml::table& document);

}  // namespace barchan
