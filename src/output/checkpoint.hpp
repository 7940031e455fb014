// The file of a state from which a run goes on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace barchan {

struct Checkpoint {
  std::string version;       // of the program that wrote it, with its commit
  std::string instructions;  // the instruction set; another one goes on with other bits
  std::string scene;         // Scene::identity
  double time = 0.0;         // s
  long step = 0;
  std::vector<char> state;  // Archive::bytes()
};

/// Replaces the file by rename when all of it is on the disk. Throws OutputError.
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint);

/// Throws SceneError when there is no such file, or it is no checkpoint, of another format, cut off or damaged (the
/// CRC-32 of zlib over all that follows the head).
Checkpoint read_checkpoint(const std::filesystem::path& file);

/// Lines of two scenes' identities that differ, as "- of the checkpoint" and "+ of the scene"; empty when none do.
std::string difference(const std::string& then, const std::string& now);

}  // namespace barchan
