// barchan new: a scene of one's own, from one that comes along.
#include <filesystem>
#include <iostream>
#include <variant>

#include "app/habits.hpp"
#include "app/shipped.hpp"
#include "base/data_folder.hpp"
#include "base/errors.hpp"
#include "base/input_file.hpp"
#include "base/version.hpp"
#include "checks/reader.hpp"
#include "output/series.hpp"
#include "output/whole_file.hpp"
#include "scene/scene_files.hpp"

namespace barchan {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& file) {
  try {
    return read_input(file);
  } catch (const InputError& e) { throw OutputError(file.string() + ": " + e.what()); }
}

/// The copied text under a head of its own: who made it, and the schema that editors complete keys from.
std::string with_head(const std::string& text, const std::string& name, const std::string& from) {
  std::string body = text;
  if (body.starts_with("#:schema")) body.erase(0, body.find('\n') + 1);
  const fs::path schema = data_folder() / "scenes" / "scene.schema.json";
  std::error_code none;
  std::string head;
  if (fs::exists(schema, none)) head = "#:schema " + schema.string() + "\n";
  return head + "# Made by `barchan new " + name + " --from " + from + "`, barchan " + version() +
         ". What follows is the text of that scene.\n# Run it: barchan run " + name + ".toml\n\n" + body;
}

}  // namespace

int make_new(const std::string& name, const std::string& from) {
  fs::path target = name;
  if (target.extension() == ".toml") target.replace_extension();
  const std::string stem = target.string();
  if (target.filename().empty() || target.filename() == "." || target.filename() == "..")
    throw SceneError("new " + name +
                     ": is a folder; expected the name of a scene, as in `barchan new mine --from dune`");
  const fs::path source = scene_file(from), folder = target.parent_path();
  const fs::path file = stem + ".toml";
  const Scene scene = read_scene(source.string());

  // All is looked at before anything is written.
  std::error_code none;
  if (fs::exists(fs::symlink_status(file, none)))
    throw SceneError(file.string() + ": is there already, and stays as it is; expected another name");
  std::vector<std::pair<fs::path, std::string>> files{{file, with_head(contents(source), stem, from)}};
  for (const std::string& read : files_of(scene)) {
    const fs::path copy = folder / read;
    const std::string text = contents(path_of_file(scene, read));
    if (fs::path(read).is_absolute()) continue;  // found from everywhere
    if (!fs::exists(fs::symlink_status(copy, none))) files.emplace_back(copy, text);
    else if (contents(copy) != text)
      throw SceneError(copy.string() + ": is there already and another file than that of " + from +
                       "; expected another folder, as in `barchan new " +
                       (fs::path(stem) / target.filename()).string() + " --from " + from + "`");
  }
  for (const auto& [path, text] : files) {
    if (!path.parent_path().empty()) make_directory(path.parent_path());
    write_whole_file(path, text);
    std::cout << "wrote " << path.string() << '\n';
  }
  const bool plain = file.string().find(' ') == std::string::npos;
  const std::string typed = plain ? file.string() : "'" + file.string() + "'";
  std::cout << "next: barchan plan " << typed << "; barchan run " << typed << '\n';
  return 0;
}

}  // namespace barchan
