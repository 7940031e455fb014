#include "state/archive.hpp"

#include <algorithm>
#include <stdexcept>

#include "base/errors.hpp"

namespace barchan {

namespace {

/// What is read of a source at once, for items that are smaller.
constexpr std::size_t window = 1 << 16;

}  // namespace

void Archive::put(const void* data, std::size_t size) {
  if (size == 0) return;  // the data of an empty vector may be null
  if (sink_) return sink_(data, size);
  const char* from = static_cast<const char*>(data);
  bytes_.insert(bytes_.end(), from, from + size);
}

void Archive::get(void* data, std::size_t size) {
  if (at_ > this->size() || size > this->size() - at_) throw SceneError("the checkpoint ends too early");
  if (size == 0) return;  // the data of an empty vector may be null
  if (source_.read) get_from_source(data, size);
  else std::memcpy(data, bytes_.data() + at_, size);
  at_ += size;
}

void Archive::get_from_source(void* data, std::size_t size) {
  if (size >= window) return source_.read(at_, data, size);
  if (at_ < window_at_ || at_ + size > window_at_ + window_.size()) {
    window_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(window, source_.size - at_)));
    source_.read(at_, window_.data(), window_.size());
    window_at_ = at_;
  }
  std::memcpy(data, window_.data() + (at_ - window_at_), size);
}

void Archive::get_part(std::uint64_t begin, std::uint64_t count, std::uint64_t first, void* to, std::size_t n,
                       std::size_t width) {
  if (first > count || n > count - first)
    throw SceneError("the checkpoint does not fit this scene: it has fewer values");
  at_ = begin + first * width;
  get(to, n * width);
}

std::uint64_t Archive::open(std::string_view name, std::size_t width) {
  std::uint32_t length = 0;
  std::uint64_t found_width = 0, count = 0;
  get(&length, sizeof length);
  std::string found(std::min<std::size_t>(length, 256), '\0');
  get(found.data(), found.size());
  get(&found_width, sizeof found_width);
  get(&count, sizeof count);
  if (found != name || found_width != width)
    throw SceneError("the checkpoint does not fit this scene: found \"" + found + "\" (" + std::to_string(found_width) +
                     " bytes a value); expected \"" + std::string(name) + "\" (" + std::to_string(width) + ")");
  if (count > (size() - at_) / width) throw SceneError("the checkpoint ends too early");
  return count;
}

void Archive::item(std::string_view name, void* data, std::size_t width, std::uint64_t count) {
  if (loads_) {
    const std::uint64_t found = open(name, width);
    if (found != count)
      throw SceneError("the checkpoint does not fit this scene: \"" + std::string(name) + "\" has " +
                       std::to_string(found) + " values; expected " + std::to_string(count));
    get(data, width * count);
    return;
  }
  head(name, width, count);
  put(data, width * count);
}

void Archive::row_item(std::string_view name, std::size_t width, void* own, const Rows& rows, const void* rest,
                       std::uint64_t rest_count) {
  if (loads_) {
    const std::uint64_t found = open(name, width), begin = at_;
    if (found != rows.all)
      throw SceneError("the checkpoint does not fit this scene: \"" + std::string(name) + "\" has " +
                       std::to_string(found) + " values; expected " + std::to_string(rows.all));
    get_part(begin, found, rows.first, own, rows.count, width);
    at_ = begin + found * width;
    return;
  }
  head(name, width, rows.all + rest_count);
  if (row_sink_) row_sink_(own, rows.count * width, rows.all * width);
  else if (rows.count == rows.all) put(own, rows.count * width);
  else throw std::logic_error("\"" + std::string(name) + "\" has rows of other ranks: expected an archive for rows");
  put(rest, rest_count * width);
}

void Archive::head(std::string_view name, std::size_t width, std::uint64_t count) {
  const std::uint64_t wide = width;
  const auto length = static_cast<std::uint32_t>(name.size());
  put(&length, sizeof length);
  put(name.data(), name.size());
  put(&wide, sizeof wide);
  put(&count, sizeof count);
}

std::uint64_t Archive::next_count(std::string_view name, std::size_t width) {
  const std::uint64_t here = at_;
  const std::uint64_t count = open(name, width);
  at_ = here;
  return count;
}

void Archive::text(std::string_view name, std::string& value) { array(name, value); }

void Archive::finish() const {
  if (loads_ && at_ != size()) throw SceneError("the checkpoint does not fit this scene: it holds more");
}

}  // namespace barchan
