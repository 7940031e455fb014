// What is printed on a terminal fits its width, and warnings and errors have a colour. Into a file or a pipe goes the
// text as it is.
#pragma once

#include <memory>
#include <string>

namespace barchan {

/// Lines of at most `columns` letters, broken at blanks. The lines that continue one begin under its last column of
/// text, which is what follows two blanks, or else two places further in than it. A word that is longer stays whole.
std::string wrapped(const std::string& line, std::size_t columns);

/// While it lives, std::cout and std::cerr go through wrapped() where they are a terminal, and "barchan: " and
/// "warning: " at the begin of a line are coloured there: not with NO_COLOR (no-color.org) or TERM=dumb.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

 private:
  class Buffer;
  std::unique_ptr<Buffer> out_, error_;
};

}  // namespace barchan
