// Air without particles: what is known of it by height, and all that its next step starts from.
#pragma once

#include <string>
#include <vector>

#include "state/archive.hpp"

namespace barchan {

/// Cells between faces, from the bottom up: cell k lies between face k and face k + 1.
struct AirProfile {
  std::size_t phase = 0;          // its number
  std::vector<double> face;       // m
  std::vector<double> speed;      // m/s, along x, of the cells
  std::vector<double> stress;     // Pa, shear stress of the air on the faces
  std::vector<double> length;     // m, mixing length on the faces
  std::vector<double> given;      // Pa s, impulse by area that the air has lost to the grains of a cell for the time
                                  // between its last step and its next one
  std::vector<double> mean_rate;  // Pa s/m and Pa, of air without inertia: averages of the drag of the grains of a cell
  std::vector<double> mean_push;  // by speed of the air, and of what they push it
  double boundary = 0.0;          // Pa s, impulse by area through bottom and top so far
  double elapsed = 0.0, kicked = 0.0;  // s, of steps and of kicks since the profile's last step
  double last = 0.0;                   // s, of the last step of the particles
  long step = -1;                      // of the particles, that the clock has counted

  std::size_t cells() const { return speed.size(); }
  void archive(Archive& a);
};

}  // namespace barchan
