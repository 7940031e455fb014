// The scene in which the grains of a settled fill come to rest: a scene made of another one.
#pragma once

#include "scene/scene.hpp"

namespace barchan {

/// The name of the wall that is the box.
inline constexpr const char* settling_box = "settling_box";
/// Height of the lattice from which grains fall over that of their bed, for equal grains.
inline constexpr double loose_lattice_height = 1.35;
/// While contacts are soft, one number says how stiff they are; at last they have the law of the scene.
inline constexpr ContactLaw soft_contact_law = ContactLaw::linear;

/// The box that a fill's grains fall into (m), and its height when they have settled.
struct SettlingRoom {
  Vec3 low{}, high{};
  double from = 0.0;  // m, where the grains begin
};

/// The grains of fill k alone, the walls that they feel, and a box about its room.
Scene settling_scene(const Scene& scene, std::size_t k, const SettlingRoom& c);

}  // namespace barchan
