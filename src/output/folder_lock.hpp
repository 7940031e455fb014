// One folder, one run: a file that says which process writes here.
#pragma once

#include <filesystem>
#include <string>

namespace barchan {

/// Holds DIR/barchan.lock while it lives and removes it then. The system gives the lock back when a process ends in
/// whatever way, so that the file of a killed run holds nobody up.
class FolderLock {
 public:
  static constexpr const char* name = "barchan.lock";

  /// Throws SceneError, with process and host, when another run holds the folder, and OutputError when the file cannot
  /// be made.
  explicit FolderLock(const std::filesystem::path& directory);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Who held the folder and ended without giving it back, as the file says; empty: nobody.
  const std::string& left_by() const { return left_by_; }

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::string left_by_;
};

std::string host_name();

}  // namespace barchan
