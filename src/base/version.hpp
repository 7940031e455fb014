// What `barchan --version` and run.json say of this build.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace barchan {

std::string version();   ///< "0.1.0"
std::string commit();    ///< git describe at configuration, "unknown" without git
std::string compiler();  ///< name and version
std::string
instruction_set();  ///< "AVX-512 (of avx2, avx512)": the one in use, and those that program and machine have
std::string vtk_version();
/// Name and version of every package that this build was made with (packages.cpp).
std::vector<std::pair<std::string, std::string>> packages();

}  // namespace barchan
