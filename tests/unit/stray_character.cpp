#include "scene/stray_character.hpp"

#include <gtest/gtest.h>

namespace barchan {
namespace {

TEST(StrayCharacter, IsAllowedInCommentsAndQuotes) {
  for (const char* text :
       {"a = 1 # \u03da", "a = \"\u03da\"", "a = '\u03da'", "a = \"\"\"x\n\u03da\"\" \" \"\"\"\nb = 1",
        "a = '''\n'\u03da''' # b", "a = \"\\\"\u03da\"", "a = \"\" # \u03da",
        "\xef\xbb\xbf"
        "a = 1"})
    EXPECT_FALSE(stray_character(text)) << text;
}

TEST(StrayCharacter, IsFoundBehindQuotes) {
  for (const char* text : {"a = \"x\" \u03da", "a = '\\' \u03da", "a = \"\"\"x\"\"\"\"\" \u03da", "a = '''x''' \u03da",
                           "a = \"\" \u03da", "a = \"\\\\\" \u03da"}) {
    const auto stray = stray_character(text);
    ASSERT_TRUE(stray) << text;
    EXPECT_EQ(stray->character, "\u03da") << text;
  }
}

TEST(StrayCharacter, HasAPlace) {
  const auto stray = stray_character("# \u00e4\na = \"\u00e4\" \u03da = 2");
  ASSERT_TRUE(stray);
  EXPECT_EQ(stray->line, 2U);
  EXPECT_EQ(stray->column, 9U);  // characters, not bytes
}

}  // namespace
}  // namespace barchan
