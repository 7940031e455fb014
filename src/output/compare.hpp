// `barchan compare`: two frames, series or runs, matched by particle id.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "output/frame.hpp"

namespace barchan {

struct FieldDifference {
  std::string field;
  double l1 = 0, l2 = 0, largest = 0;  // relative to the largest magnitude of A's field (absolute when that is 0)
  double scale = 0;                    // that largest magnitude
  std::int64_t first_id = -1;          // first particle (lowest id) above the tolerance, -1: none
  double first_a = 0, first_b = 0;     // its values (the component that differs most)
};

struct FrameDifference {
  double time_a = 0, time_b = 0;
  std::vector<FieldDifference> fields;
  std::vector<std::string> remarks;  // particles or fields that only one of the two has
  bool same = true;                  // no difference above the tolerance and no remark
};

/// Compares particle by particle. Positions count as a field "position".
FrameDifference compare(const Frame& a, const Frame& b, double tolerance);

/// The same for files: two frames, or two .pvd or folders with one (frames of the same time; others are a remark).
/// Throws OutputError when a file cannot be read.
std::vector<FrameDifference> compare_files(const std::filesystem::path& a, const std::filesystem::path& b,
                                           double tolerance);

std::string to_text(const std::vector<FrameDifference>& differences);
std::string to_json(const std::vector<FrameDifference>& differences);

}  // namespace barchan
