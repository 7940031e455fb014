#include "start/relaxed.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "kernels/kernel.hpp"
#include "scene/couplings.hpp"
#include "start/lattice.hpp"
#include "start/places.hpp"
#include "start/point_cells.hpp"

namespace barchan {
namespace {

constexpr double kernel_radius = 2.5;  // spacings
constexpr double band = 8.0;           // spacings below the border in which places move
constexpr double layer = 0.8;          // spacings: what is less deep belongs to the outermost layer
constexpr int most_rounds = 400;
constexpr double at_rest = 1e-3;  // spacings: largest move of a round that counts as none

/// The fill as a region, and what fills the space outside of it.
class Border {
 public:
  Border(const Scene& scene, std::size_t k)
      : dimensions_(scene.dimensions),
        spacing_(spacing_of(scene, scene.fills[k])),
        space_(scene.domain),
        region_(region_of_fill(scene, k, (band + kernel_radius + 1.0) * spacing_)),
        outside_(space_, kernel_radius * spacing_, dimensions_) {
    look_at_cells(scene);
    outside_.arrange();
  }

  const Solid& region() const { return region_; }
  double spacing() const { return spacing_; }
  int dimensions() const { return dimensions_; }
  const PeriodicSpace& space() const { return space_; }
  double content() const { return content_; }             ///< m2 or m3
  const PointCells& outside() const { return outside_; }  ///< points with the volume that each stands for
  double volume() const { return std::pow(spacing_, dimensions_); }

  /// The deepest places of the lattice, as many as the region has room for.
  std::vector<Vec3> start() const {
    const auto count = std::min(cells_.size(), static_cast<std::size_t>(std::llround(content_ / volume())));
    std::vector<std::size_t> order(cells_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    // Places of the same depth are taken from all round, not from one side: by the golden section.
    const auto rank = [&](std::size_t i) {
      return std::pair(-std::round(cells_[i].depth / spacing_ * 1e4),
                       std::fmod(0.6180339887498949 * static_cast<double>(i), 1.0));
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
    order.resize(count);
    std::sort(order.begin(), order.end());
    std::vector<Vec3> places;
    for (const std::size_t i : order) places.push_back(space_.wrapped(cells_[i].centre));
    return places;
  }

 private:
  struct Cell {
    Vec3 centre;
    double depth;  // m
  };

  /// Goes through the cells of a lattice about the region: those that can hold a place, the content, and points outside
  /// as far as a kernel reaches in.
  void look_at_cells(const Scene& scene) {
    const double margin = (kernel_radius + 1.0) * spacing_;
    Vec3 lower = region_.lower, upper = region_.upper, anchor{};
    for (std::size_t d = 0; d < 3; ++d) {
      anchor[d] = scene.domain.origin[d] + 0.5 * spacing_;
      const bool whole = scene.domain.periodic[d] && upper[d] - lower[d] + 2.0 * margin >= scene.domain.size[d];
      lower[d] = whole ? scene.domain.origin[d] : lower[d] - margin;
      upper[d] = whole ? scene.domain.origin[d] + scene.domain.size[d] - 1e-6 * spacing_ : upper[d] + margin;
    }
    for (const Vec3& centre : lattice(Packing::square, dimensions_, spacing_, anchor, lower, upper)) {
      const double depth = region_.depth(centre);
      if (depth > -margin) look_at(centre, depth);
    }
  }

  void look_at(const Vec3& centre, double depth) {
    const double half = 0.5 * spacing_ * std::sqrt(dimensions_);
    if (depth > -2.0 * spacing_) cells_.push_back({centre, depth});
    if (depth >= half) {
      content_ += volume();
      return;
    }
    const int parts = dimensions_ == 2 ? 4 : 3, all = dimensions_ == 2 ? parts * parts : parts * parts * parts;
    const double width = spacing_ / parts, share = volume() / all;
    double rest = 0.0;
    Vec3 moment{};
    for (int i = 0; i < all; ++i) {
      const int index[3] = {i % parts, i / parts % parts, i / parts / parts};
      Vec3 x = centre;
      for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions_); ++d)
        x[d] += (index[d] - 0.5 * (parts - 1)) * width;
      const double inside = std::clamp(0.5 + region_.depth(x) / width, 0.0, 1.0);
      content_ += inside * share;
      if (dimensions_ == 2 && inside < 1.0) outside_.add(space_.wrapped(x), (1.0 - inside) * share);
      rest += (1.0 - inside) * share;
      moment = moment + (1.0 - inside) * share * x;
    }
    // In 3D one point for the part of a cell that is outside: 27 would make most of the work of a relaxation.
    if (dimensions_ == 3 && rest > 0.0) outside_.add(space_.wrapped(1.0 / rest * moment), rest);
  }

  int dimensions_;
  double spacing_, content_ = 0.0;
  PeriodicSpace space_;
  Solid region_;
  std::vector<Cell> cells_;
  PointCells outside_;
};

class Relaxation {
 public:
  Relaxation(const Border& border, std::vector<Vec3> places)
      : border_(border),
        places_(std::move(places)),
        depth_(places_.size()),
        moves_(places_.size()),
        points_(border.space(), kernel_radius * border.spacing(), border.dimensions()) {
    long moving = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      depth_[i] = border_.region().depth(places_[i]);
      moving += depth_[i] < band * border_.spacing();
    }
    threads_ = static_cast<int>(std::clamp(moving / 1000, 1l, static_cast<long>(omp_get_max_threads())));
  }

  std::vector<Vec3> take() { return std::move(places_); }

  /// True when the places have come to rest.
  bool round(int number) {
    points_.clear();
    for (std::size_t i = 0; i < places_.size(); ++i)  // those that move, and those that they see
      if (depth_[i] < (band + kernel_radius + 0.5) * border_.spacing()) points_.add(places_[i], border_.volume());
    points_.arrange();
    const double dx = border_.spacing();
    // The layer forms in the first rounds, and then stands.
    const double hold = std::min(1.0, number / 100.0);
    double largest = 0.0;
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(max : largest)
    for (std::size_t i = 0; i < places_.size(); ++i) {
      moves_[i] = depth_[i] < band * dx ? move_of(i, hold) : Vec3{};
      largest = std::max(largest, norm(moves_[i]));
    }
#pragma omp parallel for num_threads(threads_) schedule(static)
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (!(depth_[i] < band * dx)) continue;
      places_[i] = border_.space().wrapped(places_[i] + moves_[i]);
      depth_[i] = border_.region().depth(places_[i]);
    }
    return number > 100 && largest < at_rest * dx;
  }

 private:
  Vec3 move_of(std::size_t i, double hold) const {
    const double dx = border_.spacing();
    const Vec3& x = places_[i];
    Vec3 gradient{};
    with_kernel<double>(KernelKind::wendland_c2, kernel_radius * dx, border_.dimensions(), [&](const auto& kernel) {
      const auto add = [&](const Vec3& r, double distance, double volume) {
        if (distance > 0.0) gradient = gradient + volume * kernel.derivative(distance) / distance * r;
      };
      points_.for_each_near(x, add);
      if (depth_[i] < kernel_radius * dx) border_.outside().for_each_near(x, add);
    });
    Vec3 move = -0.4 * dx * dx * gradient;
    if (depth_[i] < layer * dx) {
      const Vec3 out = way_out(border_.region(), x, 1e-3 * dx, border_.dimensions());
      const double along = dot(move, out);
      move = move + (hold * ((depth_[i] - 0.5 * dx) - along)) * out;
    }
    const double length = norm(move), most = 0.1 * dx;
    return length > most ? most / length * move : move;
  }

  const Border& border_;
  std::vector<Vec3> places_;
  std::vector<double> depth_;  // m
  std::vector<Vec3> moves_;    // m
  PointCells points_;
  int threads_ = 1;  // few for few places: more would wait for each other
};

}  // namespace

std::vector<Vec3> relaxed_places(const Scene& scene, std::size_t k) {
  const Border border(scene, k);
  Relaxation relaxation(border, border.start());
  for (int number = 0; number < most_rounds; ++number)
    if (relaxation.round(number)) break;
  return relaxation.take();
}

Evenness evenness_of(const Scene& scene, std::size_t k, const std::vector<Vec3>& places) {
  const Border border(scene, k);
  PointCells points(border.space(), kernel_radius * border.spacing(), border.dimensions());
  for (const Vec3& x : places) points.add(x, border.volume());
  points.arrange();
  Evenness even{1e300, 1e300, 0.0, 0.0, border.content()};
  with_kernel<double>(
      KernelKind::wendland_c2, kernel_radius * border.spacing(), border.dimensions(), [&](const auto& kernel) {
        for (const Vec3& x : places) {
          double sum = 0.0;
          const auto add = [&](const Vec3&, double distance, double volume) { sum += volume * kernel.value(distance); };
          points.for_each_near(x, [&](const Vec3& r, double distance, double volume) {
            add(r, distance, volume);
            if (distance > 0.0) even.least_distance = std::min(even.least_distance, distance / border.spacing());
          });
          border.outside().for_each_near(x, add);
          even.least_sum = std::min(even.least_sum, sum);
          even.largest_sum = std::max(even.largest_sum, sum);
          even.mean_sum += sum / static_cast<double>(places.size());
        }
      });
  return even;
}

}  // namespace barchan
