#include "checks/reader.hpp"

#include <cstdint>

#include "base/errors.hpp"
#include "base/input_file.hpp"
#include "checks/checks.hpp"
#include "scene/constants.hpp"
#include "scene/controls.hpp"
#include "scene/identity.hpp"
#include "scene/located.hpp"
#include "scene/read.hpp"
#include "scene/validate.hpp"

namespace barchan {

namespace {

constexpr std::uint64_t most_of_a_scene = 16'000'000;  // bytes; a person writes some thousand

}  // namespace

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
  if (toml::table values; !controls().empty()) {  // a checkpoint is of a scene with these values at the start
    for (const Control& control : controls()) values.insert(control.name, control.value);
    document.insert("controls", values);
  }
  scene.identity = identity_of(document, checksums_of_files(scene));
  check(document, scene, problems);
  problems.throw_if_any();
  return scene;
}

Scene read_scene(const std::string& file, const std::vector<std::string>& overrides) {
  std::string text;
  try {
    text = read_input(file, most_of_a_scene);
  } catch (const InputError& e) { throw SceneError(file + ": " + e.what() + "; expected a scene file (.toml)"); }
  return parse_scene(text, file, overrides);
}

}  // namespace barchan
