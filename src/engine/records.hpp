// Records: what a pair loop loads of a neighbour, packed side by side so that whole cache lines are fetched and
// transposed in registers. Particles come first, then periodic images, then one dummy that pads the rows of pair lists.
//
// A motion record holds position, velocity and two scalars:
//   2D  x y u v p V s -      3D  x y z u v w p V
// p is the pressure [Pa] (its meaning is the pass's own), V the volume [m^dimensions]; V = 0 marks the dummy; s, of a
// turbulent fluid, is the square root of the dynamic viscosity [sqrt(Pa s)]; of a laminar one that meets another fluid,
// the distance to the interface [m].
// A stress record holds position, velocity, stress/density^2 and volume:
//   2D  x y u v sxx syy sxy V     3D  x y z u v w sxx syy szz sxy syz sxz V - - -
// A carried record holds of a particle of a solid its position, its own velocity at the end of the step, the part of it
// that the turning of its rigid body gives, w x x_b, and the angular velocity of that body, w at the end of the step
// and w0 with which its torque was computed:
//   2D  x y u v cx cy w w0        3D  x y z u v w cx cy cz wx wy wz w0x w0y w0z -
// A turbulence record is a motion record whose velocity is (k, ln omega), whose pressure is the root of k/omega:
//   2D  x y k l s V - -      3D  x y z k l - s V     (l the logarithm of omega in 1/s)
// A surface record holds of a particle of an elastic body its position, velocity, the outward normal n of the surface,
// whose length says how sure it is, and its share g of a contact; g = 0 inside of the body:
//   2D  x y u v nx ny g -    3D  x y z u v w nx ny nz g - ...
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "base/aligned.hpp"
#include "engine/cell_grid.hpp"
#include "state/access.hpp"

namespace barchan {

template <int Dim>
struct MotionRecord {
  static constexpr int size = 8, position = 0, velocity = Dim, pressure = 2 * Dim, volume = 2 * Dim + 1;
  static constexpr int root = 2 * Dim + 2;  // 2D only
};

template <int Dim>
struct StressRecord {
  static constexpr int size = Dim == 2 ? 8 : 16, position = 0, velocity = Dim, stress = 2 * Dim;
  static constexpr int stresses = Dim == 2 ? 3 : 6, volume = stress + stresses;
};

/// Artificial stress/density^2 (laws/elastic.hpp), components as in a stress record; a list's entry finds it too.
struct ArtificialStressRecord {
  static constexpr int size = 8;
};

template <int Dim>
struct CarriedRecord {
  static constexpr int size = Dim == 2 ? 8 : 16, position = 0, velocity = Dim, turning = 2 * Dim, rate = 3 * Dim,
                       old_rate = Dim == 2 ? 7 : 12;
};

template <int Dim>
struct SurfaceRecord {
  static constexpr int size = Dim == 2 ? 8 : 16, position = 0, velocity = Dim, normal = 2 * Dim, share = 3 * Dim;
};

/// Whose records these are, for the check of access in builds with assertions, and whether their images are of now.
struct RecordLabel {
  std::string phase;  // empty: of no run, nobody checks
  Record record = Record::motion;
  bool images_of_now = false;  // the images are copies of the records as they are

  /// Throws std::logic_error when a task is running that did not declare that it reads them, or images of an earlier
  /// moment.
  void check_read([[maybe_unused]] bool images) const {
#ifndef NDEBUG
    if (!phase.empty()) AccessGuard::check(phase, record, images, images_of_now);
#endif
  }
};

/// Records of one phase.
class RecordArray {
 public:
  RecordArray() : RecordArray(0) {}
  explicit RecordArray(int size) : size_(static_cast<std::size_t>(size)) {}

  /// Room for `particles` + `images` + the dummy. Allocates only to grow.
  void resize(std::size_t particles, std::size_t images) {
    particles_ = particles;
    const std::size_t needed = (particles + images + 1) * size_;
    if (data_.size() < needed) data_.resize(needed + (images / 4 + 64) * size_);
    dummy_ = particles + images;
    double* d = data_.data() + dummy_ * size_;
    for (std::size_t f = 0; f < size_; ++f) d[f] = 0.0;
    d[0] = d[1] = far_away;  // finite, beyond every kernel
  }

  double* operator[](std::size_t k) { return data_.data() + k * size_; }
  const double* operator[](std::size_t k) const {
    label.check_read(k >= particles_);
    return data_.data() + k * size_;
  }
  /// For who reads particles and images.
  const double* data() const {
    label.check_read(true);
    return data_.data();
  }
  std::size_t stride() const { return size_; }
  std::uint32_t dummy() const { return static_cast<std::uint32_t>(dummy_); }
  std::size_t bytes() const { return data_.capacity() * sizeof(double); }

  RecordLabel label;

  /// Copies the images from their sources, shifted by their periods. The first `dimensions` fields are the position.
  void fill_images(const CellGrid& grid, int dimensions) {
    if (grid.is_shared()) return take_ghosts(grid, dimensions);
    const auto& images = grid.image_list();
    const auto n = static_cast<std::int64_t>(images.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t q = 0; q < n; ++q) {
      const Image& image = images[static_cast<std::size_t>(q)];
      const double* from = data_.data() + image.source * size_;
      double* to = (*this)[particles_ + static_cast<std::size_t>(q)];
      for (std::size_t f = 0; f < size_; ++f) to[f] = from[f];
      for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) to[d] += image.shift[d] * grid.period()[d];
    }
  }

 private:
  static constexpr double far_away = 1.0e12;
  /// The same on several ranks.
  void take_ghosts(const CellGrid& grid, int dimensions);
  std::size_t size_, particles_ = 0, dummy_ = 0;
  AlignedVector<double> data_;
};

/// Motion records in mixed precision, half a cache line each: positions are 32-bit whole numbers of `unit` (m) about
/// the middle of the domain, so that differences are exact however large the domain; the other fields are floats.
///   2D  x y u v p V s -      3D  x y z u v w p V
class CompactRecords {
 public:
  static constexpr int size = 8;

  CompactRecords() = default;
  explicit CompactRecords(const Bounds& bounds) {
    double extent = 0.0;
    for (std::size_t d = 0; d < static_cast<std::size_t>(bounds.dimensions); ++d) {
      middle_[d] = 0.5 * (bounds.low[d] + bounds.high[d]);
      extent = std::max(extent, bounds.high[d] - bounds.low[d]);
    }
    // The domain fills three quarters of half the range: walls stand outside it, the dummy far from both.
    unit_ = 1.5 * extent / 2147483648.0;
  }

  /// Room for `particles` + `images` + the dummy. Allocates only to grow.
  void resize(std::size_t particles, std::size_t images) {
    particles_ = particles;
    const std::size_t needed = (particles + images + 1) * size;
    if (data_.size() < needed) data_.resize(needed + (images / 4 + 64) * size);
    float* d = data_.data() + (particles + images) * size;
    std::fill(d, d + size, 0.0f);
    d[0] = d[1] = std::bit_cast<float>(std::numeric_limits<std::int32_t>::min());
  }

  /// Writes record k. x: m; v: m/s; p: Pa; volume: m^dimensions.
  template <int Dim>
  void write(std::size_t k, const std::array<double, Dim>& x, const std::array<double, Dim>& v, double p,
             double volume) {
    float* r = data_.data() + k * size;
    for (std::size_t d = 0; d < Dim; ++d) {
      r[d] = std::bit_cast<float>(place(x[d], d));
      r[Dim + d] = static_cast<float>(v[d]);
    }
    r[2 * Dim] = static_cast<float>(p);
    r[2 * Dim + 1] = static_cast<float>(volume);
  }

  /// Copies the records of `count` particles, of the same layout.
  template <int Dim>
  void copy(const RecordArray& from, std::size_t count) {
    using R = MotionRecord<Dim>;
    const auto n = static_cast<std::int64_t>(count);
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      const double* r = from[static_cast<std::size_t>(i)];
      std::array<double, Dim> x, v;
      for (std::size_t d = 0; d < Dim; ++d) {
        x[d] = r[R::position + d];
        v[d] = r[R::velocity + d];
      }
      write<Dim>(static_cast<std::size_t>(i), x, v, r[R::pressure], r[R::volume]);
    }
  }

  /// Makes the images of the particles' records; x: the particles' positions (m) by axis.
  template <int Dim>
  void fill_images(const CellGrid& grid, const std::array<const double*, Dim>& x) {
    if (grid.is_shared()) return take_ghosts<Dim>(grid, x);
    const auto& images = grid.image_list();
    const auto n = static_cast<std::int64_t>(images.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t q = 0; q < n; ++q) {
      const Image& image = images[static_cast<std::size_t>(q)];
      const float* from = data_.data() + static_cast<std::size_t>(image.source) * size;
      float* to = data_.data() + (particles_ + static_cast<std::size_t>(q)) * size;
      std::copy(from, from + size, to);
      for (std::size_t d = 0; d < Dim; ++d)
        if (image.shift[d] != 0)
          to[d] = std::bit_cast<float>(place(x[d][image.source] + image.shift[d] * grid.period()[d], d));
    }
  }

  /// For who reads particles and images.
  const float* data() const {
    label.check_read(true);
    return data_.data();
  }
  float* operator[](std::size_t k) { return data_.data() + k * size; }
  const float* operator[](std::size_t k) const {
    label.check_read(k >= particles_);
    return data_.data() + k * size;
  }
  double unit() const { return unit_; }

  RecordLabel label;

  std::size_t bytes() const { return data_.capacity() * sizeof(float); }

 private:
  std::int32_t place(double x, std::size_t axis) const {
    constexpr double limit = 1.9 * 1073741824.0;  // what left the domain is far enough there
    return static_cast<std::int32_t>(std::clamp((x - middle_[axis]) * (1.0 / unit_), -limit, limit));
  }
  /// The images of the particles' records on several ranks.
  template <int Dim>
  void take_ghosts(const CellGrid& grid, const std::array<const double*, Dim>& x) {
    grid.fill_ghosts(
        size * sizeof(float),
        [&](const Image& image, std::byte* item) {
          std::array<float, size> to;
          std::copy_n(data_.data() + static_cast<std::size_t>(image.source) * size, size, to.data());
          for (std::size_t d = 0; d < Dim; ++d)
            if (image.shift[d] != 0)
              to[d] = std::bit_cast<float>(place(x[d][image.source] + image.shift[d] * grid.period()[d], d));
          std::memcpy(item, to.data(), sizeof to);
        },
        [&](std::size_t q, const std::byte* item) {
          std::memcpy(data_.data() + (particles_ + q) * size, item, size * sizeof(float));
        });
  }
  double unit_ = 1.0;
  std::array<double, 3> middle_{};
  std::size_t particles_ = 0;
  AlignedVector<float> data_;
};

/// What pair loops load of a neighbour beside its motion record; order as there.
struct EddyRecords {
  AlignedVector<double> root;   // sqrt of the dynamic viscosity, eddies included [sqrt(Pa s)]; or what s is (above)
  AlignedVector<double> touch;  // Pa s, of pairs with grains next to the particle
  RecordLabel label;
  static constexpr std::size_t of_a_particle = 2 * sizeof(double);  // bytes
  void resize(std::size_t particles, std::size_t images);
  void fill_images(std::size_t particles, const CellGrid& grid);
  /// Gives the motion records of `count` particles, in two dimensions, their roots.
  void give_roots(RecordArray& records, std::size_t count) const;
  void give_roots(CompactRecords& records, std::size_t count) const;
  std::size_t bytes() const;

 private:
  /// The images on several ranks.
  void take_ghosts(std::size_t particles, const CellGrid& grid);
};

}  // namespace barchan
