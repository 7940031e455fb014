// Bytes of a file that are read in any order, and their checksum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/input_file.hpp"
#include "state/archive.hpp"

namespace barchan {

/// The CRC-32 of zlib. `before`: that of what stands before.
std::uint32_t checksum(const void* data, std::size_t size, std::uint32_t before = 0);

/// A file that stays open: what is read is of the file that had the name at the begin, also when another one gets it.
class OpenFile {
 public:
  /// Throws SceneError when it is no file that can be read; `missing`: what to say when there is none.
  OpenFile(std::filesystem::path file, const std::string& missing);

  std::uint64_t size() const { return open_.size(); }
  /// Throws SceneError when the file cannot be read, or is shorter.
  void read(std::uint64_t at, void* to, std::size_t size) const;

 private:
  std::filesystem::path file_;
  InputFile open_;
};

/// Of bytes in memory, which must stay where they are.
Archive::Source source_of(const std::vector<char>& bytes);
/// A part of what a source has.
Archive::Source part_of(const Archive::Source& source, std::uint64_t at, std::uint64_t size);

/// What stands between the magic words of a file and the bytes that it is about.
struct CheckedHead {
  std::uint64_t size = 0;  // of the bytes
  std::uint32_t sum = 0;   // their checksum
  std::uint32_t unused = 0;
};
/// The bytes behind the head of a file, whose magic words are `magic` bytes long, and which `sum_of` sums up. Throws
/// SceneError when their number or their sum is another one.
Archive::Source behind_head(const Archive::Source& file, std::size_t magic,
                            const std::function<std::uint32_t(const Archive::Source&)>& sum_of);

/// The checksum of all that a source has; takes little memory.
std::uint32_t checksum(const Archive::Source& source);

/// The same, read by all processes together, a share each. All call it. Throws SceneError on all when one of them
/// cannot read.
std::uint32_t shared_checksum(const Archive::Source& source);

}  // namespace barchan
