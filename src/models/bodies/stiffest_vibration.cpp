#include "models/bodies/stiffest_vibration.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "kernels/kernel.hpp"
#include "start/random.hpp"

namespace barchan {

double stiffest_vibration(KernelKind kernel, double radius, double spacing, int dimensions, TotalParameters q) {
  const int side = dimensions == 2 ? 14 : 8, deep = dimensions == 2 ? 1 : side;
  std::vector<Vec3> places;
  for (int k = 0; k < deep; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) places.push_back({i * spacing, j * spacing, k * spacing});
  Bounds bounds;
  bounds.dimensions = dimensions;
  bounds.low = {-spacing, -spacing, -spacing};
  bounds.high = {(side + 1) * spacing, (side + 1) * spacing, (side + 1) * spacing};
  q.moduli.retardation = 0.0;
  q.gravity = q.period = {};
  const auto reference =
      make_reference_body<double>(places, bounds, spacing, kernel, radius, simd::width_in_use<double>());
  TotalWork<double> work;
  work.resize(places.size(), reference.width, dimensions, q);
  PhaseParticles block("block", dimensions, places.size(), 1.0, 0);
  for (const Field f : {Field::position, Field::velocity, Field::acceleration, Field::density}) block.add(f);
  block.keep_places();
  work.at = block.places();
  Random random(1);
  const double amplitude = 1e-6 * spacing;  // of a component, in the mean
  std::vector<double> u(places.size() * static_cast<std::size_t>(dimensions));
  for (double& x : u) x = random.uniform(-1.0, 1.0);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // so few particles are not worth a team
  double square = 0.0;     // w^2
  for (int turn = 0; turn < 200; ++turn) {
    double length = 0.0;
    for (const double x : u) length += x * x;
    const double scale = amplitude * std::sqrt(static_cast<double>(u.size()) / length);
    square = std::sqrt(length);
    for (int d = 0; d < dimensions; ++d)
      for (std::size_t k = 0; k < places.size(); ++k)
        block.column(Field::position, d)[k] =
            places[k][static_cast<std::size_t>(d)] + scale * u[static_cast<std::size_t>(d) * places.size() + k];
    pack_displacements(block, reference, work, q);
    total_stress(block, reference, work, q);
    total_forces(block, reference, work, q);
    for (int d = 0; d < dimensions; ++d)
      for (std::size_t k = 0; k < places.size(); ++k)
        u[static_cast<std::size_t>(d) * places.size() + k] =
            block.column(Field::acceleration, d)[k] / (amplitude * std::sqrt(static_cast<double>(u.size())));
  }
  omp_set_num_threads(threads);
  return std::sqrt(square);
}

double length_stiffness(KernelKind kernel, double radius, double spacing, int dimensions, const TotalParameters& q) {
  const int far = static_cast<int>(radius / spacing), deep = dimensions == 2 ? 0 : far;
  double second = 0.0, fourth = 0.0, along = 0.0;  // sums of w X^2, w X^4, w X^6/r^2
  with_kernel<double>(kernel, radius, dimensions, [&](const auto& w_of) {
    for (int k = -deep; k <= deep; ++k)
      for (int j = -far; j <= far; ++j)
        for (int i = -far; i <= far; ++i) {
          const double x = i * spacing, r = spacing * std::sqrt(static_cast<double>(i * i + j * j + k * k));
          if (i == 0 || r >= radius) continue;
          const double w = std::pow(spacing, dimensions) * std::abs(w_of.derivative(r)) / r;
          second += w * x * x;
          fourth += w * x * x * x * x;
          along += w * std::pow(x, 6) / (r * r);
        }
  });
  if (!(along > 0.0)) return 0.0;
  return std::max(0.0, (4.0 / 3.0 * q.moduli.compression() / second - q.hourglass) * fourth / along);
}

}  // namespace barchan
