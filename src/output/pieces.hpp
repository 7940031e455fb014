// A frame in pieces: NAME_000010.pvtp names NAME_000010/NAME_000010_0000.vtp, ..., a file of each rank (.pvtu: .vtu).
// ParaView and VTK read the first as one data set.
#pragma once

#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "output/frame.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// STEM.vtp, or of a frame in pieces STEM.pvtp; .vtu and .pvtu likewise.
std::string frame_name(const std::string& stem, bool in_pieces, FrameFormat format);

/// The file of a piece, from the folder of the list: STEM/STEM_0003.vtp.
std::string piece_name(const std::string& stem, int piece, FrameFormat format);

/// Writes a piece into DIRECTORY, in a folder that is made where there is none. Throws OutputError.
void write_piece(const std::filesystem::path& directory, const std::string& stem, const Frame& piece,
                 FrameFormat format, bool compress);

/// Writes the list of the pieces of a frame. `frame`: one of them; its values are not looked at, it may have none.
/// Throws OutputError.
void write_list_of_pieces(const std::filesystem::path& directory, const std::string& stem, const Frame& frame,
                          FrameFormat format);

/// The files that a list names (.pvtp, .pvtu), in its order, each with its folder. Throws OutputError when it cannot be
/// read, or names a file that is not below its own folder.
std::vector<std::filesystem::path> pieces_of(const std::filesystem::path& list);
/// The same of the text of a list; files as they stand there.
std::vector<std::string> parse_pieces(std::string_view text);

/// The frame of a list: particles by phase, of a phase piece by piece, which is the order of a frame in one file.
/// Throws OutputError, also when the pieces do not belong together.
Frame read_pieces(const std::filesystem::path& list);

/// A folder, and no link to one.
bool is_folder_of_pieces(const std::filesystem::path& path);
/// Removes the pieces in such a folder STEM, and the folder if nothing else is in it. What fails is left.
void remove_pieces(const std::filesystem::path& folder);
/// Removes the frame STEM in every format.
void remove_frame(const std::filesystem::path& directory, const std::string& stem);

/// Whether the name of a file in a list (.pvd, .pvtp, .pvtu) is that of a file below the folder of the list.
bool is_below_its_list(const std::filesystem::path& file);

/// Whether the name ends in .pvtp or .pvtu.
bool is_list_of_pieces(const std::filesystem::path& file);

/// Writes the pieces of one rank behind the computation's back, one at a time.
class PieceWriter {
 public:
  PieceWriter(std::filesystem::path directory, FrameFormat format, bool compress);

  /// Waits until the piece before is on the disk. Throws OutputError if that failed.
  void write(std::string stem, Frame&& piece);
  /// Whether the last piece is on the disk. Throws OutputError if it failed.
  bool is_done();
  /// Waits until it is. Throws OutputError.
  void finish();

  /// Whether the last piece could not be written.
  bool failed() const { return failed_; }

  double seconds_writing() const { return writing_; }  ///< until the last finish()
  double seconds_waiting() const { return waiting_; }  ///< time that write() and finish() blocked the caller

 private:
  std::filesystem::path directory_;
  FrameFormat format_;
  bool compress_;
  double writing_ = 0.0, waiting_ = 0.0;
  bool failed_ = false;
  std::future<double> work_;  // its destructor waits
};

}  // namespace barchan
