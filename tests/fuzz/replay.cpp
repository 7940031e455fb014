// Every input of the corpus, and what a few thousand small damages make of it: refused or read, in less than a second
// each. docs/robustness.md says how the targets are run under libFuzzer.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "fuzz/targets.hpp"

namespace barchan::fuzz {
namespace {

namespace fs = std::filesystem;

class Corpus : public ::testing::TestWithParam<Target> {};

void run_for_less_than_a_second(const Target& target, const std::string& text, const std::string& what) {
  const auto begin = std::chrono::steady_clock::now();
  target.run(text);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_LT(seconds, 1.0) << target.name << " " << what;
}

TEST_P(Corpus, IsReadOrRefused) {
  const fs::path folder = fs::path(BARCHAN_SOURCE_DIR) / "tests/fuzz/corpus" / GetParam().name;
  std::mt19937 random(1);
  int inputs = 0;
  for (const auto& file : fs::directory_iterator(folder)) {
    std::ifstream stream(file.path(), std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(stream), {}};
    run_for_less_than_a_second(GetParam(), whole, file.path().filename());
    ++inputs;
    for (int k = 0; k < 100 && !whole.empty(); ++k) {
      std::string damaged = whole;
      const std::size_t at = random() % damaged.size();
      switch (random() % 4) {
        case 0: damaged.resize(at); break;
        case 1: damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8)); break;
        case 2: damaged.insert(at, "99999999999"); break;
        default: damaged.erase(at, 1 + random() % 20);
      }
      run_for_less_than_a_second(GetParam(), damaged, file.path().filename());
    }
  }
  EXPECT_GT(inputs, 2) << folder;
}

INSTANTIATE_TEST_SUITE_P(Targets, Corpus, ::testing::ValuesIn(targets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace barchan::fuzz
