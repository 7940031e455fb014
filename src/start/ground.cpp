// The ground: bed and dune of the first fill that has one.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "start/generate.hpp"
#include "start/ground.hpp"

namespace barchan {

Ground::Ground(const Scene& scene) {
  for (const Fill& fill : scene.fills) {
    const auto* bed = std::get_if<BedShape>(&fill.shape);
    if (!bed) continue;
    *this = Ground(*bed, scene.domain);
    return;
  }
}

Ground::Ground(const BedShape& bed, const Domain& domain) : exists_(true), bed_(bed) {
  if (domain.periodic[0]) period_ = domain.size[0];
  if (bed.dune && bed.dune->form == DuneShape::Form::formula)
    formula_ = std::make_shared<const Formula>(bed.dune->formula);
}

double Ground::height(double x, double z) const {
  if (!exists_) return 0.0;
  if (!bed_.dune) return bed_.depth;
  if (formula_) return bed_.depth + (*formula_)({x, 0.0, z});
  const double from_crest = x - bed_.dune->at;
  double height = profile(from_crest);
  if (period_ > 0.0) {
    const double shifted = from_crest - period_ * std::round(from_crest / period_);
    height = std::max({profile(shifted - period_), profile(shifted), profile(shifted + period_)});
  }
  return bed_.depth + height;
}

namespace {

/// The hills of Khurshudyan, Snyder & Nekrasov 1981 (RUSHIL), half as long as `a`: with m = H/a + sqrt((H/a)^2 + 1),
///   x = t/2 (1 + a^2/(t^2 + m^2 (a^2 - t^2))),  z = m/2 sqrt(a^2 - t^2) (1 - a^2/(t^2 + m^2 (a^2 - t^2))),  |t| <= a.
double rushil(double s, double height, double a) {
  s = std::abs(s);
  if (s >= a) return 0.0;
  const double m = height / a + std::hypot(height / a, 1.0);
  const auto share = [&](double t) { return a * a / (t * t + m * m * (a * a - t * t)); };
  double low = 0.0, high = a;  // x grows with t
  for (int k = 0; k < 60; ++k) {
    const double t = 0.5 * (low + high);
    (0.5 * t * (1.0 + share(t)) < s ? low : high) = t;
  }
  return 0.5 * m * std::sqrt(a * a - low * low) * (1.0 - share(low));
}

}  // namespace

/// Height of the dune alone, `s` metres downwind of its crest.
double Ground::profile(double s) const {
  const DuneShape& dune = *bed_.dune;
  const double pi = std::numbers::pi, H = dune.height, L = dune.length;
  switch (dune.form) {
    case DuneShape::Form::cosine: return std::abs(s) < 0.5 * L ? 0.5 * H * (1.0 + std::cos(2.0 * pi * s / L)) : 0.0;
    case DuneShape::Form::gaussian: return H * std::exp(-4.0 * std::numbers::ln2 * (s / L) * (s / L));
    case DuneShape::Form::asymmetric: {
      const double lee = H / std::tan(dune.slip_face_angle * pi / 180.0), windward = L - lee;
      if (s >= 0.0) return s < lee ? H * (1.0 - s / lee) : 0.0;
      return s > -windward ? 0.5 * H * (1.0 + std::cos(pi * s / windward)) : 0.0;
    }
    case DuneShape::Form::rushil: return rushil(s, H, 0.5 * L);
    case DuneShape::Form::formula: break;
  }
  return 0.0;
}

double ground_height(const Scene& scene, double x, double z) { return Ground(scene).height(x, z); }

}  // namespace barchan
