// Which fields and records of which phases a task of the schedule may touch. Checked in builds with assertions, free in
// all others; from what tasks say of records the engine knows when images must be made (engine/halo.hpp).
#pragma once

#include <bitset>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/fields.hpp"

namespace barchan {

/// A set of fields.
class FieldSet {
 public:
  FieldSet() = default;
  FieldSet(std::initializer_list<Field> fields) {
    for (const Field f : fields) bits_.set(static_cast<std::size_t>(f));
  }
  explicit FieldSet(const std::vector<Field>& fields) {
    for (const Field f : fields) bits_.set(static_cast<std::size_t>(f));
  }
  bool has(Field f) const { return bits_.test(static_cast<std::size_t>(f)); }
  FieldSet operator|(const FieldSet& other) const {
    FieldSet both;
    both.bits_ = bits_ | other.bits_;
    return both;
  }

 private:
  std::bitset<field_count> bits_;
};

/// What passes over pairs read of a phase, packed by particle (engine/records.hpp).
enum class Record : std::uint8_t {
  motion,
  compact,
  extended,
  stress,
  artificial,
  carried,
  eddies,
  turbulence,
  surface
};
inline constexpr std::size_t record_count = 9;
const char* name_of(Record record);

/// A set of kinds of records.
class RecordSet {
 public:
  RecordSet() = default;
  RecordSet(std::initializer_list<Record> records) {
    for (const Record r : records) bits_.set(static_cast<std::size_t>(r));
  }
  bool has(Record r) const { return bits_.test(static_cast<std::size_t>(r)); }
  RecordSet operator|(const RecordSet& other) const {
    RecordSet both;
    both.bits_ = bits_ | other.bits_;
    return both;
  }

 private:
  std::bitset<record_count> bits_;
};

/// The records of one phase that a task reads of its particles alone (`own`), those that it reads of particles and of
/// their images (`ghosts`), and those that it writes, of particles: before the next task that reads their images these
/// are made anew.
struct RecordTouch {
  RecordSet own, ghosts, writes;
};

/// The fields of one phase that a task reads and those that it writes; its records.
struct Touch {
  std::string phase;
  FieldSet reads, writes;
  RecordTouch records{};
};
using Touches = std::vector<Touch>;

/// While one lives, PhaseParticles::column throws std::logic_error for a field of a phase that `allowed` does not have;
/// the message names the task. It binds the thread that runs the task, so that two simulations may run side by side;
/// the threads of a loop get their columns from that one.
class AccessGuard {
 public:
  AccessGuard(const char* stage, const char* owner, const Touches& allowed) {
    allowed_ = &allowed;
    stage_ = stage;
    owner_ = owner;
  }
  ~AccessGuard() { allowed_ = nullptr; }
  AccessGuard(const AccessGuard&) = delete;
  AccessGuard& operator=(const AccessGuard&) = delete;

  /// Throws std::logic_error when a task is running that did not declare the field.
  static void check(const std::string& phase, Field field) {
    if (allowed_ != nullptr && !may(phase, field)) refuse(phase, field);
  }
  /// The same of records that a task reads, of particles or of images; images must be `of_now` besides.
  static void check(const std::string& phase, Record record, bool images, bool of_now) {
    if (allowed_ == nullptr) return;
    if (!may_read(phase, record, images)) refuse(phase, record, images ? "reads images of" : "reads");
    if (images && !of_now) refuse(phase, record, "reads old images of");
  }
  /// The same of records that a task writes.
  static void check_write(const std::string& phase, Record record) {
    if (allowed_ != nullptr && !may_write(phase, record)) refuse(phase, record, "writes");
  }

 private:
  static bool may_read(const std::string& phase, Record record, bool images);
  static bool may_write(const std::string& phase, Record record);
  [[noreturn]] static void refuse(const std::string& phase, Record record, const char* what);
  static bool may(const std::string& phase, Field field);
  [[noreturn]] static void refuse(const std::string& phase, Field field);
  inline static thread_local const Touches* allowed_ = nullptr;
  inline static thread_local const char *stage_ = "", *owner_ = "";
};

}  // namespace barchan
