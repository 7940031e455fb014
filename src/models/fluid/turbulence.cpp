#include "models/fluid/turbulence.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

void EddyRecords::resize(std::size_t particles, std::size_t images) {
  const std::size_t needed = particles + images + 1;  // and the dummy
  for (auto* values : {&root, &touch}) {
    if (values->size() < needed) values->resize(needed + images / 4 + 64);
    (*values)[particles + images] = 0.0;
  }
}

void EddyRecords::fill_images(std::size_t particles, const CellGrid& grid) {
  const auto& images = grid.image_list();
  const auto n = static_cast<std::int64_t>(images.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    root[particles + k] = root[images[k].source];
    touch[particles + k] = touch[images[k].source];
  }
}

namespace {

template <class T, class Records>
void copy_roots(const AlignedVector<double>& root, Records& records, std::size_t count) {
  const auto n = static_cast<std::int64_t>(count);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    records[k][MotionRecord<2>::root] = static_cast<T>(root[k]);
  }
}

}  // namespace

void EddyRecords::give_roots(RecordArray& records, std::size_t count) const {
  copy_roots<double>(root, records, count);
}
void EddyRecords::give_roots(CompactRecords& records, std::size_t count) const {
  copy_roots<float>(root, records, count);
}

double pack_eddies(PhaseParticles& fluid, EddyRecords& records, const GroundDistance& ground, const EddyParameters& e) {
  double *distance = fluid.column(Field::ground_distance), *nu_t = fluid.column(Field::eddy_viscosity);
  std::array<const double*, 3> x{}, v{};
  for (int d = 0; d < fluid.dimensions(); ++d) {
    x[static_cast<std::size_t>(d)] = fluid.column(Field::position, d);
    v[static_cast<std::size_t>(d)] = fluid.column(Field::velocity, d);
  }
  const auto n = static_cast<std::int64_t>(fluid.size());
  double largest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : largest)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Vec3 place{};
    double speed2 = 0.0;
    for (std::size_t d = 0; d < static_cast<std::size_t>(fluid.dimensions()); ++d) {
      place[d] = x[d][k];
      speed2 += v[d][k] * v[d][k];
    }
    const double at = ground.distance(place), nu = e.viscosity + nu_t[k];
    distance[k] = at;
    largest = std::max(largest, nu);
    records.root[k] = std::sqrt(e.density * nu);
    records.touch[k] = e.density * e.viscosity;
    if (e.roughness > 0.0 && at < e.grain_reach)
      records.touch[k] += rough_viscosity(e.density, at, e.roughness, e.spacing, std::sqrt(speed2));
  }
  return largest;
}

}  // namespace barchan
