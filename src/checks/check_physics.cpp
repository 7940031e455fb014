// Physics that no law can do, and keys that nothing reads where they stand.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "checks/checks.hpp"
#include "scene/contact_words.hpp"
#include "scene/couplings.hpp"

namespace barchan {
namespace {

bool is_zero(const VectorExpression& vector) {
  return std::all_of(vector.begin(), vector.end(),
                     [](const Expression& e) { return !e.is_formula() && e.value == 0.0; });
}

/// The checks of one scene. A phase whose kind is not known and a pair that is not one are left out.
class PhysicsChecker {
 public:
  PhysicsChecker(const Scene& scene, const Report& report)
      : scene_(scene),
        report_(report),
        pairs_known_(!report.misread("interactions")),
        sound_speed_known_(some_speed_is_known()) {}

  void fluid(const Phase& fluid) {
    const FluidKeys& own = fluid.fluid();
    const std::string dotted = place(fluid);
    if (report_.has(dotted + ".tait-exponent") && own.equation_of_state != EquationOfState::tait)
      tell(dotted + ".tait-exponent",
           "the linear equation of state has no exponent; expected equation-of-state = \"tait\" too");
    if (report_.has(dotted + ".smagorinsky") && own.turbulence != Turbulence::smagorinsky)
      tell(dotted + ".smagorinsky", "nothing reads it; expected turbulence = \"smagorinsky\" too");
    if (!sound_speed_known_ && !own.sound_speed)
      tell(dotted + ".sound-speed",
           "missing: nothing in the scene moves or weighs, so that none can be chosen; expected sound-speed or "
           "time.largest-speed");
    const bool eddies = has_eddies(scene_, fluid), plain = own.scheme == FluidScheme::plain;
    if (pairs_known_ && eddies && plain)
      tell(dotted + ".scheme",
           "eddy viscosity, rough walls and given shear stresses need corrected operators; expected \"consistent\"");
    if (own.energy && (!plain || eddies))
      tell(dotted + ".energy",
           "the internal energy of a fluid is computed with the plain sums only; expected scheme = \"plain\" and no "
           "turbulence with it, or no such key");
    if (!pairs_known_) return;
    if (!entry_between(scene_, fluid, fluid))
      tell("interactions." + fluid.name + "-" + fluid.name,
           "missing: a fluid needs an entry with itself; expected " + fluid.name + "-" + fluid.name + " = 2.1");
    if ((own.turbulence == Turbulence::k_omega || own.turbulence == Turbulence::mixing_length) && !has_ground(fluid))
      tell(dotted + ".turbulence",
           std::string(own.turbulence == Turbulence::k_omega ? "\"k-omega\"" : "a mixing length") +
               " needs ground, and this fluid touches no wall with friction and no grains; expected such an "
               "entry in [interactions], or \"smagorinsky\"");
  }

  void grains(const Phase& grains) {
    const std::string dotted = place(grains);
    const bool read = std::any_of(scene_.phases.begin(), scene_.phases.end(), [&](const Phase& fluid) {
      const Interaction* pair = entry_between(scene_, grains, fluid);
      return pair && !(pair->drag > 0.0) && has_eddies(scene_, fluid);
    });
    if (pairs_known_ && report_.has(dotted + ".roughness") && !read)
      tell(dotted + ".roughness",
           "roughness of grains acts only on a turbulent fluid whose entry has no drag; expected turbulence in a fluid "
           "that has an entry with "
           "\"" +
               grains.name + "\"");
  }

  /// The keys of grains that only some laws of spheres read, each once.
  static std::set<std::string> keys_of_some_laws(const Phase& phase) {
    std::set<std::string> keys;
    for (const SphereLawKeys& row : sphere_laws)
      for (const std::string_view key : {row.stiffness, row.others[0], row.others[1]})
        if (phase.if_grains() && !key.empty()) keys.emplace(key);
    return keys;
  }

  /// A distribution of diameters: one, and one that can be.
  void sizes(const SphereSize& size, const std::string& dotted) {
    if (report_.touched(dotted + ".sieve") || report_.touched(dotted + ".mean")) return;
    std::vector<std::string> given;
    for (const char* key : {"spread", "log-normal", "sieve"})
      if (report_.has(dotted + "." + key)) given.emplace_back(key);
    if (given.size() > 1)
      tell(dotted + "." + given[1], given[0] + " says how the diameters differ; expected one of the two");
    if (size.sieve.empty()) {
      if (!(size.mean > 0.0) && report_.has(dotted)) tell(dotted + ".mean", "missing; expected it, or a sieve curve");
      return;
    }
    constexpr double widest = 20.0;  // largest over smallest diameter
    bool rises = size.sieve.front()[0] > 0.0;
    for (std::size_t k = 1; k < size.sieve.size(); ++k)
      rises = rises && size.sieve[k][0] > size.sieve[k - 1][0] && size.sieve[k][1] >= size.sieve[k - 1][1];
    if (!rises || size.sieve.front()[1] != 0.0 || size.sieve.back()[1] != 1.0)
      tell(dotted + ".sieve", "not a sieve curve; expected rising diameters above 0, and shares that go from 0 to 1");
    else if (size.largest() > widest * size.least())
      tell(dotted + ".sieve", "the largest grain is " + number_text(size.largest() / size.least()) +
                                  " times as wide as the smallest; expected at most " + number_text(widest));
    else if (!(size.mean >= size.least() && size.mean <= size.largest()))
      tell(dotted + ".mean", "no diameter of the sieve curve; expected one, or no such key");
  }

  /// Spheres and what only they have.
  void spheres(const Phase& phase) {
    const std::string dotted = place(phase);
    const auto without = [&](const std::string& key, const std::string& needs) {
      if (report_.has(dotted + "." + key)) tell(dotted + "." + key, "nothing reads it; expected " + needs);
    };
    if (!phase.diameter()) {
      for (const char* key : {"material", "friction", "rolling-friction", "largest-overlap", "sleep"})
        without(key, "diameter too");
      for (const std::string& key : keys_of_some_laws(phase)) without(key, "diameter too");
      return;
    }
    sizes(*phase.diameter(), dotted + ".diameter");
    if (!pairs_known_) return;
    const bool touches = touches_as_spheres(scene_, phase);
    if (phase.kind() == PhaseKind::wall) {
      if (!touches) without("diameter", "an entry with grains and " + sphere_laws_that_read(""));
      return;
    }
    bool all_stiff = touches;  // each law of the phase has its key
    std::vector<const SphereLawKeys*> laws;
    for (const SphereLawKeys& row : sphere_laws)
      if (touches_by(scene_, phase, row.law)) {
        laws.push_back(&row);
        all_stiff = all_stiff && report_.has(dotted + "." + std::string(row.stiffness));
      }
    for (const std::string& key : keys_of_some_laws(phase))
      if (std::none_of(laws.begin(), laws.end(), [&](const SphereLawKeys* row) { return row->reads(key); }))
        without(key, "an entry with " + sphere_laws_that_read(key));
    if (!touches)
      for (const char* key : {"material", "friction", "rolling-friction", "largest-overlap", "restitution"})
        without(key, "an entry with " + sphere_laws_that_read(""));
    const GrainsKeys& own = *phase.if_grains();
    if (all_stiff)
      without("largest-overlap", "no such key: " + sphere_stiffness_keys(" or ") + " says how stiff contacts are");
    if (own.sleep && norm(scene_.domain.gravity) == 0.0)
      tell(dotted + ".sleep", "nothing holds grains in place without weight; expected gravity, or no such key");
    without("contact-speed", "stiffness, young or largest-overlap, which spheres have");
    if (!(own.friction > 0.0)) without("tangential-stiffness", "friction above 0");
    if (own.restitution < 0.05 && !report_.touched(dotted + ".restitution"))
      tell(dotted + ".restitution", "the dashpot of spheres cannot take that much; expected at least 0.05");
  }

  void contact(const Interaction& pair, const Phase& a, const Phase& b, const std::string& dotted) {
    const bool some_grains = a.kind() == PhaseKind::grains || b.kind() == PhaseKind::grains;
    const auto grains_or_wall = [&](const Phase& p) {
      return p.kind() == PhaseKind::grains || p.kind() == PhaseKind::wall ||
             (p.kind() == PhaseKind::rigid && some_grains);
    };
    if (!of_spheres(pair)) {
      for (const Phase* p : {&a, &b})
        if (p->if_grains() && p->diameter() && grains_or_wall(a) && grains_or_wall(b))
          tell(dotted, "\"" + p->name + "\" has a diameter: its grains are spheres; expected { " +
                           sphere_laws_that_read("") + " }");
      return;
    }
    if (!grains_or_wall(a) || !grains_or_wall(b))
      return tell(dotted + ".law",
                  "only grains touch as spheres, each other, walls and rigid bodies; expected no such key here");
    if (report_.has(dotted + ".radius"))
      tell(dotted + ".radius", "spheres interact when they touch; expected no such key with law");
    if (report_.has(dotted + ".kernel"))
      tell(dotted + ".kernel", "a contact of spheres has no kernel; expected no such key with law");
    for (const Phase* p : {&a, &b})
      if (p->if_grains() && !p->diameter())
        tell(place(*p) + ".diameter", "missing: the contacts " + pair.a + "-" + pair.b +
                                          " are of spheres; expected diameter = a number > 0 (m)");
  }

  /// What the layers of models/coupling/sand_layer.hpp need.
  void wind_over_sand(const Interaction& pair, const Phase& fluid, const Phase& grains, const std::string& dotted) {
    const std::string drag = dotted + ".drag", why = "a law of drag by name needs ";
    const Vec3& g = scene_.domain.gravity;
    const bool wrong_itself = report_.touched(drag);
    const auto needs = [&](const std::string& what) {  // all of them at once, though they stand at one key
      if (!wrong_itself) report_(drag, why + what);
    };
    for (const char* key : {".radius", ".radius-in-metres", ".kernel"})
      if (report_.has(dotted + key))
        tell(dotted + key, "with a law of drag by name the mean wind about a grain acts on it; expected no such key");
    if (pair.drag_law == DragLaw::di_felice)
      tell(drag, "crowded drag acts in air of kind column; expected stokes, schiller-naumann, cheng or duran");
    if (!(g[1] < 0.0) || g[0] != 0.0) needs("gravity along -y; expected domain.gravity = [0, -9.81]");
    if (!grains.diameter()) tell(place(grains) + ".diameter", why + "spheres; expected a number > 0 (m)");
    else if (fluid.spacing < 2.0 * grains.diameter()->mean)
      needs("air coarser than the grains; expected a spacing of \"" + fluid.name +
            "\" of two diameters or more, or a number");
    const Turbulence turbulence = fluid.fluid().turbulence;
    if ((turbulence != Turbulence::mixing_length && turbulence != Turbulence::k_omega) ||
        fluid.fluid().scheme != FluidScheme::consistent || !(fluid.fluid().viscosity > 0.0))
      needs(
          "a turbulent wind; expected scheme = \"consistent\", turbulence = \"mixing-length\" or \"k-omega\" and a "
          "viscosity above 0 of "
          "\"" +
          fluid.name + "\"");
    const bool ground = std::any_of(scene_.fills.begin(), scene_.fills.end(), [&](const Fill& fill) {
      const Phase* wall = find_phase(scene_, fill.phase);
      return wall && wall->if_wall() && wall->wall().roughness && fill.packing == Packing::fitted &&
             std::holds_alternative<BedShape>(fill.shape) && entry_between(scene_, fluid, *wall);
    });
    several_airs(pair, fluid, grains, dotted);
    for (const Phase& other : scene_.phases) {
      const Interaction* const its = other.if_grains() ? entry_between(scene_, other, fluid) : nullptr;
      if (its && its != &pair && its->drag_law != DragLaw::none)
        needs("one phase of grains in its air, whose momentum one exchange keeps, and \"" + other.name +
              "\" is another; expected one phase with sizes that differ (log-normal, sieve), or air of kind column");
    }
    if (!ground)
      needs("ground under the wind; expected a wall that \"" + fluid.name +
            "\" interacts with, with a roughness, shape = { bed = ... } and packing = \"fitted\"");
  }

  /// Grains that fly from one phase of an air into another feel both by one law (models/coupling/airs.hpp).
  void several_airs(const Interaction& pair, const Phase& fluid, const Phase& grains, const std::string& dotted) {
    for (const Phase& other : scene_.phases) {
      if (other.kind() != PhaseKind::fluid || other.name == fluid.name) continue;
      const Interaction *joint = entry_between(scene_, fluid, other), *its = entry_between(scene_, grains, other);
      const bool drags = its && its->drag_law != DragLaw::none;
      if (joint && !drags) {
        tell(dotted + ".drag", "grains that fly from \"" + fluid.name + "\" into \"" + other.name +
                                   "\", which is joined to it, would not be driven; expected an entry " + other.name +
                                   "-" + grains.name + " with the same drag");
        continue;
      }
      if (!drags) continue;
      if (other.spacing == fluid.spacing || fluid.density != other.density ||
          fluid.fluid().viscosity != other.fluid().viscosity)
        tell(dotted + ".drag", "\"" + grains.name + "\" interacts with two airs, \"" + fluid.name + "\" and \"" +
                                   other.name +
                                   "\"; expected phases of one air, with the same density and viscosity and spacings "
                                   "that differ");
      if (its->drag_law != pair.drag_law)
        tell(dotted + ".drag",
             "another law than that of \"" + other.name + "\", which is the same air; expected one law");
      if (other.spacing < fluid.spacing)
        for (const char* key : {".lift", ".gusts", ".coupling-interval"})
          if (report_.has(dotted + key))
            tell(dotted + key, "only near the ground, in the layers of the finest air, \"" + other.name +
                                   "\", it acts; expected no such key here");
    }
  }

  /// Grains that feel a fluid through a kernel are sources of no volume: in a fluid nearly as heavy as they are, what
  /// they displace and drag along with them is missing, and they outrun free fall.
  void heavy_fluid(const Phase& fluid, const Phase& grains, const std::string& dotted) {
    constexpr double most = 0.05;
    if (fluid.density <= most * grains.density || report_.touched(place(fluid) + ".density") ||
        report_.touched(place(grains) + ".density"))
      return;
    tell(dotted,
         "a kernel couples grains to a fluid that is much lighter than they are (at most " + number_text(most) +
             " times as dense); \"" + fluid.name + "\" is " + number_text(fluid.density / grains.density) +
             " times as dense as \"" + grains.name +
             "\"; expected a fluid of kind column with drag by name and buoyancy = true, or bodies of kind rigid");
  }

  void buoyancy(const Interaction& pair, const Phase& a, const Phase& b, const std::string& dotted) {
    if (!pair.buoyancy) return;
    const bool first = a.kind() == PhaseKind::grains;
    const Phase &grains = first ? a : b, &fluid = first ? b : a;
    const bool column = fluid.kind() == PhaseKind::column;
    const std::string place = dotted + ".buoyancy";
    if (grains.kind() != PhaseKind::grains ||
        !(column || (fluid.kind() == PhaseKind::fluid && pair.drag_law != DragLaw::none)))
      return tell(place,
                  "only the entry of grains with a column, or with a fluid and a law of drag by name, has it (a kernel "
                  "gives grains the fluid's pressure, which bears them); expected no such key");
    if (norm(scene_.domain.gravity) == 0.0)
      return tell(place, "nothing has a weight; expected domain.gravity, or no such key");
    if (!(fluid.density < grains.density))
      tell(place, "\"" + grains.name + "\" would float in \"" + fluid.name +
                      "\"; expected a density of the grains above that of the fluid");
  }

  void magnus(const Interaction& pair, const Phase& a, const Phase& b, const std::string& place) {
    if (!pair.magnus) return;
    const Phase &grains = a.kind() == PhaseKind::grains ? a : b, &fluid = &grains == &a ? b : a;
    const bool column = fluid.kind() == PhaseKind::column;
    if (grains.kind() != PhaseKind::grains ||
        !(column || (fluid.kind() == PhaseKind::fluid && pair.drag_law != DragLaw::none)))
      return tell(place,
                  "only the entry of grains with a column, or with a fluid and a law of drag by name, has it; expected "
                  "no such key");
    const GrainsKeys& keys = grains.grains();
    if (!(keys.friction > 0.0 || keys.rolling_friction > 0.0) || !touches_as_spheres(scene_, grains))
      tell(place, "\"" + grains.name +
                      "\" does not turn; expected spheres that touch by a law, with friction, or no such key");
  }

  /// What models/fluid/spacing_border.hpp needs: two phases that differ in nothing but their spacing.
  void border(const Interaction& pair, const Phase& a, const Phase& b, const std::string& at) {
    if (!report_.has(at)) return;
    if (a.kind() != PhaseKind::fluid || b.kind() != PhaseKind::fluid || a.name == b.name)
      return tell(at, "only two phases of one fluid pass it on to each other; expected no such key here");
    if (!pair.border.is_formula())
      return tell(at,
                  "a number has one sign everywhere; expected a formula that is below zero where the finer particles "
                  "are, as \"y - 0.05\"");
    const FluidKeys &p = a.fluid(), &q = b.fluid();
    const auto alike = [&](const char* key, bool same) {
      if (!same && !report_.touched(place(a) + "." + key) && !report_.touched(place(b) + "." + key))
        tell(at, std::string("a particle that is passed on keeps all it has, and \"") + a.name + "\" and \"" + b.name +
                     "\" differ in " + key + "; expected the same in both, or no border");
    };
    for (const Phase* fluid : {&a, &b})
      if (fluid->fluid().scheme == FluidScheme::plain)
        tell(at, "plain sums have no two spacings; expected scheme = \"consistent\" of \"" + fluid->name + "\"");
    alike("density", a.density == b.density);
    alike("viscosity", p.viscosity == q.viscosity);
    alike("sound-speed", p.sound_speed == q.sound_speed);
    alike("equation-of-state", p.equation_of_state == q.equation_of_state);
    alike("tait-exponent", p.tait_exponent == q.tait_exponent);
    alike("background-pressure", p.background_pressure == q.background_pressure);
    alike("turbulence", p.turbulence == q.turbulence);
    const double ratio = std::max(a.spacing, b.spacing) / std::min(a.spacing, b.spacing);
    if (!(std::abs(ratio - 2.0) < 1e-6) && !report_.touched(place(a) + ".spacing") &&
        !report_.touched(place(b) + ".spacing"))
      tell(at, "a coarse particle becomes " + std::string(scene_.dimensions == 2 ? "4" : "8") +
                   " fine ones; expected spacings 1 to 2, and they are 1 to " + number_text(ratio));
  }

  void pair(const Interaction& pair, const Phase& a, const Phase& b) {
    const std::string dotted = "interactions." + pair.a + "-" + pair.b;
    const auto is = [&](PhaseKind k, PhaseKind l) {
      return (a.kind() == k && b.kind() == l) || (a.kind() == l && b.kind() == k);
    };
    using enum PhaseKind;
    const bool by_name = pair.drag_law != DragLaw::none && is(fluid, grains);
    for (const char* key : {".lift", ".gusts"})
      if (report_.has(dotted + key) && !by_name && !is(column, grains))
        tell(
            dotted + key,
            "only the entry of a column, or of a fluid with a law of drag by name, as drag = \"duran\", and grains has "
            "it; expected no such key");
    if (report_.has(dotted + ".coupling-interval") && !by_name)
      tell(dotted + ".coupling-interval",
           "only the entry of a fluid of particles and grains with a law of drag by name, as drag = \"duran\", has "
           "it; expected no such key");
    border(pair, a, b, dotted + ".border");
    buoyancy(pair, a, b, dotted);
    magnus(pair, a, b, dotted + ".magnus");
    contact(pair, a, b, dotted);
    if (of_spheres(pair) || touch_as_bodies(pair, a, b)) return;
    if (report_.has(dotted + ".drag") && !is(fluid, grains) && !is(column, grains))
      tell(dotted + ".drag", "only a fluid or a column with grains has a drag; expected no such key here");
    const bool touches =
        (a.kind() != fluid && b.kind() != fluid && !is(elastic, elastic)) || repulsive(a) || repulsive(b);
    if (pair.drag_law != DragLaw::none && is(fluid, grains))
      return wind_over_sand(pair, a.kind() == fluid ? a : b, a.kind() == fluid ? b : a, dotted);
    if (a.kind() == column || b.kind() == column) return;  // check_column.cpp
    if (is(fluid, grains)) heavy_fluid(a.kind() == fluid ? a : b, a.kind() == fluid ? b : a, dotted);
    if (report_.has(dotted + ".radius") && report_.has(dotted + ".radius-in-metres"))
      tell(dotted + ".radius-in-metres", "a radius in metres and one in spacings; expected one of the two");
    if (pair.radius_in_metres && !(pair.radius <= 8.0))
      tell(dotted + ".radius-in-metres", number_text(*pair.radius_in_metres) + " m is " + number_text(pair.radius) +
                                             " spacings of the coarser phase; expected at most 8");
    if (pair.radius == 0.0)
      tell(dotted + ".radius", std::string("missing: none is recommended for ") +
                                   (touches ? "repulsive walls" : "elastic bodies") +
                                   "; expected a number > 0 and <= 8 (spacings)");
    else if (touches && pair.radius <= 1.0)
      tell(report_.has(dotted + ".radius") ? dotted + ".radius" : dotted,
           "a contact needs a radius beyond one spacing, so that particles that touch interact; expected more than "
           "1, as 1.1 (eq. 16 of Halik et al. 2015)");
    if (is(fluid, fluid)) fluids(pair, a, b, dotted);
  }

  void time() {
    if (scene_.time.fixed_step && report_.has("time.safety"))
      tell("time.safety", "a fixed step has no stability limit to multiply; expected either step or safety");
  }

 private:
  static std::string place(const Phase& phase) { return "phases." + phase.name; }
  static bool repulsive(const Phase& p) { return p.kind() == PhaseKind::wall && p.wall().law == WallLaw::repulsive; }

  void tell(const std::string& dotted, const std::string& what) const {
    if (!report_.touched(dotted)) report_(dotted, what);
  }

  void fluids(const Interaction& pair, const Phase& a, const Phase& b, const std::string& dotted) const {
    const bool consistent = a.fluid().scheme == FluidScheme::consistent || b.fluid().scheme == FluidScheme::consistent;
    if ((consistent || has_eddies(scene_, a)) && pair.kernel != KernelKind::wendland_c2 && a.name == b.name)
      tell(report_.has(dotted + ".kernel") ? dotted + ".kernel" : "interactions.kernel",
           "the consistent scheme has no pressure that keeps particles apart, and under the cubic spline they pair (" +
               pair.a + "-" + pair.b + "); expected \"wendland-c2\"");
    if (a.density != b.density && (has_eddies(scene_, a) || has_eddies(scene_, b)))
      tell(dotted,
           "a turbulent fluid cannot touch one of another density yet; expected turbulence = \"none\", or no such "
           "entry");
    for (const Phase* fluid : {&a, &b})
      if (consistent && fluid->fluid().scheme == FluidScheme::plain)
        tell(place(*fluid) + ".scheme",
             "two fluids that meet need one scheme; expected \"consistent\", or no entry " + pair.a + "-" + pair.b);
  }

  bool has_ground(const Phase& fluid) const {
    return std::any_of(scene_.phases.begin(), scene_.phases.end(), [&](const Phase& other) {
      const bool ground =
          other.kind() == PhaseKind::grains || (other.kind() == PhaseKind::wall && !repulsive(other) &&
                                                other.wall().slip == Slip::no_slip && !other.wall().shear_stress);
      return ground && entry_between(scene_, fluid, other);
    });
  }

  /// What plan.cpp chooses a sound speed from, as far as the document says it. What is in doubt counts as known.
  bool some_speed_is_known() const {
    if (report_.touched("time") || report_.touched("domain") || report_.misread("fill") || report_.misread("phases") ||
        report_.touched("motion"))
      return true;
    const auto moves = [](const Fill& f) {
      return !is_zero(f.velocity) || (f.log_profile && f.log_profile->friction_velocity != 0.0);
    };
    const auto drives = [](const Motion& m) {
      return !is_zero(m.velocity) || (m.angular_velocity && !is_zero(m.angular_velocity->about));
    };
    return scene_.time.largest_speed > 0.0 || norm(scene_.domain.gravity) > 0.0 ||
           std::any_of(scene_.fills.begin(), scene_.fills.end(), moves) ||
           std::any_of(scene_.motions.begin(), scene_.motions.end(), drives) ||
           std::any_of(scene_.phases.begin(), scene_.phases.end(),
                       [](const Phase& p) { return p.kind() == PhaseKind::wall && !is_zero(p.wall().velocity); });
  }

  const Scene& scene_;
  const Report& report_;
  bool pairs_known_, sound_speed_known_;
};

}  // namespace

void check_physics(const Scene& scene, const Report& report) {
  const auto kind_known = [&](const Phase& phase) { return !report.touched("phases." + phase.name + ".kind"); };
  const bool all_known = std::all_of(scene.phases.begin(), scene.phases.end(), kind_known);
  PhysicsChecker checker(scene, report);
  for (const Phase& phase : scene.phases)
    if (all_known && phase.kind() == PhaseKind::fluid) checker.fluid(phase);
  for (const Phase& phase : scene.phases) {
    if (all_known && phase.kind() == PhaseKind::grains) checker.grains(phase);
    if (all_known && (phase.if_grains() || phase.if_wall())) checker.spheres(phase);
  }
  for (const Interaction& pair : scene.interactions) {
    const Phase *a = find_phase(scene, pair.a), *b = find_phase(scene, pair.b);
    if (a && b && kind_known(*a) && kind_known(*b) && !report.touched("interactions." + pair.a + "-" + pair.b))
      checker.pair(pair, *a, *b);
  }
  checker.time();
}

}  // namespace barchan
