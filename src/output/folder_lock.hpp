// One folder, one run: a file that says which process writes here.
#pragma once

#include <filesystem>
#include <string>

namespace barchan {

/// Holds the folder, and DIR/barchan.lock in it, while it lives. The system gives both locks back when a process ends
/// in whatever way, so that the file of a killed run holds nobody up. The folder's own lock holds when the file is
/// removed.
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
  /// Whether the name still means the folder that is held: it was not removed, moved or replaced.
  bool is_there() const;

 private:
  /// Another run may hold the folder although its file is gone. Throws SceneError.
  void hold_folder();

  std::filesystem::path directory_, file_;
  int descriptor_ = -1, folder_ = -1;
  std::string left_by_;
};

std::string host_name();

}  // namespace barchan
