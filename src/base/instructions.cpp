// Compiled for any x86-64, whatever the other files are compiled for: it runs before them and refuses a machine on
// which they would stop with an illegal instruction.
#include "base/instructions.hpp"

#include <unistd.h>

#include <cstdlib>
#include <cstring>

#if __has_include(<sys/platform/x86.h>)
// The header is written in C; clang knows no _Bool in C++.
#define _Bool bool  // NOLINT(bugprone-reserved-identifier)
#include <sys/platform/x86.h>
#undef _Bool
#endif

#include "base/errors.hpp"

namespace barchan {

const char* name_of(Instructions i) {
  return i == Instructions::avx512 ? "AVX-512" : i == Instructions::avx2 ? "AVX2" : "SSE2";
}

#if defined(BARCHAN_DISPATCH)

namespace detail {
constinit Instructions chosen_instructions = Instructions::avx2;
}

namespace {

// What the processor and the system have together. glibc's answer follows GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2, by
// which a machine can be made to look older.
#if defined(CPU_FEATURE_ACTIVE)
#define BARCHAN_HAS(glibc, gcc) (CPU_FEATURE_ACTIVE(glibc) != 0)
#else
#define BARCHAN_HAS(glibc, gcc) (__builtin_cpu_supports(gcc) != 0)
#endif

/// The first instruction set of x86-64-v3 that is missing, or null.
const char* missing_of_avx2() {
  if (!BARCHAN_HAS(AVX2, "avx2")) return "AVX2";
  if (!BARCHAN_HAS(FMA, "fma")) return "FMA";
  if (!BARCHAN_HAS(BMI1, "bmi")) return "BMI1";
  if (!BARCHAN_HAS(BMI2, "bmi2")) return "BMI2";
  return nullptr;
}

/// The same of x86-64-v4.
const char* missing_of_avx512() {
  if (const char* missing = missing_of_avx2()) return missing;
  if (!BARCHAN_HAS(AVX512F, "avx512f")) return "AVX512F";
  if (!BARCHAN_HAS(AVX512VL, "avx512vl")) return "AVX512VL";
  if (!BARCHAN_HAS(AVX512DQ, "avx512dq")) return "AVX512DQ";
  if (!BARCHAN_HAS(AVX512BW, "avx512bw")) return "AVX512BW";
  if (!BARCHAN_HAS(AVX512CD, "avx512cd")) return "AVX512CD";
  return nullptr;
}
#undef BARCHAN_HAS

/// Chooses by name. What is wrong with the name, or "".
std::string choose(std::string_view name) {
  const bool wide = name == "avx512";
  if (!wide && name != "avx2")
    return "\"" + std::string(name) + "\" is no instruction set of this program; expected avx2 or avx512";
  if (const char* missing = wide ? missing_of_avx512() : missing_of_avx2())
    return std::string(name) + ": this machine does not have " + missing + "; expected avx2";
  detail::chosen_instructions = wide ? Instructions::avx512 : Instructions::avx2;
  return "";
}

/// Uses no C++ library: the linker may have taken its inline functions from files that are compiled for AVX2.
[[noreturn]] void refuse(const char* what, const char* which, const char* rest) {
  for (const char* text : {"barchan: ", what, which, rest, "\n"})
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text, std::strlen(text));
  _exit(2);
}

/// Runs before the constructors of the files that are compiled for AVX2: 101 is the first priority that is free.
[[gnu::constructor(101)]] void look_at_the_machine() {
#if !defined(CPU_FEATURE_ACTIVE)
  __builtin_cpu_init();
#endif
  if (const char* missing = missing_of_avx2())
    refuse(
        "this machine does not have ", missing,
        ", which this program needs (x86-64-v3: processors since about 2013); expected another machine, or a program "
        "built on this one: cmake --preset native && ninja -C build-native");
  if (!missing_of_avx512()) detail::chosen_instructions = Instructions::avx512;
  if (const char* asked = std::getenv("BARCHAN_INSTRUCTIONS"))
    if (const std::string wrong = choose(asked); !wrong.empty()) refuse("BARCHAN_INSTRUCTIONS=", wrong.c_str(), "");
}

}  // namespace

void choose_instructions(std::string_view name) {
  if (const std::string wrong = choose(name); !wrong.empty()) throw SceneError("--instructions " + wrong);
}

std::vector<std::string> available_instructions() {
  if (missing_of_avx512()) return {"avx2"};
  return {"avx2", "avx512"};
}

#else

std::vector<std::string> available_instructions() {
  return {compiled_instructions == Instructions::avx512 ? "avx512"
          : compiled_instructions == Instructions::avx2 ? "avx2"
                                                        : "sse2"};
}

void choose_instructions(std::string_view name) {
  const std::string only = available_instructions().front();
  if (name != only)
    throw SceneError("--instructions " + std::string(name) +
                     ": this program is built for one instruction set; expected " + only);
}

#endif

}  // namespace barchan
