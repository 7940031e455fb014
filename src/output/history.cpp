#include "output/history.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "base/errors.hpp"
#include "output/numbers.hpp"

namespace barchan {
namespace {

std::string header(const std::vector<std::string>& columns) {
  std::string line;
  for (const auto& column : columns) line += (line.empty() ? "" : ",") + column;
  return line + "\n";
}

/// The part of an earlier history that a restart goes on from: the header and the whole rows up to `until`. A last row
/// without its end of line was cut off by the end of the earlier run.
std::string rows_until(std::string_view text, const std::string& expected_header, double until) {
  if (text.empty()) return expected_header;
  if (!text.starts_with(expected_header))
    throw OutputError("its columns are not '" + expected_header.substr(0, expected_header.size() - 1) +
                      "'; move it away or write elsewhere");
  std::string kept = expected_header;
  text.remove_prefix(expected_header.size());
  for (auto end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    const auto line = text.substr(0, end + 1);
    const auto time = parse_number(line.substr(0, line.find_first_of(",\n")));
    if (!time || *time > until) break;
    kept += line;
    text.remove_prefix(line.size());
  }
  return kept;
}

/// Device and number of a file; zeros where there is none.
std::pair<std::uintmax_t, std::uintmax_t> identity_of_file(const std::filesystem::path& file) {
  struct stat about {};
  if (::stat(file.c_str(), &about) != 0) return {};
  return {about.st_dev, about.st_ino};
}

}  // namespace

History::History(const std::filesystem::path& file, const std::vector<std::string>& columns, bool append, double until)
    : file_(file), columns_(columns.size()) {
  std::string begin = header(columns);
  std::error_code unseen;
  if (std::filesystem::is_fifo(file, unseen) || std::filesystem::is_socket(file, unseen))  // nobody may ever read it
    throw OutputError("cannot write '" + file.string() + "': is not a file");
  if (append && std::filesystem::exists(file)) {
    try {
      begin = rows_until(read_text(file), begin, until);
    } catch (const OutputError& e) { throw OutputError("cannot go on with '" + file.string() + "': " + e.what()); }
  }
  if (!std::filesystem::exists(file) || std::filesystem::is_regular_file(file)) write_whole_file(file, begin);
  errno = 0;
  stream_.open(file, std::ios::app | std::ios::binary);
  if (!stream_) throw OutputError("cannot write '" + file.string() + "': " + std::strerror(errno));
  identity_ = identity_of_file(file);
}

std::string History::removed() const { return identity_of_file(file_) == identity_ ? "" : file_.filename().string(); }

void History::row(const std::vector<double>& values) {
  if (values.size() != columns_) throw std::logic_error("a row of the history must have one value a column");
  std::string line;
  for (const double value : values) line += (line.empty() ? "" : ",") + exact(value);
  line += '\n';
  errno = 0;
  stream_ << line << std::flush;
  if (!stream_) throw OutputError("cannot write '" + file_.string() + "': " + std::strerror(errno != 0 ? errno : EIO));
}

}  // namespace barchan
