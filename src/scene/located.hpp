// Where a key of a scene stands, for mistakes that only show when the particles or the plan are there.
#pragma once

#include <string>

#include "scene/scene.hpp"
#include "scene/toml.hpp"

namespace barchan {

/// The places of all keys of a document, by dotted key.
std::map<std::string, std::string> places_of_keys(const toml::table& document, const std::string& file);

/// "FILE:LINE:COLUMN: KEY" with the place of the key, or of the section that it would stand in; "FILE: KEY" when that
/// is not known either.
std::string located(const Scene& scene, const std::string& dotted);

}  // namespace barchan
