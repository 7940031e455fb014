#include "app/launch.hpp"

#include <charconv>
#include <cstdlib>
#include <string_view>

#include "base/errors.hpp"

namespace barchan {

namespace {

/// A whole number above zero of the environment; 0: there is none.
long count_of(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr) return 0;
  const std::string_view text(value);
  long number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() && number > 0 ? number : 0;
}

}  // namespace

std::string Launch::told() const {
  return "mpirun or srun started " + std::to_string(processes) + " processes (" + variable + ")";
}

Launch how_launched() {
  // The innermost launcher comes first: mpirun in a job of Slurm starts its own processes in a step of one a machine.
  // SLURM_NTASKS is set in the script of a job too; SLURM_STEP_NUM_TASKS only in what srun started.
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const long processes = count_of(variable); processes > 0)
      return processes > 1 ? Launch{processes, variable} : Launch{};
  return {};
}

void refuse_one_folder_for_many(const Launch& launch, const std::string& out) {
  if (!launch.together() || !out.empty()) return;
  throw SceneError(launch.told() +
                   ", and all of them would write one folder: a run is one process; expected barchan without mpirun "
                   "(it uses all cores of a machine, see --threads), or an --out of its own for each process where "
                   "they are independent runs");
}

}  // namespace barchan
