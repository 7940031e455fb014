#include "start/flow_ends.hpp"

#include <algorithm>
#include <cmath>

#include "scene/couplings.hpp"
#include "scene/located.hpp"
#include "scene/log_wind.hpp"
#include "scene/scene_files.hpp"

namespace barchan {

namespace {

constexpr double layer_in_spacings = 20.0;  // of an outflow that does not say it; docs/method.md, Open sides

/// Whether an entry joins a fluid to a coarser one, whose particles then see those of the zone.
const Interaction* joint_with_coarser(const Scene& scene, const Phase& fluid, const Phase& other) {
  const bool coarser = other.kind() == PhaseKind::fluid && other.spacing > fluid.spacing;
  return coarser ? entry_between(scene, fluid, other) : nullptr;
}

/// Rows of given values: as wide as the kernels of the fluid, and one more, since the last row enters as a whole.
double rows_beyond(const Scene& scene, const Phase& fluid) {
  const Interaction* own = entry_between(scene, fluid, fluid);
  double widest = own ? own->radius : 3.0;
  for (const Phase& other : scene.phases)
    if (const Interaction* joint = joint_with_coarser(scene, fluid, other))
      widest = std::max(widest, joint->radius * other.spacing / fluid.spacing);
  return std::ceil(widest) + 1.0;
}

/// m, of a layer whose length the scene does not say: phases of a fluid that are joined have one of the same length.
double usual_layer(const Scene& scene, const Phase& fluid) {
  double longest = layer_in_spacings * fluid.spacing;
  for (const Phase& other : scene.phases)
    if (joint_with_coarser(scene, fluid, other)) longest = std::max(longest, usual_layer(scene, other));
  return longest;
}

FlowEnd make_end(const Scene& scene, const Phase& fluid, Side side, double layer) {
  FlowEnd end;
  end.side = side;
  end.where = side_at(scene.domain, side);
  end.place = scene.domain.origin[end.axis()] + (end.upper() ? scene.domain.size[end.axis()] : 0.0);
  end.layer = fluid.spacing * std::round(layer / fluid.spacing);
  end.length = end.layer + fluid.spacing * rows_beyond(scene, fluid);
  return end;
}

void add_ends(const Scene& scene, const Phase& fluid, std::vector<FlowEnd>& ends) {
  for (const Inflow& inflow : scene.inflows) {
    if (inflow.phase != fluid.name) continue;
    ends.push_back(make_end(scene, fluid, inflow.side, inflow.layer));
    ends.back().inflow = &inflow;
  }
  for (const Outflow& outflow : scene.outflows) {
    if (outflow.phase != fluid.name) continue;
    ends.push_back(make_end(scene, fluid, outflow.side, outflow.layer.value_or(usual_layer(scene, fluid))));
    ends.back().outflow = &outflow;
  }
}

/// The ends beyond which a phase goes on; of several fluids through one side the longest zone.
std::vector<FlowEnd> ends_of(const Scene& scene, const Phase& phase) {
  if (!phase.if_wall()) return flow_ends(scene, phase);
  std::vector<FlowEnd> longest;
  for (const FlowEnd& end : flow_ends(scene)) {
    const auto same =
        std::find_if(longest.begin(), longest.end(), [&](const FlowEnd& e) { return e.side == end.side; });
    if (same == longest.end()) longest.push_back(end);
    else if (same->length < end.length) *same = end;
  }
  return longest;
}

template <class Values>
void copy_value(Values& values, std::size_t from) {
  if (values.size() > from) values.push_back(values[from]);
}

}  // namespace

std::vector<FlowEnd> flow_ends(const Scene& scene, const Phase& fluid) {
  std::vector<FlowEnd> ends;
  add_ends(scene, fluid, ends);
  return ends;
}

std::vector<FlowEnd> flow_ends(const Scene& scene) {
  std::vector<FlowEnd> ends;
  for (const Phase& phase : scene.phases) add_ends(scene, phase, ends);
  return ends;
}

GivenVelocity::GivenVelocity(const Scene& scene, const FlowEnd& end)
    : components_{Formula(end.inflow->velocity[0]), Formula(end.inflow->velocity[1]), Formula(end.inflow->velocity[2])},
      log_(end.inflow->log_profile),
      ground_(scene),
      bottom_(scene.domain.origin[1]),
      place_(end.place) {
  if (end.inflow->profile.empty()) return;
  const auto number = end.inflow - scene.inflows.data();
  profile_ = read_velocity_profile(
      path_of_file(scene, end.inflow->profile),
      located(scene, "inflow." + std::to_string(number) + ".velocity.profile") + ": \"" + end.inflow->profile + "\" ");
}

Vec3 GivenVelocity::operator()(const Vec3& x, double t) const {
  Vec3 v{components_[0](x, t), components_[1](x, t), components_[2](x, t)};
  if (log_) v[0] += log_wind(*log_, x[1] - bottom_ - (log_->over_ground ? ground_.height(place_, x[2]) : 0.0));
  return profile_ ? v + (*profile_)(x[1]) : v;
}

void leave_out_beyond_flow_ends(const Scene& scene, const Phase& phase, std::vector<Vec3>& places) {
  if (!phase.if_wall()) return;
  for (const FlowEnd& end : ends_of(scene, phase))
    std::erase_if(places, [&](const Vec3& x) { return end.beyond(x[end.axis()]) > 1e-6 * phase.spacing; });
}

std::vector<std::size_t> continue_beyond_flow_ends(const Scene& scene, const Phase& phase,
                                                   const std::vector<Vec3>& places, std::size_t first,
                                                   ParticleBlock& block) {
  const double dx = phase.spacing;
  std::vector<std::size_t> counts;
  for (const FlowEnd& end : ends_of(scene, phase)) {
    const std::size_t axis = end.axis(), before = block.position.size();
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double inside = -end.beyond(places[k][axis]);
      if (inside < -1e-6 * dx || inside >= (1.0 - 1e-6) * dx) continue;
      for (int row = 1; row * dx - inside < end.length - 1e-6 * dx; ++row) {
        Vec3 x = places[k];
        x[axis] = end.at(row * dx - inside);
        block.position.push_back(x);
        const std::size_t from = first + k;
        copy_value(block.velocity, from);
        copy_value(block.pressure, from);
        copy_value(block.radius, from);
        copy_value(block.normal, from);
        copy_value(block.depth, from);
        copy_value(block.bend, from);
      }
    }
    counts.push_back(block.position.size() - before);
  }
  return counts;
}

}  // namespace barchan
