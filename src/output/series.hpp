// The ParaView series: frames written behind the computation's back, a .pvd that lists exactly the whole ones.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "output/frame.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// Writes DIR/NAME_000000.vtp ... on a thread of its own and DIR/NAME.pvd after each. A file gets its name by rename
/// when it is whole and on the disk, and the .pvd is replaced by rename, so that a killed run leaves a series that
/// opens. At most two frames wait; a third write() blocks until one is done.
class SeriesWriter {
 public:
  struct Entry {
    double time;
    std::string file;
  };  // file relative to DIR

  /// Creates DIR. `kept` are the frames of an earlier run that a restart goes on from. Throws OutputError.
  SeriesWriter(std::filesystem::path directory, std::string name, FrameFormat format, bool compress,
               std::vector<Entry> kept = {});
  ~SeriesWriter();  ///< finishes what waits; swallows errors (call finish() to see them)

  /// Hands a frame over. Of one in pieces, which are on the disk, the list is written (output/pieces.hpp). Throws
  /// OutputError if an earlier frame could not be written; earlier frames stay whole.
  void write(Frame&& frame);
  /// Waits until all is on the disk. Throws OutputError.
  void finish();

  double seconds_writing() const;  ///< time the writer's thread spent
  double seconds_waiting() const;  ///< time write() and finish() blocked the caller
  long frames() const;             ///< whole frames, kept ones included
  std::string last_file() const;   ///< of the last whole frame; "" if none. After finish()
  /// Frames that somebody removed after they were written; the .pvd lists the others. After finish(). Throws
  /// OutputError.
  std::vector<std::string> removed();

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// NAME_000010: what the name of a frame's file begins with.
std::string frame_stem(const std::string& name, int index);
/// The number in such a name; nothing: it is none of this series.
std::optional<long> frame_number(const std::string& name, const std::filesystem::path& file);
/// Whether a frame of this series, a list of its pieces or their folder lies in the folder.
bool has_frames(const std::filesystem::path& directory, const std::string& name);

/// Makes the folder of a run where there is none. Throws OutputError.
void make_directory(const std::filesystem::path& directory);

/// The entries of a .pvd, in file order. Throws OutputError when it cannot be read.
std::vector<SeriesWriter::Entry> read_pvd(const std::filesystem::path& pvd);

/// Writes one frame to a .vtp or .vtu (by format): appended data, compressed on request, vertices for every particle,
/// point arrays id (Int64, also set as global ids), phase (Int32) and the fields; field data TimeValue, step, frame
/// (its index) and phase_names, phase_kinds, units (lines "name unit") as arrays of strings, which a .vtu holds as
/// UInt8 text with a newline between, because meshio reads no strings. Throws OutputError.
void write_frame(const std::filesystem::path& file, const Frame& frame, FrameFormat format, bool compress);

/// Reads a frame back (.vtp or .vtu; .pvtp or .pvtu with its pieces). Throws OutputError.
Frame read_frame(const std::filesystem::path& file);

}  // namespace barchan
