// Materials of grains: constants of their contacts, each from where it was measured.
#pragma once

#include "scene/contact_words.hpp"

namespace barchan {

/// What a material says of a phase of grains (docs/materials.md has the sources).
struct MaterialConstants {
  Material material;
  double density;  // kg/m3
  double restitution, friction, rolling_friction;
  double tangential_stiffness;  // over the normal one, of linear contacts
};

/// Throws std::logic_error of Material::none.
const MaterialConstants& constants_of(Material material);

}  // namespace barchan
