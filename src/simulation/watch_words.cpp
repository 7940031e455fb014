// The slow part of the watch: finds the particle that is wrong and makes the message with the remedy.
#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "engine/exchange.hpp"
#include "output/numbers.hpp"
#include "scene/formula_keys.hpp"
#include "simulation/watch.hpp"

namespace barchan {

namespace {

Vec3 place_of(const PhaseParticles& p, std::size_t k) {
  Vec3 x{};
  for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[k];
  return x;
}

std::string text_of(const Vec3& x, int dimensions) {
  std::string text = "(" + brief(x[0]);
  for (std::size_t d = 1; d < static_cast<std::size_t>(dimensions); ++d) text += ", " + brief(x[d]);
  return text + ") m";
}

double size_of(const PhaseParticles& p, std::size_t k, Field vector) {
  double squares = 0.0;
  for (int d = 0; d < p.dimensions(); ++d) squares += p.column(vector, d)[k] * p.column(vector, d)[k];
  return std::sqrt(squares);
}

}  // namespace

std::string Watch::who(std::size_t phase, std::size_t k, const Moment& now) const {
  const PhaseParticles& p = see_.particles[phase];
  return "particle " + std::to_string(p.id()[k]) + " of phase \"" + p.name() + "\" at " +
         text_of(place_of(p, k), p.dimensions()) + ", t = " + brief(now.time) + " s, step " + std::to_string(now.step);
}

void Watch::tell(const std::string& trouble, const Moment& now) const {
  throw BreakdownError("t = " + brief(now.time) + " s, step " + std::to_string(now.step) + ": " + trouble);
}

/// The key that makes the step shorter.
std::string Watch::step_key() const { return see_.plan.fixed_step > 0 ? "time.step" : "time.safety"; }

std::string Watch::most_accelerated(const Moment& now) const {
  double most = -1.0;
  std::size_t phase = 0, particle = 0;
  for (const Guard& g : guards_) {
    const PhaseParticles& p = see_.particles[g.phase];
    for (std::size_t k = 0; k < p.size(); ++k) {
      double size = 0.0;  // the largest component, as the limit of the step sees it
      for (int d = 0; d < p.dimensions(); ++d) size = std::max(size, std::abs(p.column(Field::acceleration, d)[k]));
      if (size < most || (size == most && p.id()[k] > see_.particles[phase].id()[particle])) continue;
      most = size;
      phase = g.phase;
      particle = k;
    }
  }
  struct Found {
    double most;
    std::int64_t id;
  } found{most, most < 0.0 ? 0 : see_.particles[phase].id()[particle]};
  const int rank = Exchange().best(
      found, [](const Found& a, const Found& b) { return a.most > b.most || (a.most == b.most && a.id < b.id); });
  const bool here = most == found.most && most >= 0.0;
  most = found.most;
  if (most < 0.0) return "no particle";
  return Exchange().text_of(rank, here ? who(phase, particle, now) : "") + ", with an acceleration of " + brief(most) +
         " m/s2";
}

/// What is wrong with a particle, and what to do; nothing if it is within its bounds.
std::optional<std::string> Watch::wrong_with(const Guard& g, std::size_t k, double dt) const {
  const PhaseParticles& p = see_.particles[g.phase];
  const Plan& plan = see_.plan;
  const PhaseRules& rules = plan.phases[g.phase].rules;
  const double spacing = plan.phases[g.phase].spacing;
  for (const Field f : {Field::acceleration, Field::velocity, Field::position})
    for (int d = 0; d < p.dimensions(); ++d)
      if (!std::isfinite(p.column(f, d)[k]))
        return ": " + std::string(info(f).name) + " is not finite; the step was too long or particles overlap: lower " +
               step_key() + ", raise " + rules.remedy(Fault::not_finite, 0.0, 0.0) +
               ", or look for particles in one place in the fills";
  if (auto outside = wrong_place(g, k)) return outside;
  const double speed = size_of(p, k, Field::velocity);
  if (!(speed <= g.signal_speed))
    return " is faster (" + brief(speed) + " m/s, with an acceleration of " +
           brief(size_of(p, k, Field::acceleration)) + " m/s2) than " +
           rules.remedy(Fault::too_fast, speed, g.signal_speed);
  if (!(speed * dt <= g.way))
    return " moves " + brief(speed * dt / spacing) + " spacings in one step (" + brief(speed) + " m/s in " + brief(dt) +
           " s; the bound is " + brief(g.way / spacing) +
           " spacings) and would pass what it meets: " + rules.remedy(Fault::too_far, speed, g.way / dt);
  if (!g.dense) return std::nullopt;
  const double rho = p.column(Field::density)[k];
  if (rho >= g.least_density && rho <= g.most_density) return std::nullopt;
  if (!(rules.density_share > 0.0))
    return ": density " + brief(rho) + " kg/m3 " + rules.remedy(Fault::density, speed, 0.0);
  return ": density " + brief(rho) + " kg/m3 is out of bounds (" + brief(g.least_density) + " to " +
         brief(g.most_density) + "); " + rules.remedy(Fault::density, speed, 0.0);
}

/// Beyond which side a particle is, and what to do; nothing if it is within its bounds.
std::optional<std::string> Watch::wrong_place(const Guard& g, std::size_t k) const {
  const PhaseParticles& p = see_.particles[g.phase];
  for (int d = 0; d < p.dimensions(); ++d) {
    const auto c = static_cast<std::size_t>(d);
    const double x = p.column(Field::position, d)[k];
    if (x >= g.low[c] && x <= g.high[c]) continue;
    const bool low = x < g.low[c];
    const std::string side = std::string(low ? "lower" : "upper") + " side of " + "xyz"[d];
    const int wall = g.closed[c][low ? 0 : 1];
    if (wall >= 0)
      return " passed the wall \"" + see_.plan.phases[static_cast<std::size_t>(wall)].name + "\" at the " + side +
             " (a bound at " + brief(low ? g.low[c] : g.high[c]) +
             " m); the wall could not stop it, it was too fast or pressed too hard: " +
             see_.plan.phases[g.phase].rules.remedy(Fault::passed_wall, 0.0, 0.0);
    const double speed = size_of(p, k, Field::velocity);
    if (given_ > 0.0 && speed > WatchBounds::remarkable_speed * given_)
      return " escaped through the " + side + " at " + brief(speed) + " m/s, " + brief(speed / given_) +
             " times what gravity, forcings, walls and the start can give: the computation gained that energy, no wall "
             "would help: " +
             (see_.plan.phases[g.phase].sphere_records
                  ? "grains that overlap others or a wall at the start are pushed away: move the fills apart, or lower "
                    "the diameter of the wall; else lower " +
                        step_key()
                  : "lower " + step_key() + " or the spacing");
    return " escaped through the " + side +
           "; no wall with which it interacts holds it there: add a wall on that side and an entry of \"" + p.name() +
           "\" with it in [interactions], or enlarge domain.size" +
           (see_.scene.domain.open.empty() ? "" : "; domain.open closes the sides that it does not name");
  }
  return std::nullopt;
}

/// A formula that is not finite is to blame, not the step. Nothing: there is none.
std::optional<std::string> Watch::formula_to_blame(const Moment& now) const {
  for (const Force& f : forces_) {
    const PhaseParticles& p = see_.particles[f.phase];
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Vec3 x = place_of(p, k);
      for (std::size_t d = 0; d < static_cast<std::size_t>(p.dimensions()); ++d) {
        const double value =
            f.acceleration[d].is_constant() ? f.acceleration[d].constant() : f.acceleration[d](x, now.time);
        if (std::isfinite(value) || !std::isfinite(x[0] + x[1] + x[2])) continue;
        return "forcing." + std::to_string(f.number) + ".acceleration: the formula \"" +
               shortened(see_.scene.forcings[f.number].acceleration[d].formula) + "\" gives " + brief(value) + " for " +
               who(f.phase, k, now) + "; expected a finite number at every place and time";
      }
    }
  }
  if (const auto fault = formula_fault()) {
    const std::string keys = keys_of_formula(see_.scene, fault->formula);
    return (keys.empty() ? "" : keys + ": ") + "the formula \"" + shortened(fault->formula) + "\" gives " +
           brief(fault->value) + " at (" + brief(fault->x[0]) + ", " + brief(fault->x[1]) + ", " + brief(fault->x[2]) +
           ") m, t = " + brief(fault->t) + " s; expected " + fault->expected + " at every place and time";
  }
  return std::nullopt;
}

void Watch::tell_worst(const Moment& now) const {
  const auto formula = formula_to_blame(now);
  int blamed = formula ? 1 : 0;
  const int first_to_blame = Exchange().best(blamed, [](int a, int b) { return a > b; });
  if (blamed != 0) throw LastingBreakdown(Exchange().text_of(first_to_blame, formula.value_or("")));
  std::int64_t lowest = -1;
  long wrong = 0;
  std::string what, whom;
  for (const Guard& g : guards_) {
    const PhaseParticles& p = see_.particles[g.phase];
    for (std::size_t k = 0; k < p.size(); ++k) {
      const auto found = wrong_with(g, k, now.dt);
      if (!found) continue;
      if (!p.is_whole() || Exchange::is_first_process()) ++wrong;
      if (lowest >= 0 && p.id()[k] > lowest) continue;
      lowest = p.id()[k];
      what = *found;
      whom = who(g.phase, k, now);
    }
  }
  wrong = static_cast<long>(Exchange().total(std::int64_t{wrong}));
  std::int64_t of_all = lowest;
  const int rank = Exchange().best(of_all, [](std::int64_t a, std::int64_t b) { return a >= 0 && (b < 0 || a < b); });
  whom = Exchange().text_of(rank, whom + what);
  what.clear();
  if (wrong == 0) throw BreakdownError("a sum of accelerations is not finite; " + most_accelerated(now));
  throw BreakdownError(whom + what + (wrong > 1 ? " (" + std::to_string(wrong) + " particles are wrong)" : ""));
}

void Watch::tell_pair(const Apart& pair, const Moment& now) const {
  const PhaseParticles &a = see_.particles[pair.a], &b = see_.particles[pair.b];
  const PairList& list = see_.neighbours.list(static_cast<std::size_t>(pair.list));
  const Record record = pair.stress ? Record::stress : Record::motion;
  const RecordArray &own = see_.work.records(pair.a, record), &others = see_.work.records(pair.b, record);
  const CellGrid& grid = see_.neighbours.grid(pair.b);
  std::size_t first = 0, with = 0;
  double distance = 0.0;
  bool any = false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (any && a.id()[k] > a.id()[first]) continue;
    const auto row = list.row(k);
    double least = pair.distance;
    for (const std::uint32_t* q = row.begin; q != row.end; ++q) {
      const std::size_t at = *q / PairList::stride, image = at - b.size();
      if (at >= b.size() && image >= grid.images()) continue;  // the dummy
      double r2 = 0.0;
      for (std::size_t d = 0; d < static_cast<std::size_t>(a.dimensions()); ++d)
        r2 += std::pow(own[k][d] - others[at][d], 2);
      if (!(std::sqrt(r2) < least)) continue;
      least = distance = std::sqrt(r2);
      first = k;
      with = at < b.size() ? at : grid.image_list()[image].source;
      any = true;
    }
  }
  std::int64_t lowest = any ? a.id()[first] : -1;  // a row may be that of one rank alone
  const int rank = Exchange().best(lowest, [](std::int64_t x, std::int64_t y) { return x >= 0 && (y < 0 || x < y); });
  const double spacing = 0.5 * (see_.plan.phases[pair.a].spacing + see_.plan.phases[pair.b].spacing);
  const std::string near = brief(distance / spacing) + " spacings (bound " + brief(pair.distance / spacing) + ")";
  const std::string stiffer = see_.plan.phases[pair.a].rules.remedy(Fault::too_near, 0.0, 0.0);
  const std::string what = see_.plan.phases[pair.b].moves()
                               ? " is in the same place as " + see_.plan.phases[pair.b].rules.one + " " +
                                     std::to_string(b.id()[with]) + " of phase \"" + b.name() + "\": they are " + near +
                                     " apart; the contact could not keep them apart, or "
                               : " is deep in the wall \"" + b.name() + "\", " + near +
                                     " from a particle of it; it was too fast or pressed too hard for the contact, or ";
  throw BreakdownError(Exchange().text_of(
      rank, who(pair.a, first, now) + what + "the fills overlap: raise " + stiffer + ", or move the fills apart"));
}

/// Pairing: the kernel no longer separates two particles. A fault when more than a share is nearer than pair_distance
/// to another particle. A sample decides whether all are counted: of one in `thinning` particles, or of `close_sample`
/// particles before a state is written or kept on demand. A row of neighbours in 3D has some 250, so that all of them
/// would take as long as some steps. Of 4096 particles with the share `paired` 205 are expected in pairs, with a
/// deviation of 14, and 61 make all be counted.
void Watch::look_for_pairing(const Guard& g, const Moment& now, bool all) const {
  const PhaseParticles& p = see_.particles[g.phase];
  const double near2 = std::pow(WatchBounds::pair_distance * see_.plan.phases[g.phase].spacing, 2);
  const auto own = static_cast<std::int64_t>(p.size()), before = static_cast<std::int64_t>(Exchange().before(p.size())),
             n = Exchange().total(own);
  take_places_of_ghosts(g.phase);
  const auto share = [&](std::int64_t first, std::int64_t stride) {
    std::int64_t near = 0, seen = 0;
    const std::int64_t start = ((first - before) % stride + stride) % stride;
#pragma omp parallel for schedule(static) reduction(+ : near, seen)
    for (std::int64_t k = start; k < own; k += stride) {
      near += nearest(g, static_cast<std::size_t>(k)) < near2 ? 1 : 0;
      ++seen;
    }
    near = Exchange().total(near);
    seen = Exchange().total(seen);
    return seen > 0 ? static_cast<double>(near) / static_cast<double>(seen) : 0.0;
  };
  constexpr std::int64_t least_sample = 128, thinning = 64, close_sample = 4096;
  const std::int64_t stride = std::max<std::int64_t>(1, all ? n / close_sample : std::min(thinning, n / least_sample));
  if (stride > 1 && share(looks_ / 2 % stride, stride) < 0.3 * WatchBounds::paired) return;
  const double paired = share(0, 1);
  if (paired <= WatchBounds::paired) return;
  std::size_t first = 0;
  std::int64_t lowest = -1;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (!(nearest(g, k) < near2) || (lowest >= 0 && p.id()[k] > lowest)) continue;
    lowest = p.id()[k];
    first = k;
  }
  std::int64_t of_all = lowest;
  const int rank = Exchange().best(of_all, [](std::int64_t a, std::int64_t b) { return a >= 0 && (b < 0 || a < b); });
  throw BreakdownError(Exchange().text_of(rank, lowest >= 0 ? who(g.phase, first, now) : "") + " and " +
                       brief(100.0 * paired) + " % of its phase stand in pairs, nearer than " +
                       brief(WatchBounds::pair_distance) + " spacings to another (bound " +
                       brief(100.0 * WatchBounds::paired) + " %); " + unpairing(g));
}

/// What keeps particles from standing in pairs.
std::string Watch::unpairing(const Guard& g) const {
  const Plan& plan = see_.plan;
  const std::string& name = plan.phases[g.phase].name;
  double stable = 1e300;
  for (const auto& l : plan.limits) stable = std::min(stable, l.value);
  if (plan.fixed_step > 1.001 * stable)
    return "the step is longer than the one that is stable (" + brief(plan.fixed_step) + " s and " + brief(stable) +
           " s): lower time.step, or leave it out";
  const auto own = std::find_if(plan.entries.begin(), plan.entries.end(),
                                [&](const PlanEntry& e) { return e.a == g.phase && e.b == g.phase; });
  return "the kernel does not keep particles apart: " +
         std::string(own->kernel == KernelKind::wendland_c2
                         ? ""
                         : "choose kernel = \"wendland-c2\" for interactions." + name + "-" + name + ", or ") +
         "raise phases." + name + ".shifting or lower " + step_key();
}

/// The largest kinetic energy that laws can have fed: with forces f per mass, sqrt(2 E/M) grows by no more than the
/// integral of |f| (Cauchy and Schwarz); a fall through the domain gives sqrt(2 g L) at most; moving walls give their
/// speed; the pressure of the beginning, and disorder, what start_energy_ holds.
void Watch::look_at_energy(const Moment& now) {
  forced_ += strongest_force(now) * std::max(now.time - last_time_, 0.0);
  last_time_ = now.time;
  if (torques_) return;
  double speed = start_speed_ + forced_;
  for (std::size_t d = 0; d < static_cast<std::size_t>(see_.plan.dimensions); ++d) {
    const double g = std::abs(see_.scene.domain.gravity[d]);
    speed += see_.plan.bounds.periodic[d] ? g * now.time
                                          : std::min(g * now.time, std::sqrt(2.0 * g * see_.scene.domain.size[d]));
  }
  double walls = 0.0;
  for (std::size_t k = 0; k < see_.particles.size(); ++k)
    if (!see_.plan.phases[k].moves()) {
      const bool here = see_.particles[k].size() > 0;
      walls = std::max(walls, Exchange().of_first(here, here ? size_of(see_.particles[k], 0, Field::velocity) : 0.0));
    }
  wall_speed_ = std::max(wall_speed_, walls);
  speed += wall_speed_;
  note_speed(speed - start_speed_, now);
  double mass = 0.0;  // of more particles than at the start: those that entered have no more than the largest speed
  for (const Guard& g : guards_) {
    const PhaseParticles& p = see_.particles[g.phase];
    const Exchange among(p);
    mass += p.mass() * static_cast<double>(among.total(p.size()));
  }
  const double bound = WatchBounds::energy * 0.5 * std::max(mass, mass_) * speed * speed;
  if (energy_ <= bound) return;
  throw BreakdownError("the kinetic energy of all particles, " + brief(energy_) + " J, is more than " +
                       brief(WatchBounds::energy) +
                       " times what gravity, forcings, walls and the start can have fed (" +
                       brief(bound / WatchBounds::energy) + " J) at t = " + brief(now.time) + " s, step " +
                       std::to_string(now.step) + "; the scheme feeds energy in: lower " + step_key() +
                       ", raise the sound speed, the viscosity or the artificial-viscosity; " + most_accelerated(now));
}

void Watch::note_density(const Guard& g, double error, const Moment& now) {
  if (error < WatchBounds::remarkable_density || error < 1.01 * extreme_.error) return;
  const PhaseParticles& p = see_.particles[g.phase];
  const double* rho = p.column(Field::density);
  Extreme found{-1.0, 0.0, now.time, g.phase, 0, {}, now.step};
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double e = std::abs(rho[k] / g.reference_density - 1.0);
    if (!(e > found.error) && !(e == found.error && p.id()[k] < found.id)) continue;
    found.error = e;
    found.value = rho[k];
    found.id = p.id()[k];
    found.place = place_of(p, k);
  }
  Exchange(p).best(found, [](const Extreme& a, const Extreme& b) {
    return a.error > b.error || (a.error == b.error && a.id < b.id);
  });
  extreme_ = found;
}

/// Of a fluid particle that is much faster than gravity, forcings, walls and the start can have made it (m/s).
void Watch::note_speed(double given, const Moment& now) {
  given = given_ = std::max({given, see_.plan.largest_speed, start_fastest_});
  for (const Guard& g : guards_) {
    const PhaseParticles& p = see_.particles[g.phase];
    const double speed = fastest_of_[g.phase];
    if (!see_.plan.phases[g.phase].flows() || !(speed > WatchBounds::remarkable_speed * given) ||
        speed < 1.01 * fastest_.value)
      continue;
    Extreme found{speed / given, -1.0, now.time, g.phase, 0, {}, now.step};
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double v = size_of(p, k, Field::velocity);
      if (v < found.value || (v == found.value && p.id()[k] > found.id)) continue;
      found.value = v;
      found.id = p.id()[k];
      found.place = place_of(p, k);
    }
    Exchange().best(found, [](const Extreme& a, const Extreme& b) {
      return a.value > b.value || (a.value == b.value && a.id < b.id);
    });
    fastest_ = found;
  }
}

void Watch::report(Warnings& warnings) const {
  if (fastest_.error > 0.0)
    warnings.add("speed", "a particle of \"" + see_.particles[fastest_.phase].name() + "\" reached " +
                              brief(fastest_.value) + " m/s, " + brief(fastest_.error) +
                              " times what gravity, forcings, walls and the start can give (particle " +
                              std::to_string(fastest_.id) + " at " + text_of(fastest_.place, see_.plan.dimensions) +
                              ", t = " + brief(fastest_.time) + " s, step " + std::to_string(fastest_.step) +
                              "): single drops are not to be trusted there; scheme = \"consistent\" or slip = "
                              "\"no-slip\" of the wall may help");
  if (extreme_.error < WatchBounds::remarkable_density) return;
  const PhaseParticles& p = see_.particles[extreme_.phase];
  warnings.add("density", "the density of \"" + p.name() + "\" was off by " + brief(100.0 * extreme_.error) +
                              " % (particle " + std::to_string(extreme_.id) + " at " +
                              text_of(extreme_.place, p.dimensions()) + ", t = " + brief(extreme_.time) + " s, step " +
                              std::to_string(extreme_.step) +
                              "); a weakly compressible fluid should stay within 1 %: raise phases." + p.name() +
                              ".sound-speed where the flow is faster than a tenth of it, else lower the spacing or "
                              "raise the radius of interactions." +
                              p.name() + "-" + p.name());
}

void Watch::archive(Archive& a) {
  a.number("watch: next look", next_);
  a.number("watch: looks", looks_);
  a.number("watch: energy of the start", start_energy_);
  a.number("watch: speed of the start", start_speed_);
  a.number("watch: speed given by forces", forced_);
  a.number("watch: time of the last look", last_time_);
  a.number("watch: fastest", last_fastest_);
  a.number("watch: fastest wall", wall_speed_);
  a.number("watch: largest density error", extreme_);
  a.number("watch: fastest of a fluid", fastest_);
  a.number("watch: fastest at the start", start_fastest_);
  if (a.loads()) forget();
}

std::size_t Watch::bytes() const { return good_.bytes() + parts_.size() * sizeof(Part); }

}  // namespace barchan
