// A flat bed without wind: no grain moves.
#include <cmath>
#include <map>

#include "physics/drive.hpp"

namespace barchan {
namespace {

using testing::Drive;
using testing::report;

using Place = std::array<double, 2>;

std::map<std::int64_t, Place> places(const PhaseParticles& p) {
  std::map<std::int64_t, Place> at;
  for (std::size_t k = 0; k < p.size(); ++k)
    at[p.id()[k]] = {p.column(Field::position, 0)[k], p.column(Field::position, 1)[k]};
  return at;
}

/// Number of the phase of this name.
std::size_t number_of(const Drive& drive, const std::string& name) {
  const auto& phases = drive.scene().phases;
  for (std::size_t k = 0; k < phases.size(); ++k)
    if (phases[k].name == name) return k;
  ADD_FAILURE() << "no phase " << name;
  return 0;
}

/// A fifth of the scene's length; the bed, the air over it and the lid are as deep and as high as there.
TEST(FlatBed, NoGrainMovesWithoutWind) {
  Drive drive("paper/flat_bed", {"fill.3.velocity.log-profile.friction-velocity=0", "phases.lid.shear-stress=[0, 0]",
                                 "domain.size=[0.012, 0.02]", "fill.0.shape.box.max=[0.012, 0.001]"});
  const std::size_t sand = number_of(drive, "sand");
  const double d = drive.scene().spacing, width = drive.scene().domain.size[0];
  const auto before = places(drive.phase(sand));
  ASSERT_GE(before.size(), 100u);
  drive.to(0.02);
  drive.simulation().check();
  double farthest = 0;
  for (const auto& [id, now] : places(drive.phase(sand))) {
    const Place& then = before.at(id);
    const double along = std::remainder(now[0] - then[0], width);
    farthest = std::max(farthest, std::hypot(along, now[1] - then[1]) / d);
  }
  report("farthest way of a grain/d after 0.02 s", farthest, 0.01);
  EXPECT_LE(farthest, 0.01);
}

}  // namespace
}  // namespace barchan
