// A table of averages, and its three files: .csv for people, .vtp (a line) and .vti (an image) for ParaView.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/vec3.hpp"
#include "output/frame.hpp"

namespace barchan {

/// One row a place. Fields of three components are vectors; in two dimensions their z is 0 and is not in the .csv.
struct Table {
  int dimensions = 2;
  double time = 0;           // s, of the last sample that was due
  long moments = 0;          // samples in time
  std::vector<Vec3> places;  // m
  std::vector<FrameField> fields;
  std::array<std::size_t, 3> count{1, 1, 1};  // of an image: places along x, y, z, x fastest
  Vec3 step{1, 1, 1};                         // m, between them
};

/// The columns' names with their units: "x [m]", ..., "velocity_mean_x [m/s]".
std::vector<std::string> csv_columns(const Table& table);

/// Each replaces the file by rename, so that a reader sees the old one or the whole new one. Throw OutputError.
void write_csv(const std::filesystem::path& file, const Table& table);
void write_polyline(const std::filesystem::path& file, const Table& table);
void write_image(const std::filesystem::path& file, const Table& table);

}  // namespace barchan
