// TOML document -> Scene.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace barchan {

/// Reads and validates a scene file. `overrides` are "dotted.key=value" (value in TOML syntax; a bare word is a
/// string), applied before validation. Throws SceneError with every problem found, one a line, each as
/// `FILE:LINE:COLUMN: KEY: what is wrong; expected ...; did you mean "..."?`
Scene read_scene(const std::string& file, const std::vector<std::string>& overrides = {});

/// The same from a string (for tests); `file` is the name used in messages.
Scene parse_scene(const std::string& text, const std::string& file, const std::vector<std::string>& overrides = {});

}  // namespace barchan
