// The versions of the packages that this build was made with, as their headers say.
#include <gnu/libc-version.h>
#include <muParser.h>
#include <zlib.h>
#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <toml++/impl/version.h>
#include "base/version.hpp"

namespace barchan {

namespace {

std::string dotted(int a, int b, int c) {
  return std::to_string(a) + "." + std::to_string(b) + "." + std::to_string(c);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> packages() {
  const std::string parser = mu::Parser().GetVersion();  // "2.3.3 (Release)"
  return {
      {"VTK", vtk_version()},
      {"Eigen", dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"CLI11", CLI11_VERSION},
      {"toml++", dotted(TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH)},
      {"muParser", parser.substr(0, parser.find(' '))},
      {"nlohmann-json", dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
      {"zlib", zlibVersion()},
      {"OpenMP", std::to_string(_OPENMP)},
      {"C library", gnu_get_libc_version()},
      {"C++ library", std::to_string(__GLIBCXX__)}};
}

}  // namespace barchan
