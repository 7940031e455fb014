// An entry whose law is a contact: grains with grains, walls or bodies; and the paper's wall of ghosts for a fluid.
#pragma once

#include <array>

#include "models/grains/grains.hpp"
#include "models/workspace.hpp"

namespace barchan {

class ContactEntry : public Model {
 public:
  /// Throws SceneError when the entry's radius is so short that touching grains do not feel each other.
  ContactEntry(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override;

 private:
  void push(std::size_t phase);

  const Layout& layout_;
  const PlanEntry& entry_;
  KernelContact law_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
