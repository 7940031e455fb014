#include "models/grains/bed_height.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

BedHeight::BedHeight(double bottom, double top, double diameter) : bottom_(bottom), slice_(diameter) {
  mass_.resize(static_cast<std::size_t>(std::max(1.0, std::ceil((top - bottom) / diameter))));
}

double BedHeight::operator()(const PhaseParticles& grains) {
  std::fill(mass_.begin(), mass_.end(), 0.0);
  const double* y = grains.column(Field::position, 1);
  const auto last = static_cast<double>(mass_.size() - 1);
  for (std::size_t k = 0; k < grains.size(); ++k)
    mass_[static_cast<std::size_t>(std::clamp((y[k] - bottom_) / slice_, 0.0, last))] += grains.mass_of(k);
  const double half = 0.5 * *std::max_element(mass_.begin(), mass_.end());
  if (!(half > 0.0)) return bottom_;
  std::size_t k = mass_.size() - 1;
  while (mass_[k] < half) --k;
  const double above = k + 1 < mass_.size() ? mass_[k + 1] : 0.0;
  return bottom_ + slice_ * (static_cast<double>(k) + 0.5 + (mass_[k] - half) / (mass_[k] - above));
}

}  // namespace barchan
