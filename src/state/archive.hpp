// The bytes of a state: one description of what is in it serves saving and loading.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace barchan {

/// A sequence of named items. A class with a state has `void archive(Archive& a)`, which names its items one after
/// another: an archive that saves copies them, one that loads overwrites them. Bits are kept as they are.
class Archive {
 public:
  /// Saves into bytes().
  Archive() = default;
  /// Loads what an archive saved.
  explicit Archive(std::vector<char> bytes) : bytes_(std::move(bytes)), loads_(true) {}

  /// Saves anew, into the memory that is there.
  void save_again() {
    bytes_.clear();
    at_ = 0;
    loads_ = false;
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

  /// Throws SceneError when loading has left something over.
  void finish() const;

 private:
  void item(std::string_view name, void* data, std::size_t width, std::uint64_t count);
  std::uint64_t next_count(std::string_view name, std::size_t width);
  /// Reads the head of the next item and refuses any other than this one; leaves at_ at its values.
  std::uint64_t open(std::string_view name, std::size_t width);
  void put(const void* data, std::size_t size);
  void get(void* data, std::size_t size);

  std::vector<char> bytes_;
  std::size_t at_ = 0;
  bool loads_ = false;
};

}  // namespace barchan
