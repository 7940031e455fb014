// A phase of grains: hard spheres that move, fall and are forced; their contacts are models/grains/contact_entry.hpp.
#pragma once

#include "models/forces.hpp"
#include "models/workspace.hpp"

namespace barchan {

void declare_grains(const Scene& scene, std::size_t number, Layout& layout);
void describe_grains(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                     std::vector<std::string>& warnings);

class GrainPhase : public Model {
 public:
  GrainPhase(const Scene& scene, const Layout& layout, std::size_t number);
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;
  int phase() const override { return static_cast<int>(number_); }

 private:
  void kick_and_drift();
  void weigh();

  const Scene& scene_;
  const Layout& layout_;
  const PlanPhase& plan_;
  std::size_t number_;
  Forces forces_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
