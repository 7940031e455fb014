// An entry between rigid bodies, or of rigid bodies with a wall: their outlines touch (laws/surface_contact.hpp).
#pragma once

#include <vector>

#include "laws/surface_contact.hpp"
#include "models/bodies/contact_surface.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// An entry of rigid bodies, or of rigid bodies with a wall.
void describe_rigid_contact(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);

/// N/m (2D: N/m a metre), of a contact of the bodies of a phase: one that comes with the largest speed of the scene is
/// stopped within the overlap that the scene says.
double contact_stiffness(const Scene& scene, const Layout& layout, std::size_t phase);

class RigidContact : public Model {
 public:
  RigidContact(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;
  void history(HistoryRow& row) const override;
  std::optional<std::string> trouble() const override;
  void archive(Archive& a) override;

 private:
  /// A body with its outline, or a part of a wall, which is a body that never moves.
  struct Side {
    std::size_t body = 0;                  // of the state, or of still_
    bool still = false;                    // a wall
    std::vector<ContactSurface> surfaces;  // in space as the body lay at the start
    double reach = 0.0;                    // m, of the surfaces from the body's place; 1e300: a plane
    OwnAxes first, now;                    // axes at the start and now
    Vec3 force{}, torque{};                // N, N m: of this entry in this step, the torque about the body's place
  };
  void add_bodies(std::size_t phase, double reach, std::vector<Side>& sides);
  void add_wall(std::size_t phase, double reach, std::vector<Side>& sides);
  RigidBody& body_of(const Side& side) { return side.still ? still_[side.body] : w_->state.bodies[side.body]; }
  void refuse_wide(const Side& a, const Side& b);
  double room_of_water() const;
  Vec3 image_between(const RigidBody& a, const RigidBody& b) const;
  double largest_inverse_mass(std::size_t phase) const;
  void touch();
  void touch(Side& a, Side& b, double& apart);
  double touch(Side& a, const ContactSurface& of_a, Side& b, const ContactSurface& on_b, const Vec3& image,
               double apart);
  void push(Side& of_a, Side& of_b, const Vec3& at, const Vec3& image, double overlap, const Vec3& normal);
  void load(Side& side, const Vec3& arm, const Vec3& force);
  double power();

  const Scene& scene_;
  const Layout& layout_;
  const PlanEntry& entry_;
  SurfaceContactLaw law_;
  std::vector<Side> a_, b_;       // b_ is empty where both are of one phase
  std::vector<RigidBody> still_;  // places of walls
  double room_ = 0.0;             // m, that a fluid keeps between two bodies; 0: none is between them
  std::vector<double> apart_;     // m, of each two: where their contact begins
  double overlap_ = 0.0;          // m, the deepest of the last step
  double power_ = 0.0;            // W, that the contacts take out of the motion at the end of the last step
  double taken_ = 0.0;            // J, that they took since the start
  Workspace* w_ = nullptr;
};

}  // namespace barchan
