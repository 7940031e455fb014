// barchan list: what comes along, and the keys of a scene.
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/habits.hpp"
#include "app/shipped.hpp"
#include "base/data_folder.hpp"
#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "scene/settable.hpp"

namespace barchan {
namespace {

using Json = nlohmann::ordered_json;

struct Row {
  std::string name, text;
  Json json;
};

std::vector<Row> rows_of_scenes() {
  std::vector<Row> rows;
  for (const ShippedScene& scene : shipped_scenes())
    rows.push_back({scene.name,
                    scene.shows.empty() ? scene.title : scene.shows,
                    {{"name", scene.name},
                     {"title", scene.title},
                     {"shows", scene.shows},
                     {"state", scene.state},
                     {"file", scene.file.string()}}});
  return rows;
}

std::vector<Row> rows_of_states() {
  std::vector<Row> rows;
  for (const ShippedState& state : shipped_states())
    rows.push_back(
        {state.name, state.shows, {{"name", state.name}, {"shows", state.shows}, {"file", state.file.string()}}});
  return rows;
}

std::vector<Row> rows_of_keys(const Scene* scene) {
  std::vector<Row> rows;
  for (const SettableKey& settable : settable_keys(scene)) {
    if (!settable.key) {
      rows.push_back({settable.dotted, "a number", {{"key", settable.dotted}}});
      continue;
    }
    const Key& key = *settable.key;
    rows.push_back({settable.dotted,
                    expected(key, scene ? scene->dimensions : 2),
                    {{"key", settable.dotted},
                     {"expected", expected(key, scene ? scene->dimensions : 2)},
                     {"unit", std::string(key.unit)},
                     {"default", default_text(key)},
                     {"meaning", std::string(key.meaning)}}});
  }
  return rows;
}

/// A text of so many columns at most; where words are left out it ends with "...".
std::string cut_at_word(const std::string& text, std::size_t columns) {
  if (text.size() <= columns) return text;
  const std::size_t space = text.rfind(' ', columns - 3);
  std::string begin = text.substr(0, space == std::string::npos ? columns - 3 : space);
  while (begin.ends_with(',') || begin.ends_with(':')) begin.pop_back();
  return begin + "...";
}

void print(const std::vector<Row>& rows, bool names) {
  constexpr std::size_t widest = 36, all = 100;  // columns: of names that stay aligned, of a line
  std::size_t width = 0;
  for (const Row& row : rows) width = std::max(width, std::min(row.name.size(), widest));
  for (const Row& row : rows) {
    if (names) std::cout << row.name << '\n';
    else
      std::cout << "  " << row.name << std::string(std::max(width, row.name.size()) - row.name.size() + 2, ' ')
                << cut_at_word(row.text, all - 4 - std::max(width, row.name.size())) << '\n';
  }
}

Json json_of(const std::vector<Row>& rows) {
  Json all = Json::array();
  for (const Row& row : rows) all.push_back(row.json);
  return all;
}

}  // namespace

int list(const std::string& what, const std::string& scene, bool names, bool json) {
  if (!scene.empty() && what != "keys")
    throw SceneError("list --of " + scene + ": only keys are those of a scene; expected `barchan list keys --of " +
                     scene + "`");
  if (what == "keys") {
    std::optional<Scene> of;
    if (!scene.empty()) of = read_scene(scene_file(scene));
    const auto keys = rows_of_keys(of ? &*of : nullptr);
    if (json) std::cout << Json{{"keys", json_of(keys)}}.dump(2) << '\n';
    else print(keys, names);
    return 0;
  }
  if (data_folder().empty())
    throw OutputError("there are no scenes next to this program; expected them in " BARCHAN_DATA_FROM_BIN
                      " of its folder, or the program in the build folder of its source tree");
  const auto scenes = what == "states" ? std::vector<Row>{} : rows_of_scenes();
  const auto states = what == "scenes" ? std::vector<Row>{} : rows_of_states();
  if (json) {
    Json all = Json::object();
    if (what != "states") all["scenes"] = json_of(scenes);
    if (what != "scenes") all["states"] = json_of(states);
    std::cout << all.dump(2) << '\n';
    return 0;
  }
  if (!names && !scenes.empty()) std::cout << "scenes: barchan run NAME, barchan new MINE --from NAME\n";
  print(scenes, names);
  if (!names && !states.empty()) std::cout << (scenes.empty() ? "" : "\n") << "states: the key `state` of a scene\n";
  print(states, names);
  return 0;
}

}  // namespace barchan
