// Ranks by MPI. Where the program was built without it, no run has any.
#pragma once

#include <string>

#include "app/launch.hpp"

namespace barchan {

/// Whether the program was built with MPI, and how it calls its library.
bool has_mpi();

/// For processes that were started together: lets MPI find the others, and makes them ranks of one run when all have
/// the same command (`command`: all of it that decides what is computed and written). Processes that all have an `out`
/// of their own stay independent runs. Throws SceneError for what is neither.
void join_ranks(const Launch& launch, const std::string& command, const std::string& out);

/// Of one rank, where the user says no number: its part of the cores that it may use (threads_of_placement()). Every
/// rank calls it. 0: as without ranks.
int threads_of_a_rank();

/// At the end of a command that did not fail on this rank alone; nothing where join_ranks() was not called. Returns the
/// status that the process ends with.
int leave_ranks(int status);

/// After a failure with this status: waits a moment for the others. True: all of them have failed too, so one tells.
/// Otherwise the message must be told and abort_ranks() ends all of them.
bool all_failed();
void abort_ranks(int status);

}  // namespace barchan
