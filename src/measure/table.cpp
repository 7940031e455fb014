// VTK's XML files are written here by hand: a few plain arrays behind one another, uncompressed, which needs no more
// than their offsets. Numbers are the averages bit for bit; nan stays nan.
#include "measure/table.hpp"

#include <cstdint>
#include <cstring>

#include "output/numbers.hpp"
#include "output/whole_file.hpp"

namespace barchan {
namespace {

/// Components of a field that the .csv has.
int written_components(const Table& table, const FrameField& field) {
  return field.components == 3 ? table.dimensions : field.components;
}

/// A VTK XML file: elements that refer to arrays, then the arrays, each behind its length in bytes.
class XmlFile {
 public:
  explicit XmlFile(const std::string& type) : type_(type) {}

  void line(const std::string& text) { head_ += text + "\n"; }

  template <class T>
  void array(const std::string& name, int components, const std::vector<T>& values, const std::string& more = "") {
    const char* type = std::is_same_v<T, double> ? "Float64" : "Int64";
    line("<DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\" " + more + "format=\"appended\" offset=\"" + std::to_string(data_.size()) +
         "\"/>");
    const std::uint64_t bytes = values.size() * sizeof(T);
    append(&bytes, sizeof bytes);
    append(values.data(), bytes);
  }

  /// VTK reads an array of strings as their characters' numbers, a zero behind each string.
  void strings(const std::string& name, const std::vector<std::string>& lines) {
    std::string codes;
    for (const auto& text : lines) {
      for (const char c : text) codes += std::to_string(static_cast<unsigned char>(c)) + " ";
      codes += "0 ";
    }
    line("<DataArray type=\"String\" Name=\"" + name + "\" NumberOfTuples=\"" + std::to_string(lines.size()) +
         "\" format=\"ascii\">" + codes + "</DataArray>");
  }

  void write(const std::filesystem::path& file) const {
    WholeFile whole(file);
    whole.write("<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type_ +
                "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n" + head_ +
                "<AppendedData encoding=\"raw\">\n" + std::string(appended_padding, ' ') + "_");
    whole.write(data_);
    whole.write("\n</AppendedData>\n</VTKFile>\n");
    whole.publish();
  }

 private:
  void append(const void* bytes, std::size_t count) { data_.append(static_cast<const char*>(bytes), count); }

  std::string type_, head_, data_;
};

void add_about(XmlFile& xml, const Table& table) {
  std::vector<std::string> units;
  for (const auto& field : table.fields)
    units.push_back(field.unit.empty() ? field.name : field.name + " " + field.unit);
  xml.line("<FieldData>");
  xml.array("TimeValue", 1, std::vector<double>{table.time}, "NumberOfTuples=\"1\" ");
  xml.array("moments", 1, std::vector<std::int64_t>{table.moments}, "NumberOfTuples=\"1\" ");
  xml.strings("units", units);
  xml.line("</FieldData>");
}

void add_fields(XmlFile& xml, const Table& table) {
  xml.line("<PointData>");
  for (const auto& field : table.fields) xml.array(field.name, field.components, field.values);
  xml.line("</PointData>");
}

std::string three(const Vec3& v) { return exact(v[0]) + " " + exact(v[1]) + " " + exact(v[2]); }

}  // namespace

std::vector<std::string> csv_columns(const Table& table) {
  std::vector<std::string> columns;
  for (int d = 0; d < table.dimensions; ++d) columns.push_back(std::string(1, "xyz"[d]) + " [m]");
  for (const auto& field : table.fields) {
    const std::string unit = field.unit.empty() ? "" : " [" + field.unit + "]";
    if (field.components == 1) columns.push_back(field.name + unit);
    else
      for (int c = 0; c < written_components(table, field); ++c) columns.push_back(field.name + "_" + "xyz"[c] + unit);
  }
  return columns;
}

void write_csv(const std::filesystem::path& file, const Table& table) {
  std::string text;
  for (const auto& column : csv_columns(table)) text += (text.empty() ? "" : ",") + column;
  text += '\n';
  for (std::size_t row = 0; row < table.places.size(); ++row) {
    for (int d = 0; d < table.dimensions; ++d)
      text += (d > 0 ? "," : "") + exact(table.places[row][static_cast<std::size_t>(d)]);
    for (const auto& field : table.fields)
      for (int c = 0; c < written_components(table, field); ++c)
        text +=
            "," + exact(field.values[row * static_cast<std::size_t>(field.components) + static_cast<std::size_t>(c)]);
    text += '\n';
  }
  write_whole_file(file, text);
}

void write_polyline(const std::filesystem::path& file, const Table& table) {
  const std::size_t n = table.places.size();
  std::vector<double> points;
  std::vector<std::int64_t> connectivity;
  for (std::size_t k = 0; k < n; ++k) {
    points.insert(points.end(), table.places[k].begin(), table.places[k].end());
    connectivity.push_back(static_cast<std::int64_t>(k));
  }
  XmlFile xml("PolyData");
  xml.line("<PolyData>");
  add_about(xml, table);
  xml.line("<Piece NumberOfPoints=\"" + std::to_string(n) +
           "\" NumberOfVerts=\"0\" NumberOfLines=\"1\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">");
  add_fields(xml, table);
  xml.line("<Points>");
  xml.array("Points", 3, points);
  xml.line("</Points>\n<Lines>");
  xml.array("connectivity", 1, connectivity);
  xml.array("offsets", 1, std::vector<std::int64_t>{static_cast<std::int64_t>(n)});
  xml.line("</Lines>\n</Piece>\n</PolyData>");
  xml.write(file);
}

void write_image(const std::filesystem::path& file, const Table& table) {
  std::string extent;
  for (const std::size_t n : table.count) extent += (extent.empty() ? "0 " : " 0 ") + std::to_string(n - 1);
  XmlFile xml("ImageData");
  xml.line("<ImageData WholeExtent=\"" + extent + "\" Origin=\"" + three(table.places.front()) + "\" Spacing=\"" +
           three(table.step) + "\">");
  add_about(xml, table);
  xml.line("<Piece Extent=\"" + extent + "\">");
  add_fields(xml, table);
  xml.line("</Piece>\n</ImageData>");
  xml.write(file);
}

}  // namespace barchan
