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

/// Of the values of an item, those that this rank has: `count` from `first` on, of `all`. In one process: all of them.
struct Rows {
  std::uint64_t first = 0, count = 0, all = 0;
};

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
  /// What takes the rows of an item, once an item, also where this rank has none of them: the bytes of its own, and how
  /// many bytes all ranks have.
  using RowSink = std::function<void(const void* data, std::size_t size, std::uint64_t all)>;
  /// The same of a run on several ranks: `sink` takes all but the rows, `rows` those of this rank.
  Archive(Sink sink, RowSink rows) : sink_(std::move(sink)), row_sink_(std::move(rows)) {}
  /// Loads what an archive saved.
  explicit Archive(std::vector<char> bytes) : bytes_(std::move(bytes)), loads_(true) {}
  /// Bytes that stand somewhere, to be read in any order.
  struct Source {
    std::uint64_t size = 0;
    std::function<void(std::uint64_t at, void* to, std::size_t size)> read;
  };
  /// Loads from `source`; what is loaded is read when it is asked for.
  explicit Archive(Source source) : source_(std::move(source)), loads_(true) {}

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

  /// Values of which each rank has a range: an item of rows.all values, of which `own` holds rows.count. Behind them
  /// stand `rest_count` values that the first rank has, for who saves. Throws SceneError when loading finds another
  /// number of values.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void rows(std::string_view name, T* own, const Rows& rows, const T* rest = nullptr, std::uint64_t rest_count = 0) {
    row_item(name, sizeof(T), own, rows, rest, rest_count);
  }

  /// For who loads: some values of the next item. Calls f(count, read) with the number of its values; read(first, to,
  /// n) loads n of them. Then goes on behind the item. Throws SceneError for values that the item does not have.
  template <class T, class F>
  void parts(std::string_view name, F&& f) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::uint64_t count = open(name, sizeof(T)), begin = at_;
    f(count, [&](std::uint64_t first, T* to, std::size_t n) { get_part(begin, count, first, to, n, sizeof(T)); });
    at_ = begin + count * sizeof(T);
  }
  /// For who loads: where the next item begins. go_to() goes on there.
  std::uint64_t place() const { return at_; }
  void go_to(std::uint64_t place) { at_ = place; }

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
    nested(name, size_of(all), all);
  }
  /// The same of a size that is known.
  template <class All>
  void nested(std::string_view name, std::uint64_t size, All&& all) {
    head(name, 1, size);
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
  void row_item(std::string_view name, std::size_t width, void* own, const Rows& rows, const void* rest,
                std::uint64_t rest_count);
  void get_part(std::uint64_t begin, std::uint64_t count, std::uint64_t first, void* to, std::size_t n,
                std::size_t width);
  std::uint64_t size() const { return source_.read ? source_.size : bytes_.size(); }
  void put(const void* data, std::size_t size);
  void get(void* data, std::size_t size);
  void get_from_source(void* data, std::size_t size);

  Sink sink_;         // empty: bytes_
  RowSink row_sink_;  // empty: as all others
  Source source_;     // empty: bytes_
  std::vector<char> bytes_;
  std::vector<char> window_;  // of the source
  std::uint64_t window_at_ = 0;
  std::uint64_t at_ = 0;
  bool loads_ = false;
};

/// Bytes that an archive would hold of what `all` names, with the rows of all ranks.
template <class All>
std::size_t size_of(All&& all) {
  std::size_t size = 0;
  Archive counter([&](const void*, std::size_t more) { size += more; },
                  [&](const void*, std::size_t, std::uint64_t rows) { size += rows; });
  all(counter);
  return size;
}

}  // namespace barchan
