// What is fed with anything: each takes any text, may refuse it with one of our errors, and may do nothing else.
#pragma once

#include <string_view>

namespace barchan::fuzz {

void scene(std::string_view text);       // a scene file; the first line may hold overrides after "#set "
void formula(std::string_view text);     // a formula in x, y, z, t
void checkpoint(std::string_view text);  // a checkpoint or index as it is, and with a checksum that fits
void frame(std::string_view text);       // a .vtp or .vtu as compare reads it
void series(std::string_view text);      // a .pvd or a .pvtp
void mesh(std::string_view text);        // a .stl, .obj, .ply or .csv of a shape; the texts of a .vtp and a .vtk

struct Target {
  const char* name;
  void (*run)(std::string_view);
};
inline constexpr Target targets[] = {{"scene", scene}, {"formula", formula}, {"checkpoint", checkpoint},
                                     {"frame", frame}, {"series", series},   {"mesh", mesh}};

}  // namespace barchan::fuzz
