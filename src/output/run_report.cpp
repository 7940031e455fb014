#include "output/run_report.hpp"

#include <nlohmann/json.hpp>

#include "output/whole_file.hpp"

namespace barchan {

std::string to_json(const RunReport& r) {
  using Json = nlohmann::ordered_json;
  Json seconds = Json::object();
  for (const auto& [pass, s] : r.seconds) seconds[pass] = s;
  Json json{
      {"version", r.version},
      {"commit", r.commit},
      {"compiler", r.compiler},
      {"instruction_set", r.instruction_set},
      {"vtk", r.vtk},
      {"threads", r.threads},
      {"scene",
       {{"title", r.scene_title}, {"file", r.scene_file}, {"state", r.scene_state}, {"spacing", r.scene_spacing}}},
      {"end_reason", r.end_reason},
      {"warnings", Json(r.warnings)},
      {"steps", r.steps},
      {"simulated_time", r.simulated_time},
      {"particles", Json(r.particles)},
      {"pairs", Json(r.pairs)},
      {"fields", Json(r.fields)},
      {"passes", Json(r.passes)},
      {"particle_steps_per_second", r.particle_steps_per_second},
      {"pair_interactions_per_second", r.pair_interactions_per_second},
      {"wall_seconds", r.wall_seconds},
      {"cpu_seconds", r.cpu_seconds},
      {"seconds", seconds},
      {"time_step_limits", Json(r.time_step_limits)},
      {"budgets", Json(r.budgets)},
  };
  for (const auto& m : r.measured)
    json["measured"].push_back({{"kind", m.kind}, {"name", m.name}, {"files", m.files}, {"samples", m.samples}});
  // A title that is not UTF-8 must not lose the report of a whole run.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_run_report(const std::filesystem::path& file, const RunReport& report) {
  write_whole_file(file, to_json(report));
}

}  // namespace barchan
