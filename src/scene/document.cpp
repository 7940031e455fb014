#include "scene/document.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <regex>
#include <tuple>

#include "base/errors.hpp"
#include "scene/text_table.hpp"

namespace barchan {
namespace {

constexpr std::string_view override_mark = "--set ";

/// A value with line breaks or control characters must not spoil the list of one problem a line.
std::string on_one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

bool is_override(const toml::source_region& source) { return source.path && source.path->starts_with(override_mark); }

}  // namespace

void Problems::add(const toml::source_region& source, const std::string& dotted, const std::string& what) {
  const unsigned line = std::max<unsigned>(source.begin.line, 1), column = std::max<unsigned>(source.begin.column, 1);
  const bool from_override = is_override(source);
  const std::string place =
      from_override ? *source.path : file_ + ":" + std::to_string(line) + ":" + std::to_string(column);
  list_.push_back({shortened(place, 1000), from_override, line, column, shortened(dotted), shortened(what, 4000)});
}

bool Problems::touches(const Problem& problem, const std::string& dotted) {
  return problem.dotted.starts_with(dotted) &&
         (problem.dotted.size() == dotted.size() || problem.dotted[dotted.size()] == '.');
}

bool Problems::touch(const std::string& dotted) const {
  return std::any_of(list_.begin(), list_.end(), [&](const Problem& problem) { return touches(problem, dotted); });
}

bool Problems::misread(const std::string& dotted) const {
  return std::any_of(list_.begin(), list_.begin() + static_cast<std::ptrdiff_t>(read_),
                     [&](const Problem& problem) { return touches(problem, dotted); });
}

void Problems::throw_if_any() const {
  if (list_.empty()) return;
  std::vector<Problem> sorted = list_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Problem& a, const Problem& b) {
    if (a.from_override || b.from_override) return a.from_override < b.from_override;
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  });
  std::string message;
  constexpr std::size_t most = 50;  // problems; who mends those finds the others then
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const Problem& problem = sorted[k];
    if (k == most) {
      message += "\nand " + std::to_string(sorted.size() - most) + " more";
      break;
    }
    if (!message.empty()) message += '\n';
    message += on_one_line(problem.place + ": " + (problem.dotted.empty() ? "" : problem.dotted + ": ") + problem.what);
  }
  throw SceneError(message);
}

void Problems::fail(const toml::source_region& source, const std::string& dotted, const std::string& what) {
  add(source, dotted, what);
  throw_if_any();
  std::abort();  // not reached: the list is not empty
}

namespace {

/// A dotted key makes a section within a section for each of its parts, and who reads them calls himself for each.
constexpr int most_parts = 100;

std::vector<std::string> split(const std::string& dotted) {
  std::vector<std::string> parts(1);
  for (const char c : dotted) {
    if (c == '.') parts.emplace_back();
    else parts.back() += c;
  }
  return parts;
}

/// TOML, or else a number as people write it (".5"), or else a bare word, which is a string. Null: malformed.
std::unique_ptr<toml::node> parse_value(const std::string& text, const std::string& label) {
  const auto take = [&](const std::string& source) -> std::unique_ptr<toml::node> {
    toml::table parsed;
    try {
      parsed = toml::parse(std::string_view(source), std::string_view(label));
    } catch (const toml::parse_error&) { return nullptr; }
    if (parsed.size() != 1) return nullptr;
    std::unique_ptr<toml::node> value;
    parsed.get("value")->visit([&](auto& node) {
      using Node = std::decay_t<decltype(node)>;
      value = std::make_unique<Node>(std::move(node));
    });
    return value;
  };
  if (auto value = take("value = " + text)) return value;
  if (text.empty() || std::string_view("[{\"'").find(text.front()) == std::string_view::npos) {
    double number = 0.0;
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(begin, end, number);
    toml::table holder = toml::parse(std::string_view("number = 0.0\nword = ''"), std::string_view(label));
    if (!text.empty() && error == std::errc() && rest == end) {
      *holder.get("number")->as_floating_point() = number;
      return std::make_unique<toml::value<double>>(std::move(*holder.get("number")->as_floating_point()));
    }
    *holder.get("word")->as_string() = text;
    return std::make_unique<toml::value<std::string>>(std::move(*holder.get("word")->as_string()));
  }
  return nullptr;
}

void put(toml::table& table, const std::string& name, toml::node& value, const toml::source_region& source) {
  value.visit(
      [&](auto& node) { table.insert_or_assign(toml::key(name, toml::source_region(source)), std::move(node)); });
}

/// "b-a" for "a-b": the two name the same entry of the matrix, so the override replaces the one in the file.
std::string reversed_pair(const std::string& pair) {
  const std::size_t dash = pair.find('-');
  return dash == std::string::npos ? pair : pair.substr(dash + 1) + "-" + pair.substr(0, dash);
}

/// Replaces or adds one value. Sections that do not exist are made; whether the key is known is checked later.
void apply(toml::table& document, const std::string& assignment, Problems& problems) {
  const std::string label = std::string(override_mark) + assignment;
  const toml::source_region here{{1, 1}, {1, 1}, std::make_shared<const std::string>(label)};
  const std::size_t equals = assignment.find('=');
  if (equals == 0 || equals == std::string::npos) {
    problems.add(here, "", "not an override; expected KEY=VALUE, as in time.end=0.01");
    return;
  }
  const std::string dotted = assignment.substr(0, equals);
  auto value = parse_value(assignment.substr(equals + 1), label);
  if (!value) {
    problems.add(here, dotted, "the value is malformed; expected a value as in a scene file");
    return;
  }
  const std::vector<std::string> parts = split(dotted);
  if (parts.size() > most_parts) {
    problems.add(here, dotted, "a key of more than " + std::to_string(most_parts) + " parts");
    return;
  }
  toml::node* node = &document;
  std::string so_far;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::string& part = parts[k];
    const bool last = k + 1 == parts.size();
    if (toml::table* table = node->as_table()) {
      if (last && k == 1 && parts[0] == "interactions" && !table->contains(part)) table->erase(reversed_pair(part));
      if (last) {
        put(*table, part, *value, here);
        return;
      }
      if (!table->contains(part)) {
        auto section = parse_value("{}", label);
        put(*table, part, *section, here);
      }
      node = table->get(part);
    } else if (toml::array* array = node->as_array()) {
      std::size_t index = 0;
      const auto [rest, error] = std::from_chars(part.data(), part.data() + part.size(), index);
      if (error != std::errc() || rest != part.data() + part.size() || index >= array->size()) {
        problems.add(here, dotted,
                     "there is no " + so_far + "." + part + "; expected a number from 0 to " +
                         std::to_string(array->size() - 1) + " after \"" + so_far + "\"");
        return;
      }
      if (last) {
        value->visit([&](auto& replacement) {
          array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(index), std::move(replacement));
        });
        return;
      }
      node = array->get(index);
    } else {
      problems.add(here, dotted, so_far + " is a value, not a section");
      return;
    }
    so_far += (so_far.empty() ? "" : ".") + part;
  }
}

}  // namespace

namespace {

/// The line of a dotted key of more parts; 0: there is none. Blanks and quotes may stand between the parts.
unsigned line_of_endless_key(std::string_view text) {
  unsigned line = 1;
  int parts = 1;
  for (const char c : text) {
    const bool of_key =
        std::isalnum(static_cast<unsigned char>(c)) || std::string_view("_-\"' \t.").find(c) != std::string_view::npos;
    parts = of_key ? parts + (c == '.') : 1;
    if (parts > most_parts) return line;
    line += c == '\n';
  }
  return 0;
}

/// A line without blanks before it.
std::string_view line_of(std::string_view text, unsigned line) {
  for (; line > 1 && !text.empty(); --line) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  text = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  return text;
}

/// The value that a line gives to its key, without blanks before it; nothing: it gives none.
std::string_view value_in_line(std::string_view text, unsigned line) {
  text = line_of(text, line);
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return {};
  text.remove_prefix(equals + 1);
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  return text;
}

/// Slips that one line shows: signs of a text processor, decimal commas, numbers of other languages.
std::string slip_of(std::string_view whole, std::string_view said) {
  whole = whole.substr(0, whole.find('#'));  // what a comment says is no slip
  while (!whole.empty() && std::isspace(static_cast<unsigned char>(whole.back()))) whole.remove_suffix(1);
  const auto has = [&](std::string_view text) { return whole.find(text) != whole.npos; };
  for (const char* const quote : {"\u201c", "\u201d", "\u201e", "\u2018", "\u2019"})
    if (has(quote)) return "; expected straight quotes, \"...\"";
  if (has("\u2212") || has("\u2013")) return "; expected the sign - of the keyboard";
  if (said.find("unescaped control") != said.npos) return "; expected a closing \" in this line";
  if (said.find("escape") != said.npos || said.find("hex digit") != said.npos)
    return "; in \"...\" a \\ begins a code: expected / in its place, or '...'";
  if (said.find("cannot redefine existing table") != said.npos)
    return "; it stands twice: expected all its keys in one place, or [[...]] in both for a list";
  if (said.find("saw '\\n'") != said.npos && has("{")) return "; expected { ... } in one line";
  if (whole.ends_with(';')) return "; expected no semicolon";
  const std::size_t equals = whole.find('=');
  constexpr std::size_t longest = 200;  // characters; what std::regex matches takes stack by its length
  if (equals == whole.npos || whole.size() > longest) return "";
  const std::string value(whole.substr(equals + 1));
  std::smatch number;
  static const std::regex comma(R"(^\s*([+-]?\d+),(\d+)\s*$)"), no_zero(R"(^\s*([+-]?)\.(\d+)\s*$)"),
      no_digit(R"(^\s*([+-]?\d+)\.([eE][+-]?\d+)?\s*$)"), of_fortran(R"(^\s*([+-]?[\d.]+)[dD]([+-]?\d+)\s*$)"),
      spaces(R"(^\s*\[?\(?\s*[+-]?[\d.]+(\s+[+-]?[\d.]+)+\s*\)?\]?\s*$)"), words(R"(^\s*([A-Za-z]\w*( +\w+)+)\s*$)");
  if (std::regex_match(value, number, comma)) return "; expected " + number.str(1) + "." + number.str(2);
  if (std::regex_match(value, number, no_zero)) return "; expected " + number.str(1) + "0." + number.str(2);
  if (std::regex_match(value, number, no_digit)) return "; expected " + number.str(1) + ".0" + number.str(2);
  if (std::regex_match(value, number, of_fortran)) return "; expected " + number.str(1) + "e" + number.str(2);
  if (std::regex_match(value, spaces)) return "; expected an array with commas, as in [0, -9.81]";
  if (std::regex_match(value, number, words)) return "; expected \"" + number.str(1) + "\"";
  return "";
}

/// What else to write where the reader of TOML only says what it cannot read; empty: nothing that we know.
std::string remedy(std::string_view text, unsigned line, std::string_view said) {
  constexpr std::string_view array = "' as array-of-tables", mark = "existing table '";
  if (const std::size_t end = said.find(array), begin = said.find(mark); end != said.npos && begin != said.npos) {
    const std::string name(said.substr(begin + mark.size(), end - begin - mark.size()));
    return "; expected [[" + name + "]] in place of [" + name + "]";
  }
  constexpr std::string_view table = "existing array '", as_table = "' as table";
  if (const std::size_t end = said.find(as_table), begin = said.find(table); end != said.npos && begin != said.npos) {
    const std::string name(said.substr(begin + table.size(), end - begin - table.size()));
    return "; expected [[" + name + "]] in place of [" + name + "]";
  }
  const std::string_view whole = line_of(text, line);
  if (whole.starts_with("//") || whole.starts_with("%") || whole.starts_with(";") || whole.starts_with("/*"))
    return "; a comment begins with #";
  if (whole.starts_with(".[")) return "; expected the line without the full stop at its beginning";
  if (std::string meant = slip_of(whole, said); !meant.empty()) return meant;
  const std::string_view value = value_in_line(text, line);
  const std::size_t end = std::min(value.find_first_not_of("+-.0123456789eE"), value.size());
  const std::size_t unit = std::min(value.find_first_not_of(' ', end), value.size());
  if (end > 0 && unit < value.size() && std::isalpha(static_cast<unsigned char>(value[unit])))
    return "; expected a number in units of SI, its unit in a comment, as in 9.81  # m/s2";
  return "";
}

/// The word without quotes that a line gives to its key, as in kind = fluid; else nothing.
std::string bare_word(std::string_view text, unsigned line) {
  text = value_in_line(text, line);
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos || !std::isalpha(static_cast<unsigned char>(text[begin]))) return "";
  std::size_t end = begin;
  while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '-')) ++end;
  const std::string_view rest = text.substr(end);
  const std::size_t next = rest.find_first_not_of(" \t\r");
  std::string word(text.substr(begin, end - begin));
  if ((next != std::string_view::npos && rest[next] != '#') || word == "true" || word == "false") return "";
  return word;
}

/// Of a word that stands without quotes.
std::string without_quotes(const std::string& word) {
  std::string small = word;
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (small == "true" || small == "yes" || small == "on") return word + " is no value; expected true";
  if (small == "false" || small == "no" || small == "off") return word + " is no value; expected false";
  return word + " stands without quotes; expected \"" + word + "\"";
}

}  // namespace

toml::table parse_document(const std::string& text, const std::string& file, const std::vector<std::string>& overrides,
                           Problems& problems) {
  toml::table document;
  if (const std::string why = why_no_text(text); !why.empty()) problems.fail({{1, 1}, {1, 1}, nullptr}, "", why);
  if (const unsigned line = line_of_endless_key(text))
    problems.fail({{line, 1}, {line, 1}, nullptr}, "",
                  "a key of more than " + std::to_string(most_parts) + " parts; expected a key as in docs/scenes.md");
  try {
    document = toml::parse(std::string_view(text), std::string_view(file));
  } catch (const toml::parse_error& error) {
    const unsigned line = error.source().begin.line;
    const std::string word = bare_word(text, line), said(error.description());
    problems.fail(error.source(), "",
                  "not TOML: " + (word.empty() ? said + remedy(text, line, said) : without_quotes(word)));
  }
  for (const std::string& assignment : overrides) apply(document, assignment, problems);
  return document;
}

}  // namespace barchan
