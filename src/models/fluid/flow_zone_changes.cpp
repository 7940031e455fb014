// Of models/fluid/flow_zone.hpp: sides whose velocity or pressure changes with time.
//
// To change the speed of all the fluid by a (m/s2) takes the pressure rho L a at the inflow, L the way to the outflow's
// end. It is expected there and no sound, else the inflow gives way to it and the fluid goes on by itself; the same in
// an absorbing layer, where the pressure rises along a line. No change may ask for more than `squeezed` of the density:
// a velocity or a pressure that jumps is turned over some passages of sound. report() says so.
#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "models/fluid/flow_zone.hpp"
#include "models/workspace.hpp"
#include "output/numbers.hpp"

namespace barchan {

namespace {

bool uses_time(const Expression& expression) {
  return expression.is_formula() && !formula_problem(expression.formula, "x y z").empty();
}
bool any_uses_time(const VectorExpression& v) { return std::any_of(v.begin(), v.end(), uses_time); }

}  // namespace

bool flow_changes(const Scene& scene, const Phase& fluid) {
  const auto ends = flow_ends(scene, fluid);
  return !ends.empty() &&
         (std::any_of(ends.begin(), ends.end(),
                      [](const FlowEnd& end) {
                        return end.inflow ? any_uses_time(end.inflow->velocity) : uses_time(end.outflow->pressure);
                      }) ||
          std::any_of(scene.forcings.begin(), scene.forcings.end(), [&](const Forcing& forcing) {
            return forcing.phase == fluid.name &&
                   (any_uses_time(forcing.acceleration) || any_uses_time(forcing.velocity) || uses_time(forcing.rate));
          }));
}

/// Whether the fluid starts with another speed through one of its inflows than the scene gives there.
bool FlowZone::starts_otherwise(const PhaseParticles& p) const {
  bool otherwise = false;
  for (const FlowEnd& end : flow_ends(scene_, scene_.phases[fluid_])) {
    if (!end.inflow) continue;
    const GivenVelocity given(scene_, end);
    const auto axis = end.axis();
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Vec3 x = place_of(p, k);
      if (end.beyond(x[axis]) <= end.layer) continue;
      const double difference = p.column(Field::velocity, static_cast<int>(axis))[k] - given(x, 0.0)[axis];
      otherwise = otherwise || std::abs(difference) > unlike * c_;
    }
  }
  return Exchange().any(otherwise);
}

/// Brings what a lane has nearer to what the scene gives, by `most` a step; at the start it has that.
void FlowZone::turn(Lane& lane, double given, double most) {
  const double gain = given - lane.given;
  const bool at_once = started_ == 0.0 || std::abs(gain) <= most;
  lane.given = at_once ? given : lane.given + std::copysign(most, gain);
  lane.behind = given - lane.given;
  if (!at_once) late_ += w_->state.dt / static_cast<double>(lanes_.size());
}

/// A lane that is to begin with what the fluid has there.
void FlowZone::begin_with(Lane& lane, double given, double fluid) {
  lane.given = fluid;
  lane.behind = given - fluid;
}

/// The velocity of an inflow, outwards. `squeezed` is the density that a change of the whole flow takes, rho L a/c^2.
void FlowZone::turn_inflow() {
  const double dt = w_->state.dt;
  for (std::size_t k = 0; k < lane_.size(); ++k) {
    Lane& lane = lane_[k];
    const Gathered& sum = sums_[k];
    Vec3 at = lanes_.place(k);
    at[end_.axis()] = end_.at(end_.layer);
    const double before = lane.given, given = outwards() * (*velocity_)(at, w_->state.time)[end_.axis()];
    turn(lane, given, squeezed * c_ * c_ / whole_ * dt);
    lane.push = started_ > 0.0 ? (lane.given - before) / dt : 0.0;
    if (started_ > 0.0 || sum.count == 0) continue;
    const double fluid = outwards() * c_ * sum.velocity[end_.axis()].value() / static_cast<double>(sum.count);
    if (std::abs(given - fluid) > unlike * c_) begin_with(lane, given, fluid);
  }
}

/// The pressure of an outflow, `squeezed` in a passage of sound.
void FlowZone::turn_outflow() {
  const double scale = rho_ * c_ * c_, most = squeezed * scale;
  for (std::size_t k = 0; k < lane_.size(); ++k) {
    Lane& lane = lane_[k];
    const Gathered& sum = sums_[k];
    Vec3 at = lanes_.place(k);
    at[end_.axis()] = end_.at(end_.length);
    const double given = pressure_(at, w_->state.time);
    turn(lane, given, most * w_->state.dt * c_ / whole_);
    if (started_ > 0.0 || sum.count == 0) continue;
    const double fluid = scale * sum.pressure.value() / static_cast<double>(sum.count) - law_.background;
    if (std::abs(given - fluid) > most) {
      begin_with(lane, given, fluid);
      changes_ = 1.0;
      learn_common();  // else the next step would take all of the layer's velocity for a gain
    }
  }
}

/// Pa, without sound, so far (m) behind where the velocity of the scene begins.
double FlowZone::mean_behind(const Lane& lane, double behind) const {
  if (changes_ == 0.0) return lane.pressure - lane.slope * behind;
  return lane.pressure - lane.slope * behind - rho_ * lane.push * (whole_ + behind);
}

/// m, beyond the side: the middle of a cell of the layer.
double FlowZone::depth_of_cell(std::size_t cell) const {
  return (static_cast<double>(cell % (means_.size() / lanes_.size())) + 0.5) * dx_;
}

/// What all of the layer has now: where the whole flow changes its speed its pressure rises along a line. None of that
/// is sound.
void FlowZone::learn_common() {
  common_ = {};
  if (changes_ == 0.0) return;
  double n = 0.0, depth = 0.0, depth2 = 0.0, level = 0.0, sloped = 0.0, velocity = 0.0;
  for (std::size_t k = 0; k < means_.size(); ++k) {
    const double d = depth_of_cell(k), p = rho_ * c_ * c_ * layer_sums_[k][0].value();
    n += layer_counts_[k];
    depth += layer_counts_[k] * d;
    depth2 += layer_counts_[k] * d * d;
    level += p;
    sloped += d * p;
    velocity += c_ * layer_sums_[k][1].value();
  }
  if (n == 0.0) return;
  const double spread = depth2 / n - depth * depth / (n * n);
  if (spread > 0.1 * dx_ * dx_) common_.slope = (sloped / n - depth * level / (n * n)) / spread;
  common_.pressure = level / n - common_.slope * depth / n;
  common_.velocity = velocity / n;
}

void FlowZone::report(Warnings& warnings) const {
  if (late_ == 0.0) return;
  const std::string what = end_.inflow ? "velocity" : "pressure";
  const double rate = squeezed * c_ * c_ / whole_ * (end_.inflow ? 1.0 : rho_ * c_);
  warnings.add("turned " + name_, "the " + what + " that the scene gives \"" + plan_.name + "\" at \"" +
                                      word_of(end_.side) + "\" changed faster than sound crosses the fluid: for " +
                                      brief(late_) + " s the side followed it by " + brief(rate) +
                                      (end_.inflow ? " m/s" : " Pa") + " a second; raise phases." + plan_.name +
                                      ".sound-speed, or change it more slowly");
}

}  // namespace barchan
