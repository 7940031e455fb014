// What makes a scene the one that a checkpoint is of.
#pragma once

#include <string>

#include "scene/toml.hpp"

namespace barchan {

/// The document less what a run that goes on may change: title, state, time.end, and all of [output] but the format.
std::string identity_of(toml::table document);

/// One line a key that differs, "  time.safety: 0.5 then, 0.6 now\n"; empty when none does.
std::string difference(const std::string& then, const std::string& now);

}  // namespace barchan
