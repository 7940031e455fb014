// Elastic bodies in fluids of the consistent scheme: the surface that the fluid ends at, and the fluid's load on it.
#pragma once

#include "models/bodies/elastic_border.hpp"
#include "models/coupling/border_stress.hpp"
#include "models/coupling/spray.hpp"

namespace barchan {

/// The surface of the body is its border as it is deformed (ElasticBorder). It gives the body's particles depth and
/// normal, and the velocity and the acceleration of the nearest place of the surface, from which the fluid is continued
/// into them; particles of the fluid that come too near are put back. The load is the integral of -p n + mu du/dn over
/// the border, as of rigid bodies (border_load.hpp), and goes to the particles that carry each piece
/// (docs/method.md, Elastic bodies in fluids).
///
/// The fluid's pressure follows the border by way of its density, some steps late, and feeds vibrations faster than
/// c/h. So the pressure is that of an acoustic wave that meets the border: p - rho c w, w = (v_fluid - v_border).n
/// there, which is zero but for the error of the scheme (the solution of Riemann's problem for sound; of SPH with
/// solids e.g. Zhang, Rezavand & Hu 2021). Less its mean over h/c, this is no load of slow motions. The acceleration
/// with which the fluid is continued is a mean as well: that of single steps has vibrations which no
/// pressure of the fluid follows, and their work on the body came from nowhere (docs/method.md).
class ElasticInFluid : public Model {
 public:
  /// For the phase `solid` (ends_at_border of scene/couplings.hpp) and all its entries with such fluids.
  ElasticInFluid(const Scene& scene, const Layout& layout, std::size_t solid);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  /// What the body's own vibration leaves of its step when the fluid damps it, a step late.
  void limits(std::vector<StepLimit>& limits) const override;
  void archive(Archive& a) override;

 private:
  /// m/s2: the mean acceleration of a piece, and the mean of that.
  struct Followed {
    Vec3 mean{}, of_means{};
  };
  void hold();
  void follow();
  void move_surface();
  void load();
  void find_stress(std::size_t fluid);
  void radiate(const BorderFluid& fluid, std::vector<double>& parted);
  void sum(const BorderFluid& fluid);
  void spray(std::size_t fluid);

  const Scene& scene_;
  const Layout& layout_;
  std::size_t solid_;
  std::vector<BorderFluid> fluids_;
  std::vector<BorderNeighbours> neighbours_;  // by fluid
  ElasticBorder border_;
  OwnColumn<std::uint32_t> nearest_;         // piece of the surface by particle; `inner`: none is near
  std::vector<PiecePlace> places_;           // by piece
  std::vector<BorderStress> stress_;         // by piece, of the fluid that is looked at
  std::vector<Followed> followed_;           // by piece
  std::vector<std::vector<double>> parted_;  // m/s by fluid and piece: mean speed of parting
  std::vector<Spray> spray_;                 // by fluid
  std::vector<Vec3> force_;                  // N by particle (id from the phase's first)
  Workspace* w_ = nullptr;
};

}  // namespace barchan
