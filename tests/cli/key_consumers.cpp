// A key of the scene that nothing consumes fails here. Every row of the table of keys has a case below: runs that
// differ in this key alone, whose results must differ. So it is not enough that the program reads a key, passes it on
// or mentions it: it must change what the user gets.
//
// What counts as a result: the files of a run, byte by byte (particles, history, what is measured), and of run.json the
// title and the state, which are for people and for scripts/run. Checkpoints do not count, because they hold the text
// of the scene; of a run that is killed it counts whether there is one.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

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

Results results_of(const std::string& base, const std::string& overrides, bool killed) {
  const fs::path place = fs::path(::testing::TempDir()) / ("barchan_keys_" + std::to_string(getpid()));
  fs::remove_all(place);
  fs::create_directories(place);
  const fs::path scene = place / "scene.toml", out = place / "out", said = place / "said";
  std::ofstream(scene) << scene_texts().at(base);
  std::string command = std::string(killed ? "timeout -s KILL 3 " : "") + "'" BARCHAN_PROGRAM "' run '" +
                        scene.string() + "' --quiet --threads 1 --out '" + out.string() + "'";
  std::istringstream list(overrides);
  for (std::string assignment; std::getline(list, assignment, '|');) command += " --set '" + assignment + "'";
  command += " > '" + said.string() + "' 2>&1";
  const int status = std::system(command.c_str());
  if (killed) {
    EXPECT_TRUE(fs::exists(out)) << base << ": " << overrides << ": did not begin in three seconds";
    const Results results{{"checkpoint", fs::exists(out / "scene.checkpoint") ? "is there" : "is not there"}};
    fs::remove_all(place);
    return results;
  }
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << base << ": " << overrides << "\n" << contents(said);
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
  return results;
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

TEST(KeyConsumers, EveryKeyHasACase) {
  std::map<std::string, const Case*> known;
  for (const Case& c : cases()) EXPECT_TRUE(known.emplace(c.key, &c).second) << c.key << " has two cases";
  std::size_t used = 0;
  for (const Key& key : all_keys()) {
    if (only_a_section(key)) continue;
    std::vector<std::string> names = {path_of(key)};
    if (key.section == "phases") {
      names.clear();
      for (const std::string& kind : choices(*find_key("phases", "kind")))
        if (belongs_to_kind(key, kind)) names.push_back(path_of(key) + " of " + kind);
    }
    std::set<std::string> all_given;
    for (const std::string& name : names) {
      const auto found = known.find(name);
      ASSERT_NE(found, known.end()) << name << ": no case tells what it changes; add one to key_consumers_cases.inc";
      ++used;
      EXPECT_GE(found->second->runs.size(), 2u) << name;
      const std::set<std::string> given = given_to(*found->second, std::string(key.name));
      EXPECT_FALSE(given.empty()) << name << ": the case does not give the key";
      all_given.insert(given.begin(), given.end());
    }
    if (!(key.slot.accepts & as_word)) continue;
    for (const std::string& word : choices(key))
      EXPECT_TRUE(all_given.contains(word)) << path_of(key) << ": no run with " << word;
  }
  EXPECT_EQ(used, known.size()) << "a case of a key that is not in the table";
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
