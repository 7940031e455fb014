#include "base/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/memory.hpp"

namespace barchan {

namespace {

[[noreturn]] void fail(int error) { throw InputError(std::string("cannot be read: ") + std::strerror(error)); }

/// What a file is that is not regular, by its mode.
std::string kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "is a directory";
  if (S_ISFIFO(mode)) return "is a pipe, not a regular file";
  if (S_ISSOCK(mode)) return "is a socket, not a regular file";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "is a device, not a regular file";
  return "is not a regular file";
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& file, std::uint64_t most) : most_(most) {
  struct stat about {};
  // Before it is opened too: to open a device can act on it. Without O_NONBLOCK to open a pipe waits for its writer.
  if (::stat(file.c_str(), &about) != 0) fail(errno);
  if (!S_ISREG(about.st_mode)) throw InputError(kind_of(about.st_mode));
  descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) fail(errno);
  try {
    if (::fstat(descriptor_, &about) != 0) fail(errno);
    if (!S_ISREG(about.st_mode)) throw InputError(kind_of(about.st_mode));
    size_ = static_cast<std::uint64_t>(about.st_size);
    if (size_ > most_) throw InputError("is larger than " + memory_text(static_cast<double>(most_)));
  } catch (const InputError&) {
    ::close(descriptor_);
    throw;
  }
}

InputFile::~InputFile() { ::close(descriptor_); }

std::size_t InputFile::read(std::uint64_t at, void* to, std::size_t size) const {
  char* bytes = static_cast<char*>(to);
  std::size_t done = 0;
  while (done < size) {
    const ssize_t come = ::pread(descriptor_, bytes + done, size - done, static_cast<off_t>(at + done));
    if (come < 0 && errno == EINTR) continue;
    if (come < 0) fail(errno);
    if (come == 0) break;
    done += static_cast<std::size_t>(come);
  }
  return done;
}

std::string InputFile::text() const {
  // Files of /proc state no size. A sparse file can state any, and its bytes would take the memory of the machine.
  constexpr std::uint64_t small = std::uint64_t{64} << 20;
  if (size_ > small && static_cast<double>(size_) > available_memory().bytes)
    throw InputError("has " + memory_text(static_cast<double>(size_)) + ", more than the memory that is left");
  std::string all(static_cast<std::size_t>(size_), '\0');
  all.resize(read(0, all.data(), all.size()));
  if (all.size() < size_) return all;  // it was cut meanwhile
  std::string more(4096, '\0');
  while (const std::size_t come = read(all.size(), more.data(), more.size())) {
    all.append(more, 0, come);
    if (all.size() > most_) throw InputError("is larger than " + memory_text(static_cast<double>(most_)));
  }
  return all;
}

std::string read_input(const std::filesystem::path& file, std::uint64_t most) { return InputFile(file, most).text(); }

std::string why_no_input(const std::filesystem::path& file, std::uint64_t most) {
  try {
    const InputFile open(file, most);
    return "";
  } catch (const InputError& e) { return e.what(); }
}

}  // namespace barchan
