#include "scene/settable.hpp"

#include <set>

namespace barchan {
namespace {

constexpr unsigned values = ~static_cast<unsigned>(as_section | as_sections | as_named_sections);

class Lister {
 public:
  explicit Lister(const Scene* scene) : scene_(scene) {}

  void section(std::string_view section, const std::string& dotted, std::string_view kind = {}) {
    for (const Key* key : keys_of(section)) {
      if (!kind.empty() && !belongs_to_kind(*key, kind)) continue;
      const std::string here = dotted + std::string(key->name), path = path_of(*key);
      if (key->slot.accepts & values) list.push_back({here, key});
      if (path == "constants") constants();
      else if (path == "phases") phases();
      else if (path == "interactions") pairs();
      else if (key->slot.accepts & as_sections) entries(path, here);
      else if (key->slot.accepts & as_section) this->section(path, here + ".");
    }
  }

  std::vector<SettableKey> list;

 private:
  /// The names of the entries that the scene has at this key: of "fill" 0, 1, ...; without a scene `otherwise`.
  std::vector<std::string> names(const std::string& dotted, const std::string& otherwise) const {
    if (!scene_) return {otherwise};
    std::set<std::string> found;
    const std::string begin = dotted + ".";
    for (const auto& [place, _] : scene_->places)
      if (place.starts_with(begin))
        found.insert(place.substr(begin.size(), place.find('.', begin.size()) - begin.size()));
    return {found.begin(), found.end()};
  }

  void entries(const std::string& path, const std::string& here) {
    for (const std::string& name : names(here, "0")) section(path, here + "." + name + ".");
  }

  void phases() {
    if (!scene_) return section("phases", "phases.NAME.");
    const Key& kinds = *find_key("phases", "kind");
    for (const Phase& phase : scene_->phases)
      section("phases", "phases." + phase.name + ".", kinds.slot.words[phase.own.index()].word);
  }

  void pairs() {
    for (const Key* key : keys_of("interactions")) list.push_back({"interactions." + std::string(key->name), key});
    for (const std::string& name : names("interactions", "A-B"))
      if (!find_key("interactions", name)) {
        list.push_back({"interactions." + name, find_key("interactions.pair", "radius")});
        section("interactions.pair", "interactions." + name + ".");
      }
  }

  void constants() {
    for (const std::string& name : names("constants", "NAME")) list.push_back({"constants." + name, nullptr});
  }

  const Scene* scene_;
};

}  // namespace

std::vector<SettableKey> settable_keys(const Scene* scene) {
  Lister lister(scene);
  lister.section("", "");
  return lister.list;
}

}  // namespace barchan
