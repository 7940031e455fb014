#include "output/pieces.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <numeric>

#include "base/errors.hpp"
#include "output/series.hpp"
#include "output/whole_file.hpp"
#include "output/xml_tags.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;
using Instant = std::chrono::steady_clock::time_point;

Instant now() { return std::chrono::steady_clock::now(); }
double since(Instant begin) { return std::chrono::duration<double>(now() - begin).count(); }

const char* ending(FrameFormat format) { return format == FrameFormat::vtp ? "vtp" : "vtu"; }

std::string array_line(const std::string& type, const std::string& name, int components, const std::string& more = "") {
  std::string line = "      <PDataArray type=\"" + type + "\" Name=\"" + name + "\"" + more;
  if (components > 1) line += " NumberOfComponents=\"" + std::to_string(components) + "\"";
  return line + "/>\n";
}

std::string names_of_tensor() {
  static constexpr std::array names{"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
  std::string text;
  for (std::size_t c = 0; c < names.size(); ++c) text += " ComponentName" + std::to_string(c) + "=\"" + names[c] + "\"";
  return text;
}

/// Why `next` is no piece of the frame of `first`; "" if it is.
std::string why_apart(const Frame& first, const Frame& next) {
  if (next.step != first.step || next.index != first.index || next.time != first.time) return "is of another frame";
  if (next.phase_names != first.phase_names || next.phase_kinds != first.phase_kinds) return "has other phases";
  const auto differ = [](const FrameField& a, const FrameField& b) {
    return a.name != b.name || a.components != b.components;
  };
  if (next.fields.size() != first.fields.size()) return "has other fields";
  for (std::size_t k = 0; k < first.fields.size(); ++k)
    if (differ(first.fields[k], next.fields[k])) return "has other fields";
  return "";
}

/// STEM_0003.vtp or .vtu, with any number of digits from four on; also while it is being written.
bool is_piece_of(const std::string& stem, std::string file) {
  if (file.ends_with(WholeFile::suffix)) file.resize(file.size() - WholeFile::suffix.size());
  const fs::path path(file);
  if (path.extension() != ".vtp" && path.extension() != ".vtu") return false;
  const std::string name = path.stem().string();
  if (!name.starts_with(stem + "_")) return false;
  const std::string number = name.substr(stem.size() + 1);
  return number.size() >= 4 && number.find_first_not_of("0123456789") == std::string::npos;
}

template <class T>
void append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<std::size_t>& order, std::size_t width) {
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::size_t k : order)
    for (std::size_t c = 0; c < width; ++c) sorted.push_back(values[k * width + c]);
  values = std::move(sorted);
}

/// Particles by phase; those of a phase keep their order.
void sort_by_phase(Frame& frame) {
  std::vector<std::size_t> order(frame.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return frame.phase[a] < frame.phase[b]; });
  reorder(frame.points, order, 3);
  reorder(frame.id, order, 1);
  reorder(frame.phase, order, 1);
  for (FrameField& field : frame.fields) reorder(field.values, order, static_cast<std::size_t>(field.components));
}

}  // namespace

std::string frame_name(const std::string& stem, bool in_pieces, FrameFormat format) {
  return stem + (in_pieces ? ".p" : ".") + ending(format);
}

std::string piece_name(const std::string& stem, int piece, FrameFormat format) {
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "_%04d.", piece);
  return stem + "/" + stem + number.data() + ending(format);
}

bool is_below_its_list(const fs::path& file) {
  return !file.empty() && !file.is_absolute() && std::ranges::find(file, "..") == file.end();
}

bool is_list_of_pieces(const fs::path& file) { return file.extension() == ".pvtp" || file.extension() == ".pvtu"; }

void write_piece(const fs::path& directory, const std::string& stem, const Frame& piece, FrameFormat format,
                 bool compress) {
  const fs::path file = directory / piece_name(stem, piece.piece, format);
  make_directory(file.parent_path());
  write_frame(file, piece, format, compress);
}

void write_list_of_pieces(const fs::path& directory, const std::string& stem, const Frame& frame, FrameFormat format) {
  const std::string type = format == FrameFormat::vtp ? "PPolyData" : "PUnstructuredGrid";
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type +
                     "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <" + type +
                     " GhostLevel=\"0\">\n    <PPointData GlobalIds=\"id\">\n" +
                     array_line("Int64", "id", 1, " IdType=\"1\"") + array_line("Int32", "phase", 1);
  for (const FrameField& field : frame.fields)
    text += array_line("Float64", field.name, field.components, field.components == 6 ? names_of_tensor() : "");
  text += "    </PPointData>\n    <PPoints>\n" + array_line("Float64", "Points", 3) + "    </PPoints>\n";
  for (int k = 0; k < frame.pieces; ++k)
    text += "    <Piece Source=\"" + escape(piece_name(stem, k, format)) + "\"/>\n";
  text += "  </" + type + ">\n</VTKFile>\n";
  write_whole_file(directory / frame_name(stem, true, format), text);
}

std::vector<std::string> parse_pieces(std::string_view text) {
  std::vector<std::string> files;
  XmlTags tags(text);
  XmlTags::Tag tag;
  bool listed = false, ended = false;
  while (tags.next(tag)) {
    if (tag.name == "PPolyData" || tag.name == "PUnstructuredGrid") listed = true;
    if (tag.name == "/VTKFile") ended = true;
    if (tag.name != "Piece") continue;
    const auto source = tag.attributes.find("Source");
    if (source == tag.attributes.end()) tags.fail("a Piece needs 'Source'");
    const fs::path file(source->second);
    if (!is_below_its_list(file))
      tags.fail("Source=\"" + source->second + "\" is not a file below the folder of the list");
    if (file.extension() != ".vtp" && file.extension() != ".vtu")
      tags.fail("Source=\"" + source->second + "\" does not end in .vtp or .vtu");
    files.push_back(source->second);
  }
  if (!listed || !ended || files.empty())
    throw OutputError("it is not a whole list of pieces (a VTKFile of PPolyData or PUnstructuredGrid)");
  return files;
}

std::vector<fs::path> pieces_of(const fs::path& list) {
  const std::string text = read_text(list);
  try {
    std::vector<fs::path> files;
    for (const std::string& file : parse_pieces(text)) files.push_back(list.parent_path() / file);
    return files;
  } catch (const OutputError& e) { throw OutputError("cannot read '" + list.string() + "': " + e.what()); }
}

Frame read_pieces(const fs::path& list) {
  const std::vector<fs::path> files = pieces_of(list);
  Frame all = read_frame(files.front());
  for (std::size_t k = 1; k < files.size(); ++k) {
    const Frame next = read_frame(files[k]);
    if (const std::string why = why_apart(all, next); !why.empty())
      throw OutputError("cannot read '" + list.string() + "': " + files[k].string() + " " + why + " than " +
                        files.front().string());
    append(all.points, next.points);
    append(all.id, next.id);
    append(all.phase, next.phase);
    for (std::size_t f = 0; f < all.fields.size(); ++f) append(all.fields[f].values, next.fields[f].values);
  }
  sort_by_phase(all);
  all.in_pieces = true;
  all.pieces = static_cast<int>(files.size());
  return all;
}

bool is_folder_of_pieces(const fs::path& path) {
  std::error_code failed;
  return fs::symlink_status(path, failed).type() == fs::file_type::directory;
}

void remove_pieces(const fs::path& folder) {
  if (!is_folder_of_pieces(folder)) return;
  std::error_code failed;
  std::vector<fs::path> pieces;
  for (const auto& file : fs::directory_iterator(folder, failed))
    if (is_piece_of(folder.filename().string(), file.path().filename().string())) pieces.push_back(file);
  for (const fs::path& file : pieces) fs::remove(file, failed);
  fs::remove(folder, failed);
}

void remove_frame(const fs::path& directory, const std::string& stem) {
  std::error_code failed;
  for (const char* suffix : {".pvtp", ".pvtu", ".vtp", ".vtu"}) fs::remove(directory / (stem + suffix), failed);
  remove_pieces(directory / stem);
}

PieceWriter::PieceWriter(fs::path directory, FrameFormat format, bool compress)
    : directory_(std::move(directory)), format_(format), compress_(compress) {}

void PieceWriter::write(std::string stem, Frame&& piece) {
  finish();
  work_ = std::async(std::launch::async, [this, stem = std::move(stem), piece = std::move(piece)] {
    const Instant begin = now();
    write_piece(directory_, stem, piece, format_, compress_);
    return since(begin);
  });
}

bool PieceWriter::is_done() {
  if (work_.valid() && work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  finish();
  return true;
}

void PieceWriter::finish() {
  if (!work_.valid()) return;
  const Instant begin = now();
  work_.wait();
  waiting_ += since(begin);
  failed_ = true;  // unless get() says nothing else
  writing_ += work_.get();
  failed_ = false;
}

}  // namespace barchan
