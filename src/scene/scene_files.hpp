// The files that a scene names.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace barchan {

/// The path of a file that a scene names: from the folder of the scene.
std::string path_of_file(const Scene& scene, const std::string& file);

/// The files that a scene names, as it names them: shapes, grains, profiles of the wind that enters; each once.
std::vector<std::string> files_of(const Scene& scene);

}  // namespace barchan
