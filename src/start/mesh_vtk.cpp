#include "start/mesh_vtk.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vtkCell.h>
#include <vtkDataSet.h>
#include <vtkGenericDataObjectReader.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <type_traits>

#include "base/input_file.hpp"
#include "base/memory.hpp"
#include "scene/text_table.hpp"
#include "start/mesh_parts.hpp"
#include "start/mesh_solid.hpp"

namespace barchan {

using namespace mesh;

namespace {

// What the child may take. Numbers of a damaged file can ask for any amount of both. VTK reads text at some 10 MB/s and
// holds some 10 bytes for each byte of text, of compressed numbers up to a few hundred.
constexpr double least_seconds = 10.0, seconds_a_byte = 1e-6;
constexpr double least_memory = 1e9, memory_a_byte = 500.0;
constexpr const char* unreadable = "cannot be read as what its name says it is";

/// Hears VTK's complaints and keeps them off the terminal: the scene's message tells what is wrong.
class Listener : public vtkOutputWindow {
 public:
  static Listener* New();
  vtkTypeMacro(Listener, vtkOutputWindow)  // a whole function
      void DisplayText(const char*) override {}
  void DisplayErrorText(const char*) override { heard = true; }
  void DisplayWarningText(const char*) override {}
  bool heard = false;
};
Listener* Listener::New() { VTK_STANDARD_NEW_BODY(Listener); }

void take_cells(vtkDataSet& data, const Part& part, Mesh& mesh) {
  vtkNew<vtkIdList> ids;
  std::vector<std::size_t> order;
  for (vtkIdType k = 0; k < data.GetNumberOfCells(); ++k) {
    if (!part.has(k)) continue;
    const std::vector<Vec3> corners = corners_of_cell(data, k, *ids);
    order.resize(corners.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto least = [&](std::size_t wanted) {
      if (corners.size() < wanted) refuse("cell " + std::to_string(k) + " has too few points");
    };
    switch (data.GetCellType(k)) {
      case VTK_LINE:
      case VTK_POLY_LINE:
        least(2);
        for (std::size_t i = 0; i + 1 < corners.size(); ++i) add_segment(mesh, corners[i], corners[i + 1]);
        break;
      case VTK_TRIANGLE_STRIP:
        least(3);
        add_strip(mesh, corners, order);
        break;
      case VTK_PIXEL:  // its corners go to and fro, not around
        least(4);
        std::swap(order[2], order[3]);
        [[fallthrough]];
      case VTK_TRIANGLE:
      case VTK_QUAD:
      case VTK_POLYGON:
        least(3);
        add_polygon(mesh, corners, order);
        break;
      case VTK_QUADRATIC_EDGE:
      case VTK_QUADRATIC_TRIANGLE:
      case VTK_QUADRATIC_QUAD:
      case VTK_BIQUADRATIC_QUAD: refuse("has curved cells; expected triangles, polygons or lines"); break;
      default: break;  // points bound nothing
    }
  }
}

/// The text of a file of XML, with white space before raw appended data: VTK 9.1 and 9.2 do not find these where their
/// parser is a later expat (output/whole_file.hpp).
std::string padded_text(const std::string& path) {
  constexpr std::size_t padding = 8192;  // two reads of the parser
  std::string text = read_input(path);
  const std::size_t tag = text.find("<AppendedData");
  const std::size_t close = tag == std::string::npos ? tag : text.find('>', tag);
  if (close != std::string::npos) text.insert(close + 1, padding, ' ');
  return text;
}

template <class Reader>
void read_with(const std::string& path, int part, Mesh& mesh, const Listener& listener) {
  vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  std::string text;
  if constexpr (std::is_same_v<Reader, vtkGenericDataObjectReader>) {  // it does not pass over a byte-order mark
    text = read_input(path);
    if (const std::string_view plain = without_mark(text); plain.size() < text.size()) {
      reader->ReadFromInputStringOn();
      reader->SetBinaryInputString(plain.data(), static_cast<int>(plain.size()));
    }
  }
  if constexpr (std::is_base_of_v<vtkXMLReader, Reader>) {
    reader->ReadFromInputStringOn();
    reader->SetInputString(padded_text(path));
  }
  reader->Update();
  auto* data = vtkDataSet::SafeDownCast(reader->GetOutputDataObject(0));
  if (!data || reader->GetErrorCode() != 0 || listener.heard) refuse(unreadable);
  const Part wanted(*data, part);
  if (has_solid_cells(*data, wanted)) take_border(*data, wanted, mesh);
  else take_cells(*data, wanted, mesh);
}

Mesh read_here(const std::string& path, const std::string& suffix, int part) {
  return whole([&](Mesh& mesh) {
    vtkNew<Listener> listener;
    vtkOutputWindow::SetInstance(listener);
    if (suffix == ".vtp") read_with<vtkXMLPolyDataReader>(path, part, mesh, *listener);
    else if (suffix == ".vtu") read_with<vtkXMLUnstructuredGridReader>(path, part, mesh, *listener);
    else read_with<vtkGenericDataObjectReader>(path, part, mesh, *listener);
  });
}

bool send(int to, const void* data, std::size_t size) {
  const char* from = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = write(to, from, size);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    from += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool send_mesh(int to, const Mesh& mesh) {
  const std::size_t sizes[3] = {mesh.triangles.size(), mesh.segments.size(), mesh.problem.size()};
  return send(to, sizes, sizeof sizes) && send(to, mesh.triangles.data(), sizes[0] * sizeof(Facet)) &&
         send(to, mesh.segments.data(), sizes[1] * sizeof(Facet)) && send(to, mesh.problem.data(), sizes[2]);
}

void limit(__rlimit_resource what, double most) {
  const auto value = static_cast<rlim_t>(most);
  const rlimit both{value, value};
  setrlimit(what, &both);
}

/// Bounds of time and memory that follow from the size of the file; the child ends with its parent.
void bound_the_child(pid_t parent, const std::string& path) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it has ended already
  std::error_code unseen;
  const auto size = static_cast<double>(std::filesystem::file_size(path, unseen));
  const double bytes = unseen ? 0.0 : size;
  limit(RLIMIT_CORE, 0.0);
  limit(RLIMIT_CPU, std::ceil(least_seconds + seconds_a_byte * bytes));
  limit(RLIMIT_AS, mapped_memory() + least_memory + memory_a_byte * bytes);
}

/// What the child does: nothing that it damages or prints reaches the program.
[[noreturn]] void be_the_child(int to, const std::string& path, const std::string& suffix, int part) {
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGXCPU})
    std::signal(signal, SIG_DFL);
  bool sent = false;
  try {
    sent = send_mesh(to, read_here(path, suffix, part));
  } catch (...) {}  // no memory, for one: the status tells
  _exit(sent ? 0 : 1);
}

std::string receive_all(int from) {
  std::string all;
  std::vector<char> part(std::size_t{1} << 16);
  while (true) {
    const ssize_t count = read(from, part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return all;
    all.append(part.data(), static_cast<std::size_t>(count));
  }
}

Mesh unpacked(const std::string& bytes) {
  Mesh mesh;
  std::size_t sizes[3] = {};
  if (bytes.size() < sizeof sizes) return {{}, {}, unreadable};
  std::memcpy(sizes, bytes.data(), sizeof sizes);
  if (bytes.size() != sizeof sizes + (sizes[0] + sizes[1]) * sizeof(Facet) + sizes[2]) return {{}, {}, unreadable};
  const char* from = bytes.data() + sizeof sizes;
  for (auto* facets : {&mesh.triangles, &mesh.segments}) {
    facets->resize(facets == &mesh.triangles ? sizes[0] : sizes[1]);
    if (!facets->empty()) std::memcpy(static_cast<void*>(facets->data()), from, facets->size() * sizeof(Facet));
    from += facets->size() * sizeof(Facet);
  }
  mesh.problem.assign(from, sizes[2]);
  return mesh;
}

}  // namespace

Mesh read_vtk_mesh(const std::string& path, const std::string& suffix, int part) {
  int ends[2];
  if (pipe(ends) != 0) return {{}, {}, "cannot be read: " + std::string(std::strerror(errno))};
  const pid_t parent = getpid(), child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    return {{}, {}, "cannot be read: " + std::string(std::strerror(errno))};
  }
  if (child == 0) {
    close(ends[0]);
    bound_the_child(parent, path);
    be_the_child(ends[1], path, suffix, part);
  }
  close(ends[1]);
  const std::string bytes = receive_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return {{}, {}, unreadable};
  return unpacked(bytes);
}

// --- numbers of text
// ----------------------------------------------------------------------------------------------------

namespace {

/// VTK takes what begins like a number for one, and what does not for the end of the array.
std::string wrong_number(std::string_view text) {
  for (const std::string_view word : split_words(text, " \t\r\n\f\v"))
    if (!coordinate_of(word)) return "has " + in_quotes(word) + " where a number is expected";
  return "";
}

/// VTK makes room for as many components as an array says, however few numbers follow.
std::string wrong_components(std::string_view head) {
  constexpr std::string_view key = "NumberOfComponents=\"";
  constexpr std::size_t most = 1000;
  const std::size_t at = head.find(key);
  if (at == std::string_view::npos) return "";
  const std::string_view value = head.substr(at + key.size(), head.find('"', at + key.size()) - at - key.size());
  const auto count = number_of<std::size_t>(value);
  if (count && *count <= most) return "";
  return "has an array of " + in_quotes(value) + " components; expected at most " + std::to_string(most);
}

/// Every number of points, cells and corners that a line of a legacy file states needs a byte at least.
std::string wrong_counts(const std::vector<std::string_view>& words, std::size_t bytes, std::size_t line) {
  for (std::size_t k = 1; k < words.size(); ++k)
    if (const auto count = number_of<double>(words[k]); count && !(*count <= static_cast<double>(bytes)))
      return "line " + std::to_string(line) + " states " + in_quotes(words[k]) + " numbers in a file of " +
             std::to_string(bytes) + " bytes";
  return "";
}

std::string wrong_in_xml(std::string_view text) {
  for (std::size_t at = text.find("<DataArray"); at != std::string_view::npos; at = text.find("<DataArray", at)) {
    const std::size_t open = text.find('>', at);
    if (open == std::string_view::npos) return "";
    const std::string_view head = text.substr(at, open - at);
    at = open;
    if (std::string problem = wrong_components(head); !problem.empty()) return problem;
    if (head.find("format=\"ascii\"") == std::string_view::npos || head.ends_with('/') ||
        head.find("type=\"String\"") != std::string_view::npos)
      continue;
    const std::string_view numbers = text.substr(open + 1, text.find('<', open) - open - 1);
    if (std::string problem = wrong_number(numbers); !problem.empty()) return problem;
  }
  return "";
}

std::string wrong_in_legacy(std::string_view text) {
  Lines lines(text);
  if (!lines.next() || !lines.next() || !lines.next() ||
      split_words(lines.line()) != std::vector<std::string_view>{"ASCII"})
    return "";
  bool numbers = false;
  while (lines.next_with_words()) {
    const auto words = split_words(lines.line());
    static constexpr std::string_view of_cells[] = {"POINTS",   "POLYGONS", "LINES",        "TRIANGLE_STRIPS", "CELLS",
                                                    "VERTICES", "OFFSETS",  "CONNECTIVITY", "CELL_TYPES"};
    if (words[0] == "POINT_DATA" || words[0] == "CELL_DATA") return "";  // nothing is read behind it
    if (std::find(std::begin(of_cells), std::end(of_cells), words[0]) != std::end(of_cells)) {
      numbers = true;
      if (std::string problem = wrong_counts(words, text.size(), lines.number()); !problem.empty()) return problem;
    } else if (words[0] == "METADATA" || words[0] == "FIELD") {
      numbers = false;
    } else if (numbers) {
      if (std::string problem = wrong_number(lines.line()); !problem.empty())
        return "line " + std::to_string(lines.number()) + " " + problem;
    }
  }
  return "";
}

}  // namespace

std::string wrong_number_of_vtk(std::string_view text, const std::string& suffix) {
  return suffix == ".vtk" ? wrong_in_legacy(text) : wrong_in_xml(text);
}

}  // namespace barchan
