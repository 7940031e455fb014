// The kernels by name.
#pragma once

namespace barchan {

enum class KernelKind { cubic_spline, wendland_c2 };

}  // namespace barchan
