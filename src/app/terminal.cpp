#include "app/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <streambuf>

namespace barchan {
namespace {

constexpr std::size_t narrowest = 40;  // columns: below, lines stay as they are

/// Letters, not bytes: those of UTF-8 that go on with a letter do not count.
std::size_t letters(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// Where the lines that continue this one begin.
std::size_t indent_of(const std::string& line, std::size_t columns) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  std::size_t indent = begin + 2;
  for (std::size_t at = line.find("  ", begin); at != std::string::npos && at < columns / 2; at = line.find("  ", at)) {
    at = std::min(line.find_first_not_of(' ', at), line.size());
    if (at < columns / 2) indent = at;
  }
  return indent;
}

std::size_t columns_of(int descriptor) {
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

bool coloured() {
  const char* no = std::getenv("NO_COLOR");
  const char* kind = std::getenv("TERM");
  return !(no && *no) && kind && std::string(kind) != "dumb";
}

std::string with_colour(const std::string& line) {
  const auto paint = [&](std::string_view mark, const char* colour) {
    return colour + std::string(mark) + "\033[0m" + line.substr(mark.size());
  };
  for (const char* mark : {"barchan: warning:", "warning:"})
    if (line.starts_with(mark)) return paint(mark, "\033[1;33m");
  return line.starts_with("barchan:") ? paint("barchan:", "\033[1;31m") : line;
}

}  // namespace

std::string wrapped(const std::string& line, std::size_t columns) {
  if (columns < narrowest || letters(line) <= columns) return line;
  const std::size_t indent = indent_of(line, columns);
  std::string text, current;
  std::size_t begin = 0;
  while (begin < line.size()) {
    std::size_t end = line.find(' ', std::max(line.find_first_not_of(' ', begin), begin));
    end = std::min(end, line.size());
    const std::string word = line.substr(begin, end - begin);  // with the blanks before it
    if (!current.empty() && letters(current) + letters(word) > columns &&
        current.find_first_not_of(' ') != std::string::npos) {
      text += current + '\n';
      current = std::string(indent, ' ') + word.substr(std::min(word.find_first_not_of(' '), word.size()));
    } else {
      current += word;
    }
    begin = end;
  }
  return text + current;
}

/// Keeps a line until it is whole. What stands in a line of std::cout when it is flushed is written as it is.
class Terminal::Buffer : public std::streambuf {
 public:
  /// `whole`: a line that is not whole waits. std::cerr is flushed after every piece of one.
  Buffer(std::ostream& stream, int descriptor, bool whole)
      : stream_(stream), under_(stream.rdbuf(this)), descriptor_(descriptor), colours_(coloured()), whole_(whole) {}
  ~Buffer() override {
    whole_ = false;
    Buffer::sync();
    stream_.rdbuf(under_);
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

 protected:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char letter = traits_type::to_char_type(c);
    return xsputn(&letter, 1) == 1 ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    const std::lock_guard lock(mutex_);
    for (std::streamsize k = 0; k < count; ++k) {
      if (text[k] != '\n') {
        line_ += text[k];
        continue;
      }
      if (!put(with_ends(line_) + '\n')) return k;
      line_.clear();
      begun_ = false;
    }
    return count;
  }
  int sync() override {
    const std::lock_guard lock(mutex_);
    if (!line_.empty() && !whole_) {
      put(line_);
      line_.clear();
      begun_ = true;  // the rest of the line stays as it is, too
    }
    return under_->pubsync();
  }

 private:
  std::string with_ends(const std::string& line) const {
    if (begun_) return line;
    const std::string text = wrapped(line, columns_of(descriptor_));
    return colours_ ? with_colour(text) : text;
  }
  bool put(const std::string& text) {
    const auto size = static_cast<std::streamsize>(text.size());
    return under_->sputn(text.data(), size) == size;
  }

  std::ostream& stream_;
  std::streambuf* under_;
  int descriptor_;
  bool colours_, whole_, begun_ = false;
  std::string line_;
  std::mutex mutex_;
};

Terminal::Terminal() {
  if (isatty(STDOUT_FILENO)) out_ = std::make_unique<Buffer>(std::cout, STDOUT_FILENO, false);
  if (isatty(STDERR_FILENO)) error_ = std::make_unique<Buffer>(std::cerr, STDERR_FILENO, true);
}

Terminal::~Terminal() = default;

}  // namespace barchan
