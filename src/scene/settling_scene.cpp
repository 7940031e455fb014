#include "scene/settling_scene.hpp"

#include <algorithm>
#include <cmath>

#include "scene/couplings.hpp"
#include "scene/side_names.hpp"

namespace barchan {

namespace {

constexpr double restitution = 0.26;  // of grains while they settle: the least with twelve steps a contact

/// Adds the walls that the grains, the first phase of `s`, feel and that stand in the domain, with their entries.
/// Returns the law of two grains.
ContactLaw add_walls(const Scene& scene, std::size_t k, Scene& s) {
  const std::string name = s.phases[0].name;
  ContactLaw law = soft_contact_law;
  for (const Interaction& pair : scene.interactions) {
    if (!of_spheres(pair) || (pair.a != name && pair.b != name)) continue;
    const std::string& other = pair.a == name ? pair.b : pair.a;
    const auto found =
        std::find_if(scene.phases.begin(), scene.phases.end(), [&](const Phase& p) { return p.name == other; });
    if (other == name) law = pair.law;
    else if (!found->if_wall()) continue;
    else s.phases.push_back(*found);
    s.interactions.push_back(pair);
  }
  for (std::size_t f = 0; f < k; ++f)
    for (const Phase& p : s.phases)
      if (p.if_wall() && p.name == scene.fills[f].phase && !std::holds_alternative<SidesShape>(scene.fills[f].shape))
        s.fills.push_back(scene.fills[f]);
  std::erase_if(s.phases, [&](const Phase& p) {
    return p.if_wall() &&
           std::none_of(s.fills.begin(), s.fills.end(), [&](const Fill& f) { return f.phase == p.name; });
  });
  std::erase_if(s.interactions, [&](const Interaction& pair) {
    const auto there = [&](const std::string& which) {
      return std::any_of(s.phases.begin(), s.phases.end(), [&](const Phase& p) { return p.name == which; });
    };
    return !there(pair.a) || !there(pair.b);
  });
  return law;
}

/// Adds the box about the domain of `s`: a floor, and sides where the domain is not periodic.
void add_box(const Scene& scene, ContactLaw law, Scene& s) {
  Phase box;
  box.name = settling_box;
  box.density = s.phases[0].density;
  box.own = WallKeys{};
  box.spacing = scene.spacing;
  Fill sides;
  sides.phase = settling_box;
  SidesShape shape{{"bottom"}, 1};
  const SideNames& names = side_names(scene.domain);
  for (const std::size_t d : {std::size_t{0}, across_axis(scene.domain)}) {
    if (d == 2 && scene.dimensions == 2) continue;
    const double whole = scene.domain.size[d];
    s.domain.periodic[d] = scene.domain.periodic[d] && s.domain.size[d] > whole * (1.0 - 1e-9);
    if (!s.domain.periodic[d]) shape.sides.insert(shape.sides.end(), {names[d][0], names[d][1]});
  }
  s.domain.periodic[up_axis(scene.domain)] = false;
  sides.shape = shape;
  s.phases.push_back(box);
  Interaction at_box;
  at_box.a = s.phases[0].name;
  at_box.b = settling_box;
  at_box.law = law;
  s.interactions.push_back(at_box);
  s.fills.push_back(sides);
}

}  // namespace

Scene settling_scene(const Scene& scene, std::size_t k, const SettlingRoom& c) {
  const Fill& fill = scene.fills[k];
  const Phase& phase =
      *std::find_if(scene.phases.begin(), scene.phases.end(), [&](const Phase& p) { return p.name == fill.phase; });
  const SphereSize size = *phase.diameter();
  Scene s;  // what is not named here does not exist while grains settle: motions, markers, forces, what is measured
  s.file = scene.file;
  s.name = scene.name;
  s.places = scene.places;
  s.dimensions = scene.dimensions;
  s.spacing = scene.spacing;
  s.precision = scene.precision;
  s.domain = scene.domain;
  s.phases = {phase};
  s.domain.open.clear();
  s.domain.gravity = weight_share(scene, phase) * scene.domain.gravity;
  s.time = scene.time;
  s.output = scene.output;
  std::get<GrainsKeys>(s.phases[0].own).restitution = std::min(restitution, phase.grains().restitution);
  std::get<GrainsKeys>(s.phases[0].own).sleep = false;
  s.output.fields.clear();
  s.time.fixed_step.reset();
  const ContactLaw law = add_walls(scene, k, s);
  const std::size_t up = up_axis(scene.domain);
  const double height =
      (c.high[up] - c.from) * loose_lattice_height * std::pow(size.largest_share(), scene.dimensions) +
      3.0 * size.largest();
  s.domain.origin = c.low;
  s.domain.size = c.high - c.low;
  s.domain.size[up] = c.from - c.low[up] + height;
  add_box(scene, law, s);
  s.time.end = 1e3;
  return s;
}

}  // namespace barchan
