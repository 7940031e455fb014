// The bytes of a state: one description of what is in it serves saving and loading.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace barchan {

class Archive;
template <class All>
std::size_t size_of(All&& all);

/// A sequence of named items. A class with a state has `void archive(Archive& a)`, which names its items one after
/// another: an archive that saves copies them, one that loads overwrites them. Bits are kept as they are.
class Archive {
 public:
  /// Saves into bytes().
  Archive() = default;
  /// What takes the bytes that are saved, piece by piece.
  using Sink = std::function<void(const void* data, std::size_t size)>;
  /// Saves into `sink`; nothing stays in memory.
  explicit Archive(Sink sink) : sink_(std::move(sink)) {}
  /// Loads what an archive saved.
  explicit Archive(std::vector<char> bytes) : bytes_(std::move(bytes)), loads_(true) {}

  /// Saves anew what `all` names, into memory of just the size: a vector that grows would take up to twice of it, and
  /// both while it moves. So `all` is called twice, once to count.
  template <class All>
  void save(All&& all) {
    const std::size_t size = size_of(all);
    at_ = 0;
    loads_ = false;
    bytes_.clear();
    bytes_.reserve(size);
    all(*this);
  }
  /// Loads what was saved, any number of times.
  void load_again() {
    at_ = 0;
    loads_ = true;
  }

  bool loads() const { return loads_; }
  const std::vector<char>& bytes() const { return bytes_; }

  /// A number or a plain struct. Throws SceneError when the item that comes next is another one.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void number(std::string_view name, T& value) { item(name, &value, sizeof(T), 1); }

  /// `count` values that are there already.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void values(std::string_view name, T* first, std::size_t count) { item(name, first, sizeof(T), count); }

  /// A vector; loading gives it the size that was saved.
  template <class V>
  void array(std::string_view name, V& vector) {
    using T = typename V::value_type;
    static_assert(std::is_trivially_copyable_v<T>);
    std::uint64_t count = vector.size();
    if (loads_) {
      count = next_count(name, sizeof(T));
      vector.resize(count);
    }
    item(name, vector.data(), sizeof(T), count);
  }

  void text(std::string_view name, std::string& value);

  /// One item that holds the bytes of what `all` names; loading gives it as an array of char. For who saves.
  template <class All>
  void nested(std::string_view name, All&& all) {
    head(name, 1, size_of(all));
    all(*this);
  }

  /// Throws SceneError when loading has left something over.
  void finish() const;

 private:
  void item(std::string_view name, void* data, std::size_t width, std::uint64_t count);
  std::uint64_t next_count(std::string_view name, std::size_t width);
  void head(std::string_view name, std::size_t width, std::uint64_t count);
  /// Reads the head of the next item and refuses any other than this one; leaves at_ at its values.
  std::uint64_t open(std::string_view name, std::size_t width);
  void put(const void* data, std::size_t size);
  void get(void* data, std::size_t size);

  Sink sink_;  // empty: bytes_
  std::vector<char> bytes_;
  std::size_t at_ = 0;
  bool loads_ = false;
};

/// Bytes that an archive would hold of what `all` names.
template <class All>
std::size_t size_of(All&& all) {
  std::size_t size = 0;
  Archive counter([&](const void*, std::size_t more) { size += more; });
  all(counter);
  return size;
}

}  // namespace barchan
