// A checkpoint of several ranks: an index, NAME.checkpoint, and a piece of each rank, NAME_checkpoint/000007_0002. The
// index has all but the rows (state/archive.hpp). With the rows of all pieces put in it is the checkpoint of one
// process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "state/archive.hpp"

namespace barchan {

/// A piece begins with the magic words and this; its rows follow.
struct PieceHead {
  static constexpr std::string_view magic = "barchan checkpoint piece 2\n";

  std::uint64_t identity = 0;  // of the index that names it
  std::uint32_t rank = 0, ranks = 0;
  static const std::size_t bytes;  // with the magic words
};

/// What an index says of its pieces.
struct CheckpointIndex {
  static constexpr std::string_view magic = "barchan checkpoint index 2\n";

  struct Piece {
    std::uint64_t size = 0;  // bytes of the rows
    std::uint32_t sum = 0;   // their CRC-32
    std::uint32_t unused = 0;
  };
  std::uint64_t identity = 0;             // of chance; the pieces have it too
  std::uint64_t number = 0;               // of the checkpoint, in the names of its pieces
  std::string folder;                     // of the pieces, beside the index
  std::vector<Piece> pieces;              // by rank
  std::vector<std::uint64_t> places;      // by item of rows: where among the other bytes its rows stand
  std::vector<std::uint64_t> sizes;       // by rank, then by item of rows: bytes
  std::uint64_t items_at = 0, items = 0;  // where in the file the other bytes begin, and how many

  /// From the folder of the index.
  std::string name_of(std::size_t piece) const;
  /// All that stands before the items.
  void head(Archive& a);
};

/// Whether the file begins as an index does.
bool is_index(const Archive::Source& file);

inline const std::size_t PieceHead::bytes = magic.size() + sizeof(PieceHead);

/// Of the bytes of a file that begins with the magic words; checks all that can be checked without the pieces. `sums`:
/// also the checksum. Throws SceneError.
CheckpointIndex parse_index(const Archive::Source& file, bool sums = true);

/// The bytes of the items of one process; `index` is that of `file` in `directory`. All processes call it: together
/// they check all pieces. Throws SceneError, on all of them, when a piece is not there, damaged, or of another
/// checkpoint.
Archive::Source put_together(const Archive::Source& file, const CheckpointIndex& index,
                             const std::filesystem::path& directory);

/// Writes the items of `all`: each rank its piece, and the first one the index when all pieces are on the disk, after
/// `before` was called. All ranks call it. Throws OutputError, on all of them; then the file is what it was.
void write_in_pieces(const std::filesystem::path& file, const std::function<void(Archive&)>& all,
                     const std::function<void()>& before);

/// Removes pieces of checkpoints of this name that none of `indexes` names, and the folder if nothing else is in it.
/// What fails is left. Where an index cannot be read nothing is removed.
void remove_unnamed_pieces(const std::filesystem::path& file, const std::vector<std::filesystem::path>& indexes);

}  // namespace barchan
