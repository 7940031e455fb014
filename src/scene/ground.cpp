// The ground: bed and dune of the first fill that has one.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/generate.hpp"
#include "scene/ground.hpp"

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
    case DuneShape::Form::formula: break;
  }
  return 0.0;
}

double ground_height(const Scene& scene, double x, double z) { return Ground(scene).height(x, z); }

}  // namespace barchan
