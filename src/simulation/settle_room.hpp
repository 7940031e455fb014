// Where the grains of a settled fill stand: the box that they fall into, and beds that would settle in one place.
#pragma once

#include "scene/settling_scene.hpp"

namespace barchan {

/// The room of fill k, a box or a bed. Throws SceneError when the bed is higher than the domain.
SettlingRoom settling_room(const Scene& scene, std::size_t k);

/// Throws SceneError when two fills would settle in one place, before they do: that takes minutes.
void refuse_beds_in_one_place(const Scene& scene);

}  // namespace barchan
