// Checks a document against the table of keys: names, types, bounds, words, formulas. Internal to src/scene.
#pragma once

#include "scene/document.hpp"

namespace barchan {

/// Adds every problem that a single key can have. What concerns several keys is the business of checks.hpp.
void validate(const toml::table& document, Problems& problems);

/// Dimensions of the scene; 2 when the document does not say or says nonsense.
int dimensions_of(const toml::table& document);

}  // namespace barchan
