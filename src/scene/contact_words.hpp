// Laws of contact of grains as a document names them, and the keys of grains that they read.
//
// To add a law of spheres: its enumerator, its word, its row in `sphere_laws`; a key of its own is a member of
// SphereMaterial with its row in scene/rows.cpp. The law itself is a row of laws/sphere_catalogue.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "scene/words.hpp"

namespace barchan {

enum class ContactLaw { kernel, linear, hertz };  // laws/kernel_contact.hpp; laws/sphere_catalogue.hpp
template <>
inline constexpr std::array words_of<ContactLaw>{word("kernel", ContactLaw::kernel), word("linear", ContactLaw::linear),
                                                 word("hertz", ContactLaw::hertz)};

/// A law of spheres and the keys of a phase of grains that only some laws read. `stiffness`: how stiff the contacts
/// are; largest-overlap is read in its place. Empty: no key.
struct SphereLawKeys {
  ContactLaw law;
  std::string_view stiffness;
  std::array<std::string_view, 2> others{};
  constexpr bool reads(std::string_view key) const { return key == stiffness || key == others[0] || key == others[1]; }
};
inline constexpr std::array sphere_laws{
    SphereLawKeys{ContactLaw::linear, "stiffness", {"tangential-stiffness"}},
    SphereLawKeys{ContactLaw::hertz, "young", {"poisson"}},
};

/// The row of a law; null of a law that is not one of spheres.
constexpr const SphereLawKeys* sphere_keys_of(ContactLaw law) {
  const auto* const row =
      std::find_if(sphere_laws.begin(), sphere_laws.end(), [&](const SphereLawKeys& r) { return r.law == law; });
  return row == sphere_laws.end() ? nullptr : row;
}
/// Whether it is a contact of spheres: their radii decide when they touch, and no radius of the entry is read.
constexpr bool of_spheres(ContactLaw law) { return sphere_keys_of(law) != nullptr; }

enum class Material { none, quartz_sand, glass_beads, cellulose_acetate };  // scene/materials.hpp
template <>
inline constexpr std::array words_of<Material>{word("none", Material::none), word("quartz-sand", Material::quartz_sand),
                                               word("glass-beads", Material::glass_beads),
                                               word("cellulose-acetate", Material::cellulose_acetate)};

/// What a phase of grains says of its contacts: the keys from which laws of spheres take their constants.
struct SphereMaterial {
  Material material{};        // gives the numbers that the document leaves out
  double restitution{};       // of a head-on collision of two grains, 0 < e <= 1
  double friction{};          // Coulomb's coefficient, of spheres
  double rolling_friction{};  // largest rolling torque over normal force and reduced radius, of spheres
  std::optional<double> tangential_stiffness;  // over the normal one, of a linear contact; empty: 2/7
  std::optional<double> stiffness;             // N/m, of a linear contact of two grains of the phase
  std::optional<double> largest_overlap;       // of the mean diameter, at the largest speed of the scene
  double young{};                              // Pa, of a Hertzian contact; 0: from largest_overlap
  double poisson{};
};

struct Scene;
struct Phase;

/// Whether the phase has an entry with a law of spheres.
bool touches_as_spheres(const Scene& scene, const Phase& phase);
/// The laws of spheres that read a key of grains, as a document has them: law = "linear" or "hertz". Empty key: all.
std::string sphere_laws_that_read(std::string_view key);
/// The keys of grains that say how stiff contacts of spheres are, with that text between two of them.
std::string sphere_stiffness_keys(const std::string& between);

}  // namespace barchan
