#include "scene/reader.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"
#include "scene/checks.hpp"
#include "scene/identity.hpp"
#include "scene/read.hpp"
#include "scene/validate.hpp"

namespace barchan {

Scene parse_scene(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  Problems problems(file);
  const toml::table document = parse_document(text, file, overrides, problems);
  validate(document, problems);
  Scene scene = read_document(document, file);
  scene.identity = identity_of(document);
  check(document, scene, problems);
  problems.throw_if_any();
  return scene;
}

Scene read_scene(const std::string& file, const std::vector<std::string>& overrides) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw SceneError(file + ": is a directory; expected a scene file (.toml)");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  if (!stream)
    throw SceneError(file + ": cannot be read: " + std::strerror(errno ? errno : EIO) +
                     "; expected a scene file (.toml)");
  return parse_scene(text.str(), file, overrides);
}

}  // namespace barchan
