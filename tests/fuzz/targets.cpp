#include "fuzz/targets.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "output/checked_bytes.hpp"
#include "output/checkpoint.hpp"
#include "output/checkpoint_pieces.hpp"
#include "output/frame_read.hpp"
#include "output/pieces.hpp"
#include "output/pvd.hpp"
#include "scene/formula.hpp"
#include "start/mesh_texts.hpp"
#include "start/mesh_vtk.hpp"

namespace barchan::fuzz {

void scene(std::string_view text) {
  std::vector<std::string> overrides;
  if (text.starts_with("#set ")) {
    const auto end = std::min(text.find('\n'), text.size());
    overrides.emplace_back(text.substr(5, end - 5));
  }
  try {
    parse_scene(std::string(text), "scene.toml", overrides);
  } catch (const SceneError&) {}
}

void formula(std::string_view text) {
  const std::string formula(text);
  if (!formula_problem(formula, "x y z t").empty()) return;
  Expression expression;
  expression.formula = formula;
  const Formula f(expression);
  static_cast<void>(f({0.1, -0.2, 0.3}, 0.5));
}

namespace {

/// Behind the magic words stand the size (8 bytes), the checksum (4) and a zero (4): makes all of them fit.
bool make_fit(std::vector<char>& bytes, std::string_view magic) {
  const std::size_t head = magic.size() + sizeof(CheckedHead);
  if (bytes.size() < head) return false;
  const CheckedHead fits{bytes.size() - head, checksum(bytes.data() + head, bytes.size() - head), 0};
  std::memcpy(bytes.data(), magic.data(), magic.size());
  std::memcpy(bytes.data() + magic.size(), &fits, sizeof fits);
  return true;
}

}  // namespace

void checkpoint(std::string_view text) {
  std::vector<char> bytes(text.begin(), text.end());
  const auto try_it = [](auto&& parse) {
    try {
      parse();
    } catch (const SceneError&) {}
  };
  try_it([&] { parse_checkpoint(bytes); });
  try_it([&] { parse_index(source_of(bytes)); });
  try_it([&] { parse_index(source_of(bytes), false); });
  if (make_fit(bytes, "barchan checkpoint 2\n")) try_it([&] { parse_checkpoint(bytes); });
  bytes.assign(text.begin(), text.end());
  if (make_fit(bytes, CheckpointIndex::magic)) try_it([&] { parse_index(source_of(bytes)); });
}

void frame(std::string_view text) {
  for (const char* suffix : {".vtp", ".vtu"}) try {
      read_appended(text, suffix);
    } catch (const OutputError&) {}
}

void series(std::string_view text) {
  try {
    parse_pvd(text);
  } catch (const OutputError&) {}
  try {
    parse_pieces(text);
  } catch (const OutputError&) {}
}

void mesh(std::string_view text) {
  for (const auto parse : {parse_stl, parse_obj, parse_ply, parse_corners}) {
    const Mesh found = parse(text);
    for (const auto* facets : {&found.triangles, &found.segments})
      for (const Facet& facet : *facets)
        for (const Vec3& corner : facet)
          for (const double x : corner)
            if (!std::isfinite(x)) std::abort();
  }
  for (const char* suffix : {".vtp", ".vtk"}) static_cast<void>(wrong_number_of_vtk(text, suffix));
}

}  // namespace barchan::fuzz
