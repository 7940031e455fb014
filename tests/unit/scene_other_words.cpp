// Words of other programs (scene/other_words.hpp): what they point to exists, and none of them is a word of ours.
#include "scene/other_words.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scene/keys.hpp"

namespace barchan {
namespace {

TEST(OtherWords, OfKeysPointToKeys) {
  for (const OtherWord& o : other_keys) {
    const std::string section(o.section.substr(0, o.section.find(':')));
    EXPECT_FALSE(keys_of(section).empty()) << section;
    if (const Key* own = find_key(section, o.word); own && o.section == section) ADD_FAILURE() << o.word << " is a key";
    EXPECT_FALSE(o.ours.empty() && o.remark.empty()) << o.word;
    if (o.ours.empty()) continue;
    const std::size_t point = o.ours.find('.');
    const Key* const key =
        point == o.ours.npos ? find_key(section, o.ours) : find_key(o.ours.substr(0, point), o.ours.substr(point + 1));
    EXPECT_NE(key, nullptr) << section << "." << o.word << " points to " << o.ours;
  }
}

TEST(OtherWords, OfValuesPointToValues) {
  for (const OtherWord& o : other_values) {
    std::vector<std::string> words;
    for (const Key& key : all_keys()) {
      const std::vector<std::string> those = choices(key);
      const bool sides = o.section.empty() && std::find(those.begin(), those.end(), "bottom") != those.end();
      if (sides || path_of(key) == o.section) words.insert(words.end(), those.begin(), those.end());
    }
    EXPECT_FALSE(words.empty()) << o.section;
    EXPECT_EQ(std::count(words.begin(), words.end(), o.word), 0) << o.word;
    if (!o.ours.empty()) { EXPECT_GT(std::count(words.begin(), words.end(), o.ours), 0) << o.word; }
  }
}

}  // namespace
}  // namespace barchan
