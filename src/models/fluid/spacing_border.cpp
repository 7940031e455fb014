#include "models/fluid/spacing_border.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "models/fluid/fluid_phase.hpp"
#include "scene/couplings.hpp"
#include "scene/located.hpp"

namespace barchan {

namespace {

bool first_is_finer(const Layout& layout, const PlanEntry& e) {
  return layout.phases[e.a].spacing < layout.phases[e.b].spacing;
}

}  // namespace

std::unique_ptr<Model> make_spacing_border(const Scene& scene, const Layout& layout, const PlanEntry& entry) {
  const Interaction* pair = entry_between(scene, scene.phases[entry.a], scene.phases[entry.b]);
  if (!pair->border.is_formula()) return nullptr;
  return std::make_unique<SpacingBorder>(scene, layout, entry);
}

SpacingBorder::SpacingBorder(const Scene& scene, const Layout& layout, const PlanEntry& entry)
    : scene_(scene),
      layout_(layout),
      fine_(first_is_finer(layout, entry) ? entry.a : entry.b),
      coarse_(entry.partner(fine_)),
      name_(layout.phases[fine_].name + "-" + layout.phases[coarse_].name),
      fine_spacing_(layout.phases[fine_].spacing),
      coarse_spacing_(layout.phases[coarse_].spacing),
      border_(entry_between(scene, scene.phases[fine_], scene.phases[coarse_])->border, layout.domain, coarse_spacing_,
              located(scene, "interactions." + entry.name + ".border")) {
  for (const std::size_t phase : {fine_, coarse_})
    if (layout.phases[phase].free_surface)
      throw SceneError(located(scene, "interactions." + entry.name + ".border") + ": \"" + layout.phases[phase].name +
                       "\" has a free surface, at which nothing is passed on yet; expected a fluid that fills its "
                       "space, or no border");
  std::size_t all = 1;
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout.dimensions); ++d) {
    const double size = layout.domain.high[d] - layout.domain.low[d];
    cells_[d] = static_cast<std::size_t>(std::max(1.0, std::floor(size / (2.0 * coarse_spacing_))));
    cell_[d] = size / static_cast<double>(cells_[d]);
    all *= cells_[d];
  }
  begin_.resize(all + 1);
}

void SpacingBorder::begin(State& state, const std::vector<ParticleBlock>&) {
  place_ = state.departed.size();
  state.departed.emplace_back();
  state.departed.back().phase = static_cast<std::int64_t>(coarse_);
  for (const std::size_t phase : {fine_, coarse_}) state.phases[phase].number_may_change();
}

void SpacingBorder::attach(Workspace& w) {
  w_ = &w;
  if (w.particles(fine_).has(Field::turbulent_kinetic_energy)) count_ = most_values;
}

void SpacingBorder::schedule(Schedule& s) {
  s.add({stage::walls,
         name_ + ", border of spacings",
         {layout_.phases[fine_].all_fields(), layout_.phases[coarse_].all_fields()},
         [this] {
           if (is_due()) pass_on();
         }});
}

/// Adds the way of the fastest flow to what has gone since the last look.
bool SpacingBorder::is_due() {
  double most = 0.0;
  for (const std::size_t phase : {fine_, coarse_}) {
    const PhaseParticles& p = w_->particles(phase);
    std::array<const double*, 3> v{};
    const auto dimensions = static_cast<std::size_t>(layout_.dimensions);
    for (std::size_t d = 0; d < dimensions; ++d) v[d] = p.column(Field::velocity, static_cast<int>(d));
    const auto n = static_cast<std::int64_t>(p.size());
#pragma omp parallel for schedule(static) reduction(max : most)
    for (std::int64_t k = 0; k < n; ++k) {
      double speed2 = 0.0;
      for (std::size_t d = 0; d < dimensions; ++d) speed2 += v[d][k] * v[d][k];
      most = std::max(most, speed2);
    }
  }
  most = Exchange().largest(most);
  gone_ += std::sqrt(most) * w_->state.dt / fine_spacing_;
  return gone_ >= often;
}

void SpacingBorder::pass_on() {
  gone_ = 0.0;
  made_fine_.clear();
  made_coarse_.clear();
  if (!find_members()) return;
  sort_members();
  split();
  merge();
  apply();
}

Vec3 SpacingBorder::wrapped(Vec3 x) const {
  for (std::size_t d = 0; d < 3; ++d) {
    if (!layout_.domain.periodic[d]) continue;
    const double period = layout_.domain.high[d] - layout_.domain.low[d];
    x[d] -= period * std::floor((x[d] - layout_.domain.low[d]) / period);
  }
  return x;
}

/// a - b, to the nearest image.
Vec3 SpacingBorder::apart(const Vec3& a, const Vec3& b) const {
  Vec3 r = a - b;
  for (std::size_t d = 0; d < 3; ++d) {
    if (!layout_.domain.periodic[d]) continue;
    const double period = layout_.domain.high[d] - layout_.domain.low[d];
    r[d] -= period * std::round(r[d] / period);
  }
  return r;
}

double SpacingBorder::squared(const Vec3& r) const { return r[0] * r[0] + r[1] * r[1] + r[2] * r[2]; }

/// Particles as far from the border as any that crosses it, and their neighbours; false: none crosses it.
bool SpacingBorder::find_members() {
  members_.clear();
  const double over = play * coarse_spacing_;
  double deepest = 0.0;
  const bool flows = layout_.flows_through();
  for (const std::size_t phase : {fine_, coarse_}) {
    const PhaseParticles& p = w_->particles(phase);
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (flows && !layout_.in_domain(p, k)) continue;  // those of a zone with a flow stay what they are
      Member m;
      for (int d = 0; d < p.dimensions(); ++d) m.x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
      m.x = wrapped(m.x);
      m.distance = border_(m.x);
      m.coarse = phase == coarse_;
      m.place = static_cast<std::uint32_t>(k);
      m.id = p.id()[k];
      members_.push_back(m);
      if (m.coarse ? m.distance < -over : m.distance > over) deepest = std::max(deepest, std::abs(m.distance));
    }
  }
  deepest = Exchange().largest(deepest);
  if (deepest == 0.0) return false;
  std::erase_if(members_, [&](const Member& m) { return std::abs(m.distance) > deepest + 3.0 * coarse_spacing_; });
  details_.clear();
  if (Exchange().is_shared()) join_ranks();
  return true;
}

/// By cell, and in a cell by phase and id, whatever the storage.
void SpacingBorder::sort_members() {
  for (Member& m : members_) {
    std::size_t cell = 0;
    for (std::size_t d = 3; d-- > 0;) {
      const double s =
          std::clamp((m.x[d] - layout_.domain.low[d]) / cell_[d], 0.0, static_cast<double>(cells_[d]) - 0.5);
      cell = cell * cells_[d] + static_cast<std::size_t>(s);
    }
    m.cell = static_cast<std::uint32_t>(cell);
  }
  std::sort(members_.begin(), members_.end(), [](const Member& a, const Member& b) {
    return std::tie(a.cell, a.coarse, a.id) < std::tie(b.cell, b.coarse, b.id);
  });
  std::fill(begin_.begin(), begin_.end(), 0u);
  for (const Member& m : members_) ++begin_[m.cell + 1];
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
}

// ---- the particles --------------------------------------------------------------------------------------------------

void SpacingBorder::book(std::size_t phase, const Vec3& x, const Values& values, double sign) {
  const double m = sign * w_->particles(phase).mass();
  Departed& departed = w_->state.departed[place_];
  for (std::size_t d = 0; d < static_cast<std::size_t>(layout_.dimensions); ++d) {
    const double v = values[d];
    departed.momentum[d] += m * v;
    departed.kinetic += 0.5 * m * v * v;
    passed_.loss += 0.5 * m * v * v;
    departed.potential -= m * scene_.domain.gravity[d] * x[d];
  }
  const double strain = values[3] / scene_.phases[phase].density - 1.0;
  departed.stored += 0.5 * m * std::pow(layout_.phases[phase].sound_speed * strain, 2);
}

void SpacingBorder::create(std::size_t phase, const std::vector<Made>& made) {
  if (made.empty()) return;
  for (const Made& one : made) book(phase, one.x, one.values, -1.0);
  if (!Exchange().is_first()) {
    w_->state.ids.next += static_cast<std::int64_t>(made.size());
    return;
  }
  PhaseParticles& p = w_->particles(phase);
  const PressureLaw law = pressure_law(scene_, layout_, phase);
  const std::size_t first = p.create(made.size(), w_->state.ids);
  for (std::size_t n = 0; n < made.size(); ++n) {
    const Made& one = made[n];
    const std::size_t k = first + n;
    for (int d = 0; d < p.dimensions(); ++d) {
      p.column(Field::position, d)[k] = one.x[static_cast<std::size_t>(d)];
      p.column(Field::velocity, d)[k] = one.values[static_cast<std::size_t>(d)];
    }
    p.column(Field::density)[k] = one.values[3];
    p.column(Field::pressure)[k] = law(one.values[3]);
    if (p.has(Field::eddy_viscosity)) p.column(Field::eddy_viscosity)[k] = one.values[4];
    if (count_ > 5) {
      p.column(Field::turbulent_kinetic_energy)[k] = one.values[5];
      p.column(Field::specific_dissipation_rate)[k] = std::exp(one.values[6]);
    }
    for (int c = 0; c < p.components(Field::anisotropy); ++c)
      p.column(Field::anisotropy, c)[k] = one.skew[static_cast<std::size_t>(c)];
    if (p.has(Field::drag_acceleration))
      for (int d = 0; d < p.dimensions(); ++d)
        p.column(Field::drag_acceleration, d)[k] = one.drag[static_cast<std::size_t>(d)];
    if (p.has(Field::near_void)) p.column(Field::near_void)[k] = one.near_void;
  }
}

/// The taken ones of a phase go, in the order of their ids.
void SpacingBorder::take_away(std::size_t phase) {
  PhaseParticles& p = w_->particles(phase);
  seeds_.clear();
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (members_[k].taken && members_[k].coarse == (phase == coarse_)) seeds_.push_back(k);
  if (seeds_.empty()) return;
  std::sort(seeds_.begin(), seeds_.end(),
            [&](std::size_t a, std::size_t b) { return members_[a].id < members_[b].id; });
  leaves_.assign(p.size(), 0);
  for (const std::size_t k : seeds_) {
    const Member& m = members_[k];
    book(phase, stands_at(m), values_of(m), 1.0);
    if (const auto place = place_here(m)) leaves_[*place] = 1;
  }
  const double mass = p.mass() * static_cast<double>(seeds_.size());
  (phase == fine_ ? passed_.to_coarse : passed_.to_fine) += mass;
  p.remove_if([&](std::size_t k) { return leaves_[k] != 0; });
}

void SpacingBorder::apply() {
  for (const std::size_t phase : {fine_, coarse_}) take_away(phase);
  create(fine_, made_fine_);
  create(coarse_, made_coarse_);
  if (!made_fine_.empty() || !made_coarse_.empty()) w_->must_search = true;  // on all ranks
}

void SpacingBorder::history(HistoryRow& row) const {
  row.add(name_ + "_to_fine [kg]", passed_.to_fine);
  row.add(name_ + "_to_coarse [kg]", passed_.to_coarse);
  row.add(name_ + "_loss [J]", passed_.loss);
}

void SpacingBorder::archive(Archive& a) {
  a.number(name_ + " way since the last look", gone_);
  a.number(name_ + " passed on", passed_);
}

}  // namespace barchan
