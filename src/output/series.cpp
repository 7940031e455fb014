// The writer's thread of a series, and the .pvd that lists what it has written.
#include "output/series.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <set>
#include <thread>

#include "base/errors.hpp"
#include "output/pieces.hpp"
#include "output/pvd.hpp"
#include "output/whole_file.hpp"

namespace barchan {
namespace {

using Clock = std::chrono::steady_clock;
using Lock = std::unique_lock<std::mutex>;

constexpr std::size_t most_waiting = 2;

/// Adds the time of a scope to a counter that other threads may read.
class Timed {
 public:
  explicit Timed(std::atomic<double>& seconds) : seconds_(seconds), begin_(Clock::now()) {}
  ~Timed() { seconds_.fetch_add(std::chrono::duration<double>(Clock::now() - begin_).count()); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  std::atomic<double>& seconds_;
  Clock::time_point begin_;
};

/// NAME_000000, with any number of digits from six on.
bool is_stem_of(const std::string& name, const std::string& stem) {
  if (!stem.starts_with(name + "_")) return false;
  const std::string number = stem.substr(name.size() + 1);
  return number.size() >= 6 && number.find_first_not_of("0123456789") == std::string::npos;
}

/// The file of a frame or the list of its pieces, also while it is being written; the folder of its pieces.
bool is_of_series(const std::string& name, const std::filesystem::directory_entry& entry) {
  std::string file = entry.path().filename().string();
  if (is_folder_of_pieces(entry)) return is_stem_of(name, file);
  if (!entry.is_regular_file()) return false;
  if (file.ends_with(WholeFile::suffix)) file.resize(file.size() - WholeFile::suffix.size());
  const std::filesystem::path path(file), suffix = path.extension();
  return (suffix == ".vtp" || suffix == ".vtu" || is_list_of_pieces(path)) && is_stem_of(name, path.stem().string());
}

}  // namespace

std::optional<long> frame_number(const std::string& name, const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  long number = 0;
  if (!is_stem_of(name, stem)) return std::nullopt;
  const char* const end = stem.data() + stem.size();
  const auto [rest, error] = std::from_chars(stem.data() + name.size() + 1, end, number);
  return error == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

bool has_frames(const std::filesystem::path& directory, const std::string& name) {
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(directory, failed))
    if (is_of_series(name, entry)) return true;
  return false;
}

std::string frame_stem(const std::string& name, int index) {
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "_%06d", index);
  return name + number.data();
}

void make_directory(const std::filesystem::path& directory) {
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (failed) throw OutputError("cannot create the directory '" + directory.string() + "': " + failed.message());
  if (!std::filesystem::is_directory(directory, failed))
    throw OutputError("cannot write into '" + directory.string() + "': it is not a directory");
}

struct SeriesWriter::Work {
  std::filesystem::path directory;
  std::string name;
  FrameFormat format;
  bool compress;

  std::vector<Entry> entries;  // of the .pvd; the writer's thread alone changes them
  std::atomic<long> whole{0};  // how many they are
  std::atomic<double> writing{0}, waiting{0};

  std::mutex mutex;  // guards what follows
  std::condition_variable changed;
  std::deque<Frame> frames;  // the first is the one being written
  std::exception_ptr error;  // the first one; nothing is written after it
  bool ending = false;
  std::thread thread;

  std::filesystem::path pvd() const { return directory / (name + ".pvd"); }
  void prepare();
  void loop();
  void write_first(const Frame& frame);

  std::vector<std::string> removed;  // frames that were whole and are gone
  Clock::time_point next_look{};
  void look_for_removed(bool at_once);
};

/// The directory exists and can be written, and holds no frame of an earlier run but those that are kept.
void SeriesWriter::Work::prepare() {
  make_directory(directory);
  std::error_code failed;
  { const WholeFile trial(pvd()); }  // says now, not at the first frame, that nothing can be written here

  // First the list, then the files that it no longer names: at no moment does it name one that is gone.
  if (entries.empty()) std::filesystem::remove(pvd(), failed);
  else write_pvd(pvd(), entries);
  std::set<std::string> kept;
  for (const auto& entry : entries) {
    kept.insert(entry.file);
    if (const std::filesystem::path file(entry.file); is_list_of_pieces(file)) kept.insert(file.stem().string());
  }
  std::vector<std::filesystem::path> stale;
  for (const auto& file : std::filesystem::directory_iterator(directory, failed))
    if (is_of_series(name, file) && !kept.contains(file.path().filename().string())) stale.push_back(file);
  std::ranges::sort(stale, std::greater());  // a list (NAME_000010.pvtp) goes before its folder (NAME_000010)
  for (const auto& file : stale)
    if (is_folder_of_pieces(file)) remove_pieces(file);
    else std::filesystem::remove(file, failed);
}

void SeriesWriter::Work::write_first(const Frame& frame) {
  const Timed timed(writing);
  const std::string stem = frame_stem(name, frame.index), file = frame_name(stem, frame.in_pieces, format);
  if (frame.in_pieces) write_list_of_pieces(directory, stem, frame, format);
  else write_frame(directory / file, frame, format, compress);
  entries.push_back({frame.time, file});
  look_for_removed(false);
  write_pvd(pvd(), entries);
  whole = static_cast<long>(entries.size());
}

/// The .pvd lists only what is there. Of a long series not every frame is a moment to look, so that it takes a
/// hundredth of the time at most.
void SeriesWriter::Work::look_for_removed(bool at_once) {
  const Clock::time_point begin = Clock::now();
  if (!at_once && begin < next_look) return;
  std::erase_if(entries, [&](const Entry& entry) {
    std::error_code unseen;
    const std::filesystem::path file = directory / entry.file;
    const bool there =
        std::filesystem::exists(file, unseen) &&
        (!is_list_of_pieces(file) || is_folder_of_pieces(directory / std::filesystem::path(entry.file).stem()));
    if (!there && !unseen) removed.push_back(entry.file);
    return !there && !unseen;
  });
  next_look = Clock::now() + 100 * (Clock::now() - begin);
}

void SeriesWriter::Work::loop() {
  Lock lock(mutex);
  while (true) {
    changed.wait(lock, [&] { return ending || !frames.empty(); });
    if (frames.empty()) return;
    if (!error) {
      const Frame& frame = frames.front();  // a deque's elements stay where they are when write() adds one
      lock.unlock();
      std::exception_ptr failure;
      try {
        write_first(frame);
      } catch (...) { failure = std::current_exception(); }
      lock.lock();
      error = failure;
    }
    frames.pop_front();
    changed.notify_all();
  }
}

SeriesWriter::SeriesWriter(std::filesystem::path directory, std::string name, FrameFormat format, bool compress,
                           std::vector<Entry> kept)
    : work_(std::make_unique<Work>()) {
  work_->directory = std::move(directory);
  work_->name = std::move(name);
  work_->format = format;
  work_->compress = compress;
  work_->entries = std::move(kept);
  work_->whole = static_cast<long>(work_->entries.size());
  work_->prepare();
  work_->thread = std::thread([work = work_.get()] { work->loop(); });
}

SeriesWriter::~SeriesWriter() {
  {
    const Lock lock(work_->mutex);
    work_->ending = true;
  }
  work_->changed.notify_all();
  work_->thread.join();
}

void SeriesWriter::write(Frame&& frame) {
  const Timed timed(work_->waiting);
  Lock lock(work_->mutex);
  work_->changed.wait(lock, [&] { return work_->error || work_->frames.size() < most_waiting; });
  if (work_->error) std::rethrow_exception(work_->error);
  work_->frames.push_back(std::move(frame));
  work_->changed.notify_all();
}

void SeriesWriter::finish() {
  const Timed timed(work_->waiting);
  Lock lock(work_->mutex);
  work_->changed.wait(lock, [&] { return work_->frames.empty(); });
  if (work_->error) std::rethrow_exception(work_->error);
}

std::vector<std::string> SeriesWriter::removed() {
  const Lock lock(work_->mutex);
  const std::size_t listed = work_->entries.size();
  work_->look_for_removed(true);
  std::error_code unseen;
  if (work_->entries.size() < listed || !std::filesystem::exists(work_->pvd(), unseen))
    write_pvd(work_->pvd(), work_->entries);
  work_->whole = static_cast<long>(work_->entries.size());
  return work_->removed;
}

double SeriesWriter::seconds_writing() const { return work_->writing; }
double SeriesWriter::seconds_waiting() const { return work_->waiting; }
long SeriesWriter::frames() const { return work_->whole; }
std::string SeriesWriter::last_file() const {
  const Lock lock(work_->mutex);
  return work_->entries.empty() ? "" : work_->entries.back().file;
}

}  // namespace barchan
