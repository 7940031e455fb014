// history.csv: one row a sampled step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "output/whole_file.hpp"

namespace barchan {

/// Columns are named once, "time [s]" and so on; rows are flushed as they are written, so that a killed run keeps them.
class History {
 public:
  /// Throws OutputError when the file cannot be opened. With `append` an existing file is continued: rows later than
  /// `until` (s) are dropped first, which is what a restart needs.
  History(const std::filesystem::path& file, const std::vector<std::string>& columns, bool append = false,
          double until = 0.0);
  void row(const std::vector<double>& values);  ///< as many as there are columns; 17 significant digits
  /// Brings the rows to the disk: a checkpoint there must not be without them. Throws OutputError.
  void sync() const { sync_file(file_); }
  /// Its name; "" where the file that the rows go to still has it.
  std::string removed() const;

 private:
  std::ofstream stream_;
  std::filesystem::path file_;
  std::size_t columns_;
  std::pair<std::uintmax_t, std::uintmax_t> identity_;  // of the file: its device and its number there
};

}  // namespace barchan
