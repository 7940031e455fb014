// An entry of a fluid and grains with a form drag.
#pragma once

#include "models/coupling/drag.hpp"
#include "models/workspace.hpp"

namespace barchan {

class DragModel : public Model {
 public:
  DragModel(const Scene& scene, const Layout& layout, const PlanEntry& entry);
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override;

 private:
  void pull(std::size_t phase);

  const PlanEntry& entry_;
  DragEntry law_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
