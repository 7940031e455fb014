// The pair pass of interface_distance.hpp.
#include <algorithm>
#include <cmath>

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

/// The fit of one particle, in units of the reach; no plane where too few neighbours have a distance.
template <int Dim>
struct Plane {
  static constexpr std::size_t size = InterfacePlane::functions<Dim>, linear = Dim + 1;
  bool found = false;
  double distance = 0.0, spread = 0.0;
  std::array<double, Dim> normal{};  // out of its own fluid

  /// Cholesky's factors of the products: those of the first functions are the linear fit's, and the last pivot is what
  /// no function explains. A function that its neighbours do not tell from those before it is left out.
  template <class Products>
  explicit Plane(const Products& products) {
    std::array<std::array<double, size>, size> l{};
    std::size_t m = 0;
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j <= i; ++j, ++m) l[i][j] = simd::sum(products[m]);
    const double weight = l[0][0];
    for (std::size_t j = 0; j < size; ++j) {
      const double whole = l[j][j];
      double pivot = whole;
      for (std::size_t k = 0; k < j; ++k) pivot -= l[j][k] * l[j][k];
      if (j + 1 == size) spread = std::sqrt(std::max(pivot, 0.0) / weight);
      const bool told = pivot > least * whole;
      if (!told && j < linear) return;
      l[j][j] = told ? std::sqrt(pivot) : 0.0;
      for (std::size_t i = j + 1; i < size; ++i) {
        for (std::size_t k = 0; k < j; ++k) l[i][j] -= l[i][k] * l[j][k];
        l[i][j] = told ? l[i][j] / l[j][j] : 0.0;
      }
    }
    std::array<double, linear> fit;
    double square = 0.0;
    for (std::size_t j = linear; j-- > 0;) {
      fit[j] = l[size - 1][j];
      for (std::size_t i = j + 1; i < linear; ++i) fit[j] -= l[i][j] * fit[i];
      fit[j] /= l[j][j];
      if (j > 0) square += fit[j] * fit[j];
    }
    if (!(square > flat)) return;
    found = true;
    distance = fit[0];
    for (std::size_t d = 0; d < Dim; ++d) normal[d] = fit[1 + d] / std::sqrt(square);
  }

 private:
  static constexpr double least = 1e-3;  // of a function, what those before it leave of it
  static constexpr double flat = 0.25;   // of |grad s|^2, 1 beside a plane: less is none
};

template <int Dim>
void fit(std::size_t n, const RecordArray& own, std::span<const PairEntry<InterfacePlane>> entries,
         const AlignedVector<double>& raw, AlignedVector<double>& out, InterfacePlanes& planes) {
  const double reach = entries.front().law.reach;
  planes.normal.resize(Dim * n);
  planes.spread.resize(n);
  pair_pass<Dim, InterfacePlane>(
      n, 64, own, entries, [](std::size_t, auto&) {},
      [&](std::size_t k, const auto& sums, bool) {
        const Plane<Dim> plane(sums.products);
        out[k] = plane.found ? reach * plane.distance : raw[k];
        planes.spread[k] = reach * plane.spread;
        for (std::size_t d = 0; d < Dim; ++d) planes.normal[Dim * k + d] = plane.normal[d];
      });
}

}  // namespace

void fit_interface(std::size_t n, int dimensions, const RecordArray& own,
                   std::span<const PairEntry<InterfacePlane>> entries, const AlignedVector<double>& raw,
                   AlignedVector<double>& out, InterfacePlanes& planes) {
  if (dimensions == 2) fit<2>(n, own, entries, raw, out, planes);
  else fit<3>(n, own, entries, raw, out, planes);
}

void find_interface(std::size_t n, int dimensions, const RecordArray& own,
                    std::span<const PairEntry<InterfaceSide>> entries, const InterfaceDistance& distance,
                    AlignedVector<double>& out) {
  if (dimensions == 2) find<2>(n, own, entries, distance, out);
  else find<3>(n, own, entries, distance, out);
}

}  // namespace barchan::BARCHAN_TARGET
