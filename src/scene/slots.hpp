// Makes a row's slot from a pointer to a member: what the value may be follows from the member's type. Internal to the
// table of keys (rows.cpp).
#pragma once

#include <concepts>
#include <type_traits>

#include "scene/keys.hpp"

namespace barchan::slots {

inline constexpr Default required{.in_words = "required", .required = true};

/// A default as a row writes it: a value of the member's type, words where a value does not tell it, or both.
constexpr Default otherwise() { return {}; }
constexpr Default otherwise(Default told) { return told; }
constexpr Default otherwise(const char* in_words) { return {.in_words = in_words}; }
constexpr Default otherwise(Default told, const char* in_words) {
  told.in_words = in_words;
  return told;
}
template <class Value>
requires std::is_enum_v<Value>
constexpr Default otherwise(Value value) { return {.value = static_cast<int>(value)}; }
template <class Value>
requires std::same_as<Value, bool> || std::same_as<Value, int> || std::same_as<Value, double>
constexpr Default otherwise(Value value, const char* in_words = "") { return {.value = value, .in_words = in_words}; }

template <class T>
struct Plain {
  using type = T;
  static constexpr bool optional = false, list = false;
};
template <class T>
struct Plain<std::optional<T>> {
  using type = T;
  static constexpr bool optional = true, list = false;
};
template <class T>
struct Plain<std::vector<T>> {
  using type = T;
  static constexpr bool optional = false, list = true;
};

template <class Member>
concept Leaf = requires(Member& member) {
  Target{&member};
};

/// Only of members of these types: what a document may say for them.
template <class Member>
constexpr unsigned accepts_of() {
  using Value = typename Plain<Member>::type;
  if constexpr (std::is_enum_v<Value>) return as_word;
  else if constexpr (std::same_as<Member, std::vector<std::string>>) return as_words;
  else if constexpr (std::same_as<Member, std::vector<Vec3>>) return as_points;
  else if constexpr (std::same_as<Member, std::vector<std::array<double, 2>>>) return as_corners;
  else if constexpr (std::same_as<Value, bool>) return as_boolean;
  else if constexpr (std::same_as<Value, int> || std::same_as<Value, unsigned>) return as_integer;
  else if constexpr (std::same_as<Value, double>) return as_number;
  else if constexpr (std::same_as<Value, std::string>) return as_text;
  else if constexpr (std::same_as<Value, Vec3>) return as_vector;
  else if constexpr (std::same_as<Value, Expression>) return as_formula;
  else if constexpr (std::same_as<Value, VectorExpression>) return as_formulas;
  else if constexpr (std::same_as<Value, AxialExpression>) return as_axial;
  else if constexpr (std::same_as<Member, std::vector<Phase>>) return as_named_sections;
  else return Plain<Member>::list ? as_sections : as_section;
}

/// A default has the member's type; a member that a value does not tell (a string, an optional number) has none.
template <class Member>
constexpr bool fits(const Default& otherwise) {
  if (std::holds_alternative<std::monostate>(otherwise.value)) return true;
  if constexpr (std::is_enum_v<Member> || std::same_as<Member, unsigned>)
    return std::holds_alternative<int>(otherwise.value);
  else if constexpr (std::is_arithmetic_v<Member>) return std::holds_alternative<Member>(otherwise.value);
  else return false;
}

template <class Owner, class Member>
Owner owner_of(Member Owner::*);
template <class Owner, class Member>
Member type_of(Member Owner::*);

/// Slot of a member found by `find(object)`, a reference or, where the object may lack it, a pointer.
template <class Member, auto find>
constexpr Slot slot_of(Default otherwise) {
  using Value = typename Plain<Member>::type;
  if (!fits<Member>(otherwise)) throw "the default is of another type than the member";  // the table does not compile
  Slot slot{.accepts = accepts_of<Member>(), .otherwise = otherwise};
  if constexpr (std::is_enum_v<Value>) {
    slot.words = words_of<Value>;
    slot.choose = [](void* object, int meaning) {
      if (Member* member = find(object)) *member = static_cast<Value>(meaning);
    };
  } else if constexpr (Leaf<Member>) {
    slot.member = [](void* object) -> Target {
      Member* member = find(object);
      return member ? Target{member} : Target{};
    };
  } else {
    slot.always = !Plain<Member>::optional && !Plain<Member>::list;
    slot.open = [](void* object) -> void* {
      Member* member = find(object);
      if (!member) return nullptr;
      if constexpr (Plain<Member>::list) return &member->emplace_back();
      else if constexpr (Plain<Member>::optional) return &member->emplace();
      else return member;
    };
  }
  return slot;
}

/// A member of the section's object. `Object` where the member belongs to a base of it.
template <auto member, class Object = decltype(owner_of(member)), class... Otherwise>
constexpr Slot at(Otherwise... text) {
  using Member = decltype(type_of(member));
  constexpr auto find = [](void* object) -> Member* { return &(static_cast<Object*>(object)->*member); };
  return slot_of<Member, find>(otherwise(text...));
}

/// The kind of phase whose keys they are.
template <class Keys>
inline constexpr PhaseKind kind_of = Keys::kind;
template <>
inline constexpr PhaseKind kind_of<SphereMaterial> = PhaseKind::grains;

/// A member of a kind of phase, or of several kinds that have the key in common.
template <class Member, class Keys>
Member* member_of(Phase& phase, Member Keys::*member) {
  Keys* keys = std::get_if<static_cast<std::size_t>(kind_of<Keys>)>(&phase.own);
  return keys ? &(keys->*member) : nullptr;
}
template <PhaseKind... kind>
constexpr std::array kinds_with{kind...};
template <auto first, auto... others, class... Otherwise>
constexpr Slot of(Otherwise... text) {
  using Member = decltype(type_of(first));
  constexpr auto find = [](void* object) -> Member* {
    Phase& phase = *static_cast<Phase*>(object);
    Member* found = member_of(phase, first);
    ((found = found ? found : member_of(phase, others)), ...);
    return found;
  };
  Slot slot = slot_of<Member, find>(otherwise(text...));
  slot.kinds = kinds_with<kind_of<decltype(owner_of(first))>, kind_of<decltype(owner_of(others))>...>;
  return slot;
}

/// A member of the shape that the fill has: `names` if the key itself names the shape, and then the first one counts.
enum Companion { names, belongs };
template <class Kind>
Kind* shape_of(void* object, Companion key) {
  Shape& shape = *static_cast<Shape*>(object);
  if (key == names && std::holds_alternative<RemainderShape>(shape)) shape.emplace<Kind>();
  return std::get_if<Kind>(&shape);
}
template <auto member, Companion key = names, class... Otherwise>
constexpr Slot in_shape(Otherwise... text) {
  using Member = decltype(type_of(member));
  constexpr auto find = [](void* object) -> Member* {
    auto* kind = shape_of<decltype(owner_of(member))>(object, key);
    return kind ? &(kind->*member) : nullptr;
  };
  return slot_of<Member, find>(otherwise(text...));
}
/// A shape that is a section of its own.
template <class Kind>
constexpr Slot shape() {
  return {.accepts = as_section, .open = [](void* object) -> void* { return shape_of<Kind>(object, names); }};
}

}  // namespace barchan::slots
