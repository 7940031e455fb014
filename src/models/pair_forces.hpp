// Entries whose law is a force between two particles: the loops over their pairs, one for each law in the list below,
// and the model of such an entry.
//
// To add a law of forces: its file in laws/, its row in BARCHAN_FORCE_LAWS, and where the scene's numbers become its
// constants (make_models in models/catalogue.cpp, or the model that has the entry).
#pragma once

#include <utility>

#include "engine/pair_entry.hpp"
#include "laws/grain_drag.hpp"
#include "laws/kernel_contact.hpp"
#include "models/workspace.hpp"

namespace barchan {

/// The laws whose sums are a force [N] on the first particle.
// clang-format off
#define BARCHAN_FORCE_LAWS(row) \
  row(DragAndBarrier) \
  row(KernelContacts)
// clang-format on

#define BARCHAN_FORCES_OF(Law) void pair_forces(PhaseParticles& a, const RecordArray& own, const PairEntry<Law>& entry);

/// Adds to the acceleration of `a` the forces of its pairs with the entry's records (motion records with true
/// velocities) over its mass.
BARCHAN_PER_INSTRUCTION_SET(pair_forces, BARCHAN_FORCE_LAWS(BARCHAN_FORCES_OF))
#undef BARCHAN_FORCES_OF

/// An entry with such a law: it acts on each of the two phases that moves.
template <class Law>
class ForceEntry : public Model {
 public:
  ForceEntry(const Layout& layout, const PlanEntry& entry, const Law& law, stage::Stage in, FieldSet reads)
      : layout_(layout), entry_(entry), law_(law), stage_(in), reads_(reads) {}
  void attach(Workspace& w) override { w_ = &w; }
  void schedule(Schedule& s) override {
    act_on(entry_.a, s);
    if (entry_.a != entry_.b) act_on(entry_.b, s);
  }

 private:
  void act_on(std::size_t phase, Schedule& s) {
    if (entry_.direction(phase) < 0 || !layout_.phases[phase].moves()) return;
    const RecordTouch motion{{}, {Record::motion}, {}};
    Touches touches{{layout_.phases[phase].name, reads_, {Field::acceleration}, motion}};
    if (entry_.a != entry_.b) touches.push_back({layout_.phases[entry_.partner(phase)].name, {}, {}, motion});
    s.add({stage_, entry_.name, touches, [this, phase] { push(phase); }});
  }
  /// The particles of one phase feel those of the other.
  void push(std::size_t phase) {
    Law law = law_;
    if constexpr (requires { law.a_is_fluid; }) law.a_is_fluid = phase == entry_.fluid;
    pair_forces(w_->particles(phase), w_->records(phase, Record::motion),
                PairEntry<Law>{&w_->list(entry_.direction(phase)), &w_->records(entry_.partner(phase), Record::motion),
                               entry_.kernel, entry_.radius, law});
    w_->share_field(phase, Field::acceleration);
  }

  const Layout& layout_;
  const PlanEntry& entry_;
  Law law_;
  stage::Stage stage_;
  FieldSet reads_;
  Workspace* w_ = nullptr;
};

}  // namespace barchan
