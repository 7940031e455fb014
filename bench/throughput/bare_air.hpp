// A program with nothing but periodic plain air in two dimensions in it: what a scene of air alone would cost if
// Barchan could do nothing else. Its step is that of Simulation, without phases, plan, walls, limits or anything
// optional.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "engine/integrate.hpp"
#include "engine/neighbours.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

class BareAir {
 public:
  /// From the state of a simulation of one fluid phase in double precision.
  explicit BareAir(const Simulation& from)
      : particles_(from.phases()),
        neighbours_(from.plan().bounds, {{0, 0, from.plan().directions[0].radius}}, from.plan().skin,
                    {from.plan().phases[0].spacing}),
        records_(MotionRecord<2>::size),
        dt_(from.last_step()) {
    const Plan& plan = from.plan();
    const Phase& phase = from.scene().phases[0];
    const double c = plan.phases[0].sound_speed, h = plan.phases[0].smoothing_length;
    law_ = {phase.density, c, 1.0, phase.fluid().background_pressure * phase.density * c * c};
    q_.reference_density = phase.density;
    q_.sound_speed = c;
    q_.diffusivity = 1.25 * c * c * dt_ + 0.05 * h * c;
    q_.source_diffusivity = 0.75 * c * c * dt_ + 0.05 * h * c;
    q_.shift_speed = 1.0;
    q_.shift_limit = 0.2;
    q_.smoothing_length = h;
    viscosity_ = phase.density * phase.fluid().viscosity;
    neighbours_.adapt_skin();
    rates(true);
  }

  void step() {
    kick_and_drift(particles_[0], 0.5 * dt_, dt_, &law_);
    rates(false);
    kick(particles_[0], 0.5 * dt_);
  }

 private:
  void rates(bool first) {
    if (neighbours_.update(particles_, first)) records_.resize(particles_[0].size(), neighbours_.grid(0).images());
    pack();
    const FluidNeighbour entry{&neighbours_.list(0), &records_,  KernelKind::wendland_c2,
                               neighbours_radius(),  viscosity_, true};
    fluid_rates(particles_[0], records_, std::span<const FluidNeighbour>(&entry, 1), q_, FluidScheme::plain);
  }
  double neighbours_radius() const { return 2.0 * q_.smoothing_length; }
  void pack() {
    using R = MotionRecord<2>;
    const PhaseParticles& p = particles_[0];
    const double *x = p.column(Field::position, 0), *y = p.column(Field::position, 1),
                 *u = p.column(Field::velocity, 0), *v = p.column(Field::velocity, 1),
                 *pressure = p.column(Field::pressure), *rho = p.column(Field::density), mass = p.mass();
    const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      double* r = records_[static_cast<std::size_t>(i)];
      r[R::position] = x[i];
      r[R::position + 1] = y[i];
      r[R::velocity] = u[i];
      r[R::velocity + 1] = v[i];
      r[R::pressure] = pressure[i];
      r[R::volume] = mass / rho[i];
    }
    records_.fill_images(neighbours_.grid(0), 2);
  }

  std::vector<PhaseParticles> particles_;
  Neighbours neighbours_;
  RecordArray records_;
  FluidParameters q_{};
  PressureLaw law_{};
  double dt_, viscosity_ = 0.0;
};

}  // namespace barchan
