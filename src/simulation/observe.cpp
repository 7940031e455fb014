// The results of a Simulation: frames, rows of history.csv, warnings.
#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "simulation/simulation.hpp"

namespace barchan {

std::uint64_t Simulation::pairs(const PlanEntry& e) const {
  std::uint64_t n = 0;
  for (const int direction : {e.forward, e.backward})
    if (direction >= 0) n += work_->list(direction).entries();
  for (const auto& model : models_) n += model->pairs(e);
  const bool whole = state_.phases[e.a].is_whole() && state_.phases[e.b].is_whole();
  return (whole ? Exchange::none() : Exchange()).total(n);
}

long Simulation::searches() const {
  long n = work_->neighbours.rebuilds();
  for (const auto& model : models_) n += model->searches();
  return n;
}

std::vector<RestingContact> Simulation::resting_contacts(std::size_t phase) const {
  std::vector<RestingContact> all;
  for (const auto& model : models_)
    for (const RestingContact& contact : model->resting_contacts(phase)) all.push_back(contact);
  return all;
}

std::size_t Simulation::bytes() const { return Exchange().total(work_->bytes() + (watch_ ? watch_->bytes() : 0)); }

/// Whether outputs have a particle: those in zones beyond sides with a flow belong to the world outside.
bool Simulation::is_shown(const PhaseParticles& p, std::size_t k) const {
  return !flows_through_ || plan_.in_domain(p, k);
}

std::size_t Simulation::shown_of(std::size_t phase) const {
  const PhaseParticles& p = state_.phases[phase];
  std::size_t n = p.size();
  for (std::size_t k = 0; flows_through_ && k < p.size(); ++k) n -= is_shown(p, k) ? 0 : 1;
  return n;
}

std::vector<std::size_t> Simulation::written_phases() const {
  std::vector<std::size_t> written;
  for (std::size_t k = 0; k < state_.phases.size(); ++k)
    if (plan_.phases[k].moves() || scene_.output.walls) written.push_back(k);
  return written;
}

Frame Simulation::frame(int index) const {
  for (const auto& model : models_) model->derive();
  Frame f;
  f.index = index;
  f.step = state_.steps;
  f.time = state_.time;
  for (std::size_t d = 0; d < static_cast<std::size_t>(plan_.dimensions); ++d) {
    f.domain[2 * d] = plan_.domain.low[d];
    f.domain[2 * d + 1] = plan_.domain.high[d];
  }
  for (std::size_t k = 0; k < state_.phases.size(); ++k) {
    f.phase_names.push_back(state_.phases[k].name());
    f.phase_kinds.push_back(plan_.phases[k].kind);
  }
  std::vector<std::size_t> written = written_phases();
  f.in_pieces = is_in_pieces(written);
  if (f.in_pieces) {
    const Exchange::Share own = Exchange().share();
    f.piece = static_cast<int>(own.number);
    f.pieces = static_cast<int>(own.count);
    if (own.number > 0) std::erase_if(written, [&](std::size_t k) { return state_.phases[k].is_whole(); });
  }
  std::size_t n = 0;
  for (const std::size_t k : written) n += shown_of(k);
  f.points.reserve(3 * n);
  f.id.reserve(n);
  f.phase.reserve(n);
  // Between two sorts a particle may be a little past a periodic side; what is written stands within it.
  const auto inside = [&](double x, int axis) {
    const auto d = static_cast<std::size_t>(axis);
    const double low = plan_.bounds.low[d], high = plan_.bounds.high[d];
    if (!plan_.bounds.periodic[d] || (x >= low && x < high)) return x;
    x -= (high - low) * std::floor((x - low) / (high - low));
    return x >= low && x < high ? x : low;
  };
  for (const std::size_t k : written) {
    const auto& p = state_.phases[k];
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!is_shown(p, i)) continue;
      for (int d = 0; d < 3; ++d)
        f.points.push_back(d < plan_.dimensions ? inside(p.column(Field::position, d)[i], d) : 0.0);
      f.id.push_back(p.id()[i]);
      f.phase.push_back(static_cast<std::int32_t>(k));
    }
  }
  for (const Field field : frame_fields(scene_)) f.fields.push_back(values_of(field, written, n));
  if (Exchange().is_shared() && !f.in_pieces) gather_frame(f, written);
  return f;
}

/// The values of a field of the phases that a frame has, `n` particles.
FrameField Simulation::values_of(Field field, const std::vector<std::size_t>& written, std::size_t n) const {
  const FieldInfo& about = info(field);
  FrameField out;
  out.name = about.name;
  out.unit = about.unit;
  const int width = components(about.rank, plan_.dimensions);
  out.components = about.rank == Rank::scalar      ? 1
                   : about.rank == Rank::vector    ? 3
                   : about.rank == Rank::symmetric ? 6
                                                   : width;
  out.values.reserve(n * static_cast<std::size_t>(out.components));
  for (const std::size_t k : written) {
    const auto& p = state_.phases[k];
    for (std::size_t i = 0; i < p.size(); ++i)
      for (int c = 0; c < out.components && is_shown(p, i); ++c) {
        double value = 0.0;
        if (field == Field::smoothing_length) value = plan_.phases[k].smoothing_length;
        else if (field == Field::density && !p.has(field)) value = scene_.phases[k].density;
        else if (field == Field::radius && !p.has(field)) value = p.mean_radius();
        else if (p.has(field) && c < width) value = p.column(field, c)[i];
        out.values.push_back(value);
      }
  }
  return out;
}

void Simulation::add_phase(std::size_t k, HistoryRow& row) const {
  const auto& p = state_.phases[k];
  const Exchange among(p);
  const std::size_t n = p.size(), shown = among.total(shown_of(k));
  std::array<const double*, 3> v{};
  for (int d = 0; d < plan_.dimensions; ++d) v[static_cast<std::size_t>(d)] = p.column(Field::velocity, d);
  double fastest = 0.0;
  const bool sizes = p.has(Field::radius);
  const double square = among.sum(n, [&](std::size_t i) {
    if (!is_shown(p, i)) return 0.0;
    double s = 0;
    for (int d = 0; d < plan_.dimensions; ++d)
      s += v[static_cast<std::size_t>(d)][i] * v[static_cast<std::size_t>(d)][i];
    fastest = std::max(fastest, s);
    return sizes ? s * p.mass_of(i) / p.mass() : s;
  });
  // The particles of rigid bodies have not their mass.
  const bool rigid = has_bodies(state_, k);
  double kinetic = rigid ? 0.0 : 0.5 * p.mass() * square;
  std::array<double, 3> mean{};
  for (int d = 0; d < plan_.dimensions; ++d) {
    const auto c = static_cast<std::size_t>(d);
    const double total = among.sum(n, [&](std::size_t i) { return is_shown(p, i) ? v[c][i] : 0.0; });
    mean[c] = shown > 0 ? total / static_cast<double>(shown) : 0.0;
    if (rigid) continue;
    row.values[HistoryRow::momentum_x + c] +=
        sizes ? among.sum(n, [&](std::size_t i) { return is_shown(p, i) ? p.mass_of(i) * v[c][i] : 0.0; })
              : p.mass() * total;
  }
  for (const RigidBody& body : state_.bodies) {
    if (body.phase != k) continue;
    const Vec3 momentum = body.mass * centre_velocity(body);
    for (std::size_t c = 0; c < 3; ++c) row.values[HistoryRow::momentum_x + c] += momentum[c];
    kinetic += kinetic_energy(body);
  }
  fastest = std::sqrt(among.largest(fastest));
  row.raise(HistoryRow::largest_speed, fastest);
  const std::string& name = plan_.phases[k].name;
  row.add(name + "_kinetic_energy [J]", kinetic);
  row.add(name + "_largest_speed [m/s]", fastest);
  constexpr const char* axes[] = {"x", "y", "z"};
  for (int d = 0; d < plan_.dimensions; ++d)
    row.add(name + "_mean_v" + axes[d] + " [m/s]", mean[static_cast<std::size_t>(d)]);
  if (rigid) return;
  const auto of_all = [&](auto&& value) {
    return among.sum(n, [&](std::size_t i) { return is_shown(p, i) ? value(i) : 0.0; });
  };
  const double mass = sizes ? of_all([&](std::size_t i) { return p.mass_of(i); }) : static_cast<double>(shown);
  if (p.may_change()) row.add(name + "_mass [kg]", sizes ? mass : p.mass() * mass);
  // Along a periodic axis there is no centre.
  for (int d = 0; d < plan_.dimensions; ++d) {
    if (plan_.domain.periodic[static_cast<std::size_t>(d)]) continue;
    const double* x = p.column(Field::position, d);
    const double moment = of_all([&](std::size_t i) { return (sizes ? p.mass_of(i) : 1.0) * x[i]; });
    row.add(name + "_centre_" + axes[d] + " [m]", mass > 0.0 ? moment / mass : 0.0);
  }
}

HistoryRow Simulation::history() const {
  for (const auto& model : models_) model->derive();
  HistoryRow row;
  row.add("time [s]", state_.time);
  row.add("step", static_cast<double>(state_.steps));
  row.add("dt [s]", state_.dt);
  for (const char* name : {"momentum_x [kg m/s]", "momentum_y [kg m/s]", "momentum_z [kg m/s]", "largest_speed [m/s]",
                           "largest_density_error"})
    row.add(name, 0.0);
  for (const auto& model : models_) {
    if (model->phase() < 0) continue;
    const auto k = static_cast<std::size_t>(model->phase());
    if (plan_.phases[k].moves()) add_phase(k, row);
    model->history(row);
  }
  for (const auto& model : models_)
    if (model->phase() < 0) model->history(row);
  if (plan_.dimensions == 2) row.count_by_metre();
  return row;
}

void Simulation::begin_row() {
  for (const auto& model : models_) model->begin_row();
}

Frame Simulation::good_frame(int index) {
  KeptState& good = watch_->good();
  const double time = state_.time;
  const long step = state_.steps;
  good.exchange(state_.phases);
  state_.time = good.time();
  state_.steps = good.step();
  Frame f = frame(index);
  good.exchange(state_.phases);
  state_.time = time;
  state_.steps = step;
  return f;
}

void Simulation::write_results(const std::string& folder, double time) const {
  for (const auto& model : models_) model->write(folder, time);
}

double Simulation::held_energy() const {
  double held = 0.0;
  for (const auto& model : models_) held += model->budget_energy();
  return held;
}

Warnings Simulation::warnings() const {
  Warnings all;
  watch_->report(all);
  budget_->report(state_, all, held_energy());
  for (const auto& model : models_) model->report(all);
  return all;
}

}  // namespace barchan
