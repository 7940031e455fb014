#include "base/data_folder.hpp"

#include <algorithm>

namespace barchan {

namespace fs = std::filesystem;

fs::path data_folder() {
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  if (unknown) return {};
  const fs::path bin = program.parent_path();
  for (const fs::path& folder : {bin / BARCHAN_DATA_FROM_BIN, bin.parent_path(), bin.parent_path().parent_path()})
    if (fs::is_directory(folder / "scenes", unknown) && fs::is_directory(folder / "pvstate", unknown))
      return folder.lexically_normal();
  return {};
}

std::vector<std::string> names_of_states() {
  std::vector<std::string> names;
  const fs::path folder = data_folder();
  std::error_code none;
  if (!folder.empty())
    for (const auto& entry : fs::directory_iterator(folder / "pvstate", none)) {
      const std::string name = entry.path().stem().string();
      if (entry.path().extension() != ".py") continue;
      if (name.starts_with("barchan_") || name.starts_with("render_")) continue;  // parts of the states, the renderer
      names.push_back(name);
    }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace barchan
