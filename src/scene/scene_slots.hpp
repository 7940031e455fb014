// Slots of single keys of a scene: of those that are more than one member, or that have words for a member of another
// type. Internal to the table of keys (rows.cpp).
#pragma once

#include <utility>

#include "scene/slots.hpp"

namespace barchan::slots {

// What follows from the alternatives of Phase::own.

using Own = decltype(Phase::own);
using Kinds = std::make_index_sequence<std::variant_size_v<Own>>;
template <std::size_t k>
using KeysOfKind = std::variant_alternative_t<k, Own>;

template <std::size_t... k>
constexpr std::array<Word, sizeof...(k)> words_of_kinds(std::index_sequence<k...>) {
  static_assert(((KeysOfKind<k>::kind == static_cast<PhaseKind>(k)) && ...), "own is in the order of PhaseKind");
  return {Word{KeysOfKind<k>::word, static_cast<int>(k)}...};
}
inline constexpr auto kind_words = words_of_kinds(Kinds{});

template <std::size_t... k>
void make_own(Own& own, std::size_t kind, std::index_sequence<k...>) {
  ((kind == k ? static_cast<void>(own.emplace<k>()) : static_cast<void>(0)), ...);
}

/// Chooses the type of the phase: it comes first in its section, before the keys that only this type has.
constexpr Slot kind_of_phase() {
  return {.accepts = as_word, .otherwise = required, .words = kind_words, .choose = [](void* phase, int kind) {
            make_own(static_cast<Phase*>(phase)->own, static_cast<std::size_t>(kind), Kinds{});
          }};
}

template <std::size_t... k>
constexpr std::size_t count_with_particles(std::index_sequence<k...>) {
  return (static_cast<std::size_t>(KeysOfKind<k>::has_particles) + ...);
}
template <std::size_t... k>
constexpr auto find_with_particles(std::index_sequence<k...>) {
  std::array<PhaseKind, count_with_particles(Kinds{})> kinds{};
  std::size_t n = 0;
  ((KeysOfKind<k>::has_particles ? static_cast<void>(kinds[n++] = KeysOfKind<k>::kind) : static_cast<void>(0)), ...);
  return kinds;
}
inline constexpr auto kinds_with_particles = find_with_particles(Kinds{});

inline constexpr std::array axes{Word{"x", 0}, Word{"y", 1}, Word{"z", 2}};
inline constexpr auto sides_of_domain = words_of<Side>;
inline constexpr std::array sides_or_none{sides_of_domain[0], sides_of_domain[1], sides_of_domain[2],
                                          sides_of_domain[3], sides_of_domain[4], sides_of_domain[5],
                                          Word{"none", 6}};
inline constexpr std::array bottom_or_top{sides_of_domain[0], sides_of_domain[1]};
inline constexpr std::array rest_of_the_domain{Word{"the-rest", 0}};
inline constexpr std::array hydrostatic{Word{"hydrostatic", 1}};
inline constexpr std::array holds{Word{"bulk-speed", static_cast<int>(Hold::bulk_speed)},
                                  Word{"stress", static_cast<int>(Hold::stress)},
                                  Word{"pressure-gradient", static_cast<int>(Hold::pressure_gradient)}};

// Slots of keys that are more than one member, or that have words for a member of another type.

/// The entries of [interactions] have names that the user chooses: read.cpp reads them, one by one, by the rows of
/// interactions.pair.
/// Not read into the scene: numbers stand in the place of the names before (constants.hpp).
constexpr Slot names_of_numbers() { return {.accepts = as_section, .otherwise = otherwise("none")}; }

constexpr Slot pairs() { return {.accepts = as_section, .otherwise = required}; }

template <auto list>
constexpr Slot measured(const char* in_words) {
  Slot slot = at<list>(in_words);
  slot.open = [](void* scene) -> void* { return &(static_cast<Scene*>(scene)->measuring.*list).emplace_back(); };
  return slot;
}

constexpr Slot periodic(const char* in_words) {
  return {.accepts = as_words, .otherwise = otherwise(in_words), .words = axes, .choose = [](void* domain, int axis) {
            static_cast<Domain*>(domain)->periodic[static_cast<std::size_t>(axis)] = true;
          }};
}

/// Sizes of spheres: the mean alone, or a section.
inline std::optional<SphereSize>* sizes_of(void* object) {
  Phase& phase = *static_cast<Phase*>(object);
  auto* grains = member_of(phase, &GrainsKeys::diameter);
  return grains ? grains : member_of(phase, &WallKeys::diameter);
}
constexpr Slot sizes(const char* in_words) {
  Slot slot{.accepts = as_number | as_section, .otherwise = otherwise(in_words)};
  slot.member = [](void* object) -> Target {
    auto* size = sizes_of(object);
    return size ? Target{&size->emplace().mean} : Target{};
  };
  slot.open = [](void* object) -> void* {
    auto* size = sizes_of(object);
    return size ? &size->emplace() : nullptr;
  };
  slot.kinds = kinds_with<PhaseKind::grains, PhaseKind::wall>;
  return slot;
}

constexpr Slot fill_shape() {
  return {.accepts = as_word | as_section,
          .otherwise = required,
          .words = rest_of_the_domain,
          .choose = [](void* fill, int) { static_cast<Fill*>(fill)->shape = RemainderShape{}; },
          .open = [](void* fill) -> void* { return &static_cast<Fill*>(fill)->shape; }};
}

/// A velocity of a fill or an inflow: components, or a section with a profile.
template <auto member, class Otherwise>
constexpr Slot velocity_or_profile(Otherwise text) {
  Slot slot = at<member>(text);
  slot.accepts |= as_section;
  slot.open = [](void* object) { return object; };
  return slot;
}

constexpr Slot fill_pressure(const char* in_words) {
  Slot slot = at<&Fill::pressure>(in_words);
  slot.accepts |= as_word;
  slot.words = hydrostatic;
  slot.choose = [](void* fill, int) { static_cast<Fill*>(fill)->hydrostatic = true; };
  return slot;
}

/// Of all kinds of phases that have particles.
constexpr Slot spacing_of_particles(const char* in_words) {
  Slot slot = at<&Phase::spacing>(in_words);
  slot.kinds = kinds_with_particles;
  return slot;
}

/// A number, or the name of a law.
constexpr Slot drag(const char* in_words) {
  Slot slot = at<&Interaction::drag>(0.0, in_words);
  slot.accepts |= as_word;
  slot.words = words_of<DragLaw>;
  slot.choose = [](void* pair, int law) { static_cast<Interaction*>(pair)->drag_law = static_cast<DragLaw>(law); };
  return slot;
}

constexpr Slot sides() {
  Slot slot = in_shape<&SidesShape::sides>();
  slot.words = sides_of_domain;
  return slot;
}

constexpr Slot open_sides_of_domain(const char* in_words) {
  Slot slot = at<&Domain::open>(in_words);
  slot.words = sides_or_none;
  return slot;
}

constexpr Slot layers(const char* in_words) {
  return {.accepts = as_integer, .otherwise = otherwise(in_words), .member = [](void* shape) -> Target {
            if (auto* bed = shape_of<BedShape>(shape, belongs)) return &bed->layers;
            if (auto* sides = shape_of<SidesShape>(shape, belongs)) return &sides->layers;
            return {};
          }};
}

/// Of the shapes that come from numbers or a file.
inline Placement* placement_of(void* object) {
  if (auto* polygon = shape_of<PolygonShape>(object, belongs)) return &polygon->placement;
  auto* surface = shape_of<SurfaceShape>(object, belongs);
  return surface ? &surface->placement : nullptr;
}
template <auto member, class... Otherwise>
constexpr Slot placed(Otherwise... text) {
  using Member = decltype(type_of(member));
  constexpr auto find = [](void* shape) -> Member* {
    Placement* placement = placement_of(shape);
    return placement ? &(placement->*member) : nullptr;
  };
  return slot_of<Member, find>(otherwise(text...));
}

constexpr Slot hold(const char* in_words) {
  return {.accepts = as_word, .otherwise = otherwise(in_words), .words = holds, .choose = [](void* forcing, int word) {
            static_cast<Forcing*>(forcing)->hold = static_cast<Hold>(word);
          }};
}

constexpr Slot along(int axis) {
  return {.accepts = as_word, .otherwise = otherwise(axis), .words = axes, .choose = [](void* profile, int chosen) {
            static_cast<Profile*>(profile)->along = static_cast<std::size_t>(chosen);
          }};
}

constexpr Slot side(int side) {
  return {
      .accepts = as_word, .otherwise = otherwise(side), .words = bottom_or_top, .choose = [](void* shear, int chosen) {
        static_cast<WallShear*>(shear)->top = chosen == 1;
      }};
}

constexpr Slot fields(const char* in_words) {
  Slot slot = at<&OutputControl::fields>(in_words);
  slot.fields = true;
  return slot;
}

}  // namespace barchan::slots
