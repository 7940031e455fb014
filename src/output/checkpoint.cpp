#include "output/checkpoint.hpp"

#include <zlib.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "base/errors.hpp"
#include "output/whole_file.hpp"
#include "state/archive.hpp"

namespace barchan {

namespace {

constexpr std::string_view magic = "barchan checkpoint 1\n";

/// What stands between the magic words and the items.
struct Head {
  std::uint64_t size = 0;  // bytes of the items
  std::uint32_t sum = 0;   // their CRC-32
  std::uint32_t unused = 0;
};

std::uint32_t checksum(const char* data, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_z(crc32_z(0, nullptr, 0), reinterpret_cast<const Bytef*>(data), size));
}

void items(Archive& a, Checkpoint& c) {
  a.text("version", c.version);
  a.text("instructions", c.instructions);
  a.text("scene", c.scene);
  a.number("time", c.time);
  a.number("step", c.step);
  a.array("state", c.state);
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint) {
  Archive archive;
  Checkpoint copy = checkpoint;
  items(archive, copy);
  const auto& bytes = archive.bytes();
  const Head head{bytes.size(), checksum(bytes.data(), bytes.size()), 0};
  WholeFile out(file);
  out.write(magic);
  out.write({reinterpret_cast<const char*>(&head), sizeof head});
  out.write({bytes.data(), bytes.size()});
  out.publish();
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  const auto fail = [&](const std::string& what) -> SceneError {
    return SceneError("--restart " + file.string() + ": " + what);
  };
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw fail("there is no such file; expected a checkpoint, or \"latest\"");
  std::ifstream stream(file, std::ios::binary);
  const std::vector<char> all{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.good() && !stream.eof()) throw fail(std::string("cannot be read: ") + std::strerror(errno ? errno : EIO));
  Head head;
  if (all.size() < magic.size() + sizeof head || std::string_view(all.data(), magic.size()) != magic)
    throw fail("is no checkpoint of this version; expected a file that begins with \"barchan checkpoint 1\"");
  std::memcpy(&head, all.data() + magic.size(), sizeof head);
  const char* begin = all.data() + magic.size() + sizeof head;
  const std::size_t size = all.size() - magic.size() - sizeof head;
  if (head.size != size)
    throw fail("is damaged: it holds " + std::to_string(size) + " bytes; expected " + std::to_string(head.size));
  if (head.unused != 0 || checksum(begin, size) != head.sum) throw fail("is damaged: its checksum is wrong");
  Archive archive(std::vector<char>(begin, begin + size));
  Checkpoint checkpoint;
  items(archive, checkpoint);
  archive.finish();
  return checkpoint;
}

std::string difference(const std::string& then, const std::string& now) {
  const auto lines = [](const std::string& text) {
    std::vector<std::string> all;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) all.push_back(line);
    return all;
  };
  const auto old_lines = lines(then), new_lines = lines(now);
  const std::multiset<std::string> before(old_lines.begin(), old_lines.end()),
      after(new_lines.begin(), new_lines.end());
  std::string text;
  for (const auto& line : old_lines)
    if (!after.contains(line)) text += "  - " + line + "\n";
  for (const auto& line : new_lines)
    if (!before.contains(line)) text += "  + " + line + "\n";
  if (text.empty() && then != now) text = "  the order of its parts\n";
  return text;
}

}  // namespace barchan
