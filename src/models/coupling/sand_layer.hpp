// Grains finer than the air's particles in a turbulent wind over sand: the entry of a fluid and of spheres with a law
// of drag by name. In three dimensions the ground is the same along z, and the wind of a layer blows along x.
//
// A grain feels the mean wind about its place (airs.hpp). Nearer than `reach` spacings to the ground the particles
// of the air do not resolve the wind. There, along each spacing of the ground, the wind is one-dimensional
// (models/column/air_column.hpp): it has the speed of the air's particles on its top, passes between the grains of the
// bed, and loses what the grains take. The stress on its top is what the ground takes from the air's particles, in
// place of the logarithmic law of a roughness: grains that fly make the ground rougher by themselves.
//
// A layer is 40 diameters long at least, in three dimensions as wide or as wide as the domain, and a grain feels the
// wind of the two (four) about it, by linear weights: in a shorter one the wake of a grain would hold back the grain
// itself. (The wind needs about that way to get over what a grain has taken: the time in which it mixes over three
// diameters, times its speed.)
//
// On request grains in a layer feel gusts (gusts.hpp) and a lift across the ground by the shear about them: with U+, U-
// the mean wind about the upper and the lower half of a grain of speed v along the ground, U about all of it, u with
// the gust, and k the drag by difference of speed,
//   a = C k (U+ - U-) (u - v)/max(|u - v|, |u|),
// Anderson & Hallet's (1986) difference of the squares of the winds on top and at the bottom of the grain. It is C
// times the drag where a grain rests and the wind is linear from zero at its bottom: C = 0.85 (Chepil 1958).
//
// Grains that may sleep (`sleep = true`) and rest keep their drag, and the air what it lost by it, for 16 exchanges:
// 0.064 sqrt(d/g), in which a grain at rest goes nowhere. So most exchanges are those of the grains that move.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "models/column/air_column.hpp"
#include "models/coupling/airs.hpp"
#include "models/coupling/gusts.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// An entry of a fluid and of spheres with a law of drag by name.
void describe_sand_layer(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);

/// The model of such an entry: of several phases of one air, that of the finest does the work of all; the others have
/// none (null).
std::unique_ptr<Model> make_sand_layer(const Scene& scene, const Layout& layout, const PlanEntry& entry);

class SandLayer : public Model {
 public:
  SandLayer(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void history(HistoryRow& row) const override;
  void archive(Archive& a) override;

 private:
  static constexpr double reach = 1.5;       // spacings of the air
  static constexpr double deep = 6.0;        // diameters: grains below feel no wind
  static constexpr double cells = 4.0;       // a diameter
  static constexpr double fine = 10.0;       // diameters over the ground with such cells
  static constexpr double interval = 0.004;  // of sqrt(d/g), between two exchanges: 20 us for 0.25 mm; by default
  static constexpr double long_as = 40.0;    // diameters, of a layer, at least one spacing of the air
  static constexpr long rest_keeps = 16;     // exchanges, of the drag of a grain that rests
  static constexpr std::size_t heights = 8;  // of the ground, known a spacing of the air

  /// The ground under a place: its height (m, as a coordinate), and the direction along it.
  struct Ground {
    double height, along_x, along_y;
  };
  /// The layers about a place along x; in 3D in two rows about it along z. `share`: of the right one, of the upper row.
  struct Between {
    std::size_t left = 0, right = 0;
    double share = 0.0;
    std::size_t up = 0;      // from a layer of the lower row to that of the upper one
    double share_up = -1.0;  // below zero: there is one row (2D)
  };
  /// Calls f(layer, weight) with each layer about a place.
  template <class F>
  static void each(const Between& b, F&& f) {
    const double low = b.share_up < 0.0 ? 1.0 : 1.0 - b.share_up;
    f(b.left, low * (1.0 - b.share));
    f(b.right, low * b.share);
    if (b.share_up < 0.0) return;
    f(b.left + b.up, b.share_up * (1.0 - b.share));
    f(b.right + b.up, b.share_up * b.share);
  }
  /// Mean of value(layer) about a place. The two of a row are one expression, which compilers may contract in one way
  /// only.
  template <class Value>
  static double mean_of(const Between& b, Value&& value) {
    const double row = (1.0 - b.share) * value(b.left) + b.share * value(b.right);
    if (b.share_up < 0.0) [[likely]]
      return row;
    return (1.0 - b.share_up) * row +
           b.share_up * ((1.0 - b.share) * value(b.left + b.up) + b.share * value(b.right + b.up));
  }
  /// A grain in a layer, where it will be in the middle of the time to the next exchange.
  struct Near {
    std::size_t grain;
    Between place;
    double height, radius;  // m over the ground, m
    double wind;            // m/s, the mean about it
    double pull;            // m/s2 along the ground, its drag in that wind
    double more;            // m/s2, what the wind adds to it that the layer has after the exchange
    Ground ground;
    bool rests;  // and keeps its drag for some exchanges
  };
  /// Where a grain is: not asked for, because it keeps its drag; over the layers, in them, or under them.
  struct Place {
    enum Where : std::uint8_t { unasked, over, in, under } where;
    bool rests;
    double height;
    Ground ground;
  };
  Ground ground(double x) const;
  Between along(std::size_t axis, double x) const;
  Between between(double x, double z) const;
  double speed_over(double x, std::size_t row) const;
  double wind_about(const Between& b, double low, double high) const;

  bool exchange_is_due();
  void exchange();
  void exchange(double kept, double meant);
  void act();
  void refuse_ground_along_z() const;
  void find_steady_wind();
  void find_near();
  template <std::size_t Dim>
  void feel();
  void feel() { layout_.dimensions == 2 ? feel<2>() : feel<3>(); }
  void spread();
  void spread(bool resting, std::vector<AirColumn::Load>& loads);
  bool all_are_due();
  void keep_rest();
  void push_across(const PhaseParticles& p, const Near& q);
  void blow(double dt);
  void give_stress(std::size_t fluid);
  double top_speed(std::size_t column) const;
  double felt(double x, double wind) const;
  double lift(const Near& q, double blows, double along, double rate) const;
  AirProfile& profile(std::size_t column) const { return w_->state.air[place_ + column]; }

  const Scene& scene_;
  const Layout& layout_;
  std::size_t fluid_, grains_, place_ = 0;
  std::array<std::size_t, 2> samples_{1, 1};  // spacings of the air in a layer, along x and z
  std::array<std::size_t, 2> count_{1, 1};    // layers along x and z
  DragLaw law_;
  std::string name_;
  double density_, viscosity_, diameter_, top_;  // kg/m3, m2/s, m, m
  std::array<double, 2> width_{};                // m, of a layer along x and z
  double area_ = 0.0;                            // m2, in 2D m: of a layer
  double lift_;
  bool magnus_;                     // the force on grains that turn
  double interval_, hold_ = 0.0;    // s
  bool finds_steady_wind_ = false;  // the exchange that comes is the first one
  Workspace* w_ = nullptr;
  Airs grid_;                   // of all phases of the air; `fluid_` is the finest, at the ground
  std::optional<Gusts> gusts_;  // where the entry has some
  std::vector<double> ground_;  // m, over the bottom of the domain
  std::vector<AirColumn> layers_;
  std::vector<AirColumn::Spread> pulls_, rates_;
  std::vector<AirColumn::Load> loads_;
  bool may_rest_;                       // grains that rest keep their drag
  bool all_due_ = true;                 // of all grains in this exchange
  long to_all_ = 0, seen_changes_ = 0;  // exchanges until then; of the grains (PhaseParticles::changes)
  std::vector<std::optional<OwnColumn<GrainsInEddies>>> slowed_;  // by phase of grid_, of those with k-omega
  OwnColumn<std::uint8_t> keeps_;                                 // by grain: it rested in the last exchange of all
  std::vector<AirColumn::Load> rest_loads_;                       // pull: what those take from the layers
  std::vector<std::vector<double>> speed_before_;                 // m/s, of the layers, in an exchange of all
  std::vector<Place> places_;                                     // by grain
  std::vector<Near> near_;                                        // grains in the layers
  std::vector<std::size_t> flying_;                               // grains over them
  std::vector<double> rate_;                                      // 1/s, of each grain, by the difference of speed
};

}  // namespace barchan
