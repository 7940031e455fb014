// Checkpoint files: what was written is read back; what was damaged is refused.
#include "output/checkpoint.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "base/errors.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

class CheckpointFile : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/barchan_checkpoint_XXXXXX";
    folder_ = mkdtemp(name);
    file_ = folder_ / "x.checkpoint";
    for (int k = 0; k < 5000; ++k) whole_.state.push_back(static_cast<char>(k * k % 251));
    write_checkpoint(file_, whole_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }

  fs::path folder_, file_;
  Checkpoint whole_{"1.0", "AVX2", "a = 1\nb = 2\n", 0.25, 17, {}};
};

TEST_F(CheckpointFile, IsReadBack) {
  const Checkpoint c = read_checkpoint(file_);
  EXPECT_EQ(c.version, whole_.version);
  EXPECT_EQ(c.instructions, whole_.instructions);
  EXPECT_EQ(c.scene, whole_.scene);
  EXPECT_EQ(c.time, whole_.time);
  EXPECT_EQ(c.step, whole_.step);
  EXPECT_EQ(c.state, whole_.state);
}

TEST_F(CheckpointFile, IsRefusedWithAnyByteFlipped) {
  const std::string good = bytes();
  for (std::size_t k = 0; k < good.size(); k += 37) {
    std::string bad = good;
    bad[k] = static_cast<char>(bad[k] ^ (1 << (k % 8)));
    put(bad);
    EXPECT_THROW(read_checkpoint(file_), SceneError) << "byte " << k;
  }
}

TEST_F(CheckpointFile, IsRefusedCutOffOrTooLong) {
  const std::string good = bytes();
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, std::size_t{30}, good.size() / 2, good.size() - 1}) {
    put(good.substr(0, size));
    EXPECT_THROW(read_checkpoint(file_), SceneError) << size << " bytes";
  }
  put(good + "x");
  EXPECT_THROW(read_checkpoint(file_), SceneError);
  fs::remove(file_);
  EXPECT_THROW(read_checkpoint(file_), SceneError);
}

TEST(CheckpointScenes, DifferencesAreNamedByLine) {
  EXPECT_EQ(difference("a = 1\nb = 2\n", "a = 1\nb = 2\n"), "");
  EXPECT_EQ(difference("a = 1\nb = 2\n", "a = 1\nb = 3\n"), "  - b = 2\n  + b = 3\n");
}

}  // namespace
}  // namespace barchan
