// How this process was started: alone, or as one of several by mpirun or srun.
#pragma once

#include <string>

namespace barchan {

struct Launch {
  long processes = 1;    // that were started together
  std::string variable;  // of the environment, that says so; empty: started alone

  bool together() const { return processes > 1; }
  /// "mpirun or srun started 4 processes (OMPI_COMM_WORLD_SIZE)".
  std::string told() const;
};

/// Reads the environment: of Open MPI, of MPI libraries with PMI (MPICH, Intel), of a step of Slurm. The script of a
/// Slurm job is not one of several processes, however many the job asked for.
Launch how_launched();

/// Throws SceneError where processes that were started together would write one folder: the default one. `out`: what
/// the user gave, empty for nothing. Processes with an --out of their own are independent runs.
void refuse_one_folder_for_many(const Launch& launch, const std::string& out);

}  // namespace barchan
