// Two phases of one fluid with spacings 1 to 2 and a border between them: what crosses it is passed on from one phase
// to the other, with mass and momentum kept.
//
// Split: a coarse particle that is `play` coarse spacings beyond the border becomes 2^d fine ones (d dimensions), at
//   the corners of a cube of one fine spacing about its place. In 2D the square is turned to the one of four angles
//   that keeps them farthest from their neighbours. Velocity, density and eddy viscosity have the gradient of a linear
//   least squares fit to the neighbours, so that a shear flow stays one.
// Merge: a fine particle that is `play` coarse spacings beyond it and the 2^d - 1 that stand most closely with it, all
//   of them beyond the border, become a coarse one at their centre of mass with their mean velocity.
// Splitting by fixed patterns and merging with means go back to Feldman & Bonet 2007 and Vacondio et al. 2013. There a
// particle has a mass of its own; here the ratio is 2^d exactly, so that both phases keep one mass. The joint of the
// two phases, whose kernel is that of the coarse one for both, is the consistent scheme (docs/method.md).
//
// The mean of a group differs from the velocity in its middle by the curvature of the field, k <r^2>, and so does a
//   particle from the mean of its parts. With k of a fit to the residuals of the linear one (the isotropic part alone,
//   no more than a quarter of the spread in the group) each new particle is put right, less the mean of all that one
//   look puts right in a split or in a merge: so their momentum stays. Without it the error of a vortex
//   that passes from fine to coarse is 1.3 times as large (docs/method.md).
//
// Mass is kept exactly, momentum and centre of mass to rounding. The kinetic energy that a merge loses, or a split
// finds in its gradient, is booked in State::departed. Who is passed on follows from places and ids alone.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/fluid/border_distance.hpp"
#include "models/model.hpp"
#include "models/workspace.hpp"

namespace barchan {

class SpacingBorder : public Model {
 public:
  static constexpr double play = 0.5;    // coarse spacings beyond the border
  static constexpr double often = 0.25;  // fine spacings that the fastest flow goes from one look to the next
  static constexpr double wide = 1.5;    // times sqrt(d) fine spacings: the farthest of a group from its first
  static constexpr double astray = 2.0;  // coarse spacings: beyond it a group may be twice as wide

  SpacingBorder(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  /// FINE-COARSE_to_fine, _to_coarse [kg] (kg/m in 2D), _loss [J] (J/m): what was passed on, the kinetic energy lost.
  void history(HistoryRow& row) const override;
  void archive(Archive& a) override;

 private:
  static constexpr std::size_t most_values = 7;  // velocity, density, eddy viscosity, k, ln omega
  using Values = std::array<double, most_values>;
  /// A particle near the border.
  struct Member {
    Vec3 x{};  // m, in the domain
    std::int64_t id = 0;
    std::uint32_t place = 0, cell = 0;
    double distance = 0.0;  // m
    bool coarse = false, taken = false;
  };
  struct Made {
    Vec3 x{};
    Values values{};
    std::array<double, 6> skew{};  // Field::anisotropy
    Vec3 drag{};                   // m/s2, Field::drag_acceleration
    double near_void = 0.0;
    Vec3 sharper{};  // m/s, what the curvature of the velocity adds
  };
  /// On several ranks: what a member is made of, wherever it stands.
  struct Detail {
    Values values{};
    Made kept;  // what parts and groups take over
    Vec3 x{};   // m, as it stands
    std::int64_t rank = 0, place = 0;
  };
  struct Passed {
    double to_fine = 0.0, to_coarse = 0.0, loss = 0.0;  // kg, kg, J
  };

  bool is_due();
  void pass_on();
  bool find_members();
  void sort_members();
  void split();
  void merge();
  void apply();
  Vec3 wrapped(Vec3 x) const;
  Vec3 apart(const Vec3& a, const Vec3& b) const;
  double squared(const Vec3& r) const;
  template <class F>
  void around(const Vec3& x, double radius, F&& f) const;
  void join_ranks();
  Values values_of(const Member& m) const;
  Made kept_of(const Member& m) const;
  Vec3 stands_at(const Member& m) const;
  /// Where it stands among the particles of this rank; nothing: it is another rank's.
  std::optional<std::size_t> place_here(const Member& m) const;
  Made mean_of_group() const;
  std::array<Values, 3> gradient(const Vec3& x, const Values& own) const;
  Vec3 curvature(const Vec3& x, const Values& own, const std::array<Values, 3>& slope) const;
  static void add_curvature(std::vector<Made>& made);
  std::array<Vec3, 8> corners(const Member& m) const;
  bool gather_group(std::size_t seed, double radius);
  std::size_t parts() const { return std::size_t{1} << layout_.dimensions; }
  void create(std::size_t phase, const std::vector<Made>& made);
  void take_away(std::size_t phase);
  /// Adds `sign` times what a particle of a phase with these values has that stands at x.
  void book(std::size_t phase, const Vec3& x, const Values& values, double sign);

  const Scene& scene_;
  const Layout& layout_;
  std::size_t count_ = 5;                  // of the values, those that there are
  std::size_t fine_, coarse_, place_ = 0;  // of its row in State::departed
  std::string name_;
  double fine_spacing_, coarse_spacing_;  // m
  BorderDistance border_;
  Workspace* w_ = nullptr;
  double gone_ = 1e300;  // fine spacings since the last look; at first at once
  Passed passed_;

  std::array<std::size_t, 3> cells_{1, 1, 1};
  Vec3 cell_{1, 1, 1};  // m
  std::vector<Member> members_;
  std::vector<Detail> details_;       // on several ranks, by Member::place; else empty
  std::vector<std::uint32_t> begin_;  // by cell, of members_
  std::vector<std::size_t> seeds_, group_, near_;
  std::vector<Made> made_fine_, made_coarse_;
  std::vector<std::uint8_t> leaves_;  // by place
};

/// The model of an entry of two fluids: null without a border.
std::unique_ptr<Model> make_spacing_border(const Scene& scene, const Layout& layout, const PlanEntry& entry);

}  // namespace barchan
