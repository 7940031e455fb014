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

/// The path of a file that a scene names: from the folder of the scene.
std::string path_of_file(const Scene& scene, const std::string& file);

/// The files that a scene names, as it names them: shapes, grains, profiles of the wind that enters; each once.
std::vector<std::string> files_of(const Scene& scene);

/// JSON schema (draft 4, which editors of TOML read) of a scene file, from the same table of keys that the reader
/// checks against.
std::string scene_schema();

/// The keys of every section as Markdown tables, with an example each.
std::string scene_tables();

}  // namespace barchan
