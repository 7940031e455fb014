#include "engine/records.hpp"

namespace barchan {

void RecordArray::take_ghosts(const CellGrid& grid, int dimensions) {
  grid.fill_ghosts(
      size_ * sizeof(double),
      [&](const Image& image, std::byte* item) {
        std::memcpy(item, data_.data() + image.source * size_, size_ * sizeof(double));
        if (!image.shifted()) return;
        for (std::size_t d = 0; d < static_cast<std::size_t>(dimensions); ++d) {
          double x = data_[image.source * size_ + d];
          x += image.shift[d] * grid.period()[d];
          std::memcpy(item + d * sizeof(double), &x, sizeof x);
        }
      },
      [&](std::size_t q, const std::byte* item) {
        std::memcpy(data_.data() + (particles_ + q) * size_, item, size_ * sizeof(double));
      });
}

void EddyRecords::resize(std::size_t particles, std::size_t images) {
  const std::size_t needed = particles + images + 1;  // and the dummy
  for (auto* values : {&root, &touch}) {
    if (values->size() < needed) values->resize(needed + images / 4 + 64);
    (*values)[particles + images] = 0.0;
  }
}

void EddyRecords::fill_images(std::size_t particles, const CellGrid& grid) {
  if (grid.is_shared()) return take_ghosts(particles, grid);
  const auto& images = grid.image_list();
  const auto n = static_cast<std::int64_t>(images.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    root[particles + k] = root[images[k].source];
    touch[particles + k] = touch[images[k].source];
  }
}

void EddyRecords::take_ghosts(std::size_t particles, const CellGrid& grid) {
  grid.fill_ghosts(
      of_a_particle,
      [&](const Image& image, std::byte* item) {
        const std::array<double, 2> values{root[image.source], touch[image.source]};
        std::memcpy(item, values.data(), sizeof values);
      },
      [&](std::size_t q, const std::byte* item) {
        std::memcpy(&root[particles + q], item, sizeof(double));
        std::memcpy(&touch[particles + q], item + sizeof(double), sizeof(double));
      });
}

namespace {

template <class T, class Records>
void copy_roots(const AlignedVector<double>& root, Records& records, std::size_t count) {
  const auto n = static_cast<std::int64_t>(count);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    records[k][MotionRecord<2>::root] = static_cast<T>(root[k]);
  }
}

}  // namespace

void EddyRecords::give_roots(RecordArray& records, std::size_t count) const {
  copy_roots<double>(root, records, count);
}
void EddyRecords::give_roots(CompactRecords& records, std::size_t count) const {
  copy_roots<float>(root, records, count);
}

std::size_t EddyRecords::bytes() const { return (root.capacity() + touch.capacity()) * sizeof(double); }

}  // namespace barchan
