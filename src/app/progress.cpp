#include "app/progress.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace barchan {

namespace {

std::string clock_text(double seconds) {
  if (!(seconds >= 0) || seconds > 1e7) return "--:--";
  const long s = std::lround(seconds);
  char text[32];
  if (s >= 3600) std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
  else std::snprintf(text, sizeof text, "%02ld:%02ld", s / 60, s % 60);
  return text;
}

}  // namespace

Progress::Progress(double end, double particles, bool quiet)
    : end_(end),
      particles_(particles),
      quiet_(quiet),
      terminal_(isatty(STDOUT_FILENO) != 0),
      start_(Clock::now()),
      last_(start_) {}

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

void Progress::step(const Simulation& s) {
  steps_ = s.steps();
  time_ = s.time();
  if (quiet_) return;
  const auto now = Clock::now();
  const double since = std::chrono::duration<double>(now - last_).count();
  if (since < (terminal_ ? 0.2 : 10.0)) return;
  const double done = s.time() / end_, rate = particles_ * static_cast<double>(s.steps() - last_steps_) / since * 1e-6;
  const double left = done > 0 ? seconds() * (1.0 - done) / done : -1.0;
  last_ = now;
  last_steps_ = s.steps();
  constexpr int width = 30;
  if (terminal_) {
    const int full = static_cast<int>(done * width);
    std::printf("\r[%.*s%*s] %5.1f %%  t = %.6g s  step %ld  dt %.2e (%s)  %.2f M particle-steps/s  %s left \033[K",
                full, "##############################", width - full, "", 100 * done, s.time(), s.steps(),
                s.last_step(), s.ruling_limit().c_str(), rate, clock_text(left).c_str());
  } else {
    std::printf("%5.1f %%  t = %.6g s  step %ld  dt %.2e s (%s)  %.2f M particle-steps/s  %s left\n", 100 * done,
                s.time(), s.steps(), s.last_step(), s.ruling_limit().c_str(), rate, clock_text(left).c_str());
  }
  if (std::fflush(stdout) != 0) quiet_ = true;  // nobody reads it any more: the run goes on
}

void Progress::end(const std::string& reason) {
  if (quiet_) return;
  const double s = seconds();
  std::printf("%s%s: t = %.6g s after %ld steps, %s, %.2f M particle-steps/s\n", terminal_ ? "\r\033[K" : "",
              reason.substr(0, reason.find(':')).c_str(), time_, steps_, clock_text(s).c_str(),
              particles_ * static_cast<double>(steps_) / std::max(s, 1e-9) * 1e-6);
}

}  // namespace barchan
