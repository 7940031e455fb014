// The hops of grains, where a scene has [[saltation]] of spheres: how far and how high, how fast and how steep, by
// size. It only reads the state beside a column of its own.
//
// A hop is the flight of a grain between two contacts, with grains or walls, that rises at least `flight` diameters (of
// the mean, the key of [[saltation]]) above the place where it began. Lower flights are rattling and creep of the bed.
// It begins at the end of the first step of the scene after which the grain touches nothing, and ends at the end of the
// last one before it touches again: launch and impact are known to a step, and a contact that begins and ends within
// one step is seen by the velocity, which the known acceleration of the step does not explain.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/workspace.hpp"

namespace barchan {

/// What is known of a grain between two steps; a plain struct, a column of its phase.
struct Flight {
  std::int64_t followed = 0;                // 1: the rest is of the end of the last step
  std::int64_t touches = 0;                 // 1: something
  std::int64_t flies = 0;                   // 1: since a contact that was seen
  std::array<double, 2> place{};            // m, x and y
  std::array<double, 3> velocity{};         // m/s
  std::array<double, 3> launch_velocity{};  // m/s
  double begun = 0.0, low = 0.0;            // s, m: time and height of the launch
  double top = 0.0, way = 0.0;              // m: largest height; way along x since the launch
};

/// A hop that has ended.
struct Hop {
  enum Number : std::size_t {
    length,        // m, along x
    apex,          // m, over the launch
    flight_time,   // s
    launch_speed,  // m/s
    launch_angle,  // degrees over the horizontal
    impact_speed,  // m/s
    impact_angle,  // degrees below the horizontal
    count
  };
  std::array<double, count> number{};
  double diameter = 0.0;  // m
  std::int64_t id = 0;    // of the grain
};

/// The hop whose launch a flight remembers and whose impact is at its last place, at a time (s).
Hop hop_of(const Flight& flight, double time);

/// Mean and spread of the hops of grains of one class of diameters (Welford 1962).
struct HopMeans {
  double hops = 0.0, diameter = 0.0;
  std::array<double, Hop::count> mean{}, square{};  // square: sum of squared differences from the mean
  void add(const Hop& hop);
  double deviation(std::size_t number) const;  ///< standard deviation of the hops; 0 without any
};

class HopStatistics : public Model {
 public:
  /// `phase`: of spheres.
  HopStatistics(const Scene& scene, const Layout& layout, const SaltationLayer& layer, std::size_t phase);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override;
  void archive(Archive& a) override;
  /// hops_NAME.csv: a row for all grains, and where diameters differ one for each third of their range.
  void write(const std::string& folder, double time) const override;

  /// All grains, then the classes.
  const std::vector<HopMeans>& means() const { return means_; }

 private:
  void follow();
  void count_landed();

  const SaltationLayer& layer_;
  std::size_t phase_;
  std::string name_;
  double rise_;                 // m, the least of a hop
  double period_;               // m, of the domain along x; 0: it does not repeat
  std::vector<double> bounds_;  // m, between the classes of diameters, the smallest and the largest with them
  std::vector<HopMeans> means_;
  std::vector<Hop> landed_;  // of the present step
  OwnColumn<Flight> flights_;
  Workspace* w_ = nullptr;
};

/// Models for the [[saltation]] of a scene whose grains are spheres.
void add_hop_statistics(const Scene& scene, const Layout& layout, Models& models);

}  // namespace barchan
