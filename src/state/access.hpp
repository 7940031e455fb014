// Which fields of which phases a task of the schedule may touch. Checked in builds with assertions, free in all others.
#pragma once

#include <bitset>
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

/// The fields of one phase that a task reads and those that it writes.
struct Touch {
  std::string phase;
  FieldSet reads, writes;
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

 private:
  static bool may(const std::string& phase, Field field);
  [[noreturn]] static void refuse(const std::string& phase, Field field);
  inline static thread_local const Touches* allowed_ = nullptr;
  inline static thread_local const char *stage_ = "", *owner_ = "";
};

}  // namespace barchan
