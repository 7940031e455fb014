// What a signal asks of a run; the run looks after every step.
//
//   SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU   finish the step, write a frame and a checkpoint, end with 128 + number
//   SIGUSR1                                     write a checkpoint and go on
//   SIGPIPE                                     nothing: who reads the progress has gone, the run goes on
#pragma once

#include <string>

namespace barchan {

/// From now on a closed pipe is an error of writing and no longer the end of the program.
void outlive_readers();

/// From now on SIGUSR1 does not end the program: before the first step it asks for a checkpoint after that one.
void handle_questions();

/// SIGHUP and SIGQUIT that the program's parent has switched off (nohup) stay off.
void listen_to_signals();

/// Number of the last signal that asks to stop; 0: none.
int stop_signal();
/// "SIGTERM", ... of a signal that stop_signal() returns.
std::string signal_name(int number);
/// Whether a checkpoint was asked for since the last call.
bool checkpoint_was_asked_for();

}  // namespace barchan
