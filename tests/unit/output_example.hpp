// What the tests of output share: a frame with awkward numbers, a directory that goes away, a disk that is full.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <bit>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <random>
#include <string>

#include "base/errors.hpp"
#include "output/frame.hpp"

namespace barchan::example {

/// Removed with all that is in it at the end of a test.
struct TemporaryDirectory {
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "barchan_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("mkdtemp failed");
    path = name;
  }
  ~TemporaryDirectory() { std::filesystem::remove_all(path); }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path / name; }
  std::filesystem::path path;
};

/// Files cannot grow beyond `bytes` while it lives: the nearest thing to a full disk that needs no privilege.
struct SmallDisk {
  explicit SmallDisk(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit small{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallDisk() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

/// n particles with random numbers, ids that are neither sorted nor contiguous, every number of components that the
/// fields have, and numbers that text would lose: NaN, infinities, the least number, -0.
inline Frame frame(std::size_t n, int index = 3, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Frame f;
  f.index = index;
  f.step = 1234567890123L + index;
  f.time = 0.1 * index;
  f.domain = {-0.1, 0.3, 0.0, 1e-300, 0.7, 2.0};
  f.phase_names = {"air", "sand grains", "Wände"};
  f.phase_kinds = {"fluid", "grains", "wall"};
  f.fields = {{"velocity", "m/s", 3, {}}, {"density", "kg/m3", 1, {}}, {"stress", "Pa", 6, {}}, {"marker", "", 1, {}}};
  for (std::size_t k = 0; k < n; ++k) {
    for (int c = 0; c < 3; ++c) f.points.push_back(normal(random));
    f.id.push_back(static_cast<std::int64_t>(3 * (n - k)) + 5000000000L);
    f.phase.push_back(static_cast<std::int32_t>(k % 3));
    for (auto& field : f.fields)
      for (int c = 0; c < field.components; ++c) field.values.push_back(normal(random));
  }
  using Limits = std::numeric_limits<double>;
  const double awkward[]{Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), Limits::denorm_min(), -0.0};
  for (std::size_t k = 0; k < std::size(awkward) && k < n; ++k) f.fields[1].values[k] = awkward[k];
  return f;
}

inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

inline void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.domain, b.domain);
  EXPECT_TRUE(same_bits(a.points, b.points));
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.phase, b.phase);
  EXPECT_EQ(a.phase_names, b.phase_names);
  EXPECT_EQ(a.phase_kinds, b.phase_kinds);
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (std::size_t k = 0; k < a.fields.size(); ++k) {
    EXPECT_EQ(a.fields[k].name, b.fields[k].name);
    EXPECT_EQ(a.fields[k].unit, b.fields[k].unit);
    EXPECT_EQ(a.fields[k].components, b.fields[k].components);
    EXPECT_TRUE(same_bits(a.fields[k].values, b.fields[k].values)) << a.fields[k].name;
  }
}

/// Runs `action`, which must throw an OutputError whose message holds every one of `words`.
template <class Action>
void expect_output_error(Action&& action, std::initializer_list<std::string> words) {
  try {
    action();
    FAIL() << "no OutputError";
  } catch (const OutputError& e) {
    for (const auto& word : words)
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << "'" << word << "' is not in: " << e.what();
  }
}

}  // namespace barchan::example
