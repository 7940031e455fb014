#include "state/access.hpp"

#include <stdexcept>
#include <string>

namespace barchan {

void AccessGuard::refuse(Field field) {
  throw std::logic_error("the task \"" + std::string(stage_) + "\" of " + owner_ + " touches the field \"" +
                         std::string(info(field).name) + "\", which it did not declare");
}

}  // namespace barchan
