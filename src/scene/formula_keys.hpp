// Which keys of a scene have a formula, for messages.
#pragma once

#include <string>

namespace barchan {

struct Scene;

/// "motion.0.velocity", or several with "and" between; "" where no key has it.
std::string keys_of_formula(const Scene& scene, const std::string& formula);

}  // namespace barchan
