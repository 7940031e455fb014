// One-dimensional air: a mean wind U(y) that loses the momentum that grains take, and whose turbulence is a mixing
// length.
//
//   rho dU/dt = d tau/dy - (what the grains take),   tau = rho (nu + l^2 |U'|) U',   tau = rho u*^2 on the top,
//   dl/dy = kappa [1 - exp(-sqrt(U l/(7 nu)))]                                  (Duran, Andreotti & Claudin 2012, eq.
//   7)
//
// In a bed U vanishes and l with it; over it l grows as over a rough or smooth wall: no surface of the bed is needed.
#pragma once

#include <optional>
#include <vector>

#include "scene/scene.hpp"
#include "state/air_profile.hpp"

namespace barchan {

class AirColumn {
 public:
  struct Air {
    double density, viscosity;  // kg/m3, m2/s
    MixingLength mixing_length;
    Slip slip;  // on the bottom
  };
  /// Cells of `resolution` (m) from `bottom` to `fine_top`, then 5 % higher from cell to cell, up to `top`.
  static AirProfile grid(double bottom, double fine_top, double top, double resolution);

  /// Works on a profile, which must outlive it and keep its faces.
  AirColumn(const Air& air, AirProfile& profile);

  /// Where a height lies: number of the cell; 0 below all, the last above all.
  std::size_t cell_at(double y) const {
    if (!(y > bottom_)) return 0;
    const auto bin = static_cast<std::size_t>((y - bottom_) * inverse_bin_);
    if (bin >= cell_of_bin_.size()) return profile_.cells() - 1;
    const std::size_t k = cell_of_bin_[bin];
    return k + (k + 1 < profile_.cells() && y >= profile_.face[k + 1] ? 1 : 0);
  }
  double top() const { return profile_.face.back(); }

  /// Mean speed of the air between two heights, low < high (m); still below the bottom, uniform above the top.
  double mean_speed(double low, double high) const { return (integral(high) - integral(low)) / (high - low); }
  /// After the speeds have changed: makes the integral that mean_speed() reads.
  void integrate_speed();

  /// Adds an amount, evenly spread between two heights, to the cells. What lies outside goes to the nearest cells. A
  /// sum that is finished by gather().
  class Spread {
   public:
    explicit Spread(std::size_t cells) : part_(cells, 0.0), step_(cells + 1, 0.0) {}
    void clear();
    void add(const AirColumn& column, double low, double high, double amount);
    /// The sums by cell.
    void gather(const AirColumn& column, std::vector<double>& sums) const;

   private:
    std::vector<double> part_, step_;  // of the cells where spreads begin and end; changes of the density between them
  };

  /// What drives the air from above: a stress (Pa), or a speed on the top face (m/s).
  struct Top {
    double stress = 0.0;
    std::optional<double> speed;
    Top(double pascal) : stress(pascal) {}
    static Top at_speed(double u) {
      Top top(0.0);
      top.speed = u;
      return top;
    }
  };
  /// What the grains of each cell do to the air.
  struct Load {
    std::vector<double> pull;  // Pa: what they take at the present speed of the air
    std::vector<double> rate;  // Pa s/m: how much more they take as it gets faster
    std::vector<double> owed;  // Pa s: what they have got beyond profile.given of the last step
    explicit Load(std::size_t cells) : pull(cells, 0.0), rate(cells, 0.0), owed(cells, 0.0) {}
  };
  /// One step of the air (s), implicit in shear and drag so that any dt is stable, driven from its top. What
  /// the grains are to get in this time is then profile.given. Updates the mixing length for the next step.
  void advance(double dt, const Top& top, const Load& load);
  void update_mixing_length();

  /// Momentum of the air by area, Pa s.
  double momentum() const;

 private:
  double integral(double y) const;
  void solve();

  Air air_;
  AirProfile& profile_;
  double bottom_, inverse_bin_;
  std::vector<std::uint32_t> cell_of_bin_;  // of bins as high as the lowest cell: the cell at a bin's lower end
  std::vector<double> below_;               // m2/s, integral of the speed up to each face
  std::vector<double> lower_, diagonal_, upper_, change_;  // of the linear system
  std::vector<double> conductance_;                        // Pa s/m of the faces
};

}  // namespace barchan
