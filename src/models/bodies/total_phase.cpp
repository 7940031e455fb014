#include "models/bodies/total_phase.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "engine/integrate.hpp"
#include "engine/phase_sums.hpp"
#include "models/bodies/angular_momentum.hpp"
#include "models/bodies/body_forces.hpp"
#include "models/bodies/stiffest_vibration.hpp"
#include "models/bodies/stress_fields.hpp"
#include "output/numbers.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

/// lambda/mu above which a body's sums are in double in mixed precision too: single precision would round the trace of
/// the strain, times lambda, by 1e-4 of the shear stress.
constexpr double most_compression = 1e3;

/// How much stiffer than at rest a body may be at the step of the body at rest: compression by some 7 %. Beyond it the
/// step is `deformed` of the bound of the leapfrog, over the square root of the stiffening: contacts add to the
/// stiffness, and a block of rubber that bounces twice gains energy at 1 (x 2 to x 4) and none at 0.64. The stiffening
/// is forgotten by a thousandth a step, because a step that changes all the time feeds energy too.
constexpr double free_stiffening = 1.15, deformed = 0.64, forgotten = 1e-3;

template <class T>
class BodyOf : public TotalBody {
 public:
  BodyOf(ReferenceBody<T> reference, const TotalParameters& parameters)
      : reference_(std::move(reference)), parameters_(parameters) {
    work_.resize(reference_.size, reference_.width, reference_.dimensions, parameters);
    for (std::size_t d = 0; d < 3; ++d)
      if (parameters.period[d] > 0.0) work_.displaced[d].assign(reference_.size, 0.0);
    const std::size_t padded = reference_.groups.size() * reference_.width;
    const auto numbers =
        static_cast<std::size_t>(reference_.dimensions) * static_cast<std::size_t>(reference_.dimensions);
    for (std::size_t c = 0; c < numbers; ++c) detail_.gradient[c].assign(padded, 0.0);
    detail_.hourglass.assign(padded, 0.0);
  }
  void pack(const PhaseParticles& p) override {
    work_.at = p.places();
    work_.in_order = p.in_order();
    pack_displacements(p, reference_, work_, parameters_);
  }
  void load(PhaseParticles& p) override {
    total_stress(p, reference_, work_, parameters_);
    total_forces(p, reference_, work_, parameters_);
  }
  const TotalDetail& detail() override {
    total_detail(reference_, work_, parameters_, detail_);
    return detail_;
  }
  std::uint64_t pairs() const override { return reference_.pairs; }
  double stiffening() const override { return work_.stiffening; }
  double least_volume() const override { return work_.least_volume; }
  std::int64_t flat() const override { return reference_.flat; }
  void archive(Archive& a) override {
    if (std::is_same_v<T, float>) {
      a.number("unit of displacements", work_.unit);
      work_.turns.archive(a);
    }
    for (std::size_t d = 0; d < 3; ++d)
      if (!work_.displaced[d].empty()) a.values("displacement", work_.displaced[d].data(), work_.displaced[d].size());
  }

 private:
  ReferenceBody<T> reference_;
  TotalParameters parameters_;
  TotalWork<T> work_;
  TotalDetail detail_;
};

template <class T>
std::unique_ptr<TotalBody> make_body(const std::vector<Vec3>& places, const Layout& layout, double spacing,
                                     const PlanEntry* own, const TotalParameters& parameters) {
  return std::make_unique<BodyOf<T>>(
      make_reference_body<T>(places, layout.bounds, spacing, own ? own->kernel : KernelKind::wendland_c2,
                             own ? own->radius : 0.0, simd::width_in_use<T>()),
      parameters);
}

}  // namespace

template <class T>
void TotalWork<T>::resize(std::size_t size, std::size_t width, int dimensions, const TotalParameters& q) {
  const std::size_t room = (size + width - 1) / width * width + 2 * margin, dim = static_cast<std::size_t>(dimensions);
  for (std::size_t d = 0; d < dim; ++d) {
    displacement[d].assign(room, Place(0));
    if (q.moduli.retardation > 0.0) velocity[d].assign(room, T(0));
  }
  for (std::size_t c = 0; c < dim * dim; ++c) {
    reach[c].assign(room, T(0));
    if (q.along > 0.0) gradient[c].assign(room, T(0));
  }
}
template struct TotalWork<float>;
template struct TotalWork<double>;

void describe_total_body(const Scene& scene, const Interaction& pair, const Layout&, PlanEntry& e) {
  e.law = "elastic";
  e.pairs = Pairs::first_shape;
  describe_approximation(pair, scene.dimensions, "in the body's first shape", e);
}

TotalPhase::TotalPhase(const Scene& scene, const Layout& layout, std::size_t number)
    : scene_(scene),
      layout_(layout),
      phase_(scene.phases[number]),
      plan_(layout.phases[number]),
      number_(number),
      forces_(scene, phase_.name),
      limit_{"stretch " + phase_.name, 1e300, "its stiffest vibration, as deformed"} {
  for (const auto& e : layout.entries)
    if (e.pairs == Pairs::first_shape && e.a == number) own_ = &e;
  const ElasticKeys& keys = phase_.elastic();
  parameters_.law = keys.elasticity;
  parameters_.moduli = ElasticModuli::of(keys.young, keys.poisson, keys.retardation);
  parameters_.hourglass = keys.hourglass * keys.young;
  if (keys.wave_correction && own_)
    parameters_.along = length_stiffness(own_->kernel, own_->radius, plan_.spacing, layout.dimensions, parameters_);
  parameters_.density = phase_.density;
  parameters_.gravity = scene.domain.gravity;
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout.dimensions); ++d)
    if (layout.bounds.periodic[d]) parameters_.period[d] = layout.bounds.high[d] - layout.bounds.low[d];
}

void TotalPhase::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  PhaseParticles& p = state.phases[number_];
  std::fill_n(p.column(Field::density), p.size(), phase_.density);
  start_ = blocks[number_].position;
}

void TotalPhase::attach(Workspace& w) {
  w_ = &w;
  const bool nearly_incompressible = parameters_.moduli.lambda > most_compression * parameters_.moduli.mu;
  body_ = scene_.precision == Precision::mixed && !nearly_incompressible
              ? make_body<float>(start_, layout_, plan_.spacing, own_, parameters_)
              : make_body<double>(start_, layout_, plan_.spacing, own_, parameters_);
  if (const std::int64_t flat = body_->flat(); flat >= 0) {
    const Vec3& x = start_[static_cast<std::size_t>(flat)];
    throw SceneError(located(scene_, "phases." + plan_.name + ".formulation") +
                     ": the neighbours of the particle at (" + brief(x[0]) + ", " + brief(x[1]) + ", " + brief(x[2]) +
                     ") m lie in one line or plane, from which no strain follows; expected bodies of two layers of "
                     "particles or more, a wider radius, or \"updated-lagrangian\"");
  }
  start_.clear();
  start_.shrink_to_fit();
  if (own_ && plan_.count > 0)
    rest_limit_ = scene_.time.safety * StepConstants::total * 2.0 /
                  stiffest_vibration(own_->kernel, own_->radius, plan_.spacing, layout_.dimensions, parameters_);
  w.particles(number_).keep_places();
}

void TotalPhase::schedule(Schedule& s) {
  using enum Field;
  s.add({stage::kick_and_drift, plan_.name, {{plan_.name, {acceleration}, {position, velocity}}}, [this] {
           kick_and_drift();
         }});
  s.add({stage::elastic,
         plan_.name,
         {{plan_.name, {position, velocity}, {density, acceleration, contact_force}}},
         [this] { load(); }});
}

/// The stiffest vibration bounds the step; so does what damps it.
void TotalPhase::limits(std::vector<StepLimit>& limits) const {
  if (plan_.count == 0 || !own_) return;
  const double frequency =
      stiffest_vibration(own_->kernel, own_->radius, plan_.spacing, layout_.dimensions, parameters_);
  const double undamped = StepConstants::total * 2.0 / frequency;
  limits.push_back({"elastic " + plan_.name, scene_.time.safety * undamped, "its stiffest vibration"});
  const double slow = parameters_.moduli.retardation;
  if (slow > 0.0)
    limits.push_back({"damping " + plan_.name,
                      scene_.time.safety * StepConstants::total / (slow * frequency * frequency),
                      "the retardation of its stiffest vibration"});
}

const StepLimit* TotalPhase::moving_limit() {
  if (!own_ || plan_.count == 0) return nullptr;
  limit_.value = stiffening_ > free_stiffening ? deformed * rest_limit_ / std::sqrt(stiffening_) : 1e300;
  return &limit_;
}

std::optional<std::string> TotalPhase::trouble() const {
  if (body_->least_volume() > 0.0) return std::nullopt;
  return "the body \"" + plan_.name + "\" is pressed through itself: the volume of a particle is " +
         brief(body_->least_volume()) +
         " of that at rest, expected more than 0; its motion is too fast for its stiffness: raise phases." +
         plan_.name + ".young, or lower its speed or what presses it";
}

void TotalPhase::kick_and_drift() {
  const double dt = w_->state.dt;
  barchan::kick_and_drift(w_->particles(number_), 0.5 * dt, dt, nullptr);
}

void TotalPhase::load() {
  PhaseParticles& p = w_->particles(number_);
  body_->pack(p);
  body_->load(p);
  stiffening_ = std::max(body_->stiffening(), 1.0 + (1.0 - forgotten) * (stiffening_ - 1.0));
  clear_contact_forces(p);
  forces_.add(p, w_->state.time, true);
}

void TotalPhase::history(HistoryRow& row) const {
  row.add(plan_.name + "_strain_energy [J]", strain_energy_);
  row.add(plan_.name + "_hourglass_energy [J]", hourglass_energy_);
  add_angular_momentum(row, w_->particles(number_), layout_);
}

double TotalPhase::budget_energy() {
  derive();
  return strain_energy_ + hourglass_energy_;
}

void TotalPhase::derive() {
  PhaseParticles& p = w_->particles(number_);
  body_->pack(p);
  const TotalDetail& detail = body_->detail();
  const double volume = std::pow(plan_.spacing, layout_.dimensions);
  const SolidFields fields(p);
  const auto solid = [&](std::size_t id) {
    return solid_of(detail.gradient, id, layout_.dimensions, parameters_.law, parameters_.moduli);
  };
  for (std::size_t id = 0; id < p.size(); ++id) fields.write(p.places()[id], solid(id));
  strain_energy_ = volume * sum_of(p, [&](std::size_t id) { return solid(id).energy; });
  hourglass_energy_ = volume * sum_of(p, [&](std::size_t id) { return detail.hourglass[id]; });
}

std::uint64_t TotalPhase::pairs(const PlanEntry& entry) const { return &entry == own_ && body_ ? body_->pairs() : 0; }

void TotalPhase::archive(Archive& a) {
  body_->archive(a);
  a.number("stiffening", stiffening_);
}

}  // namespace barchan
