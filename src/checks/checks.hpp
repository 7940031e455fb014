// What concerns several keys of a scene at once. Internal to src/checks.
#pragma once

#include "scene/couplings.hpp"
#include "scene/document.hpp"
#include "scene/keys.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// Adds every contradiction in the scene. Keys that already have a problem are left out, so that no mistake is told
/// twice.
void check(const toml::table& document, const Scene& scene, Problems& problems);

/// Finds the place of a dotted key and tells what is wrong with it.
class Report {
 public:
  Report(const toml::table& document, Problems& problems) : document_(document), problems_(problems) {}

  void operator()(const std::string& dotted, const std::string& what) const;
  bool touched(const std::string& dotted) const { return problems_.touch(dotted); }
  /// Whether reading found a problem in this section, so that its values may be missing.
  bool misread(const std::string& dotted) const { return problems_.misread(dotted); }
  bool has(const std::string& dotted) const;  ///< the document has this key
  bool is_section(const std::string& dotted) const;

 private:
  const toml::node* find(const std::string& dotted) const;
  const toml::table& document_;
  Problems& problems_;
};

/// "there is no phase ...; expected ...; did you mean ...".
std::string unknown_phase(const std::string& name, const Scene& scene);

/// Sides of the domain by name: they are of an axis that is there and does not repeat.
void check_side_names(const std::vector<std::string>& sides, const std::string& dotted, const Scene& scene,
                      const Report& report);

/// Of what is measured: places outside the domain, phases that cannot be measured, names that two files would share.
void check_measuring(const Scene& scene, const Report& report);

/// What no law can do, and keys that nothing reads where they stand: of fluids, grains, pairs and the time.
void check_physics(const Scene& scene, const Report& report);

/// The same of walls: keys that their law does not read, and velocities that would carry them away.
void check_columns(const Scene& scene, const Report& report);
void check_walls(const Scene& scene, const Report& report);

/// Of elastic bodies: keys of another formulation, contacts, sets of particles.
void check_bodies(const Scene& scene, const Report& report);

/// Of rigid bodies: what may touch them, and what turns.
void check_rigid(const Scene& scene, const Report& report);

/// Where weight is along -z: what has its heights along y all the same (scene/side_names.hpp).
void check_up(const Scene& scene, const Report& report);

/// Of walls that a [[motion]] carries: shapes and partners that know no such wall.
void check_motions(const Scene& scene, const Report& report);

/// Reads the files of surfaces into the scene. What is wrong with a file is told where the scene names it.
void read_surfaces(Scene& scene, const Report& report);

/// Of the run as a whole: names of files, its state in ParaView, how often it writes, its distance from zero.
void check_run(const Scene& scene, const Report& report);

/// Of sides through which fluids flow: who cannot, and sides that are closed.
void check_flow_ends(const Scene& scene, const Report& report);
void check_influxes(const Scene& scene, const Report& report);

/// Of every formula: its values, by the bounds of its key.
void check_formulas(const toml::table& document, const Scene& scene, const Report& report);

/// Of fills alone: shapes, packings, velocities and pressures that their phase or the domain cannot have.
void check_fills(const Scene& scene, const Report& report);

}  // namespace barchan
