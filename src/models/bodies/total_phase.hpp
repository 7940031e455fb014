// An elastic phase whose strain comes from its first shape (total Lagrangian; docs/method.md).
#pragma once

#include <memory>
#include <vector>

#include "models/bodies/total_lagrangian.hpp"
#include "models/forces.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// A body with arithmetic of one precision.
class TotalBody {
 public:
  virtual ~TotalBody() = default;
  virtual void pack(const PhaseParticles& particles) = 0;  // see pack_displacements
  virtual void load(PhaseParticles& particles) = 0;        // stress, then acceleration
  virtual const TotalDetail& detail() = 0;                 // of what was packed
  virtual std::uint64_t pairs() const = 0;
  virtual double stiffening() const = 0;    // see TotalWork
  virtual double least_volume() const = 0;  // see TotalWork
  virtual std::int64_t flat() const = 0;    // see ReferenceBody
  virtual void archive(Archive& a) = 0;
};

/// The entry of a total Lagrangian body with itself.
void describe_total_body(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);

class TotalPhase : public Model {
 public:
  TotalPhase(const Scene& scene, const Layout& layout, std::size_t number);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;
  const StepLimit* moving_limit() override;
  std::optional<std::string> trouble() const override;
  int phase() const override { return static_cast<int>(number_); }
  void history(HistoryRow& row) const override;
  void derive() override;
  double budget_energy() override;
  std::uint64_t pairs(const PlanEntry& entry) const override;
  void archive(Archive& a) override;

 private:
  void kick_and_drift();
  void load();

  const Scene& scene_;
  const Layout& layout_;
  const Phase& phase_;
  const PlanPhase& plan_;
  std::size_t number_;
  Forces forces_;
  Workspace* w_ = nullptr;
  const PlanEntry* own_ = nullptr;  // null: nothing holds it together
  TotalParameters parameters_;
  std::vector<Vec3> start_;  // m, by id
  std::unique_ptr<TotalBody> body_;
  double rest_limit_ = 1e300;  // s, of the stiffest vibration at rest
  double stiffening_ = 1.0;    // of the stiffest particle over the modulus at rest, forgotten slowly
  StepLimit limit_;
  double strain_energy_ = 0.0, hourglass_energy_ = 0.0;  // J, of the last derive
};

}  // namespace barchan
