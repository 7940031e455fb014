#include "scene/stray_character.hpp"

#include <algorithm>

namespace barchan {
namespace {

bool beyond_ascii(char c) { return static_cast<unsigned char>(c) >= 0x80; }
bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80; }

/// Behind the text in quotes that begins at `k`; the end of the document when it is not closed.
std::size_t behind_quotes(std::string_view text, std::size_t k) {
  const char quote = text[k];
  const bool escapes = quote == '"', many_lines = text.substr(k, 3) == std::string(3, quote);
  if (!many_lines && text.substr(k, 2) == std::string(2, quote)) return k + 2;
  for (k += many_lines ? 3 : 1; k < text.size(); ++k) {
    if (escapes && text[k] == '\\') ++k;
    else if (!many_lines && text[k] == '\n') return text.size();
    else if (text[k] == quote && !many_lines) return k + 1;
    else if (text.substr(k, 3) == std::string(3, quote)) {
      // Up to two quotes before the closing ones belong to the text.
      for (k += 3; k < text.size() && text[k] == quote;) ++k;
      return k;
    }
  }
  return text.size();
}

/// The bytes of the character that begins at `k`, or its first byte as a number when they are not UTF-8.
std::string character_at(std::string_view text, std::size_t k) {
  const auto first = static_cast<unsigned char>(text[k]);
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  const std::string_view bytes = text.substr(k, length);
  if (first >= 0xc2 && first <= 0xf4 && bytes.size() == length &&
      std::all_of(bytes.begin() + 1, bytes.end(), continues_character))
    return std::string(bytes);
  constexpr std::string_view digits = "0123456789abcdef";
  return std::string("byte 0x") + digits[first >> 4U] + digits[first & 15U];
}

StrayCharacter at(std::string_view text, std::size_t k) {
  const std::string_view before = text.substr(0, k);
  const std::size_t line_begin = before.rfind('\n') + 1;  // 0 where there is none
  const auto characters = std::count_if(before.begin() + static_cast<std::ptrdiff_t>(line_begin), before.end(),
                                        [](char c) { return !continues_character(c); });
  return {1 + static_cast<unsigned>(std::count(before.begin(), before.end(), '\n')),
          1 + static_cast<unsigned>(characters), character_at(text, k)};
}

}  // namespace

std::optional<StrayCharacter> stray_character(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  for (std::size_t k = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0; k < text.size();) {
    if (beyond_ascii(text[k])) return at(text, k);
    if (text[k] == '#') k = std::min(text.find('\n', k), text.size());
    else if (text[k] == '"' || text[k] == '\'') k = behind_quotes(text, k);
    else ++k;
  }
  return std::nullopt;
}

}  // namespace barchan
