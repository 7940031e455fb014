// Probes, profiles, grids and wall shear out of a document.
#include "scene/take.hpp"

namespace barchan {
namespace {

template <class T>
T common(const toml::table& table) {
  T measured;
  measured.name = table["name"].value_or(std::string());
  measured.phase = table["phase"].value_or(std::string());
  take_number(table, "every", measured.every);
  take_number(table, "start", measured.start);
  return measured;
}

void take(const toml::table& table, Probe& probe) { probe.at = take_vector(table, "at"); }

void take(const toml::table& table, Profile& profile) {
  profile.from = take_vector(table, "from");
  profile.to = take_vector(table, "to");
  if (const toml::table* box = table["box"].as_table())
    profile.box = BoxShape{take_vector(*box, "min"), take_vector(*box, "max")};
  profile.along = take_choice<std::size_t>(table, "along", profile.along, {{"x", 0}, {"y", 1}, {"z", 2}});
  profile.count = table["count"].value_or(profile.count);
}

void take(const toml::table& table, Grid& grid) {
  if (table.contains("min")) grid.min = take_vector(table, "min");
  if (table.contains("max")) grid.max = take_vector(table, "max");
  take_number(table, "spacing", grid.spacing);
}

void take(const toml::table& table, WallShear& shear) {
  shear.wall = table["wall"].value_or(std::string());
  shear.top = take_choice(table, "side", shear.top, {{"bottom", false}, {"top", true}});
  shear.count = table["count"].value_or(shear.count);
}

template <class T>
std::vector<T> all(const toml::table& document, std::string_view section) {
  std::vector<T> list;
  if (const toml::array* entries = document[section].as_array())
    for (const toml::node& node : *entries) {
      const toml::table* table = node.as_table();
      list.push_back(table ? common<T>(*table) : T{});
      if (table) take(*table, list.back());
    }
  return list;
}

}  // namespace

Measuring take_measuring(const toml::table& document) {
  return {all<Probe>(document, "probe"), all<Profile>(document, "profile"), all<Grid>(document, "grid"),
          all<WallShear>(document, "wall-shear")};
}

}  // namespace barchan
