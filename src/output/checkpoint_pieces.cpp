#include "output/checkpoint_pieces.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <memory>

#include "base/errors.hpp"
#include "base/ranks.hpp"
#include "output/checked_bytes.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

/// Nothing that fits on a disk is as large; sums of two such sizes are still numbers.
constexpr std::uint64_t largest_size = std::uint64_t{1} << 60;

/// Why the numbers of an index do not go together; "" if they do.
std::string why_wrong(const CheckpointIndex& index) {
  const std::size_t pieces = index.pieces.size(), items = index.places.size();
  const fs::path folder(index.folder);
  if (index.folder.empty() || folder.filename() != folder || index.folder == "." || index.folder == "..")
    return "its folder of pieces is not in the same folder";
  if (pieces == 0 || index.sizes.size() % pieces != 0 || index.sizes.size() / pieces != items)
    return "its pieces have other rows than it says";
  if (!std::is_sorted(index.places.begin(), index.places.end()) || (items > 0 && index.places.back() > index.items))
    return "its rows are not in it";
  std::uint64_t all = 0;
  for (std::size_t k = 0; k < pieces; ++k) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < items; ++i) {
      const std::uint64_t size = index.sizes[k * items + i];
      if (size > largest_size || (sum += size) > largest_size) return "its rows are too large";
    }
    if (sum != index.pieces[k].size || index.pieces[k].unused != 0) return "its pieces have other sizes than it says";
    if ((all += sum) > largest_size) return "its rows are too large";
  }
  return "";
}

/// A piece that is open, of the index that names it. Throws SceneError.
std::unique_ptr<OpenFile> open_piece(const CheckpointIndex& index, const fs::path& directory, std::size_t number) {
  const fs::path file = directory / index.name_of(number);
  const std::string its = "its piece '" + file.string() + "' ";
  try {
    auto piece = std::make_unique<OpenFile>(
        file, "is not there; expected the pieces of " + std::to_string(index.pieces.size()) + " ranks");
    std::array<char, PieceHead::magic.size()> words{};
    PieceHead head;
    if (piece->size() < PieceHead::bytes) throw SceneError("is damaged: it is cut off in its head");
    piece->read(0, words.data(), words.size());
    piece->read(words.size(), &head, sizeof head);
    if (std::string_view(words.data(), words.size()) != PieceHead::magic)
      throw SceneError("is no piece of a checkpoint");
    if (head.identity != index.identity || head.rank != number || head.ranks != index.pieces.size())
      throw SceneError("is of another checkpoint");
    if (const std::uint64_t size = piece->size() - PieceHead::bytes; size != index.pieces[number].size)
      throw SceneError("is damaged: it holds " + std::to_string(size) + " bytes; expected " +
                       std::to_string(index.pieces[number].size));
    return piece;
  } catch (const SceneError& e) { throw SceneError(its + e.what()); }
}

void check_piece(const CheckpointIndex& index, const fs::path& directory, std::size_t number) {
  const std::unique_ptr<OpenFile> piece = open_piece(index, directory, number);
  const Archive::Source rows{index.pieces[number].size, [&](std::uint64_t at, void* to, std::size_t size) {
                               piece->read(PieceHead::bytes + at, to, size);
                             }};
  if (checksum(rows) != index.pieces[number].sum)
    throw SceneError("its piece '" + (directory / index.name_of(number)).string() +
                     "' is damaged: its checksum is wrong");
}

/// The items of one process, of which each stretch stands in the index or in a piece.
class Together {
 public:
  Together(Archive::Source file, CheckpointIndex index, fs::path directory)
      : file_(std::move(file)), index_(std::move(index)), directory_(std::move(directory)) {
    const std::size_t pieces = index_.pieces.size(), items = index_.places.size();
    std::vector<std::uint64_t> at(pieces, PieceHead::bytes);
    std::uint64_t before = 0;
    for (std::size_t i = 0; i < items; ++i) {
      add(of_index, index_.items_at + before, index_.places[i] - before);
      before = index_.places[i];
      for (std::size_t k = 0; k < pieces; ++k) {
        const std::uint64_t size = index_.sizes[k * items + i];
        add(k, at[k], size);
        at[k] += size;
      }
    }
    add(of_index, index_.items_at + before, index_.items - before);
  }

  std::uint64_t size() const { return size_; }

  void read(std::uint64_t at, void* to, std::size_t size) {
    char* bytes = static_cast<char*>(to);
    while (size > 0) {
      const auto next = std::upper_bound(stretches_.begin(), stretches_.end(), at,
                                         [](std::uint64_t place, const Stretch& s) { return place < s.begin; });
      if (next == stretches_.begin() || at >= size_) throw SceneError("the checkpoint ends too early");
      const Stretch& stretch = *(next - 1);
      const std::uint64_t end = next == stretches_.end() ? size_ : next->begin,
                          from = stretch.at + (at - stretch.begin);
      const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(size, end - at));
      if (stretch.where == of_index) file_.read(from, bytes, n);
      else piece(stretch.where).read(from, bytes, n);
      bytes += n;
      at += n;
      size -= n;
    }
  }

 private:
  static constexpr std::size_t of_index = ~std::size_t{0}, most_open = 64;
  struct Stretch {
    std::uint64_t begin;  // among the items
    std::size_t where;    // of_index, or the number of a piece
    std::uint64_t at;     // in its file
  };

  void add(std::size_t where, std::uint64_t at, std::uint64_t size) {
    if (size > 0) stretches_.push_back({size_, where, at});
    size_ += size;
  }
  /// Opened when it is read first: a rank reads few of them.
  const OpenFile& piece(std::size_t number) {
    const auto found = open_.find(number);
    if (found != open_.end()) return *found->second;
    if (open_.size() >= most_open) open_.clear();
    return *open_.emplace(number, open_piece(index_, directory_, number)).first->second;
  }

  Archive::Source file_;
  CheckpointIndex index_;
  fs::path directory_;
  std::vector<Stretch> stretches_;
  std::uint64_t size_ = 0;
  std::map<std::size_t, std::unique_ptr<OpenFile>> open_;
};

}  // namespace

std::string CheckpointIndex::name_of(std::size_t piece) const {
  std::array<char, 64> file{};
  std::snprintf(file.data(), file.size(), "/%06llu_%04llu", static_cast<unsigned long long>(number),
                static_cast<unsigned long long>(piece));
  return folder + file.data();
}

void CheckpointIndex::head(Archive& a) {
  a.number("identity", identity);
  a.number("number", number);
  a.text("folder", folder);
  a.array("pieces", pieces);
  a.array("places of rows", places);
  a.array("bytes of rows", sizes);
}

bool is_index(const Archive::Source& file) {
  std::array<char, CheckpointIndex::magic.size()> words{};
  if (file.size < words.size()) return false;
  file.read(0, words.data(), words.size());
  return std::string_view(words.data(), words.size()) == CheckpointIndex::magic;
}

CheckpointIndex parse_index(const Archive::Source& file, bool sums) {
  const auto sum_of = [&](const Archive::Source& bytes) { return checksum(bytes); };
  const std::size_t begin = CheckpointIndex::magic.size() + sizeof(CheckedHead);
  const Archive::Source bytes = sums ? behind_head(file, CheckpointIndex::magic.size(), sum_of)
                                     : part_of(file, std::min<std::uint64_t>(begin, file.size),
                                               file.size - std::min<std::uint64_t>(begin, file.size));
  Archive a(bytes);
  CheckpointIndex index;
  index.head(a);
  a.parts<char>("items", [&](std::uint64_t count, auto&&) {
    index.items_at = begin + a.place();
    index.items = count;
  });
  a.finish();
  if (const std::string why = why_wrong(index); !why.empty()) throw SceneError("is damaged: " + why);
  return index;
}

Archive::Source put_together(const Archive::Source& file, const CheckpointIndex& index, const fs::path& directory) {
  Communicator* const all = ranks::available();
  const auto step = static_cast<std::size_t>(all ? all->size() : 1),
             first = static_cast<std::size_t>(all ? all->rank() : 0);
  std::string error;
  try {
    for (std::size_t k = first; k < index.pieces.size(); k += step) check_piece(index, directory, k);
  } catch (const SceneError& e) { error = e.what(); }
  if (error = ranks::first_text(error); !error.empty()) throw SceneError(error);
  const auto together = std::make_shared<Together>(file, index, directory);
  return {together->size(), [together](std::uint64_t at, void* to, std::size_t n) { together->read(at, to, n); }};
}

}  // namespace barchan
