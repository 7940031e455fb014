#include "base/version.hpp"

namespace barchan {

std::string version() { return BARCHAN_VERSION; }

std::string commit() {
  const std::string c = BARCHAN_COMMIT;
  return c.empty() ? "unknown" : c;
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

std::string instruction_set() {
#if defined(__AVX512F__)
  return "AVX-512 (-march=" BARCHAN_ARCH ")";
#elif defined(__AVX2__)
  return "AVX2 (-march=" BARCHAN_ARCH ")";
#else
  return "SSE2 (-march=" BARCHAN_ARCH ")";
#endif
}

std::string vtk_version() { return BARCHAN_VTK; }

}  // namespace barchan
