// Characters that a scene may have in comments and quotes only. Internal to src/scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace barchan {

/// Where a character stands, and it itself (the bytes of UTF-8).
struct StrayCharacter {
  unsigned line, column;  // from 1; a column is a character
  std::string character;
};

/// The first character beyond ASCII that stands outside comments and quotes; none where a quote is not closed before it.
/// TOML 1.0 allows none there. toml++ 3.3 must not see one: its tables of blanks and letters have undefined behaviour
/// for some (U+03DA).
std::optional<StrayCharacter> stray_character(std::string_view text);

}  // namespace barchan
