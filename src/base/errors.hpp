// The ways in which a run ends badly, one type each. app/guard.hpp turns them into the exit status of the contract.
#pragma once

#include <stdexcept>
#include <string>

namespace barchan {

/// The scene or the command is wrong (exit status 2). The message holds file, line, column, key and what was expected.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The run broke down (exit status 3): a particle is wrong (simulation/watch.hpp), or the time step collapsed.
struct BreakdownError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A breakdown that smaller steps cannot help: a formula of the scene has no number, for one.
struct LastingBreakdown : BreakdownError {
  using BreakdownError::BreakdownError;
};

/// Input or output failed (exit status 4): disk full, no permission.
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A text of a user for a message: not more of it than helps to find it.
inline std::string shortened(const std::string& text, std::size_t most = 200) {
  return text.size() <= most ? text : text.substr(0, most) + "... (" + std::to_string(text.size()) + " characters)";
}

}  // namespace barchan
