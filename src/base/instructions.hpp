// Which SIMD instructions a file is compiled for, and which of them the program uses.
//
// The hot files (those that stand in namespace BARCHAN_TARGET) are compiled twice, for AVX2 and for AVX-512; all other
// files are compiled for AVX2. Each copy stands in a namespace of its own, barchan::avx2 and barchan::avx512, and so do
// the vectors of simd/vec.hpp: no function of one copy has the name of a function of the other, and the linker cannot
// take one for the other. At start the program chooses a copy, once. A program built for one instruction set (presets
// native, dev and the sanitizers) has one copy and nothing to choose.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The namespace of what is compiled here.
#if defined(__AVX512F__)
#define BARCHAN_TARGET avx512
#elif defined(__AVX2__)
#define BARCHAN_TARGET avx2
#else
#define BARCHAN_TARGET sse2
#endif

namespace barchan {

enum class Instructions { sse2, avx2, avx512 };

/// Those that this file is compiled for.
inline constexpr Instructions compiled_instructions = Instructions::BARCHAN_TARGET;

/// Bytes in a register.
constexpr std::size_t register_bytes(Instructions i) {
  return i == Instructions::avx512 ? 64 : i == Instructions::avx2 ? 32 : 16;
}

#if defined(BARCHAN_DISPATCH)

namespace detail {
extern Instructions chosen_instructions;  // set before any constructor of ours runs (instructions.cpp)
}

/// Those that the hot files use in this process: the best that the machine has, or what the environment variable
/// BARCHAN_INSTRUCTIONS says.
inline Instructions instructions() { return detail::chosen_instructions; }

/// Uses the named ones from now on: "avx2", "avx512". Lists of pairs made before have the wrong padding. Throws
/// SceneError when there is no such name or the machine lacks them.
void choose_instructions(std::string_view name);

/// Those that this program and this machine have, by name.
std::vector<std::string> available_instructions();

/// Declares a function of a hot file, with all its overloads. A call goes to the copy that was chosen. An argument in
/// braces needs its type before them.
#define BARCHAN_PER_INSTRUCTION_SET(name, ...)                                                  \
  namespace avx2 {                                                                              \
  __VA_ARGS__                                                                                   \
  }                                                                                             \
  namespace avx512 {                                                                            \
  __VA_ARGS__                                                                                   \
  }                                                                                             \
  template <class... Arguments>                                                                 \
  auto name(Arguments&&... a)->decltype(::barchan::avx2::name(std::forward<Arguments>(a)...)) { \
    if (::barchan::instructions() == ::barchan::Instructions::avx512)                           \
      return ::barchan::avx512::name(std::forward<Arguments>(a)...);                            \
    return ::barchan::avx2::name(std::forward<Arguments>(a)...);                                \
  }

#else

constexpr Instructions instructions() { return compiled_instructions; }
void choose_instructions(std::string_view name);
std::vector<std::string> available_instructions();

#define BARCHAN_PER_INSTRUCTION_SET(name, ...) \
  namespace BARCHAN_TARGET {                   \
  __VA_ARGS__                                  \
  }                                            \
  using BARCHAN_TARGET::name;

#endif

/// "AVX-512", "AVX2", "SSE2".
const char* name_of(Instructions i);

}  // namespace barchan
