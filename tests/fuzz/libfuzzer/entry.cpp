// One target as libFuzzer calls it; BARCHAN_FUZZED is its name.
#include <cstddef>
#include <cstdint>

#include "fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  barchan::fuzz::BARCHAN_FUZZED({reinterpret_cast<const char*>(data), size});
  return 0;
}
