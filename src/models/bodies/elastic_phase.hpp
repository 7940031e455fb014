// An elastic phase: strain in the middle of the step, stress at its end.
#pragma once

#include <array>
#include <vector>

#include "models/bodies/updated_lagrangian.hpp"
#include "models/forces.hpp"
#include "models/workspace.hpp"

namespace barchan {

void declare_elastic(const Scene& scene, std::size_t number, Layout& layout);
void describe_elastic(const Scene& scene, const std::vector<ParticleBlock>& blocks, std::size_t number, Layout& layout,
                      std::vector<std::string>& warnings);

/// An entry of updated Lagrangian bodies, with themselves or with each other: stress.
void describe_elastic_pairs(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);

class ElasticPhase : public Model {
 public:
  ElasticPhase(const Scene& scene, const Layout& layout, std::size_t number);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void history(HistoryRow& row) const override;
  double budget_energy() override { return strain_energy(); }
  void limits(std::vector<StepLimit>& limits) const override;
  void archive(Archive& a) override;
  int phase() const override { return static_cast<int>(number_); }

 private:
  void kick_and_drift();
  void pack_middle();
  void strain();
  void load();
  void take_power();
  double strain_energy() const;
  void choose_held();

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
  // Of a body that touches itself:
  const PlanEntry* own_ = nullptr;  // its entry with itself
  FarPairs held_;                   // the pairs between which stress acts
  bool must_choose_ = true;         // the list is new
};

}  // namespace barchan
