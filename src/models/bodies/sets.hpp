// Sets of particles of bodies, by their places at the start: clamped, driven, or followed.
#pragma once

#include <optional>
#include <vector>

#include "models/forces.hpp"
#include "models/row_mean.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// The particles of a set.
class SetOfBody {
 public:
  SetOfBody(const Layout& layout, const BodySet& set);
  void find(const std::vector<ParticleBlock>& blocks);
  /// Throws SceneError when nobody stands in the box.
  void attach(Workspace& w, const std::string& section);
  /// Where they stand after a sort or a load.
  std::size_t phase() const { return phase_; }
  /// How many they are; how many of them are here: of one process all, of several ranks those of this one.
  std::size_t count() const { return ids_.size(); }
  std::size_t size() const { return here().size(); }
  /// Where its particle number q stands, q below size().
  std::uint32_t place(std::size_t q) const { return here_[q]; }
  PhaseParticles& particles() const { return w_->particles(phase_); }

 private:
  const Layout& layout_;
  const BodySet& set_;
  std::size_t phase_ = 0;
  const std::vector<std::uint32_t>& here() const;
  std::vector<std::uint32_t> ids_;                    // from the phase's first
  mutable std::vector<std::uint32_t> here_;           // places
  mutable std::optional<std::uint32_t> arrangement_;  // of the phase, for which here_ was made
  Workspace* w_ = nullptr;
};

/// Throws SceneError where two motions of an elastic phase hold one of its particles (`places` at the start): the later
/// would win.
void refuse_shared_motions(const Scene& scene, std::size_t phase, const std::vector<Vec3>& places);

/// A set that is clamped or driven: its particles have the velocity of the section.
class DrivenSet : public Model {
 public:
  DrivenSet(const Scene& scene, const Layout& layout, std::size_t number);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void history(HistoryRow& row) const override;
  void begin_row() override { force_.begin_row(); }
  double budget_energy() override;
  void archive(Archive& a) override;

 private:
  void lead();
  void hold();
  void set_velocity(double time);
  Vec3 velocity_at(double time) const;

  const Layout& layout_;
  std::size_t number_;
  SetOfBody set_;
  std::array<Formula, 3> velocity_;
  RowMean force_;       // N, of the rest of the body on the set
  double power_ = 0.0;  // W, of that force
  double taken_ = 0.0;  // J, its work on the set since the start
  Workspace* w_ = nullptr;
};

/// A set whose mean place is a column of history.csv.
class MarkedSet : public Model {
 public:
  MarkedSet(const Scene& scene, const Layout& layout, std::size_t number);
  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule&) override {}
  void history(HistoryRow& row) const override;

 private:
  const Layout& layout_;
  const Marker& marker_;
  std::size_t number_;
  SetOfBody set_;
};

}  // namespace barchan
