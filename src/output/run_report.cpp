#include "output/run_report.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string_view>

#include "base/input_file.hpp"
#include "output/whole_file.hpp"

namespace barchan {

namespace {

/// The largest over the mean; 1 where nothing was measured.
double imbalance(const std::vector<double>& seconds) {
  const double sum = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  return sum > 0.0 ? *std::max_element(seconds.begin(), seconds.end()) * static_cast<double>(seconds.size()) / sum
                   : 1.0;
}

nlohmann::ordered_json json_of(const RunReport::Ranks& ranks) {
  auto placements = nlohmann::ordered_json::array();
  for (const RunReport::Placement& placement : ranks.placements)
    placements.push_back({{"ranks", placement.ranks},
                          {"host", placement.host},
                          {"cores", placement.cores},
                          {"threads", placement.threads}});
  return {{"count", ranks.count},
          {"placements", placements},
          {"messages", ranks.messages},
          {"bytes", ranks.bytes},
          {"collectives", ranks.collectives},
          {"ghosts", ranks.ghosts},
          {"most_particles", ranks.most_particles},
          {"memory_of_first", ranks.memory_of_first},
          {"most_memory_of_others", ranks.most_memory_of_others},
          {"busy_seconds", ranks.busy_seconds},
          {"waiting_seconds", ranks.waiting_seconds},
          {"imbalance", imbalance(ranks.busy_seconds)},
          {"division", ranks.division},
          {"divisions", ranks.divisions},
          {"dividing_seconds", ranks.dividing_seconds}};
}

}  // namespace

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
       {{"title", r.scene_title},
        {"file", r.scene_file},
        {"sha256", r.scene_sha256},
        {"set", Json(r.overrides)},
        {"state", r.scene_state},
        {"spacing", r.scene_spacing},
        {"gravity", Json(r.scene_gravity)}}},
      {"end_reason", r.end_reason},
      {"process", r.process},
      {"host", r.host},
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
  for (const auto& repeat : r.repeats)
    json["repeats"].push_back({{"name", repeat.name},
                               {"of", repeat.owner},
                               {"interval", repeat.interval},
                               {"calls", repeat.calls},
                               {"seconds", repeat.seconds}});
  for (const auto& use : r.thread_uses)
    json["threads_used"].push_back({{"threads", use.threads}, {"steps", use.steps}, {"seconds", use.seconds}});
  json["thread_switches"] = r.thread_switches;
  if (r.ranks.count > 1) json["ranks"] = json_of(r.ranks);
  for (const auto& m : r.measured)
    json["measured"].push_back({{"kind", m.kind}, {"name", m.name}, {"files", m.files}, {"samples", m.samples}});
  // A title that is not UTF-8 must not lose the report of a whole run.
  json["retreats"]["count"] = r.retreat_count;
  for (const auto& back : r.retreats)
    json["retreats"]["list"].push_back({{"step", back.step},
                                        {"time", back.time},
                                        {"back_to", back.back_to},
                                        {"share_of_step", back.share},
                                        {"reason", back.reason}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_run_report(const std::filesystem::path& file, const RunReport& report) {
  write_whole_file(file, to_json(report));
}

bool overwrite_run_report(const std::filesystem::path& file, const RunReport& report) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, failed))) return false;
  const auto size = std::filesystem::file_size(file, failed);
  if (failed) return false;
  const nlohmann::ordered_json json{{"version", report.version}, {"end_reason", report.end_reason},
                                    {"process", report.process}, {"host", report.host},
                                    {"steps", report.steps},     {"simulated_time", report.simulated_time}};
  std::string text = json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  if (text.size() > size) return false;  // it must not grow: there is no room
  text.append(size - text.size(), ' ');
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream << text << std::flush;
  return stream.good();
}

namespace {

/// A file that an instrument writes: KIND_NAME with one of the suffixes, in the folder itself.
bool is_measured(const std::string& file) {
  const std::size_t dot = file.rfind('.'), line = file.find('_', file.starts_with("wall_") ? 5 : 0);
  if (dot == std::string::npos || line == std::string::npos || line > dot) return false;
  const std::string_view kind(file.data(), line), suffix(file.data() + dot, file.size() - dot);
  const auto is_one_of = [](std::string_view word, std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  return is_one_of(kind, {"probe", "gauge", "profile", "grid", "wall_shear", "saltation", "hops"}) &&
         is_one_of(suffix, {".csv", ".vtp", ".vti", ".json"}) &&
         std::all_of(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(dot),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

/// The document in a file; null where there is none or it is damaged.
nlohmann::json read_json(const std::filesystem::path& file) {
  constexpr std::uint64_t most = 64'000'000;  // bytes; a report has some thousand
  try {
    return nlohmann::json::parse(read_input(file, most), nullptr, /*allow_exceptions=*/false);
  } catch (const InputError&) { return nullptr; }
}

}  // namespace

std::string run_of_report(const std::filesystem::path& file) {
  const auto json = read_json(file);
  if (!json.is_object() || !json.contains("process") || !json.contains("host") ||
      !json["process"].is_number_integer() || !json["host"].is_string())
    return "";
  return run_of_report(json["process"].get<long>(), json["host"].get<std::string>());
}

std::string run_of_report(long process, const std::string& host) { return std::to_string(process) + "@" + host; }

std::vector<std::string> measured_files(const std::filesystem::path& file) {
  std::vector<std::string> files;
  const auto json = read_json(file);
  if (!json.is_object() || !json.contains("measured") || !json["measured"].is_array()) return files;
  for (const auto& measured : json["measured"]) {
    if (!measured.is_object() || !measured.contains("files") || !measured["files"].is_array()) continue;
    for (const auto& name : measured["files"])  // what an instrument writes, nothing else: anyone may write a run.json
      if (name.is_string() && is_measured(name)) files.push_back(name);
  }
  return files;
}

}  // namespace barchan
