// Writing a checkpoint in pieces, and removing pieces that no index names.
#include <algorithm>
#include <random>
#include <set>

#include "base/errors.hpp"
#include "base/ranks.hpp"
#include "output/checked_bytes.hpp"
#include "output/checkpoint_pieces.hpp"
#include "output/pieces.hpp"
#include "output/series.hpp"
#include "output/whole_file.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

/// NAME.checkpoint has its pieces in NAME_checkpoint.
fs::path folder_of(const fs::path& file) {
  std::string name = file.filename().string();
  std::replace(name.begin(), name.end(), '.', '_');
  return file.parent_path() / name;
}

/// The number of the checkpoint whose piece has this name, also while it is being written.
std::optional<std::uint64_t> number_of_piece(std::string name) {
  if (name.ends_with(WholeFile::suffix)) name.resize(name.size() - WholeFile::suffix.size());
  const std::size_t line = name.find('_');
  if (line == std::string::npos || line < 6 || line > 18 || name.size() < line + 5) return std::nullopt;
  const std::string number = name.substr(0, line), rank = name.substr(line + 1);
  if ((number + rank).find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return std::stoull(number);
}

/// What is in the folder of pieces, by number of the checkpoint.
std::vector<std::pair<std::uint64_t, fs::path>> pieces_in(const fs::path& folder) {
  std::vector<std::pair<std::uint64_t, fs::path>> found;
  if (!is_folder_of_pieces(folder)) return found;
  std::error_code failed;
  for (const auto& file : fs::directory_iterator(folder, failed))
    if (const auto number = number_of_piece(file.path().filename().string())) found.emplace_back(*number, file.path());
  return found;
}

/// The number in an index; nothing: the file is not there, or is a checkpoint in one file. Throws SceneError.
std::optional<std::uint64_t> number_in(const fs::path& file) {
  std::error_code unseen;
  if (!fs::exists(file, unseen) && !unseen) return std::nullopt;
  const OpenFile open(file, "cannot be read");
  const Archive::Source bytes{open.size(),
                              [&](std::uint64_t at, void* to, std::size_t size) { open.read(at, to, size); }};
  if (!is_index(bytes)) return std::nullopt;
  return parse_index(bytes, false).number;
}

/// A number that no piece in the folder has: none is written over as long as an index may name it.
std::uint64_t next_number(const fs::path& file) {
  std::uint64_t last = 0;
  for (const auto& [number, piece] : pieces_in(folder_of(file))) last = std::max(last, number);
  return last + 1;
}

/// Writes the rows of this rank; `sizes`: bytes of each item of rows.
CheckpointIndex::Piece write_own_piece(const fs::path& file, const PieceHead& head,
                                       const std::function<void(Archive&)>& all, std::vector<std::uint64_t>& sizes) {
  make_directory(file.parent_path());
  CheckpointIndex::Piece piece;
  WholeFile out(file);
  SmallWrites small(out);
  small.write(PieceHead::magic.data(), PieceHead::magic.size());
  small.write(&head, sizeof head);
  Archive rows([](const void*, std::size_t) {},
               [&](const void* data, std::size_t size, std::uint64_t) {
                 sizes.push_back(size);
                 piece.size += size;
                 if (size == 0) return;  // the data of an empty vector may be null
                 piece.sum = checksum(data, size, piece.sum);
                 small.write(data, size);
               });
  all(rows);
  small.flush();
  out.publish();
  return piece;
}

void write_index(const fs::path& file, CheckpointIndex index, const std::function<void(Archive&)>& all,
                 const std::function<void()>& before) {
  const auto without_rows = [](const Archive::Sink& sink) {
    return Archive(sink, [](const void*, std::size_t, std::uint64_t) {});
  };
  Archive places([&](const void*, std::size_t size) { index.items += size; },
                 [&](const void*, std::size_t, std::uint64_t) { index.places.push_back(index.items); });
  all(places);
  const auto items = [&](Archive& a) {
    index.head(a);
    a.nested("items", index.items, all);
  };
  CheckedHead head;
  Archive sums = without_rows([&](const void* data, std::size_t size) {
    head.size += size;
    head.sum = checksum(data, size, head.sum);
  });
  items(sums);
  WholeFile out(file);
  SmallWrites small(out);
  small.write(CheckpointIndex::magic.data(), CheckpointIndex::magic.size());
  small.write(&head, sizeof head);
  Archive bytes = without_rows([&](const void* data, std::size_t size) { small.write(data, size); });
  items(bytes);
  small.flush();
  out.sync();
  before();
  out.publish();
}

/// Calls f; throws on all ranks what it throws on any of them.
template <class F, class Undo>
void together(F&& f, Undo&& undo) {
  std::string error;
  try {
    f();
  } catch (const OutputError& e) { error = e.what(); }
  if (error = ranks::first_text(error); error.empty()) return;
  undo();
  throw OutputError(error);
}

}  // namespace

void write_in_pieces(const fs::path& file, const std::function<void(Archive&)>& all,
                     const std::function<void()>& before) {
  Communicator& others = *ranks::active();
  const auto rank = static_cast<std::size_t>(others.rank()), count = static_cast<std::size_t>(others.size());
  CheckpointIndex index;
  index.folder = folder_of(file).filename().string();
  if (ranks::is_first()) {
    std::random_device chance;
    index.identity = (std::uint64_t{chance()} << 32) | chance();
    index.number = next_number(file);
  }
  others.broadcast(&index.identity, sizeof index.identity, 0);
  others.broadcast(&index.number, sizeof index.number, 0);
  const fs::path own = file.parent_path() / index.name_of(rank);
  const auto undo = [&] {
    std::error_code ignored;
    fs::remove(own, ignored);
  };
  CheckpointIndex::Piece piece;
  together(
      [&] {
        piece =
            write_own_piece(own, {index.identity, static_cast<std::uint32_t>(rank), static_cast<std::uint32_t>(count)},
                            all, index.sizes);
      },
      undo);
  index.pieces = ranks::each(piece);
  ranks::join(index.sizes);
  together(
      [&] {
        if (ranks::is_first()) write_index(file, index, all, before);
      },
      undo);
}

void remove_unnamed_pieces(const fs::path& file, const std::vector<fs::path>& indexes) {
  const fs::path folder = folder_of(file);
  if (!is_folder_of_pieces(folder)) return;
  const auto pieces = pieces_in(folder);
  std::set<std::uint64_t> named;
  try {
    for (const fs::path& index : indexes)
      if (const auto number = number_in(index)) named.insert(*number);
  } catch (const SceneError&) { return; }
  std::error_code failed;
  for (const auto& [number, piece] : pieces)
    if (!named.contains(number)) fs::remove(piece, failed);
  fs::remove(folder, failed);  // fails where something else is in it
}

}  // namespace barchan
