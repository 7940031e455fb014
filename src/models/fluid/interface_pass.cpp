// The pair pass of interface_distance.hpp.
#include "engine/pair_pass.hpp"
#include "models/fluid/interface_distance.hpp"

namespace barchan::BARCHAN_TARGET {

namespace {

template <int Dim>
void find(std::size_t n, const RecordArray& own, std::span<const PairEntry<InterfaceSide>> entries,
          const InterfaceDistance& distance, AlignedVector<double>& out) {
  pair_pass<Dim, InterfaceSide>(
      n, 64, own, entries, [](std::size_t, auto&) {},
      [&](std::size_t k, const auto& sums, bool) {
        const double mine = simd::sum(sums.own), all = simd::sum(sums.all);
        out[k] = distance(all < 0.0 ? mine / all : 1.0);
      });
}

}  // namespace

void find_interface(std::size_t n, int dimensions, const RecordArray& own,
                    std::span<const PairEntry<InterfaceSide>> entries, const InterfaceDistance& distance,
                    AlignedVector<double>& out) {
  if (dimensions == 2) find<2>(n, own, entries, distance, out);
  else find<3>(n, own, entries, distance, out);
}

}  // namespace barchan::BARCHAN_TARGET
