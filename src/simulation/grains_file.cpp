#include "simulation/grains_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "base/errors.hpp"
#include "laws/touching_spheres.hpp"
#include "output/numbers.hpp"
#include "output/series.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"
#include "scene/scene_files.hpp"
#include "start/places.hpp"

namespace barchan {

namespace {

/// Two grains that overlap so much that a run would end at once; each is asked against those before it.
std::optional<std::array<std::size_t, 2>> first_overlap(const Scene& scene, const SettledGrains& grains,
                                                        double widest) {
  const PeriodicSpace space(scene.domain);
  Places before(space, widest);
  for (std::size_t i = 0; i < grains.position.size(); ++i) {
    const Vec3 x = space.wrapped(grains.position[i]);
    const double diameter = 2.0 * grains.radius[i];
    if (const int k = before.owner_near(x, diameter, 1.0 - most_sphere_overlap); k >= 0)
      return std::array{static_cast<std::size_t>(k), i};
    before.add(x, diameter, static_cast<int>(i));
  }
  return std::nullopt;
}

/// The array of contacts of that name; null: the file has none.
const FrameField* contact_array(const Frame& frame, const char* name, int components) {
  for (const FrameField& field : frame.contacts)
    if (field.name == name && field.components == components) return &field;
  return nullptr;
}

/// The contacts of the grains with these ids, in their order. Nothing where the file has contacts that are not whole.
std::optional<std::vector<RestingContact>> contacts_of(const Frame& frame, const std::vector<std::int64_t>& ids) {
  if (frame.contacts.empty()) return std::vector<RestingContact>{};
  const FrameField *particle = contact_array(frame, "contact_particle", 1),
                   *branch = contact_array(frame, "contact_branch", 3),
                   *force = contact_array(frame, "contact_force", 3),
                   *torque = contact_array(frame, "contact_torque", 3);
  if (!particle || !branch || !force || !torque) return std::nullopt;
  const std::size_t count = particle->values.size();
  std::map<std::int64_t, std::uint64_t> place;
  for (std::size_t k = 0; k < ids.size(); ++k) place[ids[k]] = k;
  std::vector<RestingContact> contacts;
  for (const FrameField* field : {branch, force, torque})
    if (field->values.size() != 3 * count ||
        !std::all_of(field->values.begin(), field->values.end(), [](double x) { return std::isfinite(x); }))
      return std::nullopt;
  for (std::size_t k = 0; k < count; ++k) {
    const double id = particle->values[k];
    if (!(id >= 0.0 && id < 9007199254740992.0)) return std::nullopt;  // 2^53
    const auto found = place.find(static_cast<std::int64_t>(id));
    if (found == place.end()) continue;  // of another phase
    const auto vector = [k](const FrameField& f) {
      return Vec3{f.values[3 * k], f.values[3 * k + 1], f.values[3 * k + 2]};
    };
    contacts.push_back({found->second, vector(*branch), vector(*force), vector(*torque)});
  }
  return contacts;
}

}  // namespace

void add_contacts(Frame& frame, const std::vector<RestingContact>& contacts, std::int64_t first_id) {
  if (contacts.empty()) return;
  if (frame.contacts.empty())
    frame.contacts = {{"contact_particle", "", 1, {}},
                      {"contact_branch", "m", 3, {}},
                      {"contact_force", "N", 3, {}},
                      {"contact_torque", "N m", 3, {}}};
  for (const RestingContact& c : contacts) {
    frame.contacts[0].values.push_back(static_cast<double>(first_id + static_cast<std::int64_t>(c.sphere)));
    std::size_t of = 1;
    for (const Vec3& vector : {c.branch, c.force, c.torque}) {
      auto& values = frame.contacts[of++].values;
      values.insert(values.end(), vector.begin(), vector.end());
    }
  }
}

SettledGrains grains_of_file(const Scene& scene, std::size_t fill) {
  const Fill& f = scene.fills[fill];
  const std::string file = std::get<FileShape>(f.shape).file, path = path_of_file(scene, file);
  const auto refuse = [&](const std::string& what) {
    throw SceneError(located(scene, "fill." + std::to_string(fill) + ".shape.file") + ": \"" + file + "\" " + what);
  };
  Frame frame;
  try {
    frame = read_frame(path);
  } catch (const OutputError& e) {
    throw SceneError(located(scene, "fill." + std::to_string(fill) + ".shape.file") + ": " + e.what() +
                     "; expected a .vtp of Barchan");
  }
  const auto name = std::find(frame.phase_names.begin(), frame.phase_names.end(), f.phase);
  if (name == frame.phase_names.end()) refuse("has no phase \"" + f.phase + "\"; expected a frame of a run with it");
  const auto number = static_cast<std::int32_t>(name - frame.phase_names.begin());
  const SphereSize size = *find_phase(scene, f.phase)->diameter();
  const FrameField* radii = nullptr;
  for (const FrameField& field : frame.fields)
    if (field.name == "radius" && field.components == 1) radii = &field;
  if (size.differ() && !radii)
    refuse("has no field radius, and the grains of \"" + f.phase +
           "\" differ; expected a frame with output.fields = [\"radius\"]");
  SettledGrains grains;
  std::vector<std::int64_t> ids;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (frame.phase[i] != number) continue;
    const Vec3 x{frame.points[3 * i], frame.points[3 * i + 1], frame.points[3 * i + 2]};
    const double radius = radii ? radii->values[i] : 0.5 * size.mean;
    const std::string which = "has particle " + std::to_string(frame.id[i]);
    if (!std::isfinite(x[0] + x[1] + x[2])) refuse(which + " at no finite place");
    if (scene.dimensions == 2 && x[2] != 0.0)
      refuse(which + " at z = " + brief(x[2]) + " m; expected z = 0 in two dimensions");
    if (!size.has(2.0 * radius))
      refuse(which + " with the diameter " + brief(2.0 * radius) + " m; expected " + brief(size.least()) + " to " +
             brief(size.largest()) + " m, the diameters of the phase");
    grains.position.push_back(x);
    grains.radius.push_back(radius);
    ids.push_back(frame.id[i]);
  }
  auto contacts = contacts_of(frame, ids);
  if (!contacts)
    refuse(
        "has contacts that are not whole; expected contact_particle, _branch, _force and _torque, as generate writes "
        "them");
  grains.contacts = std::move(*contacts);
  if (const auto pair = first_overlap(scene, grains, size.largest()))
    refuse("has particles " + std::to_string(ids[(*pair)[0]]) + " and " + std::to_string(ids[(*pair)[1]]) +
           " that overlap by more than " + brief(100.0 * most_sphere_overlap) +
           " % of their mean diameter; expected grains beside each other");
  return grains;
}

}  // namespace barchan
