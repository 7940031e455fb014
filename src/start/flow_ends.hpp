// Sides of the domain through which a fluid enters or leaves, and the zones beyond them. What stands in the last row of
// the domain at the start, fluid and walls, goes on beyond the side: a zone is the cross-section of the domain at its
// side, drawn out. Nearest to the domain is the absorbing layer of an outflow, in which the fluid flows on as in the
// domain; behind it `rows` rows of the fluid have the values that the scene gives (models/fluid/flow_zone.hpp), so that
// every particle that moves by itself has neighbours all round.
#pragma once

#include <vector>

#include "scene/formula.hpp"
#include "scene/scene.hpp"
#include "scene/side_names.hpp"
#include "start/generate.hpp"
#include "start/ground.hpp"
#include "start/velocity_profile.hpp"

namespace barchan {

struct FlowEnd {
  Side side{};
  SideAt where;                      // of this domain
  const Inflow* inflow = nullptr;    // one of the two
  const Outflow* outflow = nullptr;  // of the scene
  double place = 0.0;                // m, coordinate of the side
  double layer = 0.0, length = 0.0;  // m, of the absorbing layer; of the whole zone

  std::size_t axis() const { return where.axis; }
  bool upper() const { return where.upper; }
  /// m, how far a place is beyond the side; negative: inside.
  double beyond(double x) const { return upper() ? x - place : place - x; }
  /// The coordinate of a place so far beyond it.
  double at(double beyond) const { return upper() ? place + beyond : place - beyond; }
};

/// The ends of a fluid, inflows first. They point into the scene.
std::vector<FlowEnd> flow_ends(const Scene& scene, const Phase& fluid);
/// The ends of all fluids.
std::vector<FlowEnd> flow_ends(const Scene& scene);

/// What an inflow gives (m/s), at a place and a time (s).
class GivenVelocity {
 public:
  /// Reads the file of a profile. Throws SceneError where it cannot.
  GivenVelocity(const Scene& scene, const FlowEnd& end);
  Vec3 operator()(const Vec3& x, double t) const;

 private:
  std::array<Formula, 3> components_;
  std::optional<LogProfile> log_;
  std::optional<VelocityProfile> profile_;
  Ground ground_;
  double bottom_, place_;  // m
};

/// Wall particles that stand beyond a side with a flow are left out: those of the last row take their places.
void leave_out_beyond_flow_ends(const Scene& scene, const Phase& phase, std::vector<Vec3>& places);
/// Continues a fill beyond the sides with a flow: appends copies of the particles from `first` on whose place (before
/// they were disturbed) is in the last row of the domain, with all that they have. Fluids through their own ends,
/// walls through all; other phases are not continued. Returns how many were appended, by end of the phase.
std::vector<std::size_t> continue_beyond_flow_ends(const Scene& scene, const Phase& phase,
                                                   const std::vector<Vec3>& places, std::size_t first,
                                                   ParticleBlock& block);

}  // namespace barchan
