#include "models/grains/grain_flux.hpp"

#include <algorithm>
#include <cmath>

#include "engine/exchange.hpp"
#include "models/grains/saltation_layer.hpp"
#include "output/numbers.hpp"
#include "scene/couplings.hpp"

namespace barchan {

double creyssels_flux(double u) { return std::max(0.167 * (u * u - 0.171 * 0.171), 0.0); }

GrainFlux::GrainFlux(const Scene& scene, const Layout& layout, std::size_t wind, std::size_t grains)
    : scene_(scene),
      wind_(layout.phases[wind]),
      grains_(grains),
      area_(ground_area(scene)),
      tenth_(warning_interval(scene)) {
  const std::string& name = scene.phases[grains].name;
  const auto& layers = scene.measuring.saltation;
  if (std::none_of(layers.begin(), layers.end(), [&](const SaltationLayer& layer) { return layer.name == name; }))
    column_ = name + "_flux [kg/m/s]";
  const double d = layout.phases[grains].diameter;
  measured_ = d >= finest && d <= coarsest;
}

void GrainFlux::schedule(Schedule& s) {
  if (measured_)
    s.add({stage::hold,
           scene_.phases[grains_].name,
           {{scene_.phases[grains_].name, {Field::velocity, Field::radius}, {}}},
           [this] { sample(); }});
}

double GrainFlux::flux() const {
  const PhaseParticles& p = w_->particles(grains_);
  const double* vx = p.column(Field::velocity, 0);
  const Exchange among(p);
  return among.sum(p.size(), [&](std::size_t k) { return p.mass_of(k) * vx[k]; }) / area_;
}

void GrainFlux::sample() {
  if (w_->state.steps > 0 && w_->state.steps % every == 0) mean_.add(tenth_, w_->state.time, w_->state.dt, flux());
}

void GrainFlux::history(HistoryRow& row) const {
  if (!column_.empty()) row.add(column_, flux());
}

void GrainFlux::report(Warnings& warnings) const {
  const double u = wind_.wind.friction_velocity(w_->state.time);
  if (!mean_.any() || u < weakest || u > strongest) return;
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
  if (measured_) a.number(scene_.phases[grains_].name + ": flux in a tenth of the run", mean_);
}

void add_grain_fluxes(const Scene& scene, const Layout& layout, Models& models) {
  std::vector<bool> done(scene.phases.size(), false);
  for (const PlanEntry& e : layout.entries) {
    if (!e.blows || !layout.phases[e.fluid].wind.driven || done[e.other]) continue;
    done[e.other] = true;
    models.push_back(std::make_unique<GrainFlux>(scene, layout, e.fluid, e.other));
  }
}

}  // namespace barchan
