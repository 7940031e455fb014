// A key of the scene that nothing consumes fails here. Of every row of the table of keys there are runs that differ in
// this key alone, whose results must differ. So it is not enough that the program reads a key, passes it on or mentions
// it: it must change what the user gets. A key that changes the results of one of the scenes of
// key_consumers_scenes.inc by itself needs no more: values that its row allows are tried on them. One that acts only
// beside other keys has a case in key_consumers_cases.inc.
//
// What counts as a result: the files of a run, byte by byte (particles, history, what is measured), and of run.json the
// title and the state, which are for people and for scripts/run. Checkpoints do not count, because they hold the text
// of the scene; of a run that is killed it counts whether there is one.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "scene/keys.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

struct Case {
  std::string key;                // SECTION.NAME; of a key of phases also " of KIND"
  std::string base;               // of scene_texts
  std::vector<std::string> runs;  // overrides of each run, '|' between them; "" for none
  bool killed = false;            // after a second of the wall's time
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.key; }

/// Scenes of a hundred particles and some ten steps.
const std::map<std::string, std::string>& scene_texts() {
  static const std::map<std::string, std::string> texts = {
#include "key_consumers_scenes.inc"
  };
  return texts;
}

/// One run a value of the key at `dotted`; "" for a run that does not give it.
Case values(const std::string& key, const std::string& base, const std::string& dotted,
            const std::vector<std::string>& of) {
  Case result{key, base, {}, false};
  for (const std::string& value : of) result.runs.push_back(value.empty() ? "" : dotted + "=" + value);
  return result;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
#include "key_consumers_cases.inc"
  };
  return all;
}

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// All that a run gives to its user.
using Results = std::map<std::string, std::string>;

/// Of a run that ends well; without, what the program said.
struct Outcome {
  std::optional<Results> results;
  std::string said;
};

Outcome outcome_of(const std::string& base, const std::string& overrides, bool killed) {
  const fs::path place = fs::path(::testing::TempDir()) / ("barchan_keys_" + std::to_string(getpid()));
  fs::remove_all(place);
  fs::create_directories(place);
  const fs::path scene = place / "scene.toml", out = place / "out", said = place / "said";
  std::ofstream(scene) << scene_texts().at(base);
  std::ofstream(place / "small.csv") << "0.2,0.7\n0.8,0.7\n0.5,0.9\n";  // for fill.shape.surface
  std::ofstream(place / "large.csv") << "0.2,0.7\n0.8,0.7\n0.5,0.95\n";
  std::ofstream(place / "parts.vtk")  // for fill.shape.part
      << "# vtk DataFile Version 2.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0.2 0.7 0 0.8 0.7 0 0.8 "
         "0.9 0 0.2 0.9 0\nCELLS 2 8\n3 0 1 2\n3 0 2 3\nCELL_TYPES 2\n5\n5\nCELL_DATA 2\nSCALARS CellEntityIds int "
         "1\nLOOKUP_TABLE default\n1\n2\n";
  std::string command = std::string(killed ? "timeout -s KILL 3 " : "") + "'" BARCHAN_PROGRAM "' run '" +
                        scene.string() + "' --quiet --threads 1 --out '" + out.string() + "'";
  std::istringstream list(overrides);
  for (std::string assignment; std::getline(list, assignment, '|');) command += " --set '" + assignment + "'";
  command += " > '" + said.string() + "' 2>&1";
  const int status = std::system(command.c_str());
  if (killed) {
    const bool began = fs::exists(out);
    const Results results{{"checkpoint", fs::exists(out / "scene.checkpoint") ? "is there" : "is not there"}};
    fs::remove_all(place);
    return began ? Outcome{results, ""} : Outcome{std::nullopt, "did not begin in three seconds"};
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return {std::nullopt, contents(said)};
  Results results;
  if (fs::exists(out))
    for (const auto& entry : fs::directory_iterator(out))
      if (entry.path().filename() != "run.json" && entry.path().extension() != ".checkpoint")
        results[entry.path().filename().string()] = contents(entry.path());
  if (fs::exists(out / "run.json")) {
    const auto about = nlohmann::json::parse(contents(out / "run.json"))["scene"];
    results["title"] = about["title"];
    results["state"] = about["state"];
  }
  fs::remove_all(place);
  return {results, ""};
}

Results results_of(const std::string& base, const std::string& overrides, bool killed) {
  const Outcome outcome = outcome_of(base, overrides, killed);
  EXPECT_TRUE(outcome.results) << base << ": " << overrides << "\n" << outcome.said;
  return outcome.results.value_or(Results{});
}

/// The values that a case gives its key, as they stand in the overrides.
std::set<std::string> given_to(const Case& c, const std::string& name) {
  std::set<std::string> values;
  for (const std::string& run : c.runs) {
    std::istringstream list(run);
    for (std::string assignment; std::getline(list, assignment, '|');) {
      const std::string dotted = assignment.substr(0, assignment.find('='));
      const std::string value = assignment.substr(assignment.find('=') + 1);
      if (dotted == name || dotted.ends_with("." + name)) values.insert(value);
      const std::string inside = " " + name + " = ";  // of a section in one line
      const std::size_t at = value.find(inside);
      if (at == std::string::npos) continue;
      const std::string rest = value.substr(at + inside.size());
      values.insert(rest.front() == '"' ? rest.substr(1, rest.find('"', 1) - 1) : rest);
    }
  }
  return values;
}

/// A section is consumed by its keys: it needs no case of its own, unless it may also be a value.
bool only_a_section(const Key& key) {
  return (key.slot.accepts & ~static_cast<unsigned>(as_section | as_sections | as_named_sections)) == 0;
}

/// A key as cases name it: SECTION.NAME, of a key of phases once for each kind that has it.
struct NamedKey {
  std::string name;
  const Key* key;
  std::string kind;  // "": the key is not one of phases
};

std::vector<NamedKey> names_of(const Key& key) {
  if (key.section != "phases") return {{path_of(key), &key, ""}};
  std::vector<NamedKey> names;
  for (const std::string& kind : choices(*find_key("phases", "kind")))
    if (belongs_to_kind(key, kind)) names.push_back({path_of(key) + " of " + kind, &key, kind});
  return names;
}

const std::map<std::string, const Case*>& cases_by_key() {
  static const auto known = [] {
    std::map<std::string, const Case*> all;
    for (const Case& c : cases()) EXPECT_TRUE(all.emplace(c.key, &c).second) << c.key << " has two cases";
    return all;
  }();
  return known;
}

TEST(KeyConsumers, CasesGiveTheirKeys) {
  std::size_t used = 0;
  for (const Key& key : all_keys()) {
    if (only_a_section(key)) continue;
    std::set<std::string> all_given;
    bool all_have_cases = true;
    for (const NamedKey& named : names_of(key)) {
      const auto found = cases_by_key().find(named.name);
      all_have_cases = all_have_cases && found != cases_by_key().end();
      if (found == cases_by_key().end()) continue;
      ++used;
      EXPECT_GE(found->second->runs.size(), 2u) << named.name;
      const std::set<std::string> given = given_to(*found->second, std::string(key.name));
      EXPECT_FALSE(given.empty()) << named.name << ": the case does not give the key";
      all_given.insert(given.begin(), given.end());
    }
    if (!(key.slot.accepts & as_word) || !all_have_cases) continue;
    for (const std::string& word : choices(key))
      EXPECT_TRUE(all_given.contains(word)) << path_of(key) << ": no run with " << word;
  }
  EXPECT_EQ(used, cases_by_key().size()) << "a case of a key that is not in the table";
}

/// Where a key can be given by itself: a scene, overrides that all runs have, the section in dotted form.
struct Place {
  std::string base, given, section;
};

/// The scenes that need no overrides.
const std::map<std::string, Scene>& whole_scenes() {
  static const auto scenes = [] {
    std::map<std::string, Scene> all;
    for (const auto& [base, text] : scene_texts()) try {
        all.emplace(base, parse_scene(text, "scene.toml"));
      } catch (const SceneError&) {}
    return all;
  }();
  return scenes;
}

std::vector<Place> places_of(const NamedKey& named) {
  std::vector<Place> places;
  const std::string section(named.key->section);
  for (const auto& entry : whole_scenes()) {
    const std::string& base = entry.first;
    const Scene& scene = entry.second;
    const auto numbered = [&](const char* name, std::size_t count) {
      for (std::size_t k = 0; section == name && k < count; ++k)
        places.push_back({base, "", section + "." + std::to_string(k) + "."});
    };
    for (const Phase& phase : scene.phases)
      if (!named.kind.empty() && phase.kind_word() == named.kind)
        places.push_back({base, "", "phases." + phase.name + "."});
    for (const Interaction& pair : scene.interactions)
      if (section == "interactions.pair") places.push_back({base, "", "interactions." + pair.a + "-" + pair.b + "."});
    if (section.empty()) places.push_back({base, "", ""});
    for (const char* name : {"domain", "time", "output", "interactions"})
      if (section == name) places.push_back({base, "", section + "."});
    numbered("fill", scene.fills.size());
    numbered("forcing", scene.forcings.size());
    numbered("influx", scene.influxes.size());
    numbered("probe", scene.measuring.probes.size());
    numbered("profile", scene.measuring.profiles.size());
    numbered("grid", scene.measuring.grids.size());
    numbered("wall-shear", scene.measuring.wall_shears.size());
    numbered("saltation", scene.measuring.saltation.size());
  }
  if (places.empty() && !named.kind.empty()) places.push_back({"kinds", "phases.a.kind=" + named.kind, "phases.a."});
  return places;
}

/// Values that the row of a key allows, as a document writes them.
std::vector<std::string> allowed(const Key& key) {
  std::vector<std::string> values;
  if (key.slot.accepts & as_word)
    for (const std::string& word : choices(key)) values.push_back("\"" + word + "\"");
  if (!values.empty()) return values;
  if (key.slot.accepts & as_boolean) return {"true", "false"};
  if (key.slot.accepts & (as_vector | as_formulas)) return {"[0.5, 0.25]", "[0.05, 0.025]"};
  for (const char* number : {"0.5", "1", "2", "0.1", "0", "3", "10", "100", "1e-3"})
    if (key.bounds.hold(std::stod(number)) &&
        (!(key.slot.accepts & as_integer) || std::string(number).find_first_of(".e") == std::string::npos))
      values.emplace_back(number);
  return values;
}

/// Whether runs in this place with different values of the key end well and differ: with all of its words, or with one
/// other value than the scene's.
bool differs(const Place& place, const Key& key) {
  const auto run = [&](const std::string& value) {
    std::string overrides = place.given;
    if (!value.empty())
      overrides += (overrides.empty() ? "" : "|") + place.section + std::string(key.name) + "=" + value;
    return outcome_of(place.base, overrides, false).results;
  };
  std::vector<Results> seen;
  if (!(key.slot.accepts & (as_word | as_boolean))) {
    const auto without = run("");
    if (!without) return false;
    seen.push_back(*without);
  }
  for (const std::string& value : allowed(key)) {
    const auto results = run(value);
    const bool is_new = results && std::find(seen.begin(), seen.end(), *results) == seen.end();
    if (key.slot.accepts & (as_word | as_boolean)) {
      if (!is_new) return false;
      seen.push_back(*results);
    } else if (is_new) {
      return true;
    }
  }
  return (key.slot.accepts & (as_word | as_boolean)) && seen.size() > 1;
}

/// A kind of phase without a case stands in the scene of kinds, beside which a phase of grains gives other results.
bool kind_differs(const std::string& kind) {
  const auto of = [](const std::string& word) { return outcome_of("kinds", "phases.a.kind=" + word, false).results; };
  const auto results = of(kind), other = of(kind == "grains" ? "wall" : "grains");
  return results && other && *results != *other;
}

TEST(KeyConsumers, AKeyWithoutACaseChangesTheResultsByItself) {
  if (!fs::exists(BARCHAN_PROGRAM)) GTEST_SKIP() << "no program at " BARCHAN_PROGRAM;
  for (const Key& key : all_keys()) {
    if (only_a_section(key)) continue;
    for (const NamedKey& named : names_of(key)) {
      if (cases_by_key().contains(named.name)) continue;
      const auto places = places_of(named);
      const bool found =
          path_of(key) == "phases.kind"
              ? kind_differs(named.kind)
              : std::any_of(places.begin(), places.end(), [&](const Place& place) { return differs(place, key); });
      EXPECT_TRUE(found)
          << named.name
          << ": no value of it alone changes the results of a scene of key_consumers_scenes.inc; if it "
             "acts beside other keys only, add a case to key_consumers_cases.inc; of a new kind of phase, add a "
             "scene that has one";
    }
  }
}

class KeyConsumer : public ::testing::TestWithParam<Case> {};

TEST_P(KeyConsumer, ChangesTheResults) {
  if (!fs::exists(BARCHAN_PROGRAM)) GTEST_SKIP() << "no program at " BARCHAN_PROGRAM;
  const Case& c = GetParam();
  std::vector<Results> results;
  for (const std::string& run : c.runs) {
    results.push_back(results_of(c.base, run, c.killed));
    for (std::size_t other = 0; other + 1 < results.size(); ++other)
      EXPECT_NE(results[other], results.back())
          << c.key << ": the same results with \"" << c.runs[other] << "\" and \"" << run << "\"";
  }
}

INSTANTIATE_TEST_SUITE_P(Keys, KeyConsumer, ::testing::ValuesIn(cases()), [](const auto& test) {
  std::string name = test.param.key;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
}  // namespace barchan
