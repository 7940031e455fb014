#include "scene/take.hpp"

#include <algorithm>

namespace barchan {

void take_number(const toml::table& table, std::string_view name, double& value) {
  if (const toml::node* node = table.get(name); node && node->is_number()) value = node->value_or(value);
}

Vec3 take_vector(const toml::array& array) {
  Vec3 vector{};
  for (std::size_t k = 0; k < std::min<std::size_t>(array.size(), 3); ++k) vector[k] = array[k].value_or(0.0);
  return vector;
}

Vec3 take_vector(const toml::table& table, std::string_view name) {
  const toml::array* array = table[name].as_array();
  return array ? take_vector(*array) : Vec3{};
}

std::vector<std::string> take_words(const toml::table& table, std::string_view name) {
  std::vector<std::string> words;
  if (const toml::array* array = table[name].as_array())
    for (const toml::node& node : *array)
      if (const auto* text = node.as_string()) words.push_back(text->get());
  return words;
}

Expression take_expression(const toml::node* node) {
  Expression expression;
  if (!node) return expression;
  if (const auto* text = node->as_string()) expression.formula = text->get();
  else expression.value = node->value_or(0.0);
  return expression;
}

VectorExpression take_vector_expression(const toml::table& table, std::string_view name) {
  VectorExpression vector;
  if (const toml::array* array = table[name].as_array())
    for (std::size_t k = 0; k < std::min<std::size_t>(array->size(), 3); ++k)
      vector[k] = take_expression(array->get(k));
  return vector;
}

namespace {

DuneShape take_dune(const toml::table& table) {
  DuneShape dune;
  dune.form = take_choice(table, "form", dune.form,
                          {{"cosine", DuneShape::Form::cosine},
                           {"gaussian", DuneShape::Form::gaussian},
                           {"asymmetric", DuneShape::Form::asymmetric},
                           {"rushil", DuneShape::Form::rushil},
                           {"formula", DuneShape::Form::formula}});
  take_number(table, "height", dune.height);
  take_number(table, "length", dune.length);
  take_number(table, "at", dune.at);
  take_number(table, "slip-face-angle", dune.slip_face_angle);
  dune.formula = take_expression(table.get("formula"));
  return dune;
}

PolygonShape take_polygon(const toml::array& array) {
  PolygonShape polygon;
  for (const toml::node& node : array)
    if (const toml::array* corner = node.as_array()) {
      const Vec3 point = take_vector(*corner);
      polygon.corners.push_back({point[0], point[1]});
    }
  return polygon;
}

PointsShape take_points(const toml::array& array) {
  PointsShape points;
  for (const toml::node& node : array)
    if (const toml::array* point = node.as_array()) points.at.push_back(take_vector(*point));
  return points;
}

/// The first shape that the table names; checks.cpp sees to it that there is just one.
Shape take_shape(const toml::table& table) {
  const auto number = [](const toml::table& t, std::string_view name) { return t[name].value_or(0.0); };
  if (table.contains("bed")) {
    BedShape bed;
    bed.depth = number(table, "bed");
    if (table.contains("from")) bed.from = number(table, "from");
    bed.layers = table["layers"].value_or(bed.layers);
    if (const toml::table* dune = table["dune"].as_table()) bed.dune = take_dune(*dune);
    return bed;
  }
  if (const toml::table* box = table["box"].as_table())
    return BoxShape{take_vector(*box, "min"), take_vector(*box, "max")};
  if (const toml::table* disc = table["disc"].as_table())
    return DiscShape{take_vector(*disc, "centre"), number(*disc, "radius")};
  if (const toml::table* sphere = table["sphere"].as_table())
    return SphereShape{take_vector(*sphere, "centre"), number(*sphere, "radius")};
  if (const toml::table* ring = table["ring"].as_table())
    return RingShape{take_vector(*ring, "centre"), number(*ring, "inner"), number(*ring, "outer")};
  if (const toml::array* corners = table["polygon"].as_array()) return take_polygon(*corners);
  if (const toml::table* cube = table["cube"].as_table())
    return CubeShape{take_vector(*cube, "centre"), (*cube)["count"].value_or(0)};
  if (const toml::array* points = table["points"].as_array()) return take_points(*points);
  if (table.contains("formula")) return FormulaShape{take_expression(table.get("formula"))};
  if (table.contains("sides"))
    return SidesShape{take_words(table, "sides"), table["layers"].value_or(SidesShape{}.layers)};
  return TheRestShape{};
}

}  // namespace

Fill take_fill(const toml::table& table) {
  Fill fill;
  fill.phase = table["phase"].value_or(std::string());
  fill.shape = TheRestShape{};
  if (const toml::table* shape = table["shape"].as_table()) fill.shape = take_shape(*shape);
  fill.packing = take_choice(table, "packing", fill.packing,
                             {{"rows", Packing::square},
                              {"staggered", Packing::hexagonal},
                              {"random", Packing::random},
                              {"fitted", Packing::fitted}});
  take_number(table, "perturb", fill.perturb);
  fill.seed = table["seed"].value_or(fill.seed);
  fill.velocity = take_vector_expression(table, "velocity");
  if (const toml::table* profile = table["velocity"]["log-profile"].as_table()) {
    LogProfile log;
    take_number(*profile, "friction-velocity", log.friction_velocity);
    take_number(*profile, "roughness", log.roughness);
    log.over_ground = (*profile)["over-ground"].value_or(log.over_ground);
    fill.log_profile = log;
  }
  fill.hydrostatic = table["pressure"].value_or(std::string_view()) == "hydrostatic";
  if (!fill.hydrostatic) fill.pressure = take_expression(table.get("pressure"));
  return fill;
}

}  // namespace barchan
