#include "scene/text_table.hpp"

#include <algorithm>
#include <cctype>

#include "scene/text_words.hpp"

namespace barchan {

namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(mesh::blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(mesh::blanks) + 1 - begin);
}

/// What parts the fields of a line: the first of these that stands outside of quotes; ' ': none does.
char separator_of(std::string_view line) {
  for (const char mark : {';', '\t', ','}) {
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c == mark && !quoted) return mark;
    }
  }
  return ' ';
}

/// Takes one field in quotes from the line, and what follows it up to the next separator, which may be blanks only.
std::optional<std::string> take_quoted(std::string_view& line, char separator) {
  std::string field;
  std::size_t k = 1;
  for (;; ++k) {
    if (k >= line.size()) return std::nullopt;
    if (line[k] == '"' && line.substr(k + 1).starts_with('"')) ++k;
    else if (line[k] == '"') break;
    field += line[k];
  }
  line.remove_prefix(k + 1);
  const std::size_t end = std::min(line.find(separator), line.size());
  if (!trimmed(line.substr(0, end)).empty()) return std::nullopt;
  line.remove_prefix(end);
  return std::string(trimmed(field));
}

/// Words between blanks; a unit in brackets belongs to the word before it.
std::optional<std::vector<std::string>> words_between_blanks(std::string_view line) {
  std::vector<std::string> words;
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(mesh::blanks), line.size()));
    if (line.empty()) return words;
    if (line.front() == '"') {
      const auto word = take_quoted(line, ' ');
      if (!word) return std::nullopt;
      words.push_back(*word);
      continue;
    }
    const std::size_t end = std::min(line.find_first_of(mesh::blanks), line.size());
    const std::string word(line.substr(0, end));
    if (!words.empty() && (word.front() == '[' || word.front() == '(')) words.back() += " " + word;
    else words.push_back(word);
    line.remove_prefix(end);
  }
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) >= 0x80; }

}  // namespace

std::string_view without_mark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

std::string why_no_text(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
    return "is text in UTF-16; expected UTF-8 (choose it where the file is saved)";
  return "";
}

std::optional<std::vector<std::string>> fields_of(std::string_view line, bool blanks_part) {
  const char separator = separator_of(line);
  if (separator == ' ' && blanks_part) return words_between_blanks(line);
  std::vector<std::string> fields;
  while (true) {
    const std::size_t begin = line.find_first_not_of(separator == '\t' ? " \r\f\v" : mesh::blanks);
    if (begin != std::string_view::npos && line[begin] == '"') {
      line.remove_prefix(begin);
      const auto field = take_quoted(line, separator);
      if (!field) return std::nullopt;
      fields.push_back(*field);
    } else {
      const std::size_t end = separator == ' ' ? line.size() : std::min(line.find(separator), line.size());
      fields.emplace_back(trimmed(line.substr(0, end)));
      line.remove_prefix(end);
    }
    if (line.empty()) return fields;
    line.remove_prefix(1);
  }
}

ColumnHead head_of(std::string_view field, Quantity quantity) {
  field = trimmed(field);
  for (const std::string_view pair : {"[]", "()"})
    if (const std::size_t open = field.rfind(pair[0]); open != std::string_view::npos && field.ends_with(pair[1]))
      return {std::string(trimmed(field.substr(0, open))),
              std::string(trimmed(field.substr(open + 1, field.size() - open - 2)))};
  for (std::size_t k = 1; k + 1 < field.size(); ++k) {
    if (std::string_view(" _/").find(field[k]) == std::string_view::npos) continue;
    const std::string_view unit = field.substr(k + 1);
    if (!unit_of(unit, quantity)) continue;
    std::string_view name = trimmed(field.substr(0, k));
    if (name.ends_with(" in")) name = trimmed(name.substr(0, name.size() - 3));
    return {std::string(name), std::string(unit)};
  }
  return {std::string(field), std::nullopt};
}

bool is_name(std::string_view name) {
  if (name.empty() || !is_letter(name.front())) return false;
  for (const std::string_view number : {"nan", "inf", "infinity"})
    if (mesh::same(name, number)) return false;
  if (name.find_first_not_of("OoIlEeSB") == std::string_view::npos) return false;  // as 0, 1, an exponent, 5, 8
  return std::all_of(name.begin(), name.end(), [](char c) { return is_letter(c) || c == '_' || c == '-' || c == ' '; });
}

std::string no_number(std::string_view field) {
  std::string point(field);
  std::replace(point.begin(), point.end(), ',', '.');
  const bool comma = point != field && mesh::coordinate_of(point);
  return mesh::in_quotes(field) + " is no finite number" +
         (comma ? "; expected a decimal point in place of the comma" : "");
}

}  // namespace barchan
