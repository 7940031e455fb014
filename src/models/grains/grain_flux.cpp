#include "models/grains/grain_flux.hpp"

#include <algorithm>
#include <cmath>

#include "engine/phase_sums.hpp"
#include "models/grains/saltation_layer.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"

namespace barchan {

double creyssels_flux(double u) { return std::max(0.167 * (u * u - 0.171 * 0.171), 0.0); }

GrainFlux::GrainFlux(const Scene& scene, const Layout& layout, std::size_t wind, std::size_t grains)
    : scene_(scene),
      layout_(layout),
      wind_(wind),
      grains_(grains),
      area_(ground_area(scene)),
      tenth_(warning_interval(scene)) {
  const std::string& name = scene.phases[grains].name;
  const auto& layers = scene.measuring.saltation;
  if (std::none_of(layers.begin(), layers.end(), [&](const SaltationLayer& layer) { return layer.name == name; }))
    column_ = name + "_flux [kg/m/s]";
  const double d = layout.phases[grains].diameter;
  measured_ = d >= finest && d <= coarsest;
  open_ = !scene.domain.periodic[0];
}

void GrainFlux::schedule(Schedule& s) {
  if (measured_ || open_)
    s.add({stage::hold,
           scene_.phases[grains_].name,
           {{scene_.phases[grains_].name, {Field::position, Field::velocity, Field::radius}, {}}},
           [this] { sample(); }});
}

/// Of the grains between two places along x (m), over the whole ground.
double GrainFlux::flux(double from, double to) const {
  const PhaseParticles& p = w_->particles(grains_);
  const double *x = p.column(Field::position, 0), *vx = p.column(Field::velocity, 0);
  return sum_of(p, [&](std::size_t k) { return x[k] >= from && x[k] < to ? p.mass_of(k) * vx[k] : 0.0; }) / area_;
}

void GrainFlux::sample() {
  const State& state = w_->state;
  if (state.steps == 0 || state.steps % every != 0) return;
  const auto note = [&](WindowMean& mean, double value) { mean.add(tenth_, state.time, state.dt, value); };
  note(mean_, flux());
  if (open_) {
    const double low = layout_.domain.low[0], size = layout_.domain.high[0] - low;
    note(third_, 4.0 * flux(low + 0.5 * size, low + 0.75 * size));
    note(last_, 4.0 * flux(low + 0.75 * size, low + size));
  }
  double stress = 0.0;
  std::size_t layers = 0;
  for (const AirProfile& air : state.air)
    if (air.phase == wind_) stress += air.stress.back(), ++layers;
  if (layers > 0) note(stress_, stress / static_cast<double>(layers));
}

void GrainFlux::history(HistoryRow& row) const {
  if (!column_.empty()) row.add(column_, flux());
}

void GrainFlux::report_growth(Warnings& warnings) const {
  if (!last_.any()) return;
  const double third = third_.recent(tenth_), last = last_.recent(tenth_);
  const double counts = noise * creyssels_flux(weakest);
  if (!(std::abs(last) > grows * std::abs(third)) || !(std::abs(last) > counts)) return;
  const std::string& name = scene_.phases[grains_].name;
  warnings.add("growth of the flux of " + name,
               "the flux of \"" + name + "\" still grows at the outflow: " + brief(1e3 * last) +
                   " g/m/s in the last quarter of the ground, " + brief(1e3 * third) +
                   " in the third, means over the last tenth of the run: this flux is not saturated; expected a longer "
                   "domain or run, or an [[influx]]");
}

void GrainFlux::report_stress(Warnings& warnings) const {
  const Phase& wind = scene_.phases[wind_];
  const PlanPhase& plan = layout_.phases[wind_];
  const double u = plan.wind.friction_velocity(w_->state.time), said = wind.density * u * u;
  if (plan.wind.held || !stress_.any() || !(said > 0.0)) return;
  const double takes = std::abs(stress_.recent(tenth_));
  if (!(takes > most_stress * said)) return;
  warnings.add(
      "stress of " + wind.name,
      "the ground took " + brief(takes) + " Pa from \"" + wind.name +
          "\", a mean over the last tenth of the run, as in a wind of u* = " + brief(std::sqrt(takes / wind.density)) +
          " m/s: " + brief(takes / said) + " times the " + brief(said) + " Pa of the u* = " + brief(u) +
          " m/s that the scene states; expected at most " + brief(most_stress) +
          " times: sand makes the ground rougher than the roughness of the profile (about ten times), so that "
          "this profile is the wind of a larger u*; expected a profile over moving sand, or hold = \"stress\"");
}

void GrainFlux::report(Warnings& warnings) const {
  report_growth(warnings);
  report_stress(warnings);
  const double u = layout_.phases[wind_].wind.friction_velocity(w_->state.time);
  if (!measured_ || !mean_.any() || u < weakest || u > strongest) return;
  const double mean = std::abs(mean_.recent(tenth_)), law = creyssels_flux(u);
  const std::string& name = scene_.phases[grains_].name;
  if (mean > most_flux * law)
    warnings.add("flux of " + name,
                 "the flux of \"" + name + "\" was " + brief(1e3 * mean) +
                     " g/m/s, a mean over the last tenth of the run: " + brief(mean / law) + " times the " +
                     brief(1e3 * law) + " g/m/s measured at u* = " + brief(u) +
                     " m/s, which the scene says of its wind (Creyssels et al. 2009: 0.242 mm, u* = 0.24 to 0.56 m/s, "
                     "0.167 kg s/m3 (u*^2 - (0.171 m/s)^2)); expected at most " +
                     brief(most_flux) +
                     " times: the run is not long enough to saturate, or what drives the wind is stronger "
                     "(the columns _pull and _equivalent_friction_velocity of history.csv)");
}

void GrainFlux::archive(Archive& a) {
  const std::string name = scene_.phases[grains_].name + ": ";
  if (measured_ || open_) a.number(name + "flux in a tenth of the run", mean_);
  if (open_) {
    a.number(name + "flux in the third quarter", third_);
    a.number(name + "flux in the last quarter", last_);
  }
  if (measured_ || open_) a.number(name + "stress on the ground", stress_);
}

void add_grain_fluxes(const Scene& scene, const Layout& layout, Models& models) {
  std::vector<bool> done(scene.phases.size(), false);
  for (const PlanEntry& e : layout.entries) {
    if (!e.blows || done[e.other]) continue;
    const Wind& wind = layout.phases[e.fluid].wind;
    const bool enters = !scene.domain.periodic[0] && wind.friction_velocity && wind.friction_velocity(0.0) > 0.0;
    if (!wind.driven && !enters) continue;
    done[e.other] = true;
    models.push_back(std::make_unique<GrainFlux>(scene, layout, e.fluid, e.other));
  }
}

}  // namespace barchan
