// What `barchan --version` and run.json say of this build.
#pragma once

#include <string>

namespace barchan {

std::string version();   ///< "0.1.0"
std::string commit();    ///< git describe at configuration, "unknown" without git
std::string compiler();  ///< name and version
std::string
instruction_set();  ///< "AVX-512 (of avx2, avx512)": the one in use, and those that program and machine have
std::string vtk_version();

}  // namespace barchan
