// All grains of a scene that are spheres: their contacts and their motion, in steps of their own.
//
// A step of the scene holds a bundle of steps of the contacts (velocity Verlet; the acceleration by all but contacts
// and forcings stays what it was at the beginning). Between two searches no two spheres can touch that the lists do not
// hold: they have all pairs nearer than a slack. A sphere that has gone half of it is searched anew alone
// (sphere_strays.hpp); all are when that is less work.
#pragma once

#include <optional>
#include <string_view>

#include "base/errors.hpp"
#include "models/grains/solid_walls.hpp"
#include "models/grains/sphere_bodies.hpp"
#include "models/grains/sphere_forcing.hpp"
#include "models/grains/sphere_rest.hpp"
#include "models/grains/sphere_search.hpp"
#include "models/grains/sphere_shares.hpp"
#include "models/grains/sphere_sleep.hpp"
#include "models/grains/sphere_strays.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// The laws of all entries of spheres of a scene. Throws SceneError where nothing says how stiff they are.
class SphereLaws {
 public:
  SphereLaws(const Scene& scene, const Layout& layout);

  const std::vector<AnySphereContact>& laws() const { return laws_; }
  /// Inverse mass times r^3 of the first and second phase of each law (1/kg m3), 0 of a wall.
  const std::vector<double>& inverse_densities() const { return inverse_densities_; }
  /// By phase and phase; SphereSearch::none where two do not touch.
  const std::vector<std::uint32_t>& table() const { return table_; }
  /// Those of some law; what rolls rubs.
  ContactParts parts() const { return has_; }
  /// The most that a contact remembers under one of the laws, without the parts that none of them has.
  std::size_t numbers(int dimensions) const;
  /// A twelfth (without loss a 24th or 48th, less under strong dashpots) of the shortest contact at the largest speed
  /// of the scene (s); infinite without contacts.
  double step() const { return step_; }
  double reach() const { return reach_; }  ///< m, the largest sum of two radii

 private:
  SphereImpact shortest_impact(const Scene& scene, const Layout& layout, const PlanEntry& entry);

  std::vector<AnySphereContact> laws_;
  std::vector<double> inverse_densities_;
  std::vector<std::uint32_t> table_;
  double step_ = 1e300, reach_ = 0.0;
  ContactParts has_;
};

/// An entry of spheres with spheres or with a wall.
void describe_sphere_contact(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e);

/// Two mean spheres of a phase that meet with a speed (m/s).
SphereImpact impact_of(const Layout& layout, std::size_t phase, double speed);
/// Throws: neither the key nor a largest speed says how stiff the grains of the phase are.
[[noreturn]] void refuse_unknown_stiffness(const Scene& scene, std::size_t phase, std::string_view key);
/// The normal spring of two grains of the phase under a law of the catalogue. Throws SceneError where nothing says how
/// stiff it is.
template <class Row>
typename Row::Law::Normal normal_spring(const Scene& scene, const Layout& layout, std::size_t phase) {
  using Normal = typename Row::Law::Normal;
  const SphereMaterial& keys = scene.phases[phase].grains();
  if (const auto given = Normal::of(keys)) return *given;
  if (!(layout.largest_speed > 0.0)) refuse_unknown_stiffness(scene, phase, sphere_keys_of(Row::word)->stiffness);
  return Normal::of_overlap(keys, impact_of(layout, phase, layout.largest_speed),
                            keys.largest_overlap.value_or(0.02) * layout.phases[phase].diameter);
}
/// Whether spheres of the phase turn: some law of theirs rubs.
bool spheres_turn(const Scene& scene, std::size_t phase);

class Spheres : public Model {
 public:
  Spheres(const Scene& scene, const Layout& layout);

  void begin(State& state, const std::vector<ParticleBlock>& blocks) override;
  void attach(Workspace& w) override;
  void schedule(Schedule& s) override;
  void limits(std::vector<StepLimit>& limits) const override;
  void history(HistoryRow& row) const override;
  void begin_row() override { bodies_.begin_row(); }
  std::optional<std::string> trouble() const override;
  std::uint64_t pairs(const PlanEntry& entry) const override;
  long searches() const override { return searches_; }
  std::vector<RestingContact> resting_contacts(std::size_t phase) const override;
  void archive(Archive& a) override;
  void gather_to_save() override;
  void forget_gathered() override { drop_other_chunks(); }

 private:
  /// Spheres of one phase, side by side.
  struct Part {
    std::size_t phase = 0, first = 0, count = 0;
    double mean_radius = 0.0;  // m
    long changes = 0;          // of the particles (PhaseParticles::changes) that are taken over
  };

  /// Spheres of a wall that travels, among the fixed ones.
  struct SphereWall {
    std::size_t phase = 0, first = 0, count = 0;
    const WallMotion* motion = nullptr;
  };

  /// Of a step of contacts: m/s; square of a way over that of its allowance; 1 where somebody wakes.
  struct Extremes {
    double fastest = 0.0, farthest = 0.0, wakes = 0.0;
  };
  /// What a step of contacts sums up of a chunk.
  struct ChunkSums {
    double lost, stored, deepest, contacts;
    const std::array<double, 6>* pushed;  // by watched law
  };

  std::size_t all() const { return moving_ + fixed_kind_.size(); }
  std::vector<std::int64_t> present_ids();
  std::vector<SphereSleep::Part> parts_that_may_sleep() const;
  bool others_are_there() const;
  void renumber();
  void make_room();
  SphereSizes sizes() const;

  std::vector<SphereSearch::Side> sides_with_spheres() const;
  void add_wall(std::size_t phase, const ParticleBlock& block);
  void begin_steps();
  void start();
  void begin_bundle(double step, double each);
  double longest_step() const;
  double longest_forced_step();
  void sort();
  void number();
  template <int Dim>
  void pack(double dt);
  void renew_lists(const Extremes& found, double dt);
  void search();
  void sort_out_sleepers(bool all);
  void sort_out_woken(std::span<const std::uint32_t> woken);
  void sort_out_chunks();
  bool is_far_outside(std::size_t sphere) const;
  /// Whether all were searched.
  bool search_strays(double dt, bool stepped);
  template <int Dim>
  void list_strays(double dt, bool stepped);
  template <class Of>
  void add_sums(double lost, double deepest, double time, Of&& of);
  void sum_up(bool last);
  void add_kept_sums(bool last);

  // Of a run on several ranks (spheres_ranks.cpp); of one process they do nothing.
  std::span<SphereChunk> own_chunks() { return shares_.own(std::span<SphereChunk>(chunks_)); }
  std::span<const SphereChunk> own_chunks() const { return shares_.own(std::span<const SphereChunk>(chunks_)); }
  bool packs_all() const { return !shares_.on() || must_search_ || bodies_.any(); }
  std::vector<std::uint32_t> others_to_pack(const Part& part) const;
  void divide();
  void drop_other_chunks();
  Extremes of_all_ranks(Extremes own) const;
  void keep_memory(bool moved);
  void share_memory();
  void share_flags(bool& more);
  void share_columns();
  void share_wall_touches();
  std::vector<double*> shared_columns(const Part& part) const;
  static bool go_together(const Part& part);
  void copy_radii();
  void tell_places();
  void tell_records();
  void tell_all_records();
  void tell_strays();
  void archive_chunk(Archive& a, SphereChunk& chunk);
  double energy_of_sleepers() const;
  void go();
  void point_at_columns();
  template <int Dim>
  void make_records();
  SphereSet set();
  void share_out();
  void bind_walls();
  void carry_walls(double elapsed);
  template <int Dim>
  void carry_wall(const SphereWall& wall, double elapsed);
  void watch_walls();
  void touch_bodies(bool last);
  void sum_pushes(double time);
  double slack() const { return slack_ * search_.scale(); }

  static constexpr long searches_a_sort = 32;
  static constexpr std::size_t steps_told_together = 64;  // sums of so many steps of contacts

  const Scene& scene_;
  const Layout& layout_;
  SphereLaws laws_;
  Workspace* w_ = nullptr;
  std::vector<Part> parts_;    // of the phases of grains
  std::vector<double> fixed_;  // x y z r of the walls' spheres
  std::vector<std::uint8_t> fixed_kind_;
  std::vector<SphereWall> walls_;  // of spheres, that travel
  SolidWalls solid_walls_;
  std::vector<OwnColumn<SolidTouches>> wall_touches_;  // by phase; only where solid_walls_ has some
  SphereForcing forcing_;
  SphereBodies bodies_;
  std::vector<SphereBodies::Part> body_parts_;  // as parts_
  bool walls_left_ = false;                     // one of their spheres went farther than the lists allow
  std::size_t moving_ = 0;
  std::vector<std::int64_t> ids_;  // of the spheres that move, by lasting number

  AlignedVector<double> records_[2], passive_;
  std::size_t now_ = 0;  // which set of records
  std::vector<SphereChunk> chunks_;
  std::vector<double> middles_;         // by chunk: where the middle of its work stands in that of all, 0 to 1
  std::vector<SphereColumns> columns_;  // by phase
  std::vector<std::uint32_t> numbers_, listed_numbers_, order_;
  std::vector<std::uint8_t> kinds_;
  SphereSearch search_;
  SphereStrays strays_;
  SphereShares shares_;
  bool divided_ = false;                               // the chunks, among the ranks
  bool memory_was_shared_ = false;                     // when the lists were left last
  double fastest_ = 0.0;                               // m/s, of the spheres before the next step of contacts
  std::vector<double> kept_sums_;                      // of the own chunks, by step and chunk; then of all ranks
  std::vector<std::array<double, 2>> kept_of_bodies_;  // lost and deepest, by step
  std::vector<std::int64_t> shared_flags_;             // sorted_out_ of all ranks
  std::vector<std::uint32_t> gone_;                    // strays of a step
  SphereStep step_;
  SphereRest rest_;
  SphereSleep sleep_;
  std::vector<std::uint8_t> sorted_out_;  // by chunk
  bool must_search_ = true;
  bool kept_memory_ = false;   // of contacts: the search has it, the lists are of other spheres
  bool loaded_ = false;        // no step of the scene began since
  bool cells_loaded_ = false;  // the cells of the search are to be made again
  bool others_sleep_ = false;  // than the chunks know
  bool rest_anew_ = false;     // records of those that sleep are to be made again
  double slack_ = 0.1;         // of the reach
  long left_ = 0;              // steps of the contacts in the present step of the scene
  long bundle_ = 0;            // all of them
  double each_ = 0.0;          // s, of one of them; 0 before the first one
  long kept_ = 0, searches_ = 0, since_sort_ = searches_a_sort;
  double lost_ = 0.0, stored_ = 0.0, deepest_ = 0.0;
  double contacts_ = 0.0;
  std::vector<WatchedLaw> watched_;             // of w_->sphere_pushes
  std::vector<std::array<double, 6>> pushing_;  // N, N m: of the last step of a bundle, whose second half is to come
};

}  // namespace barchan
