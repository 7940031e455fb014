// Exceptions -> message and exit status: nothing leaves main uncaught.
#pragma once

#include <exception>
#include <filesystem>
#include <new>
#include <ostream>

#include "base/errors.hpp"

namespace barchan {

/// Runs `command` and returns its exit status, or that of what it throws (the table in README.md), told on `errors`.
template <class Command>
int guarded(std::ostream& errors, Command&& command) {
  const auto tell = [&](const char* what, int status) {
    errors << "barchan: " << what << '\n';
    return status;
  };
  try {
    return command();
  } catch (const SceneError& e) { return tell(e.what(), 2); } catch (const BreakdownError& e) {
    return tell(e.what(), 3);
  } catch (const OutputError& e) { return tell(e.what(), 4); } catch (const std::filesystem::filesystem_error& e) {
    return tell(e.what(), 4);
  } catch (const std::bad_alloc&) {
    return tell("out of memory; see `barchan plan` for what the scene needs", 4);
  } catch (const std::exception& e) {
    errors << "barchan: a mistake in Barchan itself, please report it with the scene: " << e.what() << '\n';
    return 5;
  }
}

}  // namespace barchan
