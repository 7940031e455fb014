#include "scene/reader.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <variant>

#include "base/errors.hpp"
#include "scene/checks.hpp"
#include "scene/constants.hpp"
#include "scene/identity.hpp"
#include "scene/located.hpp"
#include "scene/read.hpp"
#include "scene/validate.hpp"

namespace barchan {

namespace {

constexpr std::size_t most_of_a_scene = std::size_t{16} << 20;  // bytes; a person writes some thousand

}  // namespace

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

Scene parse_scene(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  Problems problems(file);
  toml::table document = parse_document(text, file, overrides, problems);
  const auto places = places_of_keys(document, file);
  replace_constants(document, problems);
  validate(document, problems);
  Scene scene = read_document(document, file);
  scene.overrides = overrides;
  scene.places = places;
  read_surfaces(scene, Report(document, problems));
  scene.identity = identity_of(document, checksums_of_files(scene));
  check(document, scene, problems);
  problems.throw_if_any();
  return scene;
}

Scene read_scene(const std::string& file, const std::vector<std::string>& overrides) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw SceneError(file + ": is a directory; expected a scene file (.toml)");
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  for (std::array<char, 16384> part; stream && text.size() <= most_of_a_scene;) {
    stream.read(part.data(), static_cast<std::streamsize>(part.size()));
    text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (text.size() > most_of_a_scene)
    throw SceneError(file + ": is larger than " + std::to_string(most_of_a_scene >> 20) +
                     " MB; expected a scene file (.toml)");
  if (!stream && !stream.eof())
    throw SceneError(file + ": cannot be read: " + std::strerror(errno ? errno : EIO) +
                     "; expected a scene file (.toml)");
  return parse_scene(text, file, overrides);
}

}  // namespace barchan
