#include "scene/located.hpp"

#include <algorithm>

#include "base/errors.hpp"

namespace barchan {

namespace {

void add(const toml::node& node, const std::string& dotted, const std::string& file,
         std::map<std::string, std::string>& places) {
  const toml::source_region& source = node.source();
  const bool from_override = source.path && source.path->starts_with("--set ");
  if (!dotted.empty())
    places[dotted] = from_override ? shortened(*source.path)
                                   : file + ":" + std::to_string(std::max<unsigned>(source.begin.line, 1)) + ":" +
                                         std::to_string(std::max<unsigned>(source.begin.column, 1));
  const auto inner = [&](const std::string& name) { return dotted.empty() ? name : dotted + "." + name; };
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, entry] : *table) add(entry, inner(std::string(name.str())), file, places);
  } else if (const toml::array* array = node.as_array(); array && !array->empty() && array->get(0)->is_table()) {
    std::size_t k = 0;
    for (const toml::node& entry : *array) add(entry, inner(std::to_string(k++)), file, places);
  }
}

}  // namespace

std::map<std::string, std::string> places_of_keys(const toml::table& document, const std::string& file) {
  std::map<std::string, std::string> places;
  add(document, "", file, places);
  return places;
}

std::string located(const Scene& scene, const std::string& dotted) {
  std::string key = dotted;
  while (true) {
    if (const auto found = scene.places.find(key); found != scene.places.end()) return found->second + ": " + dotted;
    const std::size_t dot = key.rfind('.');
    if (dot == std::string::npos) return scene.file + ": " + dotted;
    key.resize(dot);
  }
}

}  // namespace barchan
