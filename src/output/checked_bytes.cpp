#include "output/checked_bytes.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "base/errors.hpp"
#include "base/ranks.hpp"

namespace barchan {

std::uint32_t checksum(const void* data, std::size_t size, std::uint32_t before) {
  return static_cast<std::uint32_t>(crc32_z(before, static_cast<const Bytef*>(data), size));
}

namespace {

InputFile opened(const std::filesystem::path& file, const std::string& missing) {
  std::error_code unseen;
  if (!std::filesystem::exists(file, unseen) && !unseen) throw SceneError(missing);
  try {
    return InputFile(file);
  } catch (const InputError& e) { throw SceneError(e.what()); }
}

}  // namespace

OpenFile::OpenFile(std::filesystem::path file, const std::string& missing)
    : file_(std::move(file)), open_(opened(file_, missing)) {}

void OpenFile::read(std::uint64_t at, void* to, std::size_t size) const {
  std::string why;
  try {
    if (open_.read(at, to, size) < size) why = "it is shorter";
  } catch (const InputError& e) { why = e.reason(); }
  if (!why.empty()) throw SceneError("'" + file_.string() + "' cannot be read: " + why);
}

Archive::Source source_of(const std::vector<char>& bytes) {
  return {bytes.size(), [data = bytes.data()](std::uint64_t at, void* to, std::size_t size) {
            if (size > 0) std::memcpy(to, data + at, size);
          }};
}

Archive::Source part_of(const Archive::Source& source, std::uint64_t at, std::uint64_t size) {
  return {size, [read = source.read, at](std::uint64_t from, void* to, std::size_t n) { read(at + from, to, n); }};
}

Archive::Source behind_head(const Archive::Source& file, std::size_t magic,
                            const std::function<std::uint32_t(const Archive::Source&)>& sum_of) {
  CheckedHead head;
  const std::uint64_t begin = magic + sizeof head;
  if (file.size < begin) throw SceneError("is damaged: it is cut off in its head");
  file.read(magic, &head, sizeof head);
  Archive::Source bytes = part_of(file, begin, file.size - begin);
  if (head.size != bytes.size)
    throw SceneError("is damaged: it holds " + std::to_string(bytes.size) + " bytes; expected " +
                     std::to_string(head.size));
  if (head.unused != 0 || sum_of(bytes) != head.sum) throw SceneError("is damaged: its checksum is wrong");
  return bytes;
}

std::uint32_t checksum(const Archive::Source& source) {
  std::vector<char> some(static_cast<std::size_t>(std::min<std::uint64_t>(source.size, 1 << 18)));
  std::uint32_t sum = 0;
  for (std::uint64_t at = 0; at < source.size;) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(some.size(), source.size - at));
    source.read(at, some.data(), n);
    sum = checksum(some.data(), n, sum);
    at += n;
  }
  return sum;
}

std::uint32_t shared_checksum(const Archive::Source& source) {
  Communicator* const all = ranks::available();
  if (!all) return checksum(source);
  struct Share {
    std::uint64_t size;
    std::uint32_t sum, unused;
  };
  const auto count = static_cast<std::uint64_t>(all->size()), rank = static_cast<std::uint64_t>(all->rank());
  const std::uint64_t each = source.size / count, begin = rank * each;
  Share mine{rank + 1 == count ? source.size - begin : each, 0, 0};
  std::string error;
  try {
    mine.sum = checksum(part_of(source, begin, mine.size));
  } catch (const SceneError& e) { error = e.what(); }
  if (error = ranks::first_text(error); !error.empty()) throw SceneError(error);
  std::vector<Share> shares(static_cast<std::size_t>(count));
  all->all_gather(&mine, sizeof mine, shares.data());
  std::uint32_t sum = 0;
  for (const Share& share : shares)
    sum = static_cast<std::uint32_t>(crc32_combine(sum, share.sum, static_cast<z_off_t>(share.size)));
  return sum;
}

}  // namespace barchan
