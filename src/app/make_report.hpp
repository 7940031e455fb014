// run.json of a run, from where it stands now.
#pragma once

#include <filesystem>

#include "app/progress.hpp"
#include "measure/measurements.hpp"
#include "output/run_report.hpp"
#include "output/series.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

/// `measurements`: null when the scene measures nothing.
RunReport make_report(const Simulation& simulation, const SeriesWriter* series, const Measurements* measurements,
                      const Progress& progress);

/// The few words of a report that are true of every run of this process: program, scene, process and host.
RunReport start_report(const Scene& scene);

/// Writes it if that is possible in any way. For a run that ends because it cannot write.
void try_to_write(const std::filesystem::path& file, const RunReport& report);

}  // namespace barchan
