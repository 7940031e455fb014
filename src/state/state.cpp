#include "state/state.hpp"

namespace barchan {

void OutputClock::archive(Archive& a) {
  a.number("frames", frames);
  a.number("last frame step", last_frame_step);
  a.number("last frame time", last_frame_time);
}

void Retreat::archive(Archive& a) {
  a.number("retreats", count);
  a.number("share of the step", share);
  a.number("shorter until", until);
}

void State::archive(Archive& a) {
  a.number("time", time);
  a.number("dt", dt);
  a.number("steps", steps);
  a.number("next id", ids.next);
  a.number("largest acceleration", largest_acceleration);
  a.text("ruling limit", ruling_limit);
  for (auto& [name, count] : limit_counts) a.number("steps by " + name, count);
  outputs.archive(a);
  retreat.archive(a);
  for (auto& p : phases) p.archive(a);
  for (auto& profile : air) profile.archive(a);
  for (auto& body : bodies) a.number("rigid body", body.now);
  for (auto& one : departed) a.number("departed", one);
}

}  // namespace barchan
