// One frame to the disk and back: every bit returns, and what cannot be written or read says so.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "output/series.hpp"
#include "output/whole_file.hpp"
#include "unit/output_example.hpp"

// VTK 9.2 forgets its compression tables (32 bytes an array) when a write fails half way. Read by the leak sanitizer
// alone.
// NOLINTBEGIN(bugprone-reserved-identifier): its name is the sanitizer's
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:vtkXMLWriter::CreateCompressionHeader\n"; }
// NOLINTEND(bugprone-reserved-identifier)

namespace barchan {
namespace {

using namespace example;

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct Way {
  FrameFormat format;
  bool compress;
  std::size_t particles;
  std::string name() const {
    return std::string(format == FrameFormat::vtp ? "vtp" : "vtu") + (compress ? "Compressed" : "Plain") +
           std::to_string(particles);
  }
};
void PrintTo(const Way& way, std::ostream* out) { *out << way.name(); }

class RoundTrip : public ::testing::TestWithParam<Way> {};

TEST_P(RoundTrip, ReturnsEveryBit) {
  const auto& [format, compress, particles] = GetParam();
  const TemporaryDirectory directory;
  const auto file = directory / (format == FrameFormat::vtp ? "frame.vtp" : "frame.vtu");
  const Frame written = frame(particles);
  write_frame(file, written, format, compress);
  expect_same(read_frame(file), written);
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".part"));
}

std::vector<Way> every_way() {
  std::vector<Way> ways;
  for (const auto format : {FrameFormat::vtp, FrameFormat::vtu})
    for (const bool compress : {false, true})
      for (const std::size_t particles : {0, 1, 7, 100'000}) ways.push_back({format, compress, particles});
  return ways;
}

INSTANTIATE_TEST_SUITE_P(Frames, RoundTrip, ::testing::ValuesIn(every_way()),
                         [](const auto& way) { return way.param.name(); });

TEST(Frames, CompressionMakesThemSmaller) {
  const TemporaryDirectory directory;
  Frame rows = frame(20'000);
  for (auto& field : rows.fields) std::fill(field.values.begin(), field.values.end(), 1.5);
  for (const auto format : {FrameFormat::vtp, FrameFormat::vtu}) {
    write_frame(directory / "plain", rows, format, false);
    write_frame(directory / "small", rows, format, true);
    EXPECT_LT(2 * file_size(directory / "small"), file_size(directory / "plain"));
  }
}

TEST(Frames, ReplaceAnOlderOne) {
  const TemporaryDirectory directory;
  write_frame(directory / "frame.vtp", frame(1000), FrameFormat::vtp, false);
  write_frame(directory / "frame.vtp", frame(10), FrameFormat::vtp, false);
  expect_same(read_frame(directory / "frame.vtp"), frame(10));
}

TEST(Frames, WithArraysOfTheWrongLengthAreRefused) {
  const TemporaryDirectory directory;
  Frame wrong = frame(10);
  wrong.fields[1].values.pop_back();
  EXPECT_THROW(write_frame(directory / "frame.vtp", wrong, FrameFormat::vtp, true), std::logic_error);
}

TEST(Frames, WithoutADirectoryNameFileAndReason) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "a_file") << "not a directory";
  const auto write = [&](const std::filesystem::path& file) {
    return [=] { write_frame(file, frame(10), FrameFormat::vtp, true); };
  };
  expect_output_error(write(directory / "a_file" / "frame.vtp"), {"a_file/frame.vtp", "Not a directory"});
  expect_output_error(write(directory / "nowhere" / "frame.vtp"), {"nowhere/frame.vtp", "No such file or directory"});
  std::filesystem::create_directories(directory / "taken.vtp" / "child");
  expect_output_error(write(directory / "taken.vtp"), {"taken.vtp", "Is a directory"});
}

// However much fits on the disk: the error names the file and the reason, and the older frame stays whole.
TEST(Frames, OnAFullDiskLeaveTheOlderFrameAndNameFileAndReason) {
  const TemporaryDirectory directory;
  for (const auto format : {FrameFormat::vtp, FrameFormat::vtu})
    for (const bool compress : {false, true}) {
      const auto file = directory / (format == FrameFormat::vtp ? "frame.vtp" : "frame.vtu");
      const Frame larger = frame(2000);
      write_frame(file, larger, format, compress);
      const auto size = file_size(file);
      write_frame(file, frame(10), format, compress);
      for (const auto limit : {size_t{0}, size_t{100}, size_t{1500}, size_t{4096}, size / 2, size - 9, size - 1}) {
        {
          const SmallDisk small(limit);
          expect_output_error([&] { write_frame(file, larger, format, compress); }, {file.string(), "File too large"});
        }
        EXPECT_FALSE(std::filesystem::exists(file.string() + ".part")) << limit;
        expect_same(read_frame(file), frame(10));
      }
    }
}

TEST(Frames, ThatAreCutOffAreNotRead) {
  const TemporaryDirectory directory;
  for (const auto format : {FrameFormat::vtp, FrameFormat::vtu}) {
    const std::string name = format == FrameFormat::vtp ? "frame.vtp" : "frame.vtu";
    write_frame(directory / name, frame(50), format, true);
    const std::string whole = bytes_of(directory / name);
    const auto size = whole.size() - 1;  // a file without its last end of line is still whole
    for (const auto length : {size_t{0}, size_t{1}, size_t{64}, size_t{1000}, size / 2, size - 20, size - 1}) {
      std::ofstream(directory / name, std::ios::binary) << whole.substr(0, length);
      expect_output_error([&] { read_frame(directory / name); }, {name, "incomplete"});
    }
  }
}

// The end is there, something before it is not.
TEST(Frames, ThatAreDamagedAreNotRead) {
  const TemporaryDirectory directory;
  write_frame(directory / "frame.vtp", frame(50), FrameFormat::vtp, true);
  const std::string whole = bytes_of(directory / "frame.vtp");
  for (const std::string_view tag : {"<PolyData>", "<PointData", "<Points>", "Name=\"id\"", "Name=\"phase\""}) {
    std::string damaged = whole;
    damaged[damaged.find(tag) + 1] = '?';
    std::ofstream(directory / "frame.vtp", std::ios::binary) << damaged;
    expect_output_error([&] { read_frame(directory / "frame.vtp"); }, {"frame.vtp"});
  }
  const auto data = whole.find("<AppendedData");
  std::ofstream(directory / "frame.vtp", std::ios::binary)
      << whole.substr(0, data + appended_padding + 500) + "\n  </AppendedData>\n</VTKFile>\n";
  expect_output_error([&] { read_frame(directory / "frame.vtp"); }, {"frame.vtp"});
}

TEST(Frames, ThatAreNotThereAreNamed) {
  const TemporaryDirectory directory;
  expect_output_error([&] { read_frame(directory / "none.vtp"); }, {"none.vtp", "No such file or directory"});
  std::ofstream(directory / "frame.txt") << "text";
  expect_output_error([&] { read_frame(directory / "frame.txt"); }, {"frame.txt", ".vtp or .vtu"});
}

}  // namespace
}  // namespace barchan
