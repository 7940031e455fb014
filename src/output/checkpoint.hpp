// The file of a state from which a run goes on; of several ranks an index and pieces (output/checkpoint_pieces.hpp).
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
  Archive::Source state{};  // of one that is read: from the file, which stays open
};

/// `state` names what a state holds. It is called several times, for sizes, the checksum and the file: the bytes are
/// never in memory as a whole.
///
/// Replaces the file by rename when all of it is on the disk; the one before stays as older_checkpoint(), with its
/// pieces. On several ranks all call it. Throws OutputError, on all of them.
void write_checkpoint(const std::filesystem::path& file, Checkpoint about, const std::function<void(Archive&)>& state);

/// On several ranks all call it, and look through the whole of it together. Throws SceneError, on all of them, when
/// there is no such file, or it is no checkpoint, of another format, cut off or damaged (the CRC-32 of zlib over all
/// that follows the head), or when a piece of it is so.
Checkpoint read_checkpoint(const std::filesystem::path& file);

/// The same of the bytes of a file, which is no index; they must stay where they are.
Checkpoint parse_checkpoint(const std::vector<char>& bytes);

/// Of a file's ring of two: the one before the newest.
std::filesystem::path older_checkpoint(const std::filesystem::path& file);
void remove_checkpoints(const std::filesystem::path& file);  ///< Both, with their pieces.
void remove_older_checkpoint(const std::filesystem::path& file);

/// The newest of the ring that is whole, and what is wrong with the newer one if that had to be left out. Throws
/// SceneError with the reasons when neither can be read.
std::pair<Checkpoint, std::string> read_newest_checkpoint(const std::filesystem::path& file);

}  // namespace barchan
