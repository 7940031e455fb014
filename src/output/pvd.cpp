#include "output/pvd.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/errors.hpp"
#include "output/numbers.hpp"
#include "output/whole_file.hpp"

namespace barchan {
namespace {

constexpr std::array<std::pair<char, std::string_view>, 5> entities{
    {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&apos;"}}};

std::string escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    std::string_view written(&c, 1);
    for (const auto& [character, entity] : entities)
      if (c == character) written = entity;
    escaped += written;
  }
  return escaped;
}

std::string unescape(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    std::size_t length = 1;
    char c = text.front();
    for (const auto& [character, entity] : entities)
      if (text.starts_with(entity)) c = character, length = entity.size();
    plain += c;
    text.remove_prefix(length);
  }
  return plain;
}

/// As much of XML as a .pvd needs: tags with attributes, comments, declarations; text between tags is skipped.
class Tags {
 public:
  struct Tag {
    std::string_view name;
    std::map<std::string_view, std::string> attributes;
  };

  explicit Tags(std::string_view text) : text_(text) {}

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
    tag = {word(), {}};
    while (true) {
      skip_space();
      if (rest().starts_with("/>")) return at_ += 2, true;
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

std::vector<SeriesWriter::Entry> parse(std::string_view text) {
  std::vector<SeriesWriter::Entry> entries;
  Tags tags(text);
  Tags::Tag tag;
  bool collection = false, ended = false;
  while (tags.next(tag)) {
    if (tag.name == "Collection") collection = true;
    if (tag.name == "/VTKFile") ended = true;
    if (tag.name != "DataSet") continue;
    const auto file = tag.attributes.find("file"), time = tag.attributes.find("timestep");
    if (file == tag.attributes.end() || time == tag.attributes.end())
      tags.fail("a DataSet needs 'timestep' and 'file'");
    const auto value = parse_number(time->second);
    if (!value) tags.fail("timestep=\"" + time->second + "\" is not a number");
    entries.push_back({*value, file->second});
  }
  if (!collection || !ended) throw OutputError("it is not a whole .pvd file (a VTKFile with a Collection)");
  return entries;
}

}  // namespace

void write_pvd(const std::filesystem::path& pvd, const std::vector<SeriesWriter::Entry>& entries) {
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const auto& [time, file] : entries)
    text += "    <DataSet timestep=\"" + exact(time) + "\" group=\"\" part=\"0\" file=\"" + escape(file) + "\"/>\n";
  text += "  </Collection>\n</VTKFile>\n";
  write_whole_file(pvd, text);
}

std::vector<SeriesWriter::Entry> read_pvd(const std::filesystem::path& pvd) {
  const std::string text = read_text(pvd);
  try {
    return parse(text);
  } catch (const OutputError& e) { throw OutputError("cannot read '" + pvd.string() + "': " + e.what()); }
}

}  // namespace barchan
