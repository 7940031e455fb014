// Lines, words and numbers of text files: tables, meshes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "base/vec3.hpp"

namespace barchan::mesh {

constexpr std::string_view blanks = " \t\r\f\v";

/// Why a file is refused. Thrown and caught inside this file.
struct Refused {
  std::string why;
};

[[noreturn]] inline void refuse(const std::string& why) { throw Refused{why}; }

[[noreturn]] inline void refuse_line(std::size_t number, const std::string& why) {
  refuse("line " + std::to_string(number) + " " + why);
}

inline std::string in_quotes(std::string_view word) { return "\"" + shortened(std::string(word)) + "\""; }

inline std::vector<std::string_view> split_words(std::string_view line, std::string_view between = blanks) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(between);
    if (begin == std::string_view::npos) return words;
    const std::size_t end = std::min(line.find_first_of(between, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

/// A whole word as a number; nothing where letters follow.
template <class Number>
std::optional<Number> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number value{};
  const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || rest != word.data() + word.size() || word.empty()) return {};
  return value;
}

/// A finite number. Of digits behind the range of a double, as 1e-400, nothing.
inline std::optional<double> coordinate_of(std::string_view word) {
  const auto value = number_of<double>(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

inline bool same(std::string_view word, std::string_view lower) {
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

/// The lines of a text with their numbers, from 1. A line ends with \n, \r\n or \r.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}
  bool next() {
    if (at_ >= text_.size()) return false;
    std::size_t end = std::min(text_.find_first_of("\n\r", at_), text_.size());
    line_ = text_.substr(at_, end - at_);
    if (end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n') ++end;
    at_ = std::min(end + 1, text_.size());
    ++number_;
    return true;
  }
  /// The next line that has a word; false at the end.
  bool next_with_words() {
    while (next())
      if (line_.find_first_not_of(blanks) != std::string_view::npos) return true;
    return false;
  }
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }
  std::size_t at() const { return at_; }  ///< where the next line begins

 private:
  std::string_view text_, line_;
  std::size_t at_ = 0, number_ = 0;
};

inline Vec3 point_of(const std::vector<std::string_view>& words, std::size_t first, std::size_t line) {
  Vec3 x{};
  for (std::size_t d = 0; d < 3; ++d) {
    if (first + d >= words.size()) refuse_line(line, "has fewer than three coordinates");
    const auto value = coordinate_of(words[first + d]);
    if (!value) refuse_line(line, "has " + in_quotes(words[first + d]) + " where a number is expected");
    x[d] = *value;
  }
  return x;
}

/// The value whose bytes stand at `from`, of the given order of bytes.
template <class Value>
Value bytes_as(const char* from, bool big_endian) {
  std::array<char, sizeof(Value)> bytes{};
  std::memcpy(bytes.data(), from, sizeof(Value));
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Value>(bytes);
}

}  // namespace barchan::mesh
