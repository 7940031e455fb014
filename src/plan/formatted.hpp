// Lines of reports.
#pragma once

#include <cstdio>
#include <string>

namespace barchan {

/// What printf would print, at most 511 characters of it.
template <class... A>
std::string formatted(const char* format, A... a) {
  char text[512];
  std::snprintf(text, sizeof text, format, a...);
  return text;
}

}  // namespace barchan
