#include "scene/reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"
#include "scene/checks.hpp"
#include "scene/document.hpp"
#include "scene/take.hpp"
#include "scene/validate.hpp"

namespace barchan {
namespace {

/// Names of a section in the order in which a person wrote them; those that an override added come last.
std::vector<std::string> written_order(const toml::table& table) {
  std::vector<std::pair<std::pair<bool, toml::source_position>, std::string>> names;
  for (const auto& [name, node] : table) {
    const toml::source_region& source = name.source();
    const bool from_override = source.path && source.path->starts_with("--set ");
    names.push_back({{from_override, source.begin}, std::string(name.str())});
  }
  std::stable_sort(names.begin(), names.end(), [](const auto& a, const auto& b) {
    if (a.first.first != b.first.first) return b.first.first;
    return a.first.second < b.first.second;
  });
  std::vector<std::string> order;
  order.reserve(names.size());
  for (auto& name : names) order.push_back(std::move(name.second));
  return order;
}

Domain take_domain(const toml::table& table) {
  Domain domain;
  domain.origin = take_vector(table, "origin");
  domain.size = take_vector(table, "size");
  domain.gravity = take_vector(table, "gravity");
  for (const std::string& axis : take_words(table, "periodic"))
    if (axis == "x" || axis == "y" || axis == "z") domain.periodic[static_cast<std::size_t>(axis[0] - 'x')] = true;
  return domain;
}

Phase take_phase(const toml::table& table, const std::string& name) {
  Phase phase;
  phase.name = name;
  phase.kind = take_choice(table, "kind", phase.kind,
                           {{"fluid", PhaseKind::fluid},
                            {"elastic", PhaseKind::elastic},
                            {"grains", PhaseKind::grains},
                            {"wall", PhaseKind::wall}});
  take_number(table, "density", phase.density);
  take_number(table, "viscosity", phase.viscosity);
  phase.sound_speed = table["sound-speed"].value<double>();
  phase.equation_of_state = take_choice(table, "equation-of-state", phase.equation_of_state,
                                        {{"linear", EquationOfState::linear}, {"tait", EquationOfState::tait}});
  take_number(table, "tait-exponent", phase.tait_exponent);
  take_number(table, "artificial-viscosity", phase.artificial_viscosity);
  take_number(table, "artificial-viscosity-beta", phase.artificial_viscosity_beta);
  take_number(table, "density-diffusion", phase.density_diffusion);
  phase.enclosed = table["enclosed"].value<bool>();
  take_number(table, "shifting", phase.shifting);
  take_number(table, "background-pressure", phase.background_pressure);
  phase.scheme = take_choice(table, "scheme", phase.scheme,
                             {{"plain", FluidScheme::plain}, {"consistent", FluidScheme::consistent}});
  phase.turbulence = take_choice(table, "turbulence", phase.turbulence,
                                 {{"none", Turbulence::none},
                                  {"mixing-length", Turbulence::mixing_length},
                                  {"smagorinsky", Turbulence::smagorinsky}});
  take_number(table, "smagorinsky", phase.smagorinsky);
  take_number(table, "young", phase.young);
  take_number(table, "poisson", phase.poisson);
  phase.energy = table["energy"].value_or(phase.energy);
  take_number(table, "restitution", phase.restitution);
  phase.contact_speed = table["contact-speed"].value<double>();
  phase.wall_law =
      take_choice(table, "law", phase.wall_law, {{"adami", WallLaw::adami}, {"repulsive", WallLaw::repulsive}});
  phase.slip = take_choice(table, "slip", phase.slip, {{"no-slip", Slip::no_slip}, {"free-slip", Slip::free_slip}});
  phase.wall_velocity = take_vector_expression(table, "velocity");
  if (table.contains("shear-stress")) phase.shear_stress = take_vector(table, "shear-stress");
  phase.roughness = table["roughness"].value<double>();
  return phase;
}

KernelKind take_kernel(const toml::table& table, KernelKind otherwise) {
  return take_choice(table, "kernel", otherwise,
                     {{"cubic-spline", KernelKind::cubic_spline}, {"wendland-c2", KernelKind::wendland_c2}});
}

/// Kernel and radius (spacings) of a pair that does not give them; a radius of 0 must be given. Fluids: the least error
/// at a given time (docs/accuracy.md), and no pairs. Contacts: eq. (16) of Halik et al. 2015; their stiffness grows
/// less with the overlap under the cubic spline.
Interaction recommended(const std::vector<Phase>& phases, const std::string& a, const std::string& b) {
  Interaction pair{a, b};
  bool fluid = false, repulsive = false, bodies = true;
  for (const Phase& phase : phases) {
    if (phase.name != a && phase.name != b) continue;
    fluid = fluid || phase.kind == PhaseKind::fluid;
    repulsive = repulsive || (phase.kind == PhaseKind::wall && phase.wall_law == WallLaw::repulsive);
    bodies = bodies && phase.kind == PhaseKind::elastic;
  }
  pair.kernel = fluid ? KernelKind::wendland_c2 : KernelKind::cubic_spline;
  if (fluid) pair.radius = repulsive ? 0.0 : 2.1;
  else pair.radius = bodies ? 0.0 : 1.1;
  return pair;
}

std::vector<Interaction> take_interactions(const toml::table& table, const std::vector<Phase>& phases) {
  std::vector<Interaction> interactions;
  for (const std::string& name : written_order(table)) {
    if (name == "kernel") continue;
    const std::size_t dash = name.find('-');
    Interaction pair =
        recommended(phases, name.substr(0, dash), dash == std::string::npos ? "" : name.substr(dash + 1));
    pair.kernel = take_kernel(table, pair.kernel);
    take_number(table, name, pair.radius);
    if (const toml::table* entry = table[name].as_table()) {
      take_number(*entry, "radius", pair.radius);
      pair.kernel = take_kernel(*entry, pair.kernel);
      take_number(*entry, "drag", pair.drag);
    }
    interactions.push_back(pair);
  }
  return interactions;
}

Forcing take_forcing(const toml::table& table) {
  return {table["phase"].value_or(std::string()), take_vector_expression(table, "acceleration"),
          table["hold"].value_or(std::string_view()) == "bulk-speed"};
}

TimeControl take_time(const toml::table& table) {
  TimeControl time;
  take_number(table, "end", time.end);
  time.fixed_step = table["step"].value<double>();
  take_number(table, "safety", time.safety);
  take_number(table, "largest-speed", time.largest_speed);
  return time;
}

OutputControl take_output(const toml::table& table) {
  OutputControl output;
  take_number(table, "every", output.every);
  take_number(table, "history-every", output.history_every);
  take_number(table, "checkpoint-every", output.checkpoint_every);
  output.fields = take_words(table, "fields");
  output.format = take_choice(table, "format", output.format, {{"vtp", FrameFormat::vtp}, {"vtu", FrameFormat::vtu}});
  output.compress = table["compress"].value_or(output.compress);
  output.walls = table["walls"].value_or(output.walls);
  return output;
}

/// A wall without a density of its own weighs as much as the first phase that feels it.
void complete_wall_densities(Scene& scene) {
  const auto density_of = [&](const std::string& name) {
    for (const Phase& phase : scene.phases)
      if (phase.name == name && phase.kind != PhaseKind::wall) return phase.density;
    return 0.0;
  };
  for (Phase& phase : scene.phases) {
    if (phase.kind != PhaseKind::wall) continue;
    for (const Interaction& pair : scene.interactions) {
      if (phase.density > 0.0) break;
      if (pair.a == phase.name) phase.density = density_of(pair.b);
      if (pair.b == phase.name) phase.density = density_of(pair.a);
    }
  }
}

/// Takes what is there and leaves the rest at its default: `validate` has already told what is wrong.
Scene take_scene(const toml::table& document, const std::string& file) {
  static const toml::table nothing;
  const auto section = [&](const char* name) -> const toml::table& {
    const toml::table* table = document[name].as_table();
    return table ? *table : nothing;
  };
  Scene scene;
  scene.file = file;
  scene.name = std::filesystem::path(file).stem().string();
  scene.title = document["title"].value_or(scene.name);
  scene.state = document["state"].value_or(std::string());
  scene.dimensions = dimensions_of(document);
  take_number(document, "spacing", scene.spacing);
  scene.precision = take_choice(document, "precision", scene.precision,
                                {{"double", Precision::double_precision}, {"mixed", Precision::mixed}});
  scene.domain = take_domain(section("domain"));
  for (const std::string& name : written_order(section("phases")))
    if (const toml::table* table = section("phases")[name].as_table()) scene.phases.push_back(take_phase(*table, name));
  scene.interactions = take_interactions(section("interactions"), scene.phases);
  if (const toml::array* fills = document["fill"].as_array())
    for (const toml::node& fill : *fills) scene.fills.push_back(fill.is_table() ? take_fill(*fill.as_table()) : Fill{});
  if (const toml::array* forcings = document["forcing"].as_array())
    for (const toml::node& forcing : *forcings)
      scene.forcings.push_back(forcing.is_table() ? take_forcing(*forcing.as_table()) : Forcing{});
  scene.measuring = take_measuring(document);
  scene.time = take_time(section("time"));
  scene.output = take_output(section("output"));
  complete_wall_densities(scene);
  return scene;
}

/// The document less what a run that goes on may change.
std::string identity_of(toml::table document) {
  for (const char* key : {"title", "state"}) document.erase(key);
  if (toml::table* output = document["output"].as_table()) output->erase("checkpoint-every");
  if (toml::table* time = document["time"].as_table()) time->erase("end");
  std::ostringstream text;
  text << document;
  return text.str();
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  Problems problems(file);
  const toml::table document = parse_document(text, file, overrides, problems);
  validate(document, problems);
  Scene scene = take_scene(document, file);
  scene.identity = identity_of(document);
  check(document, scene, problems);
  problems.throw_if_any();
  return scene;
}

Scene read_scene(const std::string& file, const std::vector<std::string>& overrides) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw SceneError(file + ": is a directory; expected a scene file (.toml)");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  if (!stream)
    throw SceneError(file + ": cannot be read: " + std::strerror(errno ? errno : EIO) +
                     "; expected a scene file (.toml)");
  return parse_scene(text.str(), file, overrides);
}

}  // namespace barchan
