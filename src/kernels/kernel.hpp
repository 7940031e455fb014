// Kernels W(r) of compact support. `radius` is where they end, the entry of the interaction matrix; h = radius / 2.
//
// Pair loops need the gradient factor F(r) = (1/r) dW/dr, so that grad_a W(r_ab) = F r_ab with r_ab = x_a - x_b; F < 0.
// Both kernels give exactly zero beyond the radius without a branch.
#pragma once

#include "kernels/cubic_spline.hpp"
#include "kernels/kernel_kind.hpp"
#include "kernels/wendland_c2.hpp"

namespace barchan {

/// Calls f with the kernel of this kind; returns what f returns.
template <class T, class F>
auto with_kernel(KernelKind kind, double radius, int dimensions, F&& f) {
  if (kind == KernelKind::wendland_c2) return f(WendlandC2<T>(radius, dimensions));
  return f(CubicSpline<T>(radius, dimensions));
}

/// A kernel ready for a pair loop: made once a pass, chosen once a row.
template <class T>
class ReadyKernelOf {
 public:
  ReadyKernelOf(KernelKind kind, double radius, int dimensions)
      : kind_(kind), spline_(radius, dimensions), wendland_(radius, dimensions) {}
  template <class F>
  BARCHAN_SIMD_INLINE auto operator()(F&& f) const {
    if (kind_ == KernelKind::wendland_c2) return f(wendland_);
    return f(spline_);
  }
  /// The constant that slope() leaves out.
  double slope_factor() const {
    return static_cast<double>(kind_ == KernelKind::wendland_c2 ? wendland_.slope_factor() : spline_.slope_factor());
  }

 private:
  KernelKind kind_;
  CubicSpline<T> spline_;
  WendlandC2<T> wendland_;
};
using ReadyKernel = ReadyKernelOf<double>;

}  // namespace barchan
