// An elastic phase: strain in the middle of the step, stress at its end.
#pragma once

#include <array>
#include <vector>

#include "models/bodies/updated_lagrangian.hpp"
#include "models/forces.hpp"
#include "models/workspace.hpp"

namespace barchan {

void describe_elastic(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                      std::vector<std::string>& warnings);

class ElasticPhase : public Model {
 public:
  ElasticPhase(const Scene& scene, const Layout& layout, std::size_t number);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void derive() override;
  void history(HistoryRow& row) const override;
  double budget_energy() override { return strain_energy(); }
  void limits(std::vector<StepLimit>& limits) const override;
  int phase() const override { return static_cast<int>(number_); }

 private:
  void kick_and_drift();
  void pack_middle();
  void strain();
  void load();
  void take_power();
  double strain_energy() const;

  const Scene& scene_;
  const Layout& layout_;
  const Phase& phase_;
  const PlanPhase& plan_;
  std::size_t number_;
  Forces forces_;
  Workspace* w_ = nullptr;
  std::vector<ElasticNeighbour> neighbours_;
  ElasticParameters parameters_{};
  std::array<std::vector<double>, 3> pairs_;  // m/s2, acceleration by the pairs of this law; with energy = true
};

}  // namespace barchan
