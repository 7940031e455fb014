#include "app/shipped.hpp"

#include <algorithm>
#include <sstream>

#include "base/data_folder.hpp"
#include "base/errors.hpp"
#include "base/input_file.hpp"
#include "scene/nearest.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

/// The lines of a file of the program's own; none where it cannot be read.
std::istringstream lines_of(const fs::path& file) {
  constexpr std::uint64_t most = 16'000'000;  // bytes
  try {
    return std::istringstream(read_input(file, most));
  } catch (const InputError&) { return {}; }
}

/// The string that a line of a scene gives to a key, as in title = "Wind"; empty: the line does not.
std::string text_of(const std::string& line, const std::string& key) {
  if (!line.starts_with(key)) return "";
  const std::size_t equals = line.find_first_not_of(' ', key.size());
  if (equals == std::string::npos || line[equals] != '=') return "";
  const std::size_t begin = line.find('"', equals), end = line.find('"', begin + 1);
  return begin == std::string::npos || end == std::string::npos ? "" : line.substr(begin + 1, end - begin - 1);
}

/// Goes on with the first sentence of a head that is read line by line; true when it is whole.
bool takes_sentence(std::string& sentence, const std::string& line) {
  if (!line.starts_with("# ")) return !sentence.empty();
  sentence += (sentence.empty() ? "" : " ") + line.substr(2);
  for (std::size_t at = sentence.find_first_of(".?"); at != std::string::npos;
       at = sentence.find_first_of(".?", at + 1)) {
    const auto begin = sentence.begin(), end = begin + static_cast<std::ptrdiff_t>(at);
    const bool ends = at + 1 == sentence.size() || sentence[at + 1] == ' ';
    if (!ends || std::string_view(sentence).substr(0, at).ends_with("et al") ||
        std::count(begin, end, '(') != std::count(begin, end, ')'))
      continue;
    sentence.resize(sentence[at] == '?' ? at + 1 : at);
    return true;
  }
  return false;
}

ShippedScene scene_of(const fs::path& file, const std::string& name) {
  ShippedScene scene{name, file, "", "", ""};
  std::istringstream stream = lines_of(file);
  bool whole = false;
  for (std::string line; std::getline(stream, line) && !line.starts_with('[');) {
    whole = whole || (!line.starts_with("#:") && takes_sentence(scene.shows, line));
    if (scene.title.empty()) scene.title = text_of(line, "title");
    if (scene.state.empty()) scene.state = text_of(line, "state");
  }
  return scene;
}

std::vector<fs::path> files_in(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none))
    if (entry.path().extension() == extension) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// "dune" of "scenes/dune.toml".
std::string last_name(const std::string& word) { return fs::path(word).stem().string(); }

[[noreturn]] void no_such_scene(const std::string& word) {
  std::vector<std::string> files, names;
  const fs::path folder = fs::path(word).parent_path();
  for (const fs::path& file : files_in(folder.empty() ? "." : folder, ".toml"))
    files.push_back((folder / file.filename()).string());
  for (const ShippedScene& scene : shipped_scenes())
    for (const std::string& name : {scene.name, last_name(scene.name)}) names.push_back(name);
  std::string meant = nearest(word, files);
  if (meant.empty()) {
    const auto same = std::find(names.begin(), names.end(), last_name(word));
    meant = same != names.end() ? *same : nearest(last_name(word), names);
  }
  throw SceneError(word + ": there is no such file" + (word.ends_with(".toml") ? "" : " and no scene of this name") +
                   "; expected a scene file (.toml), or a name that `barchan list` shows" + did_you_mean(meant));
}

}  // namespace

std::vector<ShippedScene> shipped_scenes() {
  std::vector<ShippedScene> scenes;
  const fs::path folder = data_folder();
  if (folder.empty()) return scenes;
  for (const char* inner : {"", "paper", "verification"})
    for (const fs::path& file : files_in(folder / "scenes" / inner, ".toml"))
      scenes.push_back(scene_of(file, (fs::path(inner) / file.stem()).string()));
  return scenes;
}

std::vector<ShippedState> shipped_states() {
  std::vector<ShippedState> states;
  for (const std::string& name : names_of_states()) {
    const fs::path file = data_folder() / "pvstate" / (name + ".py");
    std::istringstream stream = lines_of(file);
    std::string line;
    while (std::getline(stream, line) && !line.starts_with("\"\"\"")) {}
    const std::size_t begin = std::min<std::size_t>(line.size(), 3);
    states.push_back({name, file, line.substr(begin, line.find_first_of(":\"", begin) - begin)});
  }
  return states;
}

std::string scene_file(const std::string& word) {
  std::error_code none;
  const bool folder = fs::is_directory(word, none);
  if (fs::exists(word, none) && !folder) return word;
  if (word.ends_with(".toml") && !folder) no_such_scene(word);
  std::vector<std::string> found;
  for (const ShippedScene& scene : shipped_scenes()) {
    if (scene.name == word) return scene.file.string();
    if (scene.name.ends_with("/" + word)) found.push_back(scene.file.string());
  }
  if (found.size() == 1) return found.front();
  if (folder) return word;  // who reads it says that it is one
  no_such_scene(word);
}

}  // namespace barchan
