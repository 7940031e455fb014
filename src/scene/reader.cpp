#include "scene/reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/errors.hpp"
#include "scene/checks.hpp"
#include "scene/identity.hpp"
#include "scene/located.hpp"
#include "scene/read.hpp"
#include "scene/validate.hpp"

namespace barchan {

namespace {

/// A line of the scene's identity that changes with what a file holds (FNV-1a, 64 bits).
std::string digest_of_file(const std::string& path, std::size_t fill) {
  std::ifstream stream(path, std::ios::binary);
  std::uint64_t hash = 14695981039346656037ull;
  char bytes[65536];
  while (stream.read(bytes, sizeof bytes), stream.gcount() > 0)
    for (std::streamsize k = 0; k < stream.gcount(); ++k)
      hash = (hash ^ static_cast<unsigned char>(bytes[k])) * 1099511628211ull;
  char text[96];
  std::snprintf(text, sizeof text, "\n[file-of-fill-%zu]\ndigest = \"%016llx\"\n", fill,
                static_cast<unsigned long long>(hash));
  return text;
}

constexpr std::size_t most_of_a_scene = std::size_t{16} << 20;  // bytes; a person writes some thousand

}  // namespace

std::string path_of_file(const Scene& scene, const std::string& file) {
  const std::filesystem::path path(file);
  return path.is_absolute() ? file : (std::filesystem::path(scene.file).parent_path() / path).string();
}

Scene parse_scene(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  Problems problems(file);
  const toml::table document = parse_document(text, file, overrides, problems);
  validate(document, problems);
  Scene scene = read_document(document, file);
  scene.places = places_of_keys(document, file);
  scene.identity = identity_of(document);
  for (std::size_t k = 0; k < scene.fills.size(); ++k)
    if (const auto* shape = std::get_if<FileShape>(&scene.fills[k].shape); shape && !shape->file.empty())
      scene.identity += digest_of_file(path_of_file(scene, shape->file), k);
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
  if (stream) text.resize(most_of_a_scene + 1);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  if (text.size() > most_of_a_scene)
    throw SceneError(file + ": is larger than " + std::to_string(most_of_a_scene >> 20) +
                     " MB; expected a scene file (.toml)");
  if (!stream && !stream.eof())
    throw SceneError(file + ": cannot be read: " + std::strerror(errno ? errno : EIO) +
                     "; expected a scene file (.toml)");
  return parse_scene(text, file, overrides);
}

}  // namespace barchan
