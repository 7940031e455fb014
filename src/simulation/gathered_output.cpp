// What is written of a run on several ranks: the frames and checkpoints of one process.
#include "engine/exchange.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

namespace {

/// Values of this rank's particles of a phase. Of one that is whole only those of the first rank count.
struct Held {
  std::size_t count = 0;
  bool whole = false;
};

/// Of each phase the values of all ranks, one rank after another, as one process has them; `width`: values a particle.
template <class T>
void gather(std::vector<T>& values, const std::vector<Held>& phases, std::size_t width) {
  std::vector<T> whole;
  std::size_t at = 0;
  for (const Held& held : phases) {
    const std::size_t count = held.whole && !Exchange::is_first_process() ? 0 : held.count;
    const std::vector<std::size_t> of_ranks = Exchange().each(count);
    std::size_t total = 0;
    for (const std::size_t n : of_ranks) total += n;
    const std::size_t before = whole.size();
    if (Exchange::is_first_process()) whole.resize(before + total * width);
    Exchange().gather(values.data() + at * width, count, whole.data() + before, of_ranks, width * sizeof(T));
    at += held.count;
  }
  values = std::move(whole);
}

}  // namespace

/// Whether a frame of these phases has so many particles that each rank writes its own.
bool Simulation::is_in_pieces(const std::vector<std::size_t>& written) const {
  std::size_t n = 0;
  for (const std::size_t k : written)
    if (!state_.phases[k].is_whole() || Exchange::is_first_process()) n += shown_of(k);
  return Exchange().total(n) >= static_cast<std::size_t>(scene_.output.pieces_from);
}

/// The frame of all ranks on the first one; an empty one on the others.
void Simulation::gather_frame(Frame& f, const std::vector<std::size_t>& written) const {
  std::vector<Held> counts;
  for (const std::size_t k : written) counts.push_back({shown_of(k), state_.phases[k].is_whole()});
  gather(f.points, counts, 3);
  gather(f.id, counts, 1);
  gather(f.phase, counts, 1);
  for (FrameField& field : f.fields) gather(field.values, counts, static_cast<std::size_t>(field.components));
}

void Simulation::save_whole(const std::function<void()>& save) {
  if (!Exchange().is_shared()) return save();
  work_->neighbours.gather();
  for (const auto& model : models_) model->gather_to_save();
  for (PhaseParticles& p : state_.phases) p.archive_all(true);
  save();
  for (PhaseParticles& p : state_.phases) p.archive_all(false);
  for (const auto& model : models_) model->forget_gathered();
  work_->neighbours.forget_gathered();
}

void Simulation::load_whole(const std::function<void()>& load) {
  loads_whole_ = Exchange().is_shared();
  if (loads_whole_)
    for (PhaseParticles& p : state_.phases) p.archive_all(true);
  load();
  if (loads_whole_)
    for (PhaseParticles& p : state_.phases) p.archive_all(false);
  loads_whole_ = false;
}

}  // namespace barchan
