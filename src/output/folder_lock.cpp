#include "output/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/errors.hpp"

namespace barchan {

namespace {

/// What the file says of its owner, on one line; at most so much of it.
std::string content(int descriptor) {
  std::array<char, 300> text{};
  const ssize_t size = ::pread(descriptor, text.data(), text.size(), 0);
  std::string line(text.data(), static_cast<std::size_t>(size > 0 ? size : 0));
  line = line.substr(0, line.find('\n'));
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return line;
}

/// Locks are not known to every file system, and those of folders not where descriptors must be open for writing.
bool has_no_locks(int error) { return error == ENOLCK || error == EOPNOTSUPP || error == EINVAL || error == EBADF; }

bool are_one(const struct stat& a, const struct stat& b) { return a.st_ino == b.st_ino && a.st_dev == b.st_dev; }

/// Whether the path means the file that is open.
bool is_open_as(int descriptor, const std::filesystem::path& path) {
  struct stat open {
  }, there{};
  return ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &there) == 0 && are_one(open, there);
}

[[noreturn]] void refuse_second_run(const std::filesystem::path& directory, const std::string& owner) {
  throw SceneError("the folder '" + directory.string() + "' belongs to a run that is going on (" + owner +
                   "); expected another --out, or wait for its end");
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

FolderLock::FolderLock(const std::filesystem::path& directory) : directory_(directory), file_(directory / name) {
  const auto fail = [&](int error) {
    if (descriptor_ >= 0) ::close(descriptor_);
    throw OutputError("cannot write '" + file_.string() + "': " + std::strerror(error));
  };
  while (true) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (descriptor_ < 0 && errno == ELOOP)
      throw OutputError("cannot write '" + file_.string() + "': is a link; remove it, or choose another --out");
    if (descriptor_ < 0) fail(errno);
    struct stat kind {};
    if (::fstat(descriptor_, &kind) != 0 || !S_ISREG(kind.st_mode)) {
      ::close(descriptor_);
      descriptor_ = -1;
      throw OutputError("cannot write '" + file_.string() + "': is not a file; remove it, or choose another --out");
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      // A file system without locks cannot tell two runs apart; one run is worth more than none.
      if (has_no_locks(error)) break;
      if (error != EWOULDBLOCK) fail(error);
      const std::string owner = content(descriptor_);
      ::close(descriptor_);
      descriptor_ = -1;
      refuse_second_run(directory, owner.empty() ? "it has just begun" : owner);
    }
    // Between opening and locking the owner may have ended and removed the file: then this is no longer the one.
    if (is_open_as(descriptor_, file_)) break;
    ::close(descriptor_);
  }
  hold_folder();
  left_by_ = content(descriptor_);
  const std::string owner = "process " + std::to_string(::getpid()) + " on host " + host_name() + "\n";
  // A disk without room for a line is told by what comes next; the lock holds without its text.
  if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, owner.data(), owner.size(), 0) < 0) return;
}

void FolderLock::hold_folder() {
  folder_ = ::open(directory_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0 || ::flock(folder_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::unlink(file_.c_str());
  for (int* descriptor : {&folder_, &descriptor_}) ::close(std::exchange(*descriptor, -1));
  refuse_second_run(directory_, std::string(name) + " of its process was removed");
}

bool FolderLock::is_there() const { return folder_ < 0 || is_open_as(folder_, directory_); }

FolderLock::~FolderLock() {
  if (folder_ >= 0) ::close(folder_);
  if (descriptor_ < 0) return;
  if (is_open_as(descriptor_, file_)) ::unlink(file_.c_str());
  ::close(descriptor_);
}

}  // namespace barchan
