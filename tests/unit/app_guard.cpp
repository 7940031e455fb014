// Every exception becomes a message and an exit status; none leaves main.
#include "app/guard.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <sstream>
#include <system_error>

namespace barchan {
namespace {

TEST(Guard, TurnsEveryExceptionIntoAStatus) {
  const struct {
    std::function<int()> command;
    int status;
    std::string message;
  } cases[] = {
      {[] { return 0; }, 0, ""},
      {[] { return 130; }, 130, ""},
      {[]() -> int { throw SceneError("s.toml:1:1: wrong"); }, 2, "barchan: s.toml:1:1: wrong\n"},
      {[]() -> int { throw BreakdownError("broke"); }, 3, "barchan: broke\n"},
      {[]() -> int { throw OutputError("disk full"); }, 4, "barchan: disk full\n"},
      {[]() -> int { throw std::bad_alloc(); }, 4,
       "barchan: out of memory; see `barchan plan` for what the scene needs\n"},
      {[]() -> int { throw std::logic_error("odd"); }, 5,
       "barchan: a mistake in Barchan itself, please report it with the scene: odd\n"},
  };
  for (const auto& c : cases) {
    std::ostringstream errors;
    EXPECT_EQ(guarded(errors, c.command), c.status);
    EXPECT_EQ(errors.str(), c.message);
  }
  std::ostringstream errors;
  const auto no_permission = [] {
    return throw std::filesystem::filesystem_error("status", "/x", std::make_error_code(std::errc::permission_denied)),
           0;
  };
  EXPECT_EQ(guarded(errors, no_permission), 4);
  EXPECT_NE(errors.str().find("/x"), std::string::npos);
}

}  // namespace
}  // namespace barchan
