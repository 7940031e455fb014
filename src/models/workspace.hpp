// What the models of a run work on: the state, the lists, and the records of all phases. Everything here but the state
// and the epoch of the lists is made anew in every step.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/neighbours.hpp"
#include "engine/phase_records.hpp"
#include "laws/grains_in_eddies.hpp"
#include "models/fluid/turbulence.hpp"
#include "models/model.hpp"
#include "models/packing.hpp"

namespace barchan {

class WallMotion;

class Workspace : public Halo {
 public:
  /// Makes the records that the entries' laws read, by phase. All three must outlive it.
  Workspace(const Scene& scene, const Layout& layout, State& state);

  const Scene& scene;
  const Layout& layout;
  State& state;
  Neighbours neighbours;

  std::vector<AlignedVector<double>> ground_stress;  // Pa, by fluid and particle; empty: walls say it themselves

  /// By fluid: the grains in it that act on its turbulence.
  std::vector<std::optional<OwnColumn<GrainsInEddies>>> grains_in_eddies;

  /// What spheres of a phase do to a wall in a step (N s and N m s, not by depth), for a meter that asks (attach).
  struct SpherePush {
    std::size_t wall, grains;  // phases
    Vec3 about;                // m, of the torque
    Vec3 impulse{}, turn{};
  };
  std::vector<SpherePush> sphere_pushes;

  /// Numbers of models that limit the next step: the kick replaces each by the largest of all ranks, with its own.
  std::vector<double*> largest_of_ranks;

  std::vector<const WallMotion*> wall_motions;  // by phase, of walls that travel; else null

  std::vector<MotionPacking> packing;  // by phase
  std::vector<std::function<void()>>
      when_sorted;            // called when particles have new places, beside the search: may only read them
  bool must_search = true;    // sort and search whatever the motion was
  long changes_of_lists = 0;  // of the numbers of particles (PhaseParticles::changes) when the lists were made
  double kick_time = 0.0;     // s, of the kick that ends a step

  PhaseParticles& particles(std::size_t phase) { return state.phases[phase]; }
  const PairList& list(int direction) const { return neighbours.list(static_cast<std::size_t>(direction)); }
  /// Records that tasks read. In a build with assertions only those tasks may that declared it (Touch::records).
  const RecordArray& records(std::size_t phase, Record record) const { return records_[phase]->array(record); }
  const CompactRecords* compact(std::size_t phase) const { return std::as_const(*records_[phase]).compact(); }
  const EddyRecords& eddies(std::size_t phase) const { return records_[phase]->eddies(); }
  bool has(std::size_t phase, Record record) const { return records_[phase]->has(record); }
  /// The same for a task that writes them.
  RecordArray& to_write(std::size_t phase, Record record);
  CompactRecords* compact_to_write(std::size_t phase);
  EddyRecords& eddies_to_write(std::size_t phase);
  /// In attach: a task will read these records of the phase. In mixed precision a fluid has no motion records unless a
  /// law other than its own reads them, or a task that says so here.
  void need(std::size_t phase, Record record) { records_[phase]->make(record); }
  /// One call for whoever reads images outside of the schedule; before tasks, the schedule calls it.
  void fill_images(std::size_t phase, Record record) override;
  void outdate_images(std::size_t phase, Record record) override { records_[phase]->outdate_images(record); }
  /// On several ranks, after a task whose loop went over the rows of a phase that is whole on every rank: some rows are
  /// other ranks' (Neighbours::owners). Every rank gets what the owner of each particle has: a field, records.
  void share_field(std::size_t phase, Field field);
  void share_records(std::size_t phase, Record record);
  /// The same of values by place.
  void share_values(std::size_t phase, std::vector<Vec3>& values) const;
  /// Gives the records the sizes of the present lists.
  void fit_records();
  std::size_t bytes() const;
  std::size_t bytes_of_an_image(std::size_t phase) const { return records_[phase]->bytes_of_an_image(); }
  /// The epoch of the lists; loading makes the lists and the records' sizes as they were. `whole`: see Neighbours.
  void archive(Archive& a, bool whole = false);

 private:
  std::vector<std::unique_ptr<PhaseRecords>> records_;  // by phase
};

/// What every scene needs: sorting, searching, packing, and the kick that ends a step.
class CommonWork : public Model {
 public:
  explicit CommonWork(const Layout& layout) : layout_(layout) {}
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void derive() override;

 private:
  void find_neighbours();
  void pack();
  void carry();
  void kick();
  /// s, by which kick() changes the velocities of a phase: spheres were kicked in the steps of their contacts, rigid
  /// bodies are kicked as a whole.
  double kick_of(std::size_t phase) const;

  const Layout& layout_;
  Workspace* w_ = nullptr;
  std::vector<double> found_;  // by kick(), for all ranks
};

}  // namespace barchan
