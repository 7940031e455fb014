// Where weight is along -z: what has its heights along y all the same.
#include "checks/checks.hpp"
#include "scene/side_names.hpp"

namespace barchan {

void check_up(const Scene& scene, const Report& report) {
  if (up_axis(scene.domain) != 2 || report.touched("domain") || report.touched("domain.gravity")) return;
  const auto refuse = [&](const std::string& key, const std::string& what) {
    if (!report.touched(key))
      report(key, what + " along y, and domain.gravity is along z; expected a scene whose gravity is along -y");
  };
  for (std::size_t k = 0; k < scene.fills.size(); ++k) {
    const Fill& fill = scene.fills[k];
    const std::string dotted = "fill." + std::to_string(k);
    const auto* bed = std::get_if<BedShape>(&fill.shape);
    if (fill.packing == Packing::fitted) refuse(dotted + ".packing", "fitted rows follow a ground with heights");
    else if (bed && bed->dune && bed->dune->form == DuneShape::Form::formula)
      refuse(dotted + ".shape.dune.form", "a dune by formula in x and z has its height");
    if (fill.log_profile) refuse(dotted + ".velocity.log-profile", "the wind has its heights");
  }
  for (std::size_t k = 0; k < scene.inflows.size(); ++k) {
    const std::string velocity = "inflow." + std::to_string(k) + ".velocity";
    if (scene.inflows[k].log_profile) refuse(velocity + ".log-profile", "the wind has its heights");
    if (!scene.inflows[k].profile.empty()) refuse(velocity + ".profile", "a profile has its heights");
  }
  for (std::size_t k = 0; k < scene.measuring.saltation.size(); ++k)
    refuse("saltation." + std::to_string(k), "layers over the bed lie");
  for (std::size_t k = 0; k < scene.measuring.wall_shears.size(); ++k)
    refuse("wall-shear." + std::to_string(k), "the heights of the ground are");
}

}  // namespace barchan
