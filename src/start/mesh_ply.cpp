#include <map>

#include "scene/text_table.hpp"
#include "start/mesh_parts.hpp"
#include "start/mesh_texts.hpp"

namespace barchan {

using namespace mesh;

namespace {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type{};
  std::optional<PlyType> count;  // of a list
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  const PlyProperty* property(std::string_view wanted) const {
    for (const PlyProperty& p : properties)
      if (p.name == wanted) return &p;
    return nullptr;
  }
};

PlyType ply_type(std::string_view word, std::size_t line) {
  static const std::map<std::string_view, PlyType> types{
      {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
      {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
      {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
      {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
      {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
      {"float64", PlyType::float64}};
  const auto found = types.find(word);
  if (found == types.end()) refuse_line(line, "has the unknown type " + in_quotes(word));
  return found->second;
}

/// The values of the elements, one after another, of text or of bytes.
class PlyValues {
 public:
  PlyValues(std::string_view data, std::size_t line, bool text, bool big_endian)
      : data_(data), lines_(data), before_(line), text_(text), big_endian_(big_endian) {}

  /// Every element of a text has a line of its own.
  void begin(const std::string& element) {
    if (!text_) return;
    if (!lines_.next_with_words()) refuse("the file ends before its last element " + in_quotes(element));
    words_ = split_words(lines_.line());
    word_ = 0;
  }
  void end() const {
    if (text_ && word_ != words_.size())
      refuse_line(line(),
                  "has " + std::to_string(words_.size()) + " values, and the head says " + std::to_string(word_));
  }
  /// Nothing may follow.
  void close() {
    if (text_ && lines_.next_with_words()) refuse_line(line(), "follows the last element that the head names");
    if (!text_ && at_ != data_.size())
      refuse(std::to_string(data_.size() - at_) + " bytes follow the last element that the head names");
  }

  double value(PlyType type) {
    const double found = text_ ? from_word(type) : from_bytes(type);
    if (!std::isfinite(found)) refuse(where() + "has a value that is not finite");
    return found;
  }
  /// How many bytes or letters are left: no list is longer.
  std::size_t left() const { return text_ ? words_.size() - word_ : data_.size() - at_; }
  std::string where() const { return text_ ? "line " + std::to_string(line()) + " " : ""; }

 private:
  std::size_t line() const { return before_ + lines_.number(); }

  double from_word(PlyType type) {
    if (word_ >= words_.size()) refuse_line(line(), "has fewer values than the head says");
    const std::string_view word = words_[word_++];
    const auto number = coordinate_of(word);
    const bool whole = type < PlyType::float32;
    if (!number || (whole && *number != std::floor(*number)))
      refuse_line(line(), "has " + in_quotes(word) + " where a " + (whole ? "whole " : "") + "number is expected");
    return *number;
  }

  double from_bytes(PlyType type) {
    const std::size_t size = size_of(type);
    if (data_.size() - at_ < size) refuse("the file ends before its last element");
    const char* from = data_.data() + at_;
    at_ += size;
    switch (type) {
      case PlyType::int8: return bytes_as<std::int8_t>(from, big_endian_);
      case PlyType::uint8: return bytes_as<std::uint8_t>(from, big_endian_);
      case PlyType::int16: return bytes_as<std::int16_t>(from, big_endian_);
      case PlyType::uint16: return bytes_as<std::uint16_t>(from, big_endian_);
      case PlyType::int32: return bytes_as<std::int32_t>(from, big_endian_);
      case PlyType::uint32: return bytes_as<std::uint32_t>(from, big_endian_);
      case PlyType::float32: return bytes_as<float>(from, big_endian_);
      case PlyType::float64: break;
    }
    return bytes_as<double>(from, big_endian_);
  }

  std::string_view data_;
  Lines lines_;
  std::vector<std::string_view> words_;
  std::size_t word_ = 0, at_ = 0, before_;
  bool text_, big_endian_;
};

struct PlyHead {
  std::string format;
  std::vector<PlyElement> elements;
  std::size_t size = 0, lines = 0;
};

PlyHead ply_head(std::string_view bytes) {
  PlyHead head;
  Lines lines(bytes);
  if (!lines.next() || split_words(lines.line()) != std::vector<std::string_view>{"ply"})
    refuse("does not begin with \"ply\"");
  while (lines.next()) {
    const auto words = split_words(lines.line());
    const std::size_t number = lines.number();
    if (words.empty()) refuse_line(number, "of the head is empty");
    if (words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header" && words.size() == 1) {
      head.size = lines.at();
      head.lines = number;
      if (head.format.empty()) refuse("the head names no format");
      return head;
    }
    if (words[0] == "format" && words.size() == 3 && head.format.empty() && words[2] == "1.0") {
      head.format = words[1];
      if (head.format != "ascii" && head.format != "binary_little_endian" && head.format != "binary_big_endian")
        refuse_line(number, "has the unknown format " + in_quotes(head.format));
    } else if (words[0] == "element" && words.size() == 3) {
      const auto count = number_of<std::size_t>(words[2]);
      if (!count || *count > bytes.size())
        refuse_line(number, "has " + in_quotes(words[2]) + " where a number of elements is expected");
      for (const PlyElement& element : head.elements)
        if (element.name == words[1]) refuse_line(number, "names the element " + in_quotes(words[1]) + " again");
      head.elements.push_back({std::string(words[1]), *count, {}});
    } else if (words[0] == "property" && !head.elements.empty() &&
               (words.size() == 3 || (words.size() == 5 && words[1] == "list"))) {
      PlyProperty property;
      property.name = words.back();
      property.type = ply_type(words[words.size() - 2], number);
      if (words.size() == 5) property.count = ply_type(words[2], number);
      if (property.count && *property.count >= PlyType::float32)
        refuse_line(number, "counts a list with " + in_quotes(words[2]));
      if (head.elements.back().property(property.name))
        refuse_line(number, "names the property " + in_quotes(property.name) + " again");
      head.elements.back().properties.push_back(property);
    } else {
      refuse_line(number, "of the head is not understood: " + in_quotes(lines.line()));
    }
  }
  refuse("the head has no \"end_header\"");
}

/// One element: numbers by name, and its list of corners where it has one.
struct PlyValue {
  std::map<std::string_view, double> numbers;
  std::vector<double> corners;
};

/// A number of the file in a message; it may be beyond every integer.
std::string written(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", number);
  return text;
}

bool names_corners(const PlyProperty& p) { return p.count && (p.name == "vertex_indices" || p.name == "vertex_index"); }

void read_element(PlyValues& values, const PlyElement& element, PlyValue& found) {
  values.begin(element.name);
  found.corners.clear();
  for (const PlyProperty& property : element.properties) {
    if (!property.count) {
      found.numbers[property.name] = values.value(property.type);
      continue;
    }
    const double count = values.value(*property.count);
    if (!(count >= 0.0) || count > static_cast<double>(values.left()))
      refuse(values.where() + "has a list of " + written(count) + " values, more than the file holds");
    for (double k = 0; k < count; ++k) {
      const double value = values.value(property.type);
      if (names_corners(property)) found.corners.push_back(value);
    }
  }
  values.end();
}

std::size_t ply_vertex(double number, std::size_t count, const PlyValues& values) {
  if (!(number >= 0.0 && number < static_cast<double>(count)) || number != std::floor(number))
    refuse(values.where() + "names vertex " + written(number) + " of " + std::to_string(count) + ", from 0");
  return static_cast<std::size_t>(number);
}

/// The corners of a face, or of strips of triangles, which -1 parts.
void add_corners(Mesh& mesh, const std::vector<Vec3>& points, const PlyValue& found, bool strips,
                 const PlyValues& values) {
  std::vector<std::size_t> corners;
  const auto close = [&] {
    if (corners.size() < 3) refuse(values.where() + "has a face of fewer than three vertices");
    if (strips) add_strip(mesh, points, corners);
    else add_polygon(mesh, points, corners);
    corners.clear();
  };
  for (const double number : found.corners) {
    if (!strips || number != -1.0) corners.push_back(ply_vertex(number, points.size(), values));
    else close();
  }
  if (!corners.empty() || !strips) close();
}

void need(const PlyElement& element, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (const PlyProperty* p = element.property(name); !p || p->count)
      refuse("the element " + in_quotes(element.name) + " has no number " + in_quotes(name));
}

void ply(std::string_view bytes, Mesh& mesh) {
  const PlyHead head = ply_head(bytes);
  PlyValues values(bytes.substr(head.size), head.lines, head.format == "ascii", head.format == "binary_big_endian");
  std::vector<Vec3> points;
  PlyValue found;
  for (const PlyElement& element : head.elements) {
    const bool vertices = element.name == "vertex", edges = element.name == "edge";
    const bool strips = element.name == "tristrips", faces = element.name == "face" || strips;
    if (vertices) need(element, {"x", "y", "z"});
    if (edges) need(element, {"vertex1", "vertex2"});
    if (faces && std::count_if(element.properties.begin(), element.properties.end(), names_corners) != 1)
      refuse("the element " + in_quotes(element.name) + " has no list \"vertex_indices\"");
    if (element.properties.empty() && element.count > 0)
      refuse("the element " + in_quotes(element.name) + " has no property");
    for (std::size_t k = 0; k < element.count; ++k) {
      read_element(values, element, found);
      if (vertices) points.push_back({found.numbers["x"], found.numbers["y"], found.numbers["z"]});
      if (faces) add_corners(mesh, points, found, strips, values);
      if (edges)
        add_segment(mesh, points[ply_vertex(found.numbers["vertex1"], points.size(), values)],
                    points[ply_vertex(found.numbers["vertex2"], points.size(), values)]);
    }
  }
  values.close();
}

}  // namespace

Mesh parse_ply(std::string_view bytes) {
  return whole([&](Mesh& mesh) { ply(without_mark(bytes), mesh); });
}

}  // namespace barchan
