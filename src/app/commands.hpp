// The subcommands of `barchan`; each returns the exit status.
#pragma once

#include <string>
#include <vector>

namespace barchan {

struct RunOptions {
  std::string scene;
  std::string out;                     // empty: out/NAME
  std::vector<std::string> overrides;  // KEY=VALUE
  int threads = 0;                     // 0: all
  std::string restart;                 // empty, "latest" or a checkpoint
  bool quiet = false;
};

int run(const RunOptions& options);
int plan(const std::string& scene, const std::vector<std::string>& overrides, bool json);
int generate(const std::string& scene, const std::string& file, const std::vector<std::string>& overrides);
int compare(const std::string& a, const std::string& b, double tolerance, bool json);
int schema();

}  // namespace barchan
