// Reads a frame whose arrays are appended as raw bytes, which is how Barchan and ParaView write them.
//
// A file may be damaged in any way, so nothing in it is believed before it was compared with the size of the file: the
// place of each array, the sizes of its blocks (VTK's XML file formats: number of blocks, size of a block, size of the
// last one if it is shorter, compressed sizes), its type, components and length.
#include <vtkCommand.h>
#include <vtkLZ4DataCompressor.h>
#include <vtkNew.h>
#include <zlib.h>

#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>

#include "base/errors.hpp"
#include "output/frame_read.hpp"
#include "output/whole_file.hpp"
#include "output/xml_tags.hpp"

namespace barchan {
namespace {

/// No compressor that is read here makes data smaller than this part of what they were (zlib, 1:1032).
constexpr std::uint64_t most_compression = 1100;
constexpr std::size_t longest_name = 200;  // characters

enum class Compressor { none, lz4, zlib };

struct Array {
  std::string section, name, type;
  std::uint64_t components = 1, tuples = 0, offset = 0;
  bool has_tuples = false;
};

struct Head {
  Compressor compressor = Compressor::none;
  std::size_t width = 4;  // bytes of a number in the heads of blocks
  std::uint64_t points = 0, cells = 0;
  int pieces = 0;
  std::vector<Array> arrays;
};

[[noreturn]] void refuse_file(const std::string& what) { throw OutputError(what); }

std::uint64_t whole_number(const XmlTags::Tag& tag, std::string_view name, std::uint64_t otherwise,
                           std::uint64_t most) {
  const auto found = tag.attributes.find(name);
  if (found == tag.attributes.end()) return otherwise;
  std::string_view text = found->second;
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  std::uint64_t value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size() || value > most)
    refuse_file(std::string(name) + "=\"" + std::string(text.substr(0, 40)) + "\" is no whole number from 0 to " +
                std::to_string(most));
  return value;
}

std::string word(const XmlTags::Tag& tag, std::string_view name, const std::string& otherwise) {
  const auto found = tag.attributes.find(name);
  if (found == tag.attributes.end()) return otherwise;
  if (found->second.size() > longest_name) refuse_file("the attribute " + std::string(name) + " is too long");
  return found->second;
}

void read_file_tag(const XmlTags::Tag& tag, Head& head, const std::string& suffix) {
  const std::string type = word(tag, "type", ""), order = word(tag, "byte_order", ""),
                    numbers = word(tag, "header_type", "UInt32"), compressor = word(tag, "compressor", "");
  if (type != (suffix == ".vtp" ? "PolyData" : "UnstructuredGrid"))
    refuse_file("its type \"" + type + "\" is not that of " + suffix);
  if (order != "LittleEndian") refuse_file("its byte order \"" + order + "\" is not LittleEndian");
  if (numbers != "UInt32" && numbers != "UInt64") refuse_file("its header_type \"" + numbers + "\" is not known");
  head.width = numbers == "UInt64" ? 8 : 4;
  if (compressor == "vtkLZ4DataCompressor") head.compressor = Compressor::lz4;
  else if (compressor == "vtkZLibDataCompressor") head.compressor = Compressor::zlib;
  else if (!compressor.empty()) refuse_file("its compressor \"" + compressor + "\" is not known");
}

bool is_known(const XmlTags::Tag& tag) {
  static const std::map<std::string_view, std::vector<std::string_view>> known{
      {"VTKFile", {"type", "version", "byte_order", "header_type", "compressor"}},
      {"PolyData", {}},
      {"UnstructuredGrid", {}},
      {"FieldData", {}},
      {"Piece", {"NumberOf"}},
      {"PointData", {"Scalars", "Vectors", "Normals", "Tensors", "TCoords", "GlobalIds", "PedigreeIds"}},
      {"CellData", {"Scalars", "Vectors", "Normals", "Tensors", "TCoords", "GlobalIds", "PedigreeIds"}},
      {"Points", {}},
      {"Verts", {}},
      {"Lines", {}},
      {"Strips", {}},
      {"Polys", {}},
      {"Cells", {}},
      {"DataArray",
       {"type", "IdType", "Name", "NumberOf", "ComponentName", "format", "RangeMin", "RangeMax", "offset"}},
      {"Array", {"type", "Name", "NumberOf", "format", "offset"}}};
  const auto found = known.find(tag.name);
  return found != known.end() && std::all_of(tag.attributes.begin(), tag.attributes.end(), [&](const auto& attribute) {
           return std::any_of(found->second.begin(), found->second.end(),
                              [&](std::string_view begin) { return attribute.first.starts_with(begin); });
         });
}

Array read_array(const XmlTags::Tag& tag, const std::string& section, std::uint64_t most) {
  Array array;
  array.section = section;
  array.name = word(tag, "Name", "");
  array.type = word(tag, "type", "");
  if (const std::string format = word(tag, "format", ""); format != "appended")
    refuse_file("the array \"" + array.name + "\" has the format \"" + format + "\"; expected \"appended\"");
  array.components = whole_number(tag, "NumberOfComponents", 1, most);
  array.has_tuples = tag.attributes.contains("NumberOfTuples");
  array.tuples = whole_number(tag, "NumberOfTuples", 0, most);
  array.offset = whole_number(tag, "offset", most, most);
  return array;
}

void read_piece(const XmlTags::Tag& tag, Head& head, const std::string& suffix, std::uint64_t most) {
  ++head.pieces;
  head.points = whole_number(tag, "NumberOfPoints", 0, most);
  head.cells = whole_number(tag, suffix == ".vtp" ? "NumberOfVerts" : "NumberOfCells", 0, most);
  for (const char* other : {"NumberOfLines", "NumberOfStrips", "NumberOfPolys"})
    if (whole_number(tag, other, 0, most) != 0) refuse_file("it holds other cells than vertices");
}

/// The text before the data. `most`: no count in it can be larger.
Head parse_head(std::string_view text, const std::string& suffix, std::uint64_t most) {
  for (const char c : text)
    if (const auto u = static_cast<unsigned char>(c); u >= 0x7f || (u < 0x20 && c != '\n' && c != '\t' && c != '\r'))
      refuse_file("its head holds bytes that are no text");
  Head head;
  XmlTags tags(text);
  XmlTags::Tag tag;
  std::vector<std::string> open;  // tags that are not closed yet
  while (tags.next(tag)) {
    const std::string name(tag.name);
    if (name.starts_with("/")) {
      if (open.empty() || open.back() != name.substr(1))
        refuse_file("the tag \"" + name.substr(0, 40) + "\" closes another");
      open.pop_back();
      continue;
    }
    if (!is_known(tag)) refuse_file("the tag \"" + name.substr(0, 40) + "\" or an attribute of it is not known");
    if (name == "VTKFile") read_file_tag(tag, head, suffix);
    else if (name == "Piece") read_piece(tag, head, suffix, most);
    else if (name == "DataArray" || name == "Array")
      head.arrays.push_back(read_array(tag, open.empty() ? "" : open.back(), most));
    if (!tag.alone) open.push_back(name);
  }
  if (open != std::vector<std::string>{"VTKFile"}) refuse_file("its tags do not close");  // AppendedData comes
  if (head.pieces != 1) refuse_file("it has " + std::to_string(head.pieces) + " pieces; expected 1");
  return head;
}

std::size_t width_of(const std::string& type) {
  static const std::map<std::string, std::size_t> widths{{"Int8", 1},    {"UInt8", 1},   {"Int16", 2}, {"UInt16", 2},
                                                         {"Int32", 4},   {"UInt32", 4},  {"Int64", 8}, {"UInt64", 8},
                                                         {"Float32", 4}, {"Float64", 8}, {"String", 1}};
  const auto found = widths.find(type);
  if (found == widths.end()) refuse_file("the type \"" + type + "\" is not known");
  return found->second;
}

/// The bytes of arrays behind the head.
class Appended {
 public:
  Appended(std::string_view data, const Head& head) : data_(data), head_(head) {}

  std::vector<char> bytes(const Array& array) const {
    at_ = array.offset;
    name_ = array.name;
    return head_.compressor == Compressor::none ? plain() : compressed();
  }

 private:
  [[noreturn]] void fail() const { refuse_file("array '" + name_ + "' is incomplete"); }

  std::uint64_t number() const {
    if (at_ > data_.size() || data_.size() - at_ < head_.width) fail();
    std::uint64_t value = 0;
    std::memcpy(&value, data_.data() + at_, head_.width);
    at_ += head_.width;
    return value;
  }

  std::vector<char> plain() const {
    const std::uint64_t size = number();
    if (size > data_.size() - at_) fail();
    return {data_.data() + at_, data_.data() + at_ + size};
  }

  std::vector<char> compressed() const {
    const std::uint64_t blocks = number(), size = number(), last = number(), left = data_.size() - at_;
    if (blocks > left / head_.width || last >= std::max<std::uint64_t>(size, 1) ||
        (blocks > 0 && (size == 0 || size > most_compression * left)))
      fail();
    std::vector<std::uint64_t> sizes(blocks);
    for (auto& s : sizes) s = number();
    std::vector<char> all;
    for (std::uint64_t k = 0; k < blocks; ++k) {
      const std::uint64_t out = k + 1 == blocks && last > 0 ? last : size;
      if (sizes[k] > data_.size() - at_ || out / most_compression > sizes[k]) fail();
      const std::size_t before = all.size();
      all.resize(before + out);
      if (!expand(data_.data() + at_, sizes[k], all.data() + before, out)) fail();
      at_ += sizes[k];
    }
    return all;
  }

  /// Whether the block holds exactly `out` bytes.
  bool expand(const char* from, std::uint64_t size, char* to, std::uint64_t out) const {
    const auto* source = reinterpret_cast<const unsigned char*>(from);
    auto* target = reinterpret_cast<unsigned char*>(to);
    if (head_.compressor == Compressor::zlib) {
      uLongf expanded = out;
      return uncompress(target, &expanded, source, size) == Z_OK && expanded == out;
    }
    if (size > std::numeric_limits<int>::max() || out > std::numeric_limits<int>::max()) return false;
    vtkNew<vtkLZ4DataCompressor> lz4;
    vtkNew<Silence> silence;
    lz4->AddObserver(vtkCommand::ErrorEvent, silence);
    return lz4->Uncompress(source, size, target, out) == out;
  }

  struct Silence : vtkCommand {
    static Silence* New() { return new Silence; }
    void Execute(vtkObject*, unsigned long, void*) override {}
  };

  std::string_view data_;
  const Head& head_;
  mutable std::uint64_t at_ = 0;
  mutable std::string name_;
};

template <class From, class To>
void convert(const std::vector<char>& bytes, std::vector<To>& values) {
  values.resize(bytes.size() / sizeof(From));
  for (std::size_t k = 0; k < values.size(); ++k) {
    From value;
    std::memcpy(&value, bytes.data() + k * sizeof(From), sizeof(From));
    if constexpr (std::is_integral_v<To> && std::is_floating_point_v<From>) {
      constexpr double least = -9007199254740992.0;  // 2^53: what a double tells apart
      if (!(value >= From(least) && value <= From(-least))) refuse_file("a whole number is expected");
    }
    values[k] = static_cast<To>(value);  // NOLINT(bugprone-signed-char-misuse): a number of eight bits, not a letter
  }
}

/// Values of any type of VTK's; bit for bit where it is the one asked for.
template <class To>
std::vector<To> values_of(const std::string& type, const std::vector<char>& bytes) {
  std::vector<To> values;
  if (type == "Float64") convert<double>(bytes, values);
  else if (type == "Float32") convert<float>(bytes, values);
  else if (type == "Int64") convert<std::int64_t>(bytes, values);
  else if (type == "UInt64") convert<std::uint64_t>(bytes, values);
  else if (type == "Int32") convert<std::int32_t>(bytes, values);
  else if (type == "UInt32") convert<std::uint32_t>(bytes, values);
  else if (type == "Int16") convert<std::int16_t>(bytes, values);
  else if (type == "UInt16") convert<std::uint16_t>(bytes, values);
  else if (type == "Int8") convert<std::int8_t>(bytes, values);
  else convert<std::uint8_t>(bytes, values);
  return values;
}

std::vector<std::string> lines_of(const Array& array, const std::vector<char>& bytes) {
  std::vector<std::string> lines;
  const char end = array.type == "String" ? '\0' : '\n';
  if (!bytes.empty()) lines.emplace_back();
  for (const char c : bytes)
    if (c == end) lines.emplace_back();
    else lines.back() += c;
  if (end == '\n' && array.has_tuples && array.tuples != bytes.size())
    refuse_file("array '" + array.name + "' is incomplete");
  if (end == '\0' && !lines.empty()) {  // each string has its end
    if (!lines.back().empty() || lines.size() - 1 != array.tuples)
      refuse_file("array '" + array.name + "' is incomplete");
    lines.pop_back();
  }
  return lines;
}

class FrameReader {
 public:
  FrameReader(const Head& head, const Appended& data) : head_(head), data_(data) {}

  Frame read() {
    for (const Array& array : head_.arrays)
      if (array.section == "FieldData") about(array);
    for (const Array& array : head_.arrays) {
      if (array.section == "PointData") field(array);
      else if (array.section == "Points") frame_.points = take<double>(array, head_.points, 3);
      else if (array.section == "Verts" || array.section == "Cells") vertices(array);
      else if (array.section != "FieldData" && !data_.bytes(array).empty())
        refuse_file("it holds other cells than vertices");
    }
    if (frame_.points.size() != 3 * head_.points) refuse_file("it has no points");
    if (head_.points > 0 && !has_id_) refuse_file("no array 'id'");
    if (head_.points > 0 && !has_phase_) refuse_file("no array 'phase'");
    for (FrameField& f : frame_.contacts) f.unit = unit_of(f.name, units_);
    if (head_.cells != head_.points) refuse_file("it has another number of vertices than of points");
    return std::move(frame_);
  }

 private:
  template <class To>
  std::vector<To> take(const Array& array, std::uint64_t tuples, std::uint64_t components) {
    if (array.components != components || array.type == "String" || (array.has_tuples && array.tuples != tuples))
      refuse_file("array '" + array.name + "' has another shape");
    const std::vector<char> bytes = data_.bytes(array);
    const std::size_t width = width_of(array.type);
    if (components == 0 || bytes.size() / width / components != tuples || bytes.size() != tuples * components * width)
      refuse_file("array '" + array.name + "' is incomplete");
    return values_of<To>(array.type, bytes);
  }

  void about(const Array& array) {
    if (array.name == "TimeValue") frame_.time = take<double>(array, 1, 1)[0];
    else if (array.name == "step") frame_.step = take<std::int64_t>(array, 1, 1)[0];
    else if (array.name == "frame") frame_.index = take<std::int32_t>(array, 1, 1)[0];
    else if (array.name == "domain") std::ranges::copy(take<double>(array, 6, 1), frame_.domain.begin());
    else if (array.name == "phase_names") frame_.phase_names = lines_of(array, data_.bytes(array));
    else if (array.name == "phase_kinds") frame_.phase_kinds = lines_of(array, data_.bytes(array));
    else if (array.name == "units") units_ = lines_of(array, data_.bytes(array));
    else if (array.name.starts_with(contact_arrays)) {
      if (!array.has_tuples) refuse_file("array '" + array.name + "' does not say its length");
      frame_.contacts.push_back(
          {array.name, "", static_cast<int>(array.components), take<double>(array, array.tuples, array.components)});
    }
  }

  void field(const Array& array) {
    if (array.name.empty()) refuse_file("an array has no name");
    if (array.name == "id") frame_.id = take<std::int64_t>(array, head_.points, 1), has_id_ = true;
    else if (array.name == "phase") frame_.phase = take<std::int32_t>(array, head_.points, 1), has_phase_ = true;
    else
      frame_.fields.push_back({array.name, unit_of(array.name, units_), static_cast<int>(array.components),
                               take<double>(array, head_.points, array.components)});
  }

  /// One a particle, in order: what every viewer of the file draws.
  void vertices(const Array& array) {
    const auto values = take<std::int64_t>(array, head_.cells, 1);
    const std::int64_t first = array.name == "offsets" ? 1 : 0;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (values[k] != (array.name == "types" ? 1 : static_cast<std::int64_t>(k) + first))
        refuse_file("its cells are not one vertex a particle");
  }

  const Head& head_;
  const Appended& data_;
  Frame frame_;
  std::vector<std::string> units_;
  bool has_id_ = false, has_phase_ = false;
};

}  // namespace

std::string unit_of(const std::string& field, const std::vector<std::string>& units) {
  for (const auto& line : units)
    if (line.starts_with(field + " ")) return line.substr(field.size() + 1);
  return "";
}

std::optional<Frame> read_appended(std::string_view text, const std::string& suffix) {
  const std::size_t tag = text.find("<AppendedData");
  if (tag == std::string_view::npos) return std::nullopt;
  const std::size_t close = std::min(text.find('>', tag), text.size() - 1),
                    begin = text.find_first_not_of(" \t\r\n", close + 1);
  if (begin == std::string_view::npos || text[begin] != '_' ||
      text.substr(tag, close - tag).find("encoding=\"raw\"") == std::string_view::npos)
    refuse_file("its appended data are not raw");
  const std::string_view data = text.substr(begin + 1);
  const Head head = parse_head(text.substr(0, tag), suffix, most_compression * text.size());
  const Appended appended(data, head);
  return FrameReader(head, appended).read();
}

}  // namespace barchan
