#include "scene/identity.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "base/input_file.hpp"
#include "base/memory.hpp"
#include "scene/scene_files.hpp"

namespace barchan {

namespace {

using Values = std::map<std::string, std::string>;

/// Of a file that cannot be read, or is larger than the memory that is left, "": who reads it for the scene says why.
std::string checksum_of(const std::string& path) {
  unsigned long sum = crc32_z(0, nullptr, 0);
  std::uint64_t size = 0;
  try {
    const InputFile file(path, static_cast<std::uint64_t>(std::min(available_memory().bytes, 1e18)));
    std::vector<char> bytes(65536);
    while (const std::size_t come = file.read(size, bytes.data(), bytes.size())) {
      sum = crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), come);
      size += come;
    }
  } catch (const InputError&) { return ""; }
  char text[48];
  std::snprintf(text, sizeof text, "%08lx-%zu", sum, static_cast<std::size_t>(size));
  return text;
}

/// Every value of the document by its dotted key.
void flatten(const toml::node& node, const std::string& dotted, Values& values) {
  const auto inner = [&](const std::string& name) { return dotted.empty() ? name : dotted + "." + name; };
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, entry] : *table) flatten(entry, inner(std::string(name.str())), values);
    return;
  }
  if (const toml::array* array = node.as_array(); array && !array->empty() && array->get(0)->is_table()) {
    std::size_t k = 0;
    for (const toml::node& entry : *array) flatten(entry, inner(std::to_string(k++)), values);
    return;
  }
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  values[dotted] = text.str();
}

Values values_of(const std::string& text) {
  Values values;
  try {
    flatten(toml::parse(text), "", values);
  } catch (const toml::parse_error&) { values["the document"] = "another one"; }
  return values;
}

}  // namespace

std::map<std::string, std::string> checksums_of_files(const Scene& scene) {
  std::map<std::string, std::string> checksums;
  const auto add = [&](const std::string& section, std::size_t k, const std::string& file) {
    if (!file.empty())
      checksums[section + " " + std::to_string(k) + ", checksum of its file"] = checksum_of(path_of_file(scene, file));
  };
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    std::string file;
    const auto* surface = std::get_if<SurfaceShape>(&scene.fills[k].shape);
    if (surface && !surface->facets.empty()) file = surface->file;  // else it was refused
    if (const auto* grains = std::get_if<FileShape>(&scene.fills[k].shape)) file = grains->file;
    add("fill", k, file);
  }
  for (std::size_t k = 0; k < scene.inflows.size(); ++k) add("inflow", k, scene.inflows[k].profile);
  for (std::size_t k = 0; k < scene.influxes.size(); ++k) add("influx", k, scene.influxes[k].file);
  return checksums;
}

std::string identity_of(toml::table document, const std::map<std::string, std::string>& checksums) {
  for (const char* key : {"title", "state"}) document.erase(key);
  if (toml::table* time = document["time"].as_table()) time->erase("end");
  if (toml::table* output = document["output"].as_table()) {
    const auto format = (*output)["format"].value<std::string>();
    output->clear();
    if (format) output->insert("format", *format);
    else document.erase("output");
  }
  for (const auto& [name, checksum] : checksums) document.insert(name, checksum);
  std::ostringstream text;
  text << document;
  return text.str();
}

std::string difference(const std::string& then, const std::string& now) {
  const Values before = values_of(then), after = values_of(now);
  std::set<std::string> keys;
  for (const auto* values : {&before, &after})
    for (const auto& [key, value] : *values) keys.insert(key);
  const auto shown = [](const Values& values, const std::string& key) {
    const auto found = values.find(key);
    if (found == values.end()) return std::string("not there");
    return found->second.size() <= 120 ? found->second : found->second.substr(0, 120) + " ...";
  };
  std::string text;
  for (const auto& key : keys) {
    const auto a = before.find(key), b = after.find(key);
    if (a != before.end() && b != after.end() && a->second == b->second) continue;
    text += "  " + key + ": " + shown(before, key) + " then, " + shown(after, key) + " now\n";
  }
  if (text.empty() && then != now && before.empty() != after.empty()) text = "  the whole document\n";
  return text;
}

}  // namespace barchan
