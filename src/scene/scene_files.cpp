#include "scene/scene_files.hpp"

#include <algorithm>
#include <filesystem>
#include <variant>

namespace barchan {

std::string path_of_file(const Scene& scene, const std::string& file) {
  const std::filesystem::path path(file);
  return path.is_absolute() ? file : (std::filesystem::path(scene.file).parent_path() / path).string();
}

std::vector<std::string> files_of(const Scene& scene) {
  std::vector<std::string> files;
  const auto add = [&](const std::string& file) {
    if (!file.empty() && std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  for (const Fill& fill : scene.fills) {
    if (const auto* surface = std::get_if<SurfaceShape>(&fill.shape)) add(surface->file);
    if (const auto* grains = std::get_if<FileShape>(&fill.shape)) add(grains->file);
  }
  for (const Inflow& inflow : scene.inflows) add(inflow.profile);
  for (const Influx& influx : scene.influxes) add(influx.file);
  return files;
}

}  // namespace barchan
