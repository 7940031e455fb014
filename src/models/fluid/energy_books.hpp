// The books of a fluid's energy, by name: what took it, and what gave it (docs/method.md, "What damps"). Only for
// fluids with phases.NAME.energy-budget; others pay nothing.
//
// Energy is that of motion, of the weight along axes that are not periodic, and of compression, m int (p - p_0)/rho^2
// drho from the density at rest. A kick of length h changes v by h a: the term a_i of a does the work m h a_i.(v + h
// a/2), so that two sums of each term say what both kicks with these rates do, however long they are. A step changes
// rho by dt times its rate: a term of the rate does the work m int f drho with f = (p - p_0)/rho^2, which three sums
// give to the third power of dt. What changes particles besides (a surface that tears, sides that hold what comes too
// near, open sides) is booked as the difference that it makes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/pressure_law.hpp"
#include "models/fluid/rate_parts.hpp"
#include "models/history_row.hpp"
#include "models/layout.hpp"
#include "state/archive.hpp"

namespace barchan {

/// The energy of compression of 1 kg (J), from the density at rest, against the pressure at rest.
double compression_energy(const PressureLaw& law, double density);

/// Throws SceneError where a fluid asks for books that are not there yet.
void check_energy_budget(const Scene& scene, std::size_t fluid, const Layout& layout);

class EnergyBooks {
 public:
  enum Name : std::size_t {
    viscosity,
    artificial_viscosity,
    surface_friction,
    density_diffusion,
    shifting,
    loose_fluid,
    torn_surface,
    kept_density,
    pressure_sums,
    held_at_walls,
    forcing,
    open_sides,
    count
  };

  /// What the books know of their fluid.
  struct Fluid {
    std::string name;
    PressureLaw law;
    Vec3 weight;                       // m/s2, gravity along axes that are not periodic
    double viscosity, artificial;      // Pa s
    std::array<bool, count> may_take;  // the names that can have something
  };

  EnergyBooks(Fluid fluid, PhaseParticles& particles);

  /// Before a step of `dt` seconds kicks and drifts: what the rates of the step before do in it.
  void begin_step(double dt);
  /// Behind the drift; behind what a torn surface gets; behind what holds the particles.
  void drifted();
  void released();
  void held();
  /// Before the rates: what left since.
  void find_left();
  PartColumns& parts() { return parts_; }
  /// When the rates are whole: their sums, and what they do in a kick of `kick` seconds. `start`: the run begins here.
  void take(double kick, bool start);

  void history(HistoryRow& row) const;
  void archive(Archive& a) { a.number(fluid_.name + ": books of the energy", numbers_); }

 private:
  static constexpr std::size_t pushes = 6, squeezes = 5;
  /// A plain struct: it is archived as it is.
  struct Numbers {
    double start = 0.0;                 // J, the whole energy
    std::array<double, count> taken{};  // J
    // Of the last rates: sum m a_i.v behind the kick (W) and sum m a_i.a (W/s); the three sums of the density's terms.
    std::array<double, pushes> power{}, square{};
    std::array<std::array<double, 3>, squeezes> work{};
    double sinking = 0.0;  // W, sum m g.du
  };

  void fit();
  template <class F>
  double total(F&& f);
  template <class Term>
  void take_push(std::size_t push, double kick, Term&& term);
  template <class Rate>
  void take_squeeze(std::size_t squeeze, Rate&& rate);
  void take_pushes(double kick);
  void take_squeezes();
  double whole_energy();
  bool tears() const { return fluid_.may_take[torn_surface]; }
  bool leaves() const { return fluid_.may_take[open_sides]; }

  Fluid fluid_;
  PhaseParticles* particles_;
  PartColumns parts_;
  Numbers numbers_;
  std::vector<double> terms_, density_;               // scratch; as it was before a torn surface got its density
  std::array<std::vector<double>, 3> slopes_;         // of the energy of compression by the density
  std::array<std::vector<double>, 3> place_, speed_;  // as they were before they were held
  double energy_before_ = 0.0;                        // J, behind what holds the particles
  std::size_t number_before_ = 0;
};

}  // namespace barchan
