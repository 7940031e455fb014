#include "scene/read.hpp"

#include <algorithm>
#include <filesystem>

#include "scene/keys.hpp"
#include "scene/materials.hpp"
#include "scene/validate.hpp"

namespace barchan {
namespace {

const toml::table nothing;

/// Names of a section in the order in which a person wrote them; those that an override added come last.
std::vector<std::string> written_order(const toml::table& table) {
  std::vector<std::pair<std::pair<bool, toml::source_position>, std::string>> names;
  for (const auto& [name, node] : table) {
    const toml::source_region& source = name.source();
    const bool from_override = source.path && source.path->starts_with("--set ");
    names.push_back({{from_override, source.begin}, std::string(name.str())});
  }
  std::stable_sort(names.begin(), names.end(), [](const auto& a, const auto& b) {
    if (a.first.first != b.first.first) return b.first.first;
    return a.first.second < b.first.second;
  });
  std::vector<std::string> order;
  order.reserve(names.size());
  for (auto& name : names) order.push_back(std::move(name.second));
  return order;
}

/// Writes a value into a member; false when it is of another type. Integers are numbers too.
struct Write {
  const toml::node& node;

  bool operator()(std::monostate) const { return true; }
  bool operator()(bool* member) const { return plain(node.as_boolean(), member); }
  bool operator()(std::optional<bool>* member) const { return plain(node.as_boolean(), member); }
  bool operator()(std::string* member) const { return plain(node.as_string(), member); }
  bool operator()(int* member) const { return whole(member); }
  bool operator()(unsigned* member) const { return whole(member); }
  bool operator()(double* member) const { return number(member); }
  bool operator()(std::optional<double>* member) const { return number(member); }

  bool operator()(Vec3* member) const {
    const toml::array* array = node.as_array();
    if (!array) return false;
    *member = {};
    for (std::size_t k = 0; k < std::min<std::size_t>(array->size(), 3); ++k)
      Write{*array->get(k)}.number(&(*member)[k]);
    return true;
  }
  bool operator()(std::optional<Vec3>* member) const { return (*this)(&member->emplace()); }
  bool operator()(Expression* member) const {
    if (const auto* text = node.as_string()) member->formula = text->get();
    else return number(&member->value);
    return true;
  }
  bool operator()(VectorExpression* member) const {
    const toml::array* array = node.as_array();
    if (!array) return false;
    for (std::size_t k = 0; k < std::min<std::size_t>(array->size(), 3); ++k) Write{*array->get(k)}(&(*member)[k]);
    return true;
  }
  bool operator()(std::optional<AxialExpression>* member) const {
    VectorExpression& about = member->emplace().about;
    return node.is_array() ? (*this)(&about) : (*this)(&about[2]);
  }
  template <class Item>
  bool operator()(std::vector<Item>* member) const {
    const toml::array* array = node.as_array();
    if (!array) return false;
    for (const toml::node& entry : *array)
      if (Item item{}; Write{entry}(&item)) member->push_back(item);
    return true;
  }
  bool operator()(std::array<double, 2>* member) const {
    Vec3 point;
    if (!(*this)(&point)) return false;
    *member = {point[0], point[1]};
    return true;
  }

 private:
  template <class Value, class Member>
  static bool plain(const Value* value, Member* member) {
    if (value) *member = value->get();
    return value != nullptr;
  }
  template <class Member>
  bool whole(Member* member) const {
    const auto value = node.value_exact<std::int64_t>();
    if (value) *member = static_cast<Member>(*value);
    return value.has_value();
  }
  template <class Member>
  bool number(Member* member) const {
    if (node.is_number()) *member = node.value<double>().value_or(0.0);
    return node.is_number();
  }
};

/// Writes a row's default into a member.
struct Assign {
  const Default& otherwise;

  void operator()(bool* member) const { *member = std::get<bool>(otherwise.value); }
  void operator()(int* member) const { *member = std::get<int>(otherwise.value); }
  void operator()(unsigned* member) const { *member = static_cast<unsigned>(std::get<int>(otherwise.value)); }
  void operator()(double* member) const { *member = std::get<double>(otherwise.value); }
  template <class Other>
  void operator()(const Other&) const {}  // no value tells it: slots.hpp
};

/// What the material of grains says where the document does not.
void take_material(const toml::table& table, Phase& phase) {
  auto* const grains = std::get_if<GrainsKeys>(&phase.own);
  if (!grains || grains->material == Material::none) return;
  const MaterialConstants& m = constants_of(grains->material);
  const auto take = [&](std::string_view key, auto& member, double value) {
    if (!table.contains(key)) member = value;
  };
  take("density", phase.density, m.density);
  take("restitution", grains->restitution, m.restitution);
  take("friction", grains->friction, m.friction);
  take("rolling-friction", grains->rolling_friction, m.rolling_friction);
  take("tangential-stiffness", grains->tangential_stiffness, m.tangential_stiffness);
}

/// Reads one section of the document into its object, a key at a time in the order of the table.
class Reader {
 public:
  /// `object` is what the slots of this section expect.
  static void section(const toml::table& table, std::string_view path, void* object) {
    for (const Key* key : keys_of(path)) {
      const toml::node* node = table.get(key->name);
      const bool read = node && value(*key, *node, object);
      if (!read) otherwise(*key, object);
    }
  }

  /// False when the value is of another type than the key's: the key then keeps its default.
  static bool value(const Key& key, const toml::node& node, void* object) {
    const Slot& slot = key.slot;
    if (const auto* text = node.as_string(); text && slot.choose) {
      if (choose(slot, text->get(), object)) return true;
    }
    if (const auto* array = node.as_array(); array && slot.choose) {
      for (const toml::node& entry : *array)
        if (const auto* text = entry.as_string()) choose(slot, text->get(), object);
      return true;
    }
    if (slot.open) {
      if (const auto* table = node.as_table())
        return slot.accepts & as_named_sections ? named(key, *table, object) : inner(key, *table, object);
      if (const auto* array = node.as_array(); array && (slot.accepts & as_sections)) {
        for (const toml::node& entry : *array) inner(key, entry.is_table() ? *entry.as_table() : nothing, object);
        return true;
      }
    }
    return slot.member && std::visit(Write{node}, slot.member(object));
  }

  static bool inner(const Key& key, const toml::table& table, void* object) {
    if (void* opened = key.slot.open(object)) section(table, path_of(key), opened);
    return true;
  }

 private:
  static bool choose(const Slot& slot, std::string_view text, void* object) {
    for (const Word& word : slot.words)
      if (word.word == text) {
        slot.choose(object, word.meaning);
        return true;
      }
    return false;
  }

  /// Sections whose names the user chooses: the object has a member `name`.
  static bool named(const Key& key, const toml::table& table, void* object) {
    for (const std::string& name : written_order(table)) {
      const toml::table* entry = table[name].as_table();
      if (!entry) continue;
      void* opened = key.slot.open(object);
      static_cast<Phase*>(opened)->name = name;
      section(*entry, path_of(key), opened);
      take_material(*entry, *static_cast<Phase*>(opened));
    }
    return true;
  }

  static void otherwise(const Key& key, void* object) {
    const Slot& slot = key.slot;
    if (slot.always) inner(key, nothing, object);
    const int* whole = std::get_if<int>(&slot.otherwise.value);
    if (whole && slot.choose) return slot.choose(object, *whole);
    if (std::holds_alternative<std::monostate>(slot.otherwise.value)) return;
    std::visit(Assign{slot.otherwise}, slot.member(object));
  }
};

/// Pairs that the matrix says do not interact: a-b = false.
std::vector<std::array<std::string, 2>> read_apart(const toml::table& table) {
  std::vector<std::array<std::string, 2>> apart;
  for (const std::string& name : written_order(table)) {
    const std::size_t dash = name.find('-');
    if (table[name].is_boolean() && dash != std::string::npos)
      apart.push_back({name.substr(0, dash), name.substr(dash + 1)});
  }
  return apart;
}

/// The matrix: its entries have names of phases, in place of keys. An entry is a section or, for short, its radius.
std::vector<Interaction> read_matrix(const toml::table& table, const std::vector<Phase>& phases) {
  static const Key& radius = *find_key("interactions.pair", "radius");
  MatrixDefaults defaults;
  Reader::section(table, "interactions", &defaults);
  std::vector<Interaction> interactions;
  for (const std::string& name : written_order(table)) {
    if (find_key("interactions", name) || table[name].is_boolean()) continue;
    const std::size_t dash = name.find('-');
    Interaction& pair = interactions.emplace_back(
        recommended(phases, name.substr(0, dash), dash == std::string::npos ? "" : name.substr(dash + 1)));
    if (defaults.kernel) pair.kernel = *defaults.kernel;
    const toml::table* entry = table[name].as_table();
    Reader::section(entry ? *entry : nothing, radius.section, &pair);
    if (!entry) Reader::value(radius, *table.get(name), &pair);
    pair.states_radius = !entry || entry->contains("radius") || entry->contains("radius-in-metres");
  }
  return interactions;
}

}  // namespace

Scene read_document(const toml::table& document, const std::string& file) {
  Scene scene;
  scene.file = file;
  scene.name = std::filesystem::path(file).stem().string();
  scene.title = scene.name;
  Reader::section(document, "", &scene);
  scene.dimensions = dimensions_of(document);
  if (const toml::table* matrix = document["interactions"].as_table()) {
    scene.interactions = read_matrix(*matrix, scene.phases);
    scene.apart = read_apart(*matrix);
  }
  complete(scene);
  return scene;
}

}  // namespace barchan
