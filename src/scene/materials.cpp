#include "scene/materials.hpp"

#include <stdexcept>

namespace barchan {

namespace {

// quartz-sand   friction: the largest measured between two grains (Senetakis, Coop & Todisco 2013; Sandeep & Senetakis
//               2018: 0.1 to 0.3). Restitution, rolling friction: chosen so that the splash of Rice, Willetts & McEwan
//               1995 and an angle of repose of 30 to 34 degrees come out with the same numbers; rolling friction stands
//               for corners
// glass-beads, cellulose-acetate   restitution, friction: Foerster, Louge, Chang & Allia 1994, table II. The tangential
//               stiffness is the one with which their beta0 (0.44, 0.43) comes out (tests/physics/spheres.cpp)
constexpr MaterialConstants materials[] = {
    {Material::quartz_sand, 2650.0, 0.7, 0.3, 1.0, 2.0 / 7.0},
    {Material::glass_beads, 2500.0, 0.97, 0.092, 0.0, 0.1245},
    {Material::cellulose_acetate, 1319.0, 0.87, 0.25, 0.0, 0.124},
};

}  // namespace

const MaterialConstants& constants_of(Material material) {
  for (const MaterialConstants& m : materials)
    if (m.material == material) return m;
  throw std::logic_error("constants of no material");
}

}  // namespace barchan
