#include "output/whole_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/errors.hpp"
#include "base/input_file.hpp"

namespace barchan {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, int error) {
  throw OutputError("cannot write '" + file.string() + "': " + std::strerror(error));
}

/// 0 or errno. Writes that were interrupted or came out short go on where they stopped.
int write_all(int descriptor, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(descriptor, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
  return 0;
}

}  // namespace

WholeFile::WholeFile(std::filesystem::path file) : file_(std::move(file)), temporary_(file_) {
  temporary_ += suffix;
  // What a killed run left under this name goes; a link or a pipe that somebody put there is not written through.
  if (::unlink(temporary_.c_str()) != 0 && errno != ENOENT) fail(file_, errno);
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(file_, errno);
}

WholeFile::~WholeFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void WholeFile::write(std::string_view bytes) {
  if (const int error = write_all(descriptor_, bytes.data(), bytes.size())) fail(file_, error);
}

void WholeFile::sync() {
  if (::fsync(descriptor_) != 0) fail(file_, errno);
}

void WholeFile::publish() {
  sync();
  if (std::rename(temporary_.c_str(), file_.c_str()) != 0) fail(file_, errno);
  ::close(descriptor_);
  descriptor_ = -1;
  // The name itself lives in the directory. Some file systems cannot sync one; the file's content is safe even there.
  const auto directory = file_.has_parent_path() ? file_.parent_path() : std::filesystem::path(".");
  if (const int d = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); d >= 0) {
    ::fsync(d);
    ::close(d);
  }
}

std::string WholeFile::why_it_failed(const std::string& otherwise) {
  // Our descriptor keeps the blocks of the file even if the other writer has removed its name, so the disk is as full
  // as it was when that writer failed. A megabyte is more than what a file system hides in a last partial block.
  const std::string trial(1 << 20, '\0');
  if (::lseek(descriptor_, 0, SEEK_END) < 0) return std::strerror(errno);
  if (const int error = write_all(descriptor_, trial.data(), trial.size())) return std::strerror(error);
  if (::fsync(descriptor_) != 0) return std::strerror(errno);
  return otherwise;
}

void SmallWrites::write(const void* data, std::size_t size) {
  const std::string_view bytes(static_cast<const char*>(data), size);
  if (waiting_.size() + size > room) flush();
  if (size > room) out_.write(bytes);
  else waiting_ += bytes;
}

void SmallWrites::flush() {
  out_.write(waiting_);
  waiting_.clear();
}

void write_whole_file(const std::filesystem::path& file, std::string_view text) {
  WholeFile whole(file);
  whole.write(text);
  whole.publish();
}

void sync_file(const std::filesystem::path& file) {
  std::error_code unseen;
  if (!std::filesystem::is_regular_file(file, unseen)) return;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(file, errno);
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  if (error != 0) fail(file, error);
}

std::string read_text(const std::filesystem::path& file) {
  try {
    return read_input(file);
  } catch (const InputError& e) { throw OutputError("cannot read '" + file.string() + "': " + e.reason()); }
}

}  // namespace barchan
