#include <cmath>

#include "kernels/kernel.hpp"
#include "models/layout.hpp"

namespace barchan {

Consistency lattice_consistency(KernelKind kind, double radius, int dimensions) {
  Consistency c;
  with_kernel<double>(kind, radius, dimensions, [&](const auto& kernel) {
    const int n = static_cast<int>(std::ceil(radius)), nz = dimensions == 3 ? n : 0;
    for (int z = -nz; z <= nz; ++z)
      for (int y = -n; y <= n; ++y)
        for (int x = -n; x <= n; ++x) {
          const double r = std::sqrt(double(x * x + y * y + z * z));
          c.volume_sum += kernel.value(r);
          if (r == 0.0 || r >= radius * (1.0 - 1e-12)) continue;
          ++c.neighbours;
          c.gradient_sum -= kernel.derivative(r) * x * x / r;
          if (y < 0) c.surface_sum += kernel.derivative(r) * y / r;
        }
  });
  return c;
}

const Consistency& own_consistency(const Layout& layout, std::size_t fluid) {
  static const Consistency none{0, 1.0, 1.0, 0.5};
  for (const auto& e : layout.entries)
    if (e.a == fluid && e.b == fluid) return e.consistency;
  return none;
}

void describe_kernel_sums(const Interaction& pair, int dimensions, PlanEntry& e) {
  e.consistency = lattice_consistency(pair.kernel, pair.radius, dimensions);
  e.meaning = "a contact law, not an approximation";
}

void describe_approximation(const Interaction& pair, int dimensions, const std::string& correction, PlanEntry& e) {
  describe_kernel_sums(pair, dimensions, e);
  e.corrected = !correction.empty();
  e.meaning = e.corrected                  ? "corrected to first order " + correction
              : e.consistency.consistent() ? "consistent"
                                           : "off by more than 3 %, and nothing corrects it";
}

}  // namespace barchan
