// toml++ for malformed documents too. Version 3.3 asserts (and with NDEBUG lets clang assume) that a table's name
// begins with a letter, although that depends on the document: "[@]" would end the program. Without the assertion it is
// reported.
#pragma once

#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition) static_cast<void>(0)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
