#include "output/checkpoint.hpp"

#include <zlib.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>

#include "base/errors.hpp"
#include "output/whole_file.hpp"
#include "state/archive.hpp"

namespace barchan {

namespace {

constexpr std::string_view magic = "barchan checkpoint 2\n";

/// What stands between the magic words and the items.
struct CheckpointHead {
  std::uint64_t size = 0;  // bytes of the items
  std::uint32_t sum = 0;   // their CRC-32
  std::uint32_t unused = 0;
};

/// `before`: that of what stands before.
std::uint32_t checksum(const void* data, std::size_t size, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, static_cast<const Bytef*>(data), size));
}

/// All items but the state, which comes last.
void items_before_state(Archive& a, Checkpoint& c) {
  a.text("version", c.version);
  a.text("instructions", c.instructions);
  a.text("scene", c.scene);
  a.number("time", c.time);
  a.number("step", c.step);
}

std::vector<char> bytes_of(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw SceneError("there is no such file; expected a checkpoint, or \"latest\"");
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> all{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.good() && !stream.eof())
    throw SceneError(std::string("cannot be read: ") + std::strerror(errno ? errno : EIO));
  return all;
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

}  // namespace

void write_checkpoint(const std::filesystem::path& file, Checkpoint about, const std::function<void(Archive&)>& state) {
  const auto all = [&](Archive& a) {
    items_before_state(a, about);
    a.nested("state", state);
  };
  CheckpointHead head;
  Archive sums([&](const void* data, std::size_t size) {
    head.size += size;
    head.sum = checksum(data, size, head.sum);
  });
  all(sums);
  WholeFile out(file);
  out.write(magic);
  out.write({reinterpret_cast<const char*>(&head), sizeof head});
  std::string small;  // pieces that wait for each other
  Archive bytes([&](const void* data, std::size_t size) {
    const std::string_view piece(static_cast<const char*>(data), size);
    if (small.size() + size > 1 << 16) {
      out.write(small);
      small.clear();
    }
    if (size > 1 << 16) out.write(piece);
    else small += piece;
  });
  all(bytes);
  out.write(small);
  keep_as_older(file);
  out.publish();
}

std::filesystem::path older_checkpoint(const std::filesystem::path& file) { return file.string() + ".older"; }

void remove_checkpoints(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::remove(older_checkpoint(file), ignored);
  std::filesystem::remove(file, ignored);
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
  const auto fail = [&](const std::string& what) -> SceneError {
    return SceneError("--restart " + file.string() + ": " + what);
  };
  try {
    return parse_checkpoint(bytes_of(file));
  } catch (const SceneError& e) { throw fail(e.what()); }
}

Checkpoint parse_checkpoint(const std::vector<char>& all) {
  CheckpointHead head;
  if (all.size() < magic.size() + sizeof head || std::string_view(all.data(), magic.size()) != magic)
    throw SceneError("is no checkpoint of this version; expected a file that begins with \"barchan checkpoint 2\"");
  std::memcpy(&head, all.data() + magic.size(), sizeof head);
  const char* begin = all.data() + magic.size() + sizeof head;
  const std::size_t size = all.size() - magic.size() - sizeof head;
  if (head.size != size)
    throw SceneError("is damaged: it holds " + std::to_string(size) + " bytes; expected " + std::to_string(head.size));
  if (head.unused != 0 || checksum(begin, size) != head.sum) throw SceneError("is damaged: its checksum is wrong");
  Archive archive(std::vector<char>(begin, begin + size));
  Checkpoint checkpoint;
  items_before_state(archive, checkpoint);
  archive.array("state", checkpoint.state);
  archive.finish();
  return checkpoint;
}

}  // namespace barchan
