// An entry whose law is a contact of bodies: with another body or with a wall (laws/body_contact.hpp).
#pragma once

#include "models/bodies/body_forces.hpp"
#include "models/workspace.hpp"

namespace barchan {

class BodyContact : public Model {
 public:
  BodyContact(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;

 private:
  void push(std::size_t phase);
  void push_from_sides(std::size_t phase);
  bool of_single_particles() const;

  const Scene& scene_;
  const Layout& layout_;
  const PlanEntry& entry_;
  BodyContactLaw law_;
  std::vector<BodySide> sides_;  // of a wall that is nothing else
  Workspace* w_ = nullptr;
};

}  // namespace barchan
