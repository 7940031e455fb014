// The laws of contact of spheres that a scene can choose: the one place where a word of an entry's `law` meets the
// parts of which its law is composed.
//
// To add a law: its part in a file of laws/ and a row here; its word and the keys that it reads in
// scene/contact_words.hpp. The loops over contacts (models/grains/sphere_forces.cpp), the constants
// (models/grains/sphere_laws.cpp), the checks of a scene and the plan follow from the rows.
#pragma once

#include <algorithm>
#include <tuple>
#include <variant>

#include "laws/hertz_spring.hpp"
#include "laws/linear_spring.hpp"
#include "laws/slip_stiffness.hpp"
#include "laws/sphere_contact.hpp"

namespace barchan {

template <ContactLaw law_word, class... Parts>
struct SphereLawRow {
  static constexpr ContactLaw word = law_word;
  using Law = SphereContact<Parts...>;
};

// In the order of `sphere_laws` (scene/contact_words.hpp).
using SphereCatalogue = std::tuple<
    // a spring and a dashpot, with the same stiffness at any speed
    SphereLawRow<ContactLaw::linear, LinearSpring, NormalDashpot, CoulombFriction<ConstantSlipStiffness>,
                 RollingResistance>,
    // elastic spheres: Hertz 1882, Mindlin 1949
    SphereLawRow<ContactLaw::hertz, HertzSpring, NormalDashpot, CoulombFriction<MindlinSlipStiffness>,
                 RollingResistance>>;

namespace detail {
template <class... Rows>
constexpr bool words_agree(const std::tuple<Rows...>*) {
  constexpr ContactLaw words[] = {Rows::word...};
  for (std::size_t k = 0; k < sizeof...(Rows) && k < sphere_laws.size(); ++k)
    if (words[k] != sphere_laws[k].law) return false;
  return sizeof...(Rows) == sphere_laws.size();
}
static_assert(words_agree(static_cast<const SphereCatalogue*>(nullptr)),
              "each law of spheres has a row here and one in scene/contact_words.hpp, in the same order");

template <class... Rows>
std::variant<typename Rows::Law...> any_of_rows(const std::tuple<Rows...>*);
template <class F, class... Rows>
constexpr void each_row(F&& f, const std::tuple<Rows...>*) {
  (f(Rows{}), ...);
}
}  // namespace detail

namespace detail {
template <class... Rows>
constexpr std::size_t most_numbers_of(const std::tuple<Rows...>*) {
  return std::max({Rows::Law::template numbers<2>..., Rows::Law::template numbers<3>...});
}
}  // namespace detail

/// The most numbers that a contact remembers under any law.
inline constexpr std::size_t most_remembered = detail::most_numbers_of(static_cast<const SphereCatalogue*>(nullptr));

/// A law of the catalogue with its constants.
using AnySphereContact = decltype(detail::any_of_rows(static_cast<const SphereCatalogue*>(nullptr)));

/// Which parts some law of a scene has.
struct ContactParts {
  bool damps = false, rubs = false, rolls = false;
};

/// Calls f with the law, without the parts that no law of a scene has: rolling resistance, friction too, and loss.
template <class F>
void with_parts(const AnySphereContact& law, ContactParts has, F&& f) {
  std::visit(
      [&](const auto& whole) {
        if (has.rolls) f(whole);
        else if (has.rubs) f(whole.without_rolling());
        else if (has.damps) f(whole.smooth());
        else f(whole.lossless());
      },
      law);
}

/// Calls f(row) for each row of the catalogue, in their order.
template <class F>
constexpr void each_sphere_law(F&& f) {
  detail::each_row(f, static_cast<const SphereCatalogue*>(nullptr));
}

}  // namespace barchan
