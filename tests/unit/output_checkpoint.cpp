// Checkpoint files: what was written is read back; what was damaged is refused.
#include "output/checkpoint.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "base/errors.hpp"
#include "scene/identity.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

class CheckpointFile : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/barchan_checkpoint_XXXXXX";
    folder_ = mkdtemp(name);
    file_ = folder_ / "x.checkpoint";
    for (int k = 0; k < 100000; ++k) many_.push_back(static_cast<char>(k % 509 * (k % 251) % 251));
    write(whole_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  /// A state of one long item and some short ones.
  static void name_state(Archive& a, std::vector<char>& many) {
    long numbers[] = {3, 4, 5};
    for (long& n : numbers) a.number("a number", n);
    a.array("many", many);
    std::vector<double> none;
    a.array("none", none);
    a.number("last", numbers[0]);
  }
  void write(const Checkpoint& c) {
    write_checkpoint(file_, c, [&](Archive& a) { name_state(a, many_); });
  }
  static std::vector<char> all_of(const Archive::Source& source) {
    std::vector<char> all(source.size);
    source.read(0, all.data(), all.size());
    return all;
  }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }

  fs::path folder_, file_;
  std::vector<char> many_;
  Checkpoint whole_{"1.0", "AVX2", "a = 1\nb = 2\n", 0.25, 17, {}};
};

TEST_F(CheckpointFile, IsReadBack) {
  const Checkpoint c = read_checkpoint(file_);
  EXPECT_EQ(c.version, whole_.version);
  EXPECT_EQ(c.instructions, whole_.instructions);
  EXPECT_EQ(c.scene, whole_.scene);
  EXPECT_EQ(c.time, whole_.time);
  EXPECT_EQ(c.step, whole_.step);
  Archive state(c.state), expected;
  name_state(expected, many_);
  EXPECT_EQ(all_of(c.state), expected.bytes());
  std::vector<char> loaded;
  name_state(state, loaded);
  state.finish();
  EXPECT_EQ(loaded, many_);
}

TEST_F(CheckpointFile, IsRefusedWithAnyByteFlipped) {
  const std::string good = bytes();
  for (std::size_t k = 0; k < good.size(); k += 997) {
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

TEST_F(CheckpointFile, OlderOneIsTakenWhenTheNewerIsDamaged) {
  EXPECT_EQ(read_newest_checkpoint(file_).second, "");
  Checkpoint next = whole_;
  next.step = 18;
  write(next);
  EXPECT_EQ(read_newest_checkpoint(file_).first.step, 18);
  EXPECT_EQ(read_checkpoint(older_checkpoint(file_)).step, 17);
  std::string bad = bytes();
  bad[bad.size() / 2] ^= 4;
  put(bad);
  const auto [older, damage] = read_newest_checkpoint(file_);
  EXPECT_EQ(older.step, 17);
  EXPECT_NE(damage.find("x.checkpoint: is damaged"), std::string::npos) << damage;
  fs::remove(file_);
  EXPECT_EQ(read_newest_checkpoint(file_).first.step, 17);
  std::ofstream(older_checkpoint(file_)) << "nothing";
  EXPECT_THROW(read_newest_checkpoint(file_), SceneError);
  remove_checkpoints(file_);
  EXPECT_FALSE(fs::exists(older_checkpoint(file_)));
}

TEST(CheckpointScenes, DifferencesAreNamedByKey) {
  EXPECT_EQ(difference("a = 1\nb = 2\n", "b = 2\na = 1\n"), "");
  EXPECT_EQ(difference("a = 1\n[c]\nb = 2\n", "a = 1\n[c]\nb = 3\n"), "  c.b: 2 then, 3 now\n");
  EXPECT_EQ(difference("[[fill]]\nx = [1, 2]", "[[fill]]\ny = 'q'"),
            "  fill.0.x: [ 1, 2 ] then, not there now\n  fill.0.y: not there then, 'q' now\n");
}

TEST(CheckpointScenes, HarmlessKeysAreLeftOut) {
  const auto of = [](const char* text) { return identity_of(toml::parse(text)); };
  EXPECT_EQ(of("title = 'a'\nspacing = 1\n[time]\nend = 1\n[output]\nevery = 1\n"),
            of("title = 'b'\nspacing = 1\n[time]\nend = 2\n[output]\nfields = ['stress']\n"));
  EXPECT_NE(of("[output]\nformat = 'vtu'\n"), of("[output]\nformat = 'vtp'\n"));
  EXPECT_NE(of("[time]\nsafety = 1\n"), of("[time]\nsafety = 2\n"));
}

}  // namespace
}  // namespace barchan
