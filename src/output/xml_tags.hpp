// As much of XML as a .pvd and the head of a frame need.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/errors.hpp"

namespace barchan {

inline constexpr std::array<std::pair<char, std::string_view>, 5> xml_entities{
    {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&apos;"}}};

inline std::string escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    std::string_view written(&c, 1);
    for (const auto& [character, entity] : xml_entities)
      if (c == character) written = entity;
    escaped += written;
  }
  return escaped;
}

inline std::string unescape(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    std::size_t length = 1;
    char c = text.front();
    for (const auto& [character, entity] : xml_entities)
      if (text.starts_with(entity)) c = character, length = entity.size();
    plain += c;
    text.remove_prefix(length);
  }
  return plain;
}

/// Tags with attributes, comments, declarations; text between tags is skipped.
class XmlTags {
 public:
  struct Tag {
    std::string_view name;
    std::map<std::string_view, std::string> attributes;
    bool alone = false;  // <Name/>: has no closing tag
  };

  explicit XmlTags(std::string_view text) : text_(text) {}

  /// The next tag, "/Name" for a closing one; false at the end. Throws OutputError("line N: ...").
  bool next(Tag& tag) {
    while (true) {
      const auto open = text_.find('<', at_);
      if (open == std::string_view::npos) return false;
      at_ = open + 1;
      if (rest().starts_with("!--")) skip_behind("-->");
      else if (rest().starts_with("?")) skip_behind("?>");
      else if (rest().starts_with("!")) skip_behind(">");
      else break;
    }
    tag = {word(), {}, false};
    while (true) {
      skip_space();
      if (rest().starts_with("/>")) return tag.alone = true, at_ += 2, true;
      if (rest().starts_with(">")) return at_ += 1, true;
      const auto name = word();
      skip_space();
      if (name.empty() || !rest().starts_with("=")) fail("a tag's attribute must be name=\"value\"");
      ++at_;
      skip_space();
      const char quote = rest().empty() ? '\0' : rest().front();
      const auto close = quote == '"' || quote == '\'' ? text_.find(quote, at_ + 1) : std::string_view::npos;
      if (close == std::string_view::npos) fail("a tag's attribute must be name=\"value\"");
      tag.attributes[name] = unescape(text_.substr(at_ + 1, close - at_ - 1));
      at_ = close + 1;
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    const auto before = text_.substr(0, at_);
    throw OutputError("line " + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ": " + what);
  }

 private:
  static constexpr std::string_view space = " \t\r\n";

  std::string_view rest() const { return text_.substr(at_); }
  void skip_space() { at_ = std::min(text_.find_first_not_of(space, at_), text_.size()); }
  void skip_behind(std::string_view end) {
    const auto found = text_.find(end, at_);
    if (found == std::string_view::npos) fail("'" + std::string(end) + "' is missing");
    at_ = found + end.size();
  }
  std::string_view word() {
    const auto begin = at_;
    if (rest().starts_with("/") && !rest().starts_with("/>")) ++at_;
    at_ = std::min(text_.find_first_of(" \t\r\n=/>", at_), text_.size());
    return text_.substr(begin, at_ - begin);
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace barchan
