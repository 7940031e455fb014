#include "models/bodies/wall_surfaces.hpp"

#include <algorithm>
#include <cmath>

#include "engine/pair_loop.hpp"
#include "models/bodies/body_forces.hpp"

namespace barchan {

WallSurfaces::WallSurfaces(const Scene& scene, const Layout& layout, const Phase& wall)
    : dimensions_(layout.dimensions), half_(0.5 * wall.spacing) {
  double widest = wall.spacing;
  for (const PlanPhase& p : layout.phases) widest = std::max(widest, p.spacing);
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions_); ++d) {
    low_[d] = layout.bounds.low[d];
    high_[d] = layout.bounds.high[d];
    period_[d] = layout.bounds.periodic[d] ? high_[d] - low_[d] : 0.0;
  }
  for (const Fill& fill : scene.fills) {
    if (fill.phase != wall.name) continue;
    for (ContactSurface& surface : surfaces_of(fill.shape, scene, wall.spacing)) {
      surface.prepare(2.0 * widest, wall.spacing);
      surfaces_.push_back(std::move(surface));
    }
  }
}

/// The gaps below `reach` (m), the deepest first, less those that push nearly as a deeper one does.
std::size_t WallSurfaces::touched(Vec3 x, double reach, std::array<Gap, 4>& found) const {
  constexpr double another = 0.5;  // cosine of 60 degrees
  std::size_t count = 0;
  const auto look = [&](const Vec3& at) {
    for (const ContactSurface& surface : surfaces_) {
      const std::optional<Gap> gap = surface.gap(at);
      if (!gap || !(gap->distance < reach) || std::isinf(gap->distance)) continue;
      if (count == found.size()) {
        if (!(gap->distance < found[count - 1].distance)) continue;
        --count;
      }
      std::size_t place = count++;
      for (; place > 0 && gap->distance < found[place - 1].distance; --place) found[place] = found[place - 1];
      found[place] = *gap;
    }
  };
  look(x);
  for (std::size_t d = 0; d < 3; ++d)  // what stands beyond a periodic side
    for (const double sign : {1.0, -1.0}) {
      if (period_[d] == 0.0 || (sign > 0.0 ? x[d] - low_[d] : high_[d] - x[d]) >= reach) continue;
      Vec3 image = x;
      image[d] += sign * period_[d];
      look(image);
    }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count; ++k) {
    bool differs = true;
    for (std::size_t q = 0; q < kept; ++q) differs = differs && dot(found[k].normal, found[q].normal) < another;
    if (differs) found[kept++] = found[k];
  }
  return kept;
}

template <int Dim, bool Rubs>
void WallSurfaces::push_in(PhaseParticles& body, double spacing, const BodyContactLaw& law, double dt) const {
  using One = simd::Vec<double, 1>;
  std::array<const double*, Dim> x{}, v{};
  std::array<double*, Dim> a{}, felt{};
  for (int d = 0; d < Dim; ++d) {
    const auto c = static_cast<std::size_t>(d);
    x[c] = body.column(Field::position, d);
    v[c] = body.column(Field::velocity, d);
    a[c] = body.column(Field::acceleration, d);
    if (body.has(Field::contact_force)) felt[c] = body.column(Field::contact_force, d);
  }
  const BodyContactLaw::Constants<One> constants(law, dt);
  const double inverse_mass = 1.0 / body.mass(), reach = 0.5 * spacing;
  const auto n = static_cast<std::int64_t>(body.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Vec3 place{};
    for (std::size_t d = 0; d < Dim; ++d) place[d] = x[d][k];
    std::array<Gap, 4> gaps;
    const std::size_t count = touched(place, reach, gaps);
    if (count == 0) continue;
    std::array<One, Dim> speed, force;
    for (std::size_t d = 0; d < Dim; ++d) {
      speed[d] = One(v[d][k]);
      force[d] = One(0.0);
    }
    for (std::size_t q = 0; q < count; ++q) {
      const double height = gaps[q].distance + half_;
      std::array<One, Dim> r;
      for (std::size_t d = 0; d < Dim; ++d) r[d] = One(height * gaps[q].normal[d]);
      BodyContactLaw::add<Rubs>(constants, r, One(height * height + least_square), speed, force);
    }
    for (std::size_t d = 0; d < Dim; ++d) {
      a[d][k] += force[d][0] * inverse_mass;
      if (felt[d]) felt[d][k] += force[d][0];
    }
  }
}

void WallSurfaces::push(PhaseParticles& body, double spacing, const BodyContactLaw& law, double dt) const {
  const bool rubs = law.friction > 0.0;
  if (dimensions_ == 2) rubs ? push_in<2, true>(body, spacing, law, dt) : push_in<2, false>(body, spacing, law, dt);
  else rubs ? push_in<3, true>(body, spacing, law, dt) : push_in<3, false>(body, spacing, law, dt);
}

}  // namespace barchan
