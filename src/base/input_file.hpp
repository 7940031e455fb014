// The one place that opens a file to read it. A pipe or a device is refused: a read of it may never end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace barchan {

/// Why a file cannot be read. what() has no subject: "is a pipe, not a regular file", "is larger than 16 MB",
/// "cannot be read: Permission denied".
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
  /// To stand behind "cannot read 'FILE': ".
  std::string reason() const {
    const std::string text = what(), begin = "cannot be read: ";
    return text.starts_with(begin) ? text.substr(begin.size()) : text;
  }
};

/// A regular file, or a link to one, open for reading.
class InputFile {
 public:
  /// Throws InputError for what is no regular file, cannot be opened, or has more than `most` bytes. Never waits.
  explicit InputFile(const std::filesystem::path& file, std::uint64_t most = largest);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  static constexpr std::uint64_t largest = ~std::uint64_t{0};

  std::uint64_t size() const { return size_; }  ///< bytes, when it was opened
  /// At most `size` bytes from `at` on; fewer only where the file ends. Throws InputError.
  std::size_t read(std::uint64_t at, void* to, std::size_t size) const;
  /// All bytes. Throws InputError, also where the file has grown beyond `most`, or has not the memory that is left.
  std::string text() const;

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0, most_;
};

/// All bytes of a regular file of at most `most`. Throws InputError.
std::string read_input(const std::filesystem::path& file, std::uint64_t most = InputFile::largest);

/// Why read_input() would refuse the file; "" where it would read it.
std::string why_no_input(const std::filesystem::path& file, std::uint64_t most = InputFile::largest);

}  // namespace barchan
