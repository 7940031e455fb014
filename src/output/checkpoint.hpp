// The file of a state from which a run goes on.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "state/archive.hpp"

namespace barchan {

struct Checkpoint {
  std::string version;       // of the program that wrote it, with its commit
  std::string instructions;  // the instruction set; another one goes on with other bits
  std::string scene;         // Scene::identity
  double time = 0.0;         // s
  long step = 0;
  std::vector<char> state;  // Archive::bytes(); of one that is read
};

/// `state` names what a state holds. It is called several times, for sizes, the checksum and the file: the bytes are
/// never in memory as a whole.
///
/// Replaces the file by rename when all of it is on the disk; the one before stays as older_checkpoint(). Throws
/// OutputError.
void write_checkpoint(const std::filesystem::path& file, Checkpoint about, const std::function<void(Archive&)>& state);

/// Throws SceneError when there is no such file, or it is no checkpoint, of another format, cut off or damaged (the
/// CRC-32 of zlib over all that follows the head).
Checkpoint read_checkpoint(const std::filesystem::path& file);

/// The same of the bytes of a file.
Checkpoint parse_checkpoint(const std::vector<char>& bytes);

/// Of a file's ring of two: the one before the newest.
std::filesystem::path older_checkpoint(const std::filesystem::path& file);
void remove_checkpoints(const std::filesystem::path& file);  ///< Both.

/// The newest of the ring that is whole, and what is wrong with the newer one if that had to be left out. Throws
/// SceneError with the reasons when neither can be read.
std::pair<Checkpoint, std::string> read_newest_checkpoint(const std::filesystem::path& file);

}  // namespace barchan
