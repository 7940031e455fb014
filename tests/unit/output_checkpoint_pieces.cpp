// The index of a checkpoint in pieces: what it says must go together; the pieces put in make the items of one process.
#include "output/checkpoint_pieces.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <numeric>

#include "base/errors.hpp"
#include "output/checked_bytes.hpp"
#include "output/checkpoint.hpp"
#include "unit/forked_ranks.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

template <class T>
void append(std::string& text, const T& value) {
  text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Of two ranks: "ab" and "c" of the rows of a first item, none and "de" of a second one.
class PiecesOfACheckpoint : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/barchan_pieces_XXXXXX";
    folder_ = mkdtemp(name);
    fs::create_directory(folder_ / "x_checkpoint");
    index_.identity = 77;
    index_.number = 12;
    index_.folder = "x_checkpoint";
    index_.places = {3, 5};
    index_.sizes = {2, 0, 1, 2};
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::string rows = k == 0 ? "ab" : "cde";
      index_.pieces.push_back({rows.size(), checksum(rows.data(), rows.size()), 0});
      put_piece(k, {77, k, 2}, rows);
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  void put_piece(std::size_t number, const PieceHead& head, const std::string& rows) const {
    std::string text(PieceHead::magic);
    append(text, head);
    std::ofstream(folder_ / index_.name_of(number), std::ios::binary) << text << rows;
  }
  /// The file of the index with the items "123456".
  std::vector<char> file() {
    Archive a;
    index_.head(a);
    std::string items = "123456";
    a.array("items", items);
    std::string text(CheckpointIndex::magic);
    append(text, CheckedHead{a.bytes().size(), checksum(a.bytes().data(), a.bytes().size()), 0});
    text.append(a.bytes().data(), a.bytes().size());
    return {text.begin(), text.end()};
  }
  std::string together() {
    const std::vector<char> bytes = file();
    const Archive::Source all = put_together(source_of(bytes), parse_index(source_of(bytes)), folder_);
    std::string text(all.size, '?');
    all.read(0, text.data(), text.size());
    for (std::size_t at = 0; at < text.size(); ++at) {  // any part of it
      std::string part(text.size() - at, '?');
      all.read(at, part.data(), part.size());
      EXPECT_EQ(part, text.substr(at));
    }
    EXPECT_THROW(all.read(text.size(), text.data(), 1), SceneError);
    return text;
  }
  void expect_error(const std::string& words) {
    try {
      together();
      FAIL() << "expected: " << words;
    } catch (const SceneError& e) { EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what(); }
  }

  fs::path folder_;
  CheckpointIndex index_;
};

TEST_F(PiecesOfACheckpoint, AreTheItemsOfOneProcess) {
  EXPECT_EQ(index_.name_of(1), "x_checkpoint/000012_0001");
  EXPECT_EQ(together(), "123abc45de6");
}

TEST_F(PiecesOfACheckpoint, LostOrDamagedOrOfAnotherAreRefusedByName) {
  put_piece(1, {78, 1, 2}, "cde");
  expect_error("x_checkpoint/000012_0001' is of another checkpoint");
  put_piece(1, {77, 0, 2}, "cde");
  expect_error("x_checkpoint/000012_0001' is of another checkpoint");
  put_piece(1, {77, 1, 2}, "cdf");
  expect_error("x_checkpoint/000012_0001' is damaged: its checksum is wrong");
  put_piece(1, {77, 1, 2}, "cd");
  expect_error("x_checkpoint/000012_0001' is damaged: it holds 2 bytes; expected 3");
  fs::remove(folder_ / index_.name_of(1));
  expect_error("x_checkpoint/000012_0001' is not there");
}

TEST_F(PiecesOfACheckpoint, AnIndexThatContradictsItselfIsRefused) {
  const CheckpointIndex good = index_;
  const auto refuses = [&](const std::string& words, auto&& change) {
    index_ = good;
    change(index_);
    expect_error(words);
  };
  refuses("folder", [](auto& x) { x.folder = "../x_checkpoint"; });
  refuses("folder", [](auto& x) { x.folder = "/tmp"; });
  refuses("folder", [](auto& x) { x.folder = ""; });
  refuses("other rows", [](auto& x) { x.sizes.pop_back(); });
  refuses("other rows", [](auto& x) { x.pieces.clear(); });
  refuses("other sizes", [](auto& x) { x.sizes[3] = 1; });
  refuses("rows are not in it", [](auto& x) { x.places = {5, 3}; });
  refuses("rows are not in it", [](auto& x) { x.places = {3, 7}; });
  refuses("too large", [](auto& x) { x.sizes[0] = ~std::uint64_t{0}; });
  index_ = good;
  std::vector<char> cut = file();
  for (std::size_t k = 0; k < cut.size(); ++k) {
    cut[k] = static_cast<char>(cut[k] ^ 16);
    EXPECT_THROW(static_cast<void>(is_index(source_of(cut)) ? parse_index(source_of(cut)) : throw SceneError("magic")),
                 SceneError)
        << "byte " << k;
    cut[k] = static_cast<char>(cut[k] ^ 16);
  }
  for (; !cut.empty(); cut.pop_back()) {
    if (cut.size() == file().size()) continue;
    EXPECT_THROW(parse_index(source_of(cut)), SceneError) << cut.size() << " bytes";
  }
}

TEST_F(PiecesOfACheckpoint, ThatNoIndexNamesAreRemoved) {
  const fs::path index = folder_ / "x.checkpoint", older = folder_ / "x.checkpoint.older",
                 in = folder_ / "x_checkpoint";
  const auto put = [](const fs::path& where, const std::vector<char>& bytes) {
    std::ofstream(where, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  };
  put(index, file());
  for (const char* name : {"000011_0000", "000013_0000.part", "000013_0001", "mine", "000013_01"}) put(in / name, {});
  const auto names = [&] {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(in)) all.push_back(entry.path().filename());
    std::sort(all.begin(), all.end());
    return all;
  };
  put(older, {'?'});  // it may be an index: a file that is read wrong is no reason to remove anything
  fs::permissions(older, fs::perms::none);
  if (::geteuid() != 0) {
    remove_unnamed_pieces(index, {index, older});
    EXPECT_EQ(names().size(), 7u);
  }
  fs::remove(older);
  remove_unnamed_pieces(index, {index, older});
  EXPECT_EQ(names(), (std::vector<std::string>{"000012_0000", "000012_0001", "000013_01", "mine"}));
  fs::remove(index);
  remove_unnamed_pieces(index, {index});
  EXPECT_EQ(names(), (std::vector<std::string>{"000013_01", "mine"}));
  fs::remove(in / "mine");
  fs::remove(in / "000013_01");
  remove_unnamed_pieces(index, {index});
  EXPECT_FALSE(fs::exists(in));
}

/// Ten numbers, of which each rank has a part, and one that all have.
void name_state(Archive& a, bool fails = false) {
  const ranks::Share share = ranks::own_share();
  const std::size_t first = share.begin(10), count = share.end(10) - first;
  std::vector<std::int64_t> own(count);
  std::iota(own.begin(), own.end(), static_cast<std::int64_t>(first));
  std::int64_t of_all = 5;
  a.rows("rows", own.data(), {first, count, 10});
  if (fails && share.number == 1) throw OutputError("the disk of rank 1 is full");
  a.number("of all", of_all);
  a.rows("rows again", own.data(), {first, count, 10});
}

class CheckpointOfRanks : public PiecesOfACheckpoint {
 protected:
  void write(const fs::path& file, bool fails = false) const {
    write_checkpoint(file, {"1.0", "AVX2", "a = 1", 0.25, 17, {}}, [&](Archive& a) { name_state(a, fails); });
  }
  static std::string state_of(const Checkpoint& c) {
    std::string bytes(c.state.size, '?');
    c.state.read(0, bytes.data(), bytes.size());
    return bytes;
  }
  std::vector<std::string> pieces() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_ / "ranks_checkpoint"))
      all.push_back(entry.path().filename());
    std::sort(all.begin(), all.end());
    return all;
  }
};

TEST_F(CheckpointOfRanks, IsThatOfOneProcess) {
  const fs::path one = folder_ / "one.checkpoint", file = folder_ / "ranks.checkpoint";
  write(one);
  EXPECT_FALSE(fs::exists(folder_ / "one_checkpoint"));
  for (int times = 1; times <= 3; ++times)
    forked::on_ranks(3, [&] {
      ranks::share();
      write(file);
      return std::string();
    });
  EXPECT_EQ(pieces().size(), 6u) << "of the last one and the one before";
  for (const fs::path& each : {file, older_checkpoint(file)}) {
    const Checkpoint c = read_checkpoint(each);
    EXPECT_EQ(state_of(c), state_of(read_checkpoint(one)));
    EXPECT_EQ(c.scene, "a = 1");
    EXPECT_EQ(c.step, 17);
  }
  for (const std::string& bytes : forked::on_ranks(2, [&] { return state_of(read_checkpoint(file)); }))
    EXPECT_EQ(bytes, state_of(read_checkpoint(one)));
  // A piece that is lost is told by all, though one rank looks for it.
  fs::remove(folder_ / "ranks_checkpoint/000003_0001");
  for (const std::string& error : forked::on_ranks(2, [&] {
         try {
           read_checkpoint(file);
         } catch (const SceneError& e) { return std::string(e.what()); }
         return std::string();
       }))
    EXPECT_NE(error.find("000003_0001' is not there"), std::string::npos) << error;
  EXPECT_EQ(read_newest_checkpoint(file).first.step, 17);
  write(file);  // of one process: the lost one becomes the older one
  write(file);
  EXPECT_FALSE(fs::exists(folder_ / "ranks_checkpoint"));
}

TEST_F(CheckpointOfRanks, StaysWhatItWasWhenARankCannotWrite) {
  const fs::path file = folder_ / "ranks.checkpoint";
  const auto written = [&](bool fails) {
    return forked::on_ranks(3, [&] {
      ranks::share();
      try {
        write(file, fails);
      } catch (const OutputError& e) { return std::string(e.what()); }
      return std::string();
    });
  };
  EXPECT_EQ(written(false), (std::vector<std::string>(3, "")));
  EXPECT_EQ(written(true), (std::vector<std::string>(3, "the disk of rank 1 is full")));
  EXPECT_EQ(pieces(), (std::vector<std::string>{"000001_0000", "000001_0001", "000001_0002"}));
  EXPECT_FALSE(fs::exists(older_checkpoint(file)));
  EXPECT_EQ(read_checkpoint(file).step, 17);
}

}  // namespace
}  // namespace barchan
