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

}  // namespace barchan
