#include "app/signals.hpp"

#include <array>
#include <csignal>
#include <utility>

namespace barchan {

namespace {

constexpr std::array<std::pair<int, const char*>, 5> stops{
    {{SIGINT, "SIGINT"}, {SIGTERM, "SIGTERM"}, {SIGHUP, "SIGHUP"}, {SIGQUIT, "SIGQUIT"}, {SIGXCPU, "SIGXCPU"}}};

volatile std::sig_atomic_t stop_number = 0, asked = 0;
void on_stop(int number) { stop_number = number; }
void on_question(int) { asked = 1; }

void handle(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // a write that is under way is not cut short
  sigaction(number, &action, nullptr);
}

}  // namespace

void outlive_readers() { handle(SIGPIPE, SIG_IGN); }

void handle_questions() { handle(SIGUSR1, on_question); }

void listen_to_signals() {
  for (const auto& [number, name] : stops) {
    struct sigaction inherited {};
    sigaction(number, nullptr, &inherited);
    const bool off = inherited.sa_handler == SIG_IGN && (number == SIGHUP || number == SIGQUIT);
    if (!off) handle(number, on_stop);
  }
}

int stop_signal() { return stop_number; }

std::string signal_name(int number) {
  for (const auto& [known, name] : stops)
    if (known == number) return name;
  return "signal " + std::to_string(number);
}

bool checkpoint_was_asked_for() {
  if (asked == 0) return false;
  asked = 0;
  return true;
}

}  // namespace barchan
