// Contacts of spheres with the outlines of rigid bodies, in the steps of contacts of models/grains/spheres.hpp.
//
// The body moves in these steps too. RigidPhase has carried it through the step of the scene as if no sphere touched
// it; that is taken back, and the body goes step by step with what spheres give it. A force kicks the sphere and the
// body in the same half steps, so that the momentum of both together is kept to rounding.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "laws/sphere_catalogue.hpp"
#include "models/bodies/body_border.hpp"
#include "models/grains/sphere_work.hpp"
#include "models/history_row.hpp"
#include "models/layout.hpp"
#include "models/row_mean.hpp"
#include "state/state.hpp"

namespace barchan {

class SphereLaws;

/// An entry of spheres with rigid bodies.
void describe_spheres_on_bodies(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);

class SphereBodies {
 public:
  /// Spheres of a phase, side by side, and what they remember of bodies that they touch.
  struct Part {
    std::size_t phase = 0, first = 0, count = 0;
  };
  /// What a step of contacts works on.
  struct Present {
    std::span<const Part> parts;
    const double *records, *passive;
    std::size_t moving;
    double dt;          // s
    double half = 1.0;  // of the impulse of this step that acts now: 1/2 in the last of a bundle
  };

  /// In Model::begin: the columns of the memory.
  void begin(const Layout& layout, State& state);
  /// Throws SceneError where a body is too wide for a periodic domain, or too light for the spheres.
  void attach(const Scene& scene, const Layout& layout, const SphereLaws& laws, State& state);
  bool any() const { return !bodies_.empty(); }

  /// A bundle of steps over `step` (s) begins, each of `each` (s): the bodies are where the first of them ends. With
  /// `each` 0 they are where the step began, and stay there until the bundle begins.
  void begin_steps(double step, double each);
  /// Forces of all contacts; kicks the bodies. Forces and torques on the spheres are then in forces().
  void touch(const Present& s, const SphereStep& step);
  /// The bodies go on for another step (s).
  void go_on(double each);
  /// The last step of the bundle is over.
  void end_steps();
  /// By sphere as in the sums of models/grains/sphere_forces.cpp: 2D fx fy t -, 3D fx fy fz - tx ty tz -.
  const double* forces() const { return forces_.data(); }

  /// What the spheres of a phase remember of bodies; null: they touch none.
  const SolidTouches* touches(std::size_t phase) const {
    return any() && remembers_[phase] != 0 ? state_->phases[phase].own(memory_[phase]) : nullptr;
  }

  double lost() const { return lost_; }          ///< J, in the last step
  double stored() const { return stored_; }      ///< J
  double deepest() const { return deepest_; }    ///< overlap over the sphere's diameter
  double contacts() const { return contacts_; }  ///< how many touch
  void history(HistoryRow& row) const;
  void begin_row();
  void archive(Archive& a);

 private:
  struct Body {
    Body(std::size_t its_number, std::size_t its_phase, std::size_t among, BodyBorder its_border)
        : number(its_number), phase(its_phase), own(among), border(std::move(its_border)) {}
    std::size_t number, phase, own;  // in the state; of the scene; among those of its phase
    BodyBorder border;
    RigidMotion end;                   // of a driven one, where the step of the scene ends
    Vec3 place{}, velocity{}, rate{};  // of the present step, in space
    Vec3 force{}, torque{};            // N, N m, of the last step
    Vec3 impulse{}, turn{};            // N s, N m s, in this step of the scene
    std::string name;
    RowMean mean_force, mean_torque;
  };
  /// A sphere and a body that touch.
  struct Meeting {
    std::size_t sphere, body;
    std::uint32_t law;
    double radius;  // m, of the sphere
    Gap gap;        // of its centre
    Vec3 foot;      // m, of the contact, from the body's place
    Vec3 velocity;  // m/s, of the sphere
    Vec3 carried;   // m/s, of the body there
  };
  /// Sums over a block of spheres.
  struct Tally {
    double lost = 0.0, stored = 0.0, deepest = 0.0, contacts = 0.0;
  };
  template <int Dim>
  void touch_all(const Present& s, const SphereStep& step);
  template <int Dim>
  void touch_one(const Present& s, const SphereStep& step, const Part& part, std::size_t sphere, Tally& tally,
                 std::array<double, 6>* loads, std::uint16_t* near);
  Vec3 arm_of(const Body& body, const Vec3& at) const;
  template <int Dim, class Law>
  void meet(const Law& law, const StepOfContacts& dt, const Present& s, const Meeting& m, SolidTouch& touch,
            Tally& tally, std::array<double, 6>& load);
  void go_back(Body& body, double step);
  void kick(Body& body, double time);
  void see(Body& body);
  RigidBody& state_of(const Body& body) const { return state_->bodies[body.number]; }

  const Layout* layout_ = nullptr;
  State* state_ = nullptr;
  std::vector<Body> bodies_;
  std::vector<OwnAxes> axes_;                    // by body, of the present step
  std::vector<std::uint32_t> laws_;              // by phase and body; SphereSearch::none
  SolidSurfaces solids_;                         // by body one, with one surface
  std::vector<std::uint16_t> near_;              // by block and body: those that may touch the present sphere
  std::vector<OwnColumn<SolidTouches>> memory_;  // by phase
  std::vector<char> remembers_;                  // by phase: it has this column
  AlignedVector<double> forces_;
  std::vector<double> far_;                   // m, by sphere and body: how far they may come nearer before they touch
  std::vector<std::array<double, 6>> loads_;  // by block and body
  std::vector<Tally> tallies_;                // by block
  Vec3 period_{};
  double step_ = 0.0;      // s, of the scene
  bool at_begin_ = false;  // the bodies are where the step of the scene began
  double lost_ = 0.0, stored_ = 0.0, deepest_ = 0.0, contacts_ = 0.0;
};

}  // namespace barchan
