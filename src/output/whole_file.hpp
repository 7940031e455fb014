// A file that gets its name only when all of it is on the disk.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace barchan {

/// Writes FILE.part; publish() puts it on the disk and renames it to FILE. A reader sees the old FILE or the whole new
/// one, never half of one. Without publish() the destructor removes what was written and FILE stays what it was.
class WholeFile {
 public:
  static constexpr std::string_view suffix = ".part";

  /// Opens FILE.part for writing. Throws OutputError with the reason (no such directory, no permission, ...).
  explicit WholeFile(std::filesystem::path file);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  /// Where another writer than write() puts its bytes.
  const std::filesystem::path& temporary() const { return temporary_; }
  void write(std::string_view bytes);  ///< Appends. Throws OutputError.
  /// Brings what is written to the disk, before something is done that cannot be undone. Throws OutputError.
  void sync();
  void publish();  ///< fsync, rename, fsync of the directory. Throws OutputError.

  /// Says why another writer could not write temporary(): tries to write there itself and returns the system's words
  /// ("No space left on device"), or `otherwise` if the trial succeeds.
  std::string why_it_failed(const std::string& otherwise);

 private:
  std::filesystem::path file_, temporary_;
  int descriptor_ = -1;
};

/// Lets small writes wait for each other.
class SmallWrites {
 public:
  explicit SmallWrites(WholeFile& out) : out_(out) {}
  void write(const void* data, std::size_t size);  ///< Throws OutputError.
  void flush();                                    ///< Before publish(). Throws OutputError.

 private:
  static constexpr std::size_t room = 1 << 16;
  WholeFile& out_;
  std::string waiting_;
};

/// White space between the tag AppendedData of VTK's XML files and its "_": with it the readers of VTK 9.1 and 9.2 find
/// the data where their parser is expat 2.6 or later, or the expat 2.5 of an updated Debian 12. That parser puts off a
/// tag of which it has got only a few bytes; the readers then feed it the next 4096 bytes of the file, which must be
/// text.
inline constexpr std::size_t appended_padding = 8192;

/// The whole of a small file at once. Throws OutputError.
void write_whole_file(const std::filesystem::path& file, std::string_view text);

/// Brings what others have written into a file to the disk; nothing where it is no regular file. Throws OutputError.
void sync_file(const std::filesystem::path& file);

/// The text of a file. Throws OutputError.
std::string read_text(const std::filesystem::path& file);

}  // namespace barchan
