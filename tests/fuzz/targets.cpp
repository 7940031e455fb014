#include "fuzz/targets.hpp"

#include <zlib.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

#include "base/errors.hpp"
#include "output/checkpoint.hpp"
#include "output/frame_read.hpp"
#include "output/pieces.hpp"
#include "output/pvd.hpp"
#include "scene/formula.hpp"
#include "scene/mesh_texts.hpp"
#include "scene/mesh_vtk.hpp"
#include "scene/reader.hpp"

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

void checkpoint(std::string_view text) {
  std::vector<char> bytes(text.begin(), text.end());
  try {
    parse_checkpoint(bytes);
  } catch (const SceneError&) {}
  // Behind the magic words stand the size (8 bytes), the checksum (4) and a zero (4): make them fit.
  constexpr std::size_t magic = 21, head = magic + 16;
  if (bytes.size() < head) return;
  const std::uint64_t size = bytes.size() - head;
  const auto sum = static_cast<std::uint32_t>(
      crc32_z(crc32_z(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data() + head), size));
  std::memcpy(bytes.data(), "barchan checkpoint 2\n", magic);
  std::memcpy(bytes.data() + magic, &size, sizeof size);
  std::memcpy(bytes.data() + magic + 8, &sum, sizeof sum);
  std::memset(bytes.data() + magic + 12, 0, 4);
  try {
    parse_checkpoint(bytes);
  } catch (const SceneError&) {}
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
