// One frame to a file through VTK's XML writers, and back: frame_read.cpp reads what is written here, VTK's readers
// what other programs write into the XML itself.
//
// .vtp and .vtu hold the same arrays and one vertex cell a particle, which is what ParaView draws without a filter.
// They differ in two ways, both for meshio's sake, which reads .vtu but neither LZ4 nor arrays of strings:
//
//           compressor    phase_names and units
//   .vtp    LZ4           vtkStringArray, one value a line
//   .vtu    zlib, 1       UInt8, the lines as UTF-8 text with a newline between
#include <vtkCellArray.h>
#include <vtkCommand.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkFieldData.h>
#include <vtkIdTypeArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkTypeTraits.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

#include "base/errors.hpp"
#include "base/input_file.hpp"
#include "output/frame_read.hpp"
#include "output/pieces.hpp"
#include "output/series.hpp"
#include "output/whole_file.hpp"

namespace barchan {
namespace {

static_assert(sizeof(vtkIdType) == sizeof(std::int64_t), "global ids are 64 bits wide: VTK_USE_64BIT_IDS");

using Lines = std::vector<std::string>;

/// Keeps the first error that a VTK object reports, which VTK would otherwise print.
class FirstError : public vtkCommand {
 public:
  static FirstError* New() { return new FirstError; }
  void Execute(vtkObject*, unsigned long, void* text) override {
    if (!happened && text) message = static_cast<const char*>(text);
    happened = true;
  }
  bool happened = false;
  std::string message;
};

/// Errors of `algorithm` go to `error`. Its executive's only repeat that something failed, so they go nowhere.
void listen(vtkAlgorithm* algorithm, FirstError* error) {
  algorithm->AddObserver(vtkCommand::ErrorEvent, error);
  algorithm->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, vtkNew<FirstError>());
}

/// VTK's messages name a source file and an object's address on lines of their own; the last line says what happened.
std::string last_line(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  const auto line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

/// A whole file ends with its closing tag (and white space). This finds every truncation, which VTK's readers do not.
bool has_its_end(const InputFile& file) {
  std::string tail(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), 64)), '\0');
  tail.resize(file.read(file.size() - tail.size(), tail.data(), tail.size()));
  while (!tail.empty() && std::isspace(static_cast<unsigned char>(tail.back()))) tail.pop_back();
  return tail.ends_with("</VTKFile>");
}

bool has_its_end(const std::filesystem::path& file) {
  try {
    return has_its_end(InputFile(file));
  } catch (const InputError&) { return false; }
}

// ---- writing --------------------------------------------------------------------------------------------------------

/// A VTK array that looks at our memory: nothing is copied, VTK neither changes nor frees it.
template <class Array, class T>
vtkSmartPointer<Array> view(const char* name, const std::vector<T>& values, int components) {
  using Value = typename Array::ValueType;
  static_assert(sizeof(Value) == sizeof(T));
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetArray(reinterpret_cast<Value*>(const_cast<T*>(values.data())), static_cast<vtkIdType>(values.size()),
                  /*save=*/1);
  return array;
}

void add_domain(vtkFieldData* to, const std::array<double, 6>& domain) {
  vtkNew<vtkDoubleArray> array;
  array->SetName("domain");
  for (const double bound : domain) array->InsertNextValue(bound);
  to->AddArray(array);
}

template <class Array, class T>
void add_value(vtkFieldData* to, const char* name, T value) {
  vtkNew<Array> array;
  array->SetName(name);
  array->InsertNextValue(value);
  to->AddArray(array);
}

void add_lines(vtkFieldData* to, const char* name, const Lines& lines, FrameFormat format) {
  if (format == FrameFormat::vtp) {
    vtkNew<vtkStringArray> array;
    array->SetName(name);
    for (const auto& line : lines) array->InsertNextValue(line);
    to->AddArray(array);
  } else {
    vtkNew<vtkUnsignedCharArray> array;
    array->SetName(name);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (k > 0) array->InsertNextValue('\n');
      for (const char c : lines[k]) array->InsertNextValue(static_cast<unsigned char>(c));
    }
    to->AddArray(array);
  }
}

void check_shape(const Frame& frame) {
  const std::size_t n = frame.size();
  bool fits = frame.points.size() == 3 * n && frame.phase.size() == n;
  for (const auto& field : frame.fields)
    fits = fits && field.components > 0 && field.values.size() == n * static_cast<std::size_t>(field.components);
  if (!fits) throw std::logic_error("a frame's arrays must have one entry a particle");
}

Lines unit_lines(const Frame& frame) {
  Lines lines{"position m", "TimeValue s"};
  for (const auto* fields : {&frame.fields, &frame.contacts})
    for (const auto& field : *fields) lines.push_back(field.unit.empty() ? field.name : field.name + " " + field.unit);
  return lines;
}

/// Points, arrays and field data, the same for both formats.
void fill(vtkPointSet* data, const Frame& frame, FrameFormat format) {
  vtkNew<vtkPoints> points;
  points->SetData(view<vtkDoubleArray>("Points", frame.points, 3));
  data->SetPoints(points);

  vtkPointData* arrays = data->GetPointData();
  arrays->SetGlobalIds(view<vtkIdTypeArray>("id", frame.id, 1));
  arrays->AddArray(view<vtkIntArray>("phase", frame.phase, 1));
  for (const auto& field : frame.fields) {
    auto array = view<vtkDoubleArray>(field.name.c_str(), field.values, field.components);
    if (field.components == 6) {
      static constexpr std::array names{"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
      for (int c = 0; c < 6; ++c) array->SetComponentName(c, names[static_cast<std::size_t>(c)]);
    }
    arrays->AddArray(array);
  }

  vtkFieldData* about = data->GetFieldData();
  add_value<vtkDoubleArray>(about, "TimeValue", frame.time);
  add_value<vtkTypeInt64Array>(about, "step", static_cast<vtkTypeInt64>(frame.step));
  add_value<vtkIntArray>(about, "frame", frame.index);
  add_domain(about, frame.domain);
  for (const auto& field : frame.contacts)
    about->AddArray(view<vtkDoubleArray>(field.name.c_str(), field.values, field.components));
  add_lines(about, "phase_names", frame.phase_names, format);
  add_lines(about, "phase_kinds", frame.phase_kinds, format);
  add_lines(about, "units", unit_lines(frame), format);
}

/// One vertex a particle: point k is cell k.
vtkSmartPointer<vtkCellArray> vertices(std::size_t n) {
  vtkNew<vtkTypeInt32Array> offsets, points;
  if (n >= static_cast<std::size_t>(VTK_INT_MAX)) throw std::logic_error("a frame holds at most 2^31 - 2 particles");
  offsets->SetNumberOfValues(static_cast<vtkIdType>(n) + 1);
  points->SetNumberOfValues(static_cast<vtkIdType>(n));
  std::iota(offsets->GetPointer(0), offsets->GetPointer(0) + n + 1, 0);
  std::iota(points->GetPointer(0), points->GetPointer(0) + n, 0);
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(offsets.Get(), points.Get());
  return cells;
}

/// A writer of VTK's, with white space before its appended data (appended_padding).
template <class Writer>
class Padded : public Writer {
 public:
  static Padded* New() {
    auto* made = new Padded;
    made->InitializeObjectBase();
    return made;
  }

 protected:
  int WriteHeader() override {  // ends with the "_" behind which VTK counts the places of arrays
    if (Writer::WriteHeader() == 0) return 0;
    this->Stream->seekp(-1, std::ios::cur);
    *this->Stream << std::string(appended_padding, ' ') << '_';
    this->AppendedDataPosition = this->Stream->tellp();
    return this->Stream->good() ? 1 : 0;
  }
};

void run(vtkXMLWriter* writer, vtkPointSet* data, WholeFile& file, FrameFormat format, bool compress) {
  writer->SetInputData(data);
  writer->SetFileName(file.temporary().c_str());
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetHeaderTypeToUInt64();
  if (!compress) {
    writer->SetCompressorTypeToNone();
  } else if (format == FrameFormat::vtp) {
    writer->SetCompressorTypeToLZ4();
  } else {
    writer->SetCompressorTypeToZLib();
    writer->SetCompressionLevel(1);
  }
  vtkNew<FirstError> error;
  listen(writer, error);
  const bool written = writer->Write() != 0;
  if (written && !error->happened && writer->GetErrorCode() == vtkErrorCode::NoError && has_its_end(file.temporary()))
    return;
  std::string reason = last_line(error->message);
  if (reason.empty()) reason = "error code " + std::to_string(writer->GetErrorCode());
  throw OutputError(file.why_it_failed("VTK says: " + reason));
}

// ---- reading --------------------------------------------------------------------------------------------------------

bool is_64_bit_integer(vtkDataArray* array) {
  const int type = array->GetDataType();
  return array->GetDataTypeSize() == 8 && (type == VTK_ID_TYPE || type == VTK_LONG || type == VTK_LONG_LONG);
}

/// The numbers of an array bit for bit where it has the type T, converted (through double) where another program wrote
/// another type. The three names that VTK has for a 64-bit integer are one type here.
template <class T>
std::vector<T> values_of(vtkDataArray* array) {
  std::vector<T> values(static_cast<std::size_t>(array->GetNumberOfValues()));
  if (array->GetDataType() == vtkTypeTraits<T>::VTK_TYPE_ID ||
      (std::is_same_v<T, std::int64_t> && is_64_bit_integer(array))) {
    std::copy_n(static_cast<const T*>(array->GetVoidPointer(0)), values.size(), values.begin());
  } else {
    const auto components = static_cast<std::size_t>(array->GetNumberOfComponents());
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] =
          static_cast<T>(array->GetComponent(static_cast<vtkIdType>(k / components), static_cast<int>(k % components)));
  }
  return values;
}

Lines lines_of(vtkFieldData* about, const char* name) {
  Lines lines;
  vtkAbstractArray* array = about->GetAbstractArray(name);
  if (auto* strings = vtkArrayDownCast<vtkStringArray>(array)) {
    for (vtkIdType k = 0; k < strings->GetNumberOfValues(); ++k) lines.push_back(strings->GetValue(k));
  } else if (auto* text = vtkArrayDownCast<vtkUnsignedCharArray>(array); text && text->GetNumberOfValues() > 0) {
    lines.emplace_back();
    for (vtkIdType k = 0; k < text->GetNumberOfValues(); ++k)
      if (const char c = static_cast<char>(text->GetValue(k)); c == '\n') lines.emplace_back();
      else lines.back() += c;
  }
  return lines;
}

Frame frame_of(vtkPointSet* data) {
  Frame frame;
  vtkFieldData* about = data->GetFieldData();
  const auto one = [&](const char* name) {
    vtkDataArray* array = about->GetArray(name);
    if (array && array->GetNumberOfValues() != 1) throw OutputError("array '" + std::string(name) + "' is incomplete");
    return array;
  };
  if (auto* time = one("TimeValue")) frame.time = time->GetComponent(0, 0);
  if (auto* step = one("step")) frame.step = values_of<std::int64_t>(step).at(0);
  if (auto* index = one("frame")) frame.index = values_of<int>(index).at(0);
  if (auto* domain = about->GetArray("domain"); domain && domain->GetNumberOfValues() == 6)
    std::ranges::copy(values_of<double>(domain), frame.domain.begin());
  frame.phase_names = lines_of(about, "phase_names");
  frame.phase_kinds = lines_of(about, "phase_kinds");
  const Lines units = lines_of(about, "units");

  for (int k = 0; k < about->GetNumberOfArrays(); ++k)
    if (vtkDataArray* array = about->GetArray(k);
        array && array->GetName() && std::string_view(array->GetName()).starts_with(contact_arrays))
      frame.contacts.push_back({array->GetName(), unit_of(array->GetName(), units), array->GetNumberOfComponents(),
                                values_of<double>(array)});

  const vtkIdType n = data->GetNumberOfPoints();
  if (n > 0) frame.points = values_of<double>(data->GetPoints()->GetData());
  vtkPointData* arrays = data->GetPointData();
  for (int k = 0; k < arrays->GetNumberOfArrays(); ++k) {
    vtkDataArray* array = arrays->GetArray(k);
    if (!array || !array->GetName()) continue;
    const std::string name = array->GetName();
    if (array->GetNumberOfTuples() != n) throw OutputError("array '" + name + "' is incomplete");
    if (name == "id") frame.id = values_of<std::int64_t>(array);
    else if (name == "phase") frame.phase = values_of<std::int32_t>(array);
    else frame.fields.push_back({name, unit_of(name, units), array->GetNumberOfComponents(), values_of<double>(array)});
  }
  for (const char* name : {"id", "phase"})
    if (n > 0 && !arrays->HasArray(name)) throw OutputError("no array '" + std::string(name) + "'");
  return frame;
}

template <class Reader>
Frame read_with(const std::filesystem::path& file) {
  vtkNew<Reader> reader;
  vtkNew<FirstError> error;
  listen(reader, error);
  reader->SetReaderErrorObserver(error);
  reader->SetParserErrorObserver(error);
  reader->SetFileName(file.c_str());
  reader->Update();
  if (error->happened) throw OutputError("VTK says: " + last_line(error->message));
  if (reader->GetErrorCode() != vtkErrorCode::NoError)
    throw OutputError("VTK says: error code " + std::to_string(reader->GetErrorCode()));
  return frame_of(reader->GetOutput());
}

}  // namespace

void write_frame(const std::filesystem::path& file, const Frame& frame, FrameFormat format, bool compress) {
  check_shape(frame);
  WholeFile whole(file);
  try {
    if (format == FrameFormat::vtp) {
      vtkNew<vtkPolyData> data;
      fill(data, frame, format);
      data->SetVerts(vertices(frame.size()));
      run(vtkNew<Padded<vtkXMLPolyDataWriter>>(), data, whole, format, compress);
    } else {
      vtkNew<vtkUnstructuredGrid> data;
      fill(data, frame, format);
      data->SetCells(VTK_VERTEX, vertices(frame.size()));
      run(vtkNew<Padded<vtkXMLUnstructuredGridWriter>>(), data, whole, format, compress);
    }
  } catch (const OutputError& e) { throw OutputError("cannot write '" + file.string() + "': " + e.what()); }
  whole.publish();
}

Frame read_frame(const std::filesystem::path& file) {
  const auto fail = [&](const std::string& reason) {
    throw OutputError("cannot read '" + file.string() + "': " + reason);
  };
  try {
    const InputFile open(file);
    if (is_list_of_pieces(file)) return read_pieces(file);
    const auto suffix = file.extension();
    if (suffix != ".vtp" && suffix != ".vtu") fail("a frame's name ends in .vtp or .vtu (in pieces: .pvtp, .pvtu)");
    if (!has_its_end(open)) fail("the file is incomplete");
    try {
      if (auto frame = read_appended(open.text(), suffix)) return std::move(*frame);
      return suffix == ".vtp" ? read_with<vtkXMLPolyDataReader>(file) : read_with<vtkXMLUnstructuredGridReader>(file);
    } catch (const OutputError& e) { fail(e.what()); }
  } catch (const InputError& e) { fail(e.reason()); }
  return {};
}

}  // namespace barchan
