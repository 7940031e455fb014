// A frame in pieces: what ranks write side by side is read as the frame of one process.
#include "output/pieces.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "output/series.hpp"
#include "unit/output_example.hpp"

namespace barchan {
namespace {

using namespace example;

/// Particles k of `whole` with k % of == number, in their order.
Frame piece_of(const Frame& whole, int number, int of) {
  Frame piece = whole.without_particles();
  piece.domain = whole.domain;
  piece.phase_names = whole.phase_names;
  piece.phase_kinds = whole.phase_kinds;
  piece.in_pieces = true;
  piece.piece = number;
  piece.pieces = of;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    if (static_cast<int>(k) % of != number) continue;
    piece.id.push_back(whole.id[k]);
    piece.phase.push_back(whole.phase[k]);
    for (std::size_t c = 0; c < 3; ++c) piece.points.push_back(whole.points[3 * k + c]);
    for (std::size_t f = 0; f < whole.fields.size(); ++f) {
      const auto width = static_cast<std::size_t>(whole.fields[f].components);
      for (std::size_t c = 0; c < width; ++c) piece.fields[f].values.push_back(whole.fields[f].values[k * width + c]);
    }
  }
  return piece;
}

void write_all(const TemporaryDirectory& directory, const std::string& stem, const Frame& whole, int of,
               FrameFormat format) {
  for (int k = 0; k < of; ++k) write_piece(directory.path, stem, piece_of(whole, k, of), format, true);
  write_list_of_pieces(directory.path, stem, piece_of(whole, 0, of), format);
}

/// By id, so that the order of particles does not count.
Frame sorted(Frame frame) {
  std::vector<std::size_t> order(frame.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](auto a, auto b) { return frame.id[a] < frame.id[b]; });
  Frame result = frame;
  for (std::size_t k = 0; k < order.size(); ++k) {
    result.id[k] = frame.id[order[k]];
    result.phase[k] = frame.phase[order[k]];
    for (std::size_t c = 0; c < 3; ++c) result.points[3 * k + c] = frame.points[3 * order[k] + c];
    for (std::size_t f = 0; f < frame.fields.size(); ++f) {
      const auto width = static_cast<std::size_t>(frame.fields[f].components);
      for (std::size_t c = 0; c < width; ++c)
        result.fields[f].values[k * width + c] = frame.fields[f].values[order[k] * width + c];
    }
  }
  return result;
}

TEST(Pieces, AreReadAsOneFrame) {
  for (const auto format : {FrameFormat::vtp, FrameFormat::vtu})
    for (const int of : {1, 3, 11}) {  // with 11 some have no particle
      const TemporaryDirectory directory;
      const Frame whole = frame(10);
      write_all(directory, "dune_000003", whole, of, format);
      const Frame read = read_frame(directory / frame_name("dune_000003", true, format));
      EXPECT_TRUE(std::ranges::is_sorted(read.phase));
      expect_same(sorted(read), sorted(whole));
    }
}

TEST(Pieces, OfAnotherFrameAreRefused) {
  const TemporaryDirectory directory;
  const Frame whole = frame(10);
  write_all(directory, "a", whole, 2, FrameFormat::vtp);
  const auto refused = [&](const Frame& second, const std::string& words) {
    write_piece(directory.path, "a", second, FrameFormat::vtp, true);
    expect_output_error([&] { read_frame(directory / "a.pvtp"); }, {"a.pvtp", "a_0001.vtp", words});
  };
  Frame later = piece_of(whole, 1, 2);
  later.time += 1.0;
  refused(later, "another frame");
  Frame others = piece_of(whole, 1, 2);
  others.fields.pop_back();
  refused(others, "other fields");
  Frame renamed = piece_of(whole, 1, 2);
  renamed.phase_names.front() += "x";
  refused(renamed, "other phases");
  std::filesystem::remove(directory / "a" / "a_0001.vtp");
  expect_output_error([&] { read_frame(directory / "a.pvtp"); }, {"a_0001.vtp", "No such file"});
}

TEST(Pieces, AListThatIsWrongSaysWhere) {
  const TemporaryDirectory directory;
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> words) {
    std::ofstream(directory / "a.pvtp") << text;
    expect_output_error([&] { read_frame(directory / "a.pvtp"); }, words);
  };
  const std::string begin = "<VTKFile type=\"PPolyData\">\n<PPolyData>\n", end = "</PPolyData></VTKFile>";
  refused("", {"a.pvtp", "whole list of pieces"});
  refused(begin + end, {"a.pvtp", "whole list of pieces"});
  refused(begin + "<Piece Source=\"a/a_0000.vtp\"/>", {"a.pvtp", "whole list of pieces"});
  refused(begin + "<Piece/>" + end, {"a.pvtp", "line 3", "'Source'"});
  for (const char* source : {"", "/etc/a.vtp", "../a.vtp", "a/../../b.vtp"})
    refused(begin + "<Piece Source=\"" + source + "\"/>" + end, {"a.pvtp", "line 3", "below the folder"});
  refused(begin + "<Piece Source=\"a.pvtp\"/>" + end, {"a.pvtp", "line 3", ".vtp or .vtu"});
}

TEST(Pieces, ASeriesListsThemAndRemovesThoseOfAnEarlierRun) {
  const TemporaryDirectory directory;
  {
    SeriesWriter series(directory.path, "dune", FrameFormat::vtp, true);
    for (int k = 0; k < 3; ++k) {
      const std::string stem = frame_stem("dune", k);
      for (int r = 0; r < 2; ++r)
        write_piece(directory.path, stem, piece_of(frame(10, k), r, 2), FrameFormat::vtp, true);
      series.write(piece_of(frame(10, k), 0, 2).without_particles());
    }
    series.finish();
  }
  auto entries = read_pvd(directory / "dune.pvd");
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[2].file, "dune_000002.pvtp");
  expect_same(sorted(read_frame(directory / entries[2].file)), sorted(frame(10, 2)));

  // A run that goes on from the first frame keeps its pieces; a file of somebody else stays where it is.
  std::ofstream(directory / "dune_000002" / "notes.txt") << "mine";
  std::filesystem::create_directory(directory / "dune_0001");
  entries.resize(1);
  { SeriesWriter series(directory.path, "dune", FrameFormat::vtp, true, entries); }
  EXPECT_EQ(read_frame(directory / "dune_000000.pvtp").size(), 10u);
  EXPECT_FALSE(std::filesystem::exists(directory / "dune_000001.pvtp"));
  EXPECT_FALSE(std::filesystem::exists(directory / "dune_000001"));
  EXPECT_FALSE(std::filesystem::exists(directory / "dune_000002" / "dune_000002_0000.vtp"));
  EXPECT_TRUE(std::filesystem::exists(directory / "dune_000002" / "notes.txt"));
  EXPECT_TRUE(std::filesystem::exists(directory / "dune_0001"));
}

TEST(Pieces, AreWrittenBehindTheCaller) {
  const TemporaryDirectory directory;
  PieceWriter writer(directory.path, FrameFormat::vtp, true);
  EXPECT_TRUE(writer.is_done());
  writer.write("a", piece_of(frame(10), 0, 1));
  writer.write("b", piece_of(frame(10), 0, 1));
  EXPECT_EQ(read_frame(directory / piece_name("a", 0, FrameFormat::vtp)).size(), 10u);
  writer.finish();
  EXPECT_TRUE(writer.is_done());
  EXPECT_GT(writer.seconds_writing(), 0.0);
  EXPECT_EQ(read_frame(directory / piece_name("b", 0, FrameFormat::vtp)).size(), 10u);
}

TEST(Pieces, ThatCannotBeWrittenTellTheCaller) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "a") << "a file where the folder of the pieces should be";
  PieceWriter writer(directory.path, FrameFormat::vtp, true);
  writer.write("a", piece_of(frame(10), 0, 1));
  expect_output_error([&] { writer.finish(); }, {"/a"});
}

}  // namespace
}  // namespace barchan
