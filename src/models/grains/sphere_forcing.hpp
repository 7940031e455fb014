// [[forcing]] of spheres that differs from place to place or in time, in the steps of contacts of
// models/grains/spheres.hpp.
//
// What else accelerates a sphere stays through a step of the scene. A forcing is taken anew after each drift, at the
// places and the time of its end (velocity Verlet; Swope et al. 1982): held from the begin of a step it gains energy,
// exp(w^2 dt t/2) in a trap of the frequency w.
#pragma once

#include <span>
#include <vector>

#include "models/forces.hpp"
#include "models/grains/sphere_work.hpp"

namespace barchan {

class SphereForcing {
 public:
  /// A step of the contacts is at most this share of 1/w of the stiffest forcing, where the scene does not fix it: a
  /// hundredth of a period, in which velocity Verlet keeps the energy to 1e-3 at any time.
  static constexpr double step = 0.06;

  /// Of a phase, if its forcing varies.
  void add(const Scene& scene, std::size_t phase);
  bool any() const { return !phases_.empty(); }
  /// Before parallel work: each thread evaluates formulas of its own.
  void make_room(std::size_t moving);
  /// 1/s2, the largest change of a forcing along the places of the chunks' spheres. `apart` (m): of two places.
  double stiffest(std::span<const SphereChunk> chunks, const SphereColumns* columns, double time, double apart);
  /// The step of the scene begins at the time (s): what stays of the acceleration of the chunks' spheres.
  void begin(std::span<const SphereChunk> chunks, const SphereColumns* columns, const double* passive, double time);
  /// The acceleration of the chunk's spheres that move, at the places of their records; in a parallel region.
  void push(const SphereChunk& chunk, const double* records, double* passive, double time);

 private:
  struct Forced {
    std::size_t phase;
    std::vector<Forces> of_thread;
  };
  Forces* of(std::size_t phase);
  template <class F>
  void each_chunk(std::span<const SphereChunk> chunks, F&& f);

  const Scene* scene_ = nullptr;
  int dimensions_ = 2;
  std::vector<Forced> phases_;
  std::vector<double> steady_;  // m/s2, by sphere and axis
};

}  // namespace barchan
