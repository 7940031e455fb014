// What concerns the run as a whole: the names of its files, the state that renders it, how often it writes, and how far
// from zero its places lie.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/data_folder.hpp"
#include "checks/checks.hpp"
#include "scene/nearest.hpp"

namespace barchan {
namespace {

constexpr std::size_t most_letters = 180;  // of a name: file systems take 255, and frames add a number and two suffixes
constexpr double most_frames = 1e6, most_rows = 1e8;

/// Letters, digits, '_' and '-': no file, no folder.
bool is_plain(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return (c < 0x80 && std::isalnum(c) != 0) || c == '_' || c == '-';
  });
}

/// A state is a program in Python: a scene, which may be another person's, names one of those that come along with
/// Barchan and no file. Where none came along, any name may be one.
void check_state(const Scene& scene, const Report& report) {
  if (scene.state.empty() || report.touched("state")) return;
  const std::vector<std::string> known = names_of_states();
  for (std::size_t begin = 0; begin <= scene.state.size();) {
    const std::size_t end = std::min(scene.state.find(',', begin), scene.state.size());
    std::string name = scene.state.substr(begin, end - begin);
    std::erase(name, ' ');
    const std::string there = known.empty() ? "a name" : one_of(known);
    if (!is_plain(name))
      return report("state",
                    "\"" + name + "\" is not the name of a state in pvstate; expected " + there +
                        "; a state of your own is named on the command line: pvstate/render SERIES --state own.py");
    if (!known.empty() && std::find(known.begin(), known.end(), name) == known.end())
      return report("state", "there is no state \"" + name + "\" in pvstate; expected " + there +
                                 did_you_mean(nearest(name, known)));
    begin = end + 1;
  }
}

/// `most`: how often; `every` of 0: not given.
void check_interval(const char* key, double every, double most, const char* what, const Scene& scene,
                    const Report& report) {
  const std::string dotted = std::string("output.") + key;
  if (report.touched(dotted) || report.touched("time.end") || !(every > 0.0) || !(scene.time.end / every > most))
    return;
  report(dotted, number_text(every) + " s makes " + number_text(scene.time.end / every) + " " + what +
                     " until time.end; expected at most " + number_text(most));
}

void check_names(const Scene& scene, const Report& report) {
  if (scene.name.size() > most_letters)
    report("", "the name of the scene has " + std::to_string(scene.name.size()) +
                   " letters, and the names of its files begin with it; expected at most " +
                   std::to_string(most_letters));
  const auto check = [&](const std::string& dotted, const std::string& name) {
    if (name.size() > most_letters && !report.touched(dotted))
      report(dotted,
             "a name of " + std::to_string(name.size()) + " letters; expected at most " + std::to_string(most_letters));
  };
  const auto check_all = [&](const char* section, const auto& list) {
    for (std::size_t k = 0; k < list.size(); ++k) check(section + std::to_string(k) + ".name", list[k].name);
  };
  check_all("probe.", scene.measuring.probes);
  check_all("gauge.", scene.measuring.gauges);
  check_all("profile.", scene.measuring.profiles);
  check_all("grid.", scene.measuring.grids);
  check_all("wall-shear.", scene.measuring.wall_shears);
  check_all("saltation.", scene.measuring.saltation);
  check_all("marker.", scene.markers);
  check_all("force.", scene.force_meters);
  for (const Phase& phase : scene.phases) check("phases." + phase.name, phase.name);
}

/// Positions have 53 bits: where the origin takes too many, what is left of a spacing is coarse.
void check_origin(const Scene& scene, const Report& report) {
  if (report.touched("domain") || report.touched("spacing") || !(scene.spacing > 0.0)) return;
  constexpr double most = 1e8;  // spacings
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimensions); ++axis) {
    const double far =
        std::max(std::abs(scene.domain.origin[axis]), std::abs(scene.domain.origin[axis] + scene.domain.size[axis]));
    if (far > most * scene.spacing)
      return report("domain.origin", "a place " + number_text(far) + " m from zero is " +
                                         number_text(far / scene.spacing) +
                                         " spacings away, and numbers do not resolve such places; expected at "
                                         "most 10^8 spacings");
  }
}

}  // namespace

void check_run(const Scene& scene, const Report& report) {
  check_state(scene, report);
  check_interval("every", scene.output.every, most_frames, "frames", scene, report);
  check_interval("history-every", scene.output.history_every, most_rows, "rows", scene, report);
  check_names(scene, report);
  check_origin(scene, report);
}

}  // namespace barchan
