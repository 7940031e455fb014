// Every scene of the repository, for suites that run each of them.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace barchan::testing {

/// Names of all scenes, "paper/flat_bed", "verification/couette", ...
inline std::vector<std::string> all_scenes() {
  std::vector<std::string> names;
  const std::filesystem::path top = BARCHAN_SOURCE_DIR "/scenes";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(top))
    if (entry.path().extension() == ".toml")
      names.push_back(std::filesystem::relative(entry.path(), top).replace_extension("").string());
  std::sort(names.begin(), names.end());
  return names;
}

/// The name of a scene as the name of a test.
inline std::string test_name(std::string scene) {
  std::replace_if(
      scene.begin(), scene.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return scene;
}

/// Overrides with which a scene has fewer particles and the same models, fills and passes: seconds of filling and
/// settling say nothing of its steps. EveryScene.RunsInTheProgram runs all scenes as they are.
inline std::vector<std::string> with_fewer_particles(const std::string& scene) {
  static const std::map<std::string, std::vector<std::string>> smaller = {
      {"bearing", {"spacing=5e-4"}},
      {"column_collapse", {"fill.1.shape.box.max=[0.015, 0.03]"}},
      {"rings", {"spacing=2e-3"}},
      {"threshold", {"domain.size=[0.04, 0.032]"}},
      {"verification/cylinder_open", {"spacing=0.16"}},
      {"verification/heaving_cylinder", {"constants.across=6"}},
      {"verification/hertz_spheres", {"spacing=4e-3"}},
      {"verification/rings_updated", {"spacing=2e-3"}},
      {"verification/sinking_disc", {"spacing=0.08", "output.history-every=0.01"}},
      {"verification/taylor_couette", {"spacing=0.1"}}};
  const auto found = smaller.find(scene);
  return found == smaller.end() ? std::vector<std::string>{} : found->second;
}

}  // namespace barchan::testing
