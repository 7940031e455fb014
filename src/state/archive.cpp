#include "state/archive.hpp"

#include "base/errors.hpp"

namespace barchan {

void Archive::put(const void* data, std::size_t size) {
  if (size == 0) return;  // the data of an empty vector may be null
  if (sink_) return sink_(data, size);
  const char* from = static_cast<const char*>(data);
  bytes_.insert(bytes_.end(), from, from + size);
}

void Archive::get(void* data, std::size_t size) {
  if (size > bytes_.size() - at_) throw SceneError("the checkpoint ends too early");
  if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
  at_ += size;
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
  if (count > (bytes_.size() - at_) / width) throw SceneError("the checkpoint ends too early");
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

void Archive::head(std::string_view name, std::size_t width, std::uint64_t count) {
  const std::uint64_t wide = width;
  const auto length = static_cast<std::uint32_t>(name.size());
  put(&length, sizeof length);
  put(name.data(), name.size());
  put(&wide, sizeof wide);
  put(&count, sizeof count);
}

std::uint64_t Archive::next_count(std::string_view name, std::size_t width) {
  const std::size_t here = at_;
  const std::uint64_t count = open(name, width);
  at_ = here;
  return count;
}

void Archive::text(std::string_view name, std::string& value) { array(name, value); }

void Archive::finish() const {
  if (loads_ && at_ != bytes_.size()) throw SceneError("the checkpoint does not fit this scene: it holds more");
}

}  // namespace barchan
