// Fit of an exponential to a profile.
#pragma once

#include <vector>

namespace barchan {

/// q(y) = at_zero exp(-y/height).
struct Decay {
  double height = 0.0, error = 0.0;  // m, and its standard error; 0: no fit
  double at_zero = 0.0;
  int used = 0;  // values that were
};

/// Weighted least squares of ln q on y. A value is weighted by (q/error)^2, the inverse variance of its logarithm, from
/// the lowest one up to the first that is not above twice its error; three are needed. The standard error comes from
/// the scatter about the line.
Decay decay(const std::vector<double>& y, const std::vector<double>& q, const std::vector<double>& errors);

}  // namespace barchan
