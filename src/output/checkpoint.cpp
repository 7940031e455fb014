#include "output/checkpoint.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "base/errors.hpp"
#include "base/ranks.hpp"
#include "output/checked_bytes.hpp"
#include "output/checkpoint_pieces.hpp"
#include "output/whole_file.hpp"

namespace barchan {

namespace {

constexpr std::string_view magic = "barchan checkpoint 2\n";

/// All items but the state, which comes last.
void items_before_state(Archive& a, Checkpoint& c) {
  a.text("version", c.version);
  a.text("instructions", c.instructions);
  a.text("scene", c.scene);
  a.number("time", c.time);
  a.number("step", c.step);
}

Archive::Source bytes_of(const std::filesystem::path& file) {
  const auto open = std::make_shared<OpenFile>(file, "there is no such file; expected a checkpoint, or \"latest\"");
  return {open->size(), [open](std::uint64_t at, void* to, std::size_t size) { open->read(at, to, size); }};
}

/// From the bytes of all items.
Checkpoint checkpoint_of(const Archive::Source& items) {
  Archive archive(items);
  Checkpoint checkpoint;
  items_before_state(archive, checkpoint);
  archive.parts<char>("state",
                      [&](std::uint64_t size, auto&&) { checkpoint.state = part_of(items, archive.place(), size); });
  archive.finish();
  return checkpoint;
}

void refuse_others(const Archive::Source& file) {
  std::array<char, magic.size()> words{};
  if (file.size >= words.size()) file.read(0, words.data(), words.size());
  if (std::string_view(words.data(), words.size()) != magic)
    throw SceneError("is no checkpoint of this version; expected a file that begins with \"barchan checkpoint 2\"");
}

/// Processes that see different files would not make the same calls from here on.
void refuse_different(const Archive::Source& file, std::uint64_t identity) {
  Communicator* const all = ranks::available();
  if (!all) return;
  using Seen = std::array<std::uint64_t, 2>;
  const Seen mine{file.size, identity};
  std::vector<Seen> seen(static_cast<std::size_t>(all->size()));
  all->all_gather(&mine, sizeof mine, seen.data());
  for (const Seen& other : seen)
    if (other != seen.front())
      throw SceneError("is not the same file for all ranks; expected one that all of them see");
}

/// Gives the file of the last checkpoint the name of the older one. A link, so that at no moment there is none; a file
/// system without links has none for a moment.
void keep_as_older(const std::filesystem::path& file) {
  const std::filesystem::path older = older_checkpoint(file);
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) return;
  std::filesystem::remove(older, failed);
  std::filesystem::create_hard_link(file, older, failed);
  if (failed) std::filesystem::rename(file, older, failed);
}

void write_one_file(const std::filesystem::path& file, const std::function<void(Archive&)>& all) {
  CheckedHead head;
  Archive sums([&](const void* data, std::size_t size) {
    head.size += size;
    head.sum = checksum(data, size, head.sum);
  });
  all(sums);
  WholeFile out(file);
  out.write(magic);
  out.write({reinterpret_cast<const char*>(&head), sizeof head});
  SmallWrites small(out);
  Archive bytes([&](const void* data, std::size_t size) { small.write(data, size); });
  all(bytes);
  small.flush();
  out.sync();  // from here on the older one is gone
  keep_as_older(file);
  out.publish();
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, Checkpoint about, const std::function<void(Archive&)>& state) {
  const auto all = [&](Archive& a) {
    items_before_state(a, about);
    a.nested("state", state);
  };
  const bool in_pieces = ranks::active() && ranks::active()->size() > 1;
  if (in_pieces) write_in_pieces(file, all, [&] { keep_as_older(file); });
  else write_one_file(file, all);
  if (ranks::is_first()) remove_unnamed_pieces(file, {file, older_checkpoint(file)});
}

std::filesystem::path older_checkpoint(const std::filesystem::path& file) { return file.string() + ".older"; }

void remove_checkpoints(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::remove(older_checkpoint(file), ignored);
  std::filesystem::remove(file, ignored);
  remove_unnamed_pieces(file, {file, older_checkpoint(file)});
}

void remove_older_checkpoint(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::remove(older_checkpoint(file), ignored);
  remove_unnamed_pieces(file, {file});
}

std::pair<Checkpoint, std::string> read_newest_checkpoint(const std::filesystem::path& file) {
  std::string damage;
  try {
    return {read_checkpoint(file), ""};
  } catch (const SceneError& e) { damage = e.what(); }
  try {
    return {read_checkpoint(older_checkpoint(file)), damage};
  } catch (const SceneError& e) {
    if (!std::filesystem::exists(older_checkpoint(file))) throw SceneError(damage);
    throw SceneError(damage + "\n" + e.what());
  }
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  Archive::Source bytes;
  std::optional<CheckpointIndex> index;
  const auto look = [&]() -> std::string {
    try {
      bytes = bytes_of(file);
      if (is_index(bytes)) index = parse_index(bytes);
      else refuse_others(bytes);
      return "";
    } catch (const SceneError& e) { return e.what(); }
  };
  try {
    if (const std::string error = ranks::first_text(look()); !error.empty()) throw SceneError(error);
    refuse_different(bytes, index ? index->identity : 0);
    return checkpoint_of(index ? put_together(bytes, *index, file.parent_path())
                               : behind_head(bytes, magic.size(), shared_checksum));
  } catch (const SceneError& e) { throw SceneError("--restart " + file.string() + ": " + e.what()); }
}

Checkpoint parse_checkpoint(const std::vector<char>& all) {
  const Archive::Source file = source_of(all);
  refuse_others(file);
  return checkpoint_of(behind_head(file, magic.size(), [](const Archive::Source& bytes) { return checksum(bytes); }));
}

}  // namespace barchan
