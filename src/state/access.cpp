#include "state/access.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace barchan {

bool AccessGuard::may(const std::string& phase, Field field) {
  return std::any_of(allowed_->begin(), allowed_->end(),
                     [&](const Touch& t) { return t.phase == phase && (t.reads.has(field) || t.writes.has(field)); });
}

void AccessGuard::refuse(const std::string& phase, Field field) {
  throw std::logic_error("the task \"" + std::string(stage_) + "\" of " + owner_ + " touches the field \"" +
                         std::string(info(field).name) + "\" of \"" + phase + "\", which it did not declare");
}

const char* name_of(Record record) {
  switch (record) {
    case Record::motion: return "motion";
    case Record::compact: return "compact";
    case Record::extended: return "extended";
    case Record::stress: return "stress";
    case Record::artificial: return "artificial stress";
    case Record::carried: return "carried";
    case Record::eddies: return "eddies";
    case Record::turbulence: return "turbulence";
    case Record::surface: return "surface";
  }
  return "";
}

bool AccessGuard::may_read(const std::string& phase, Record record, bool images) {
  return std::any_of(allowed_->begin(), allowed_->end(), [&](const Touch& t) {
    const RecordTouch& r = t.records;
    return t.phase == phase && (r.ghosts.has(record) || (!images && (r.own.has(record) || r.writes.has(record))));
  });
}

bool AccessGuard::may_write(const std::string& phase, Record record) {
  return std::any_of(allowed_->begin(), allowed_->end(),
                     [&](const Touch& t) { return t.phase == phase && t.records.writes.has(record); });
}

void AccessGuard::refuse(const std::string& phase, Record record, const char* what) {
  throw std::logic_error("the task \"" + std::string(stage_) + "\" of " + owner_ + " " + what + " the " +
                         name_of(record) + " records of \"" + phase + "\", which it did not declare");
}

}  // namespace barchan
