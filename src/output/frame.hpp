// A frame: a copy of what is to be written, made by the computation and owned by the writer from then on.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace barchan {

struct FrameField {
  std::string name;            // as in the table of fields
  std::string unit;            // SI, "" for none
  int components = 1;          // 1, 3 (vector) or 6 (symmetric tensor xx yy zz xy yz xz, ParaView's order)
  std::vector<double> values;  // particle-major, n * components
};

struct Frame {
  int index = 0;              // number in the series
  bool in_pieces = false;     // it is written in pieces (output/pieces.hpp); what is here is
  int piece = 0, pieces = 1;  // this one, of so many: one a rank
  long step = 0;
  double time = 0.0;               // s
  std::array<double, 6> domain{};  // m, lower and upper bound along x, y, z in turn; along z 0, 0 in 2D
  std::vector<double> points;      // m, 3 a particle
  std::vector<std::int64_t> id;    // stable from the first frame to the last
  std::vector<std::int32_t> phase;
  std::vector<std::string> phase_names;  // phase number -> name
  std::vector<std::string> phase_kinds;  // phase number -> fluid, elastic, grains, wall
  std::vector<FrameField> fields;
  std::vector<FrameField>
      contacts;  // of a settled bed, by contact: contact_particle (an id), contact_branch, _force, _torque
  std::size_t size() const { return id.size(); }
  /// What concerns the frame as a whole, and the names of its fields.
  Frame without_particles() const {
    Frame about;
    about.index = index;
    about.step = step;
    about.time = time;
    about.in_pieces = in_pieces;
    about.piece = piece;
    about.pieces = pieces;
    for (const FrameField& f : fields) about.fields.push_back({f.name, f.unit, f.components, {}});
    return about;
  }
  /// Memory of the arrays.
  std::size_t bytes() const {
    std::size_t all =
        points.capacity() * sizeof(double) + id.capacity() * sizeof id[0] + phase.capacity() * sizeof phase[0];
    for (const auto* group : {&fields, &contacts})
      for (const FrameField& f : *group) all += f.values.capacity() * sizeof(double);
    return all;
  }
};

}  // namespace barchan
