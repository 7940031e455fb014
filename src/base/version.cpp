#include "base/version.hpp"

#include "base/instructions.hpp"

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
#if defined(BARCHAN_DISPATCH)
  std::string all;
  for (const auto& name : available_instructions()) all += (all.empty() ? "" : ", ") + name;
  return std::string(name_of(instructions())) + " (of " + all + ")";
#else
  return std::string(name_of(instructions())) + " (-march=" BARCHAN_ARCH ")";
#endif
}

std::string vtk_version() { return BARCHAN_VTK; }

}  // namespace barchan
