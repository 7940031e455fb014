// What a checkpoint holds of the cells of a grid: of one process, and of several ranks together.
#include <algorithm>
#include <numeric>

#include "base/errors.hpp"
#include "engine/cell_grid.hpp"

namespace barchan {

namespace {

/// Items of all ranks on the first one.
template <class T>
std::vector<T> gathered(const T* mine, std::size_t count) {
  Communicator& all = *ranks::active();
  const std::vector<std::size_t> counts = ranks::each(count);
  std::vector<T> together;
  if (all.rank() == 0) together.resize(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
  all.gather(mine, count, together.data(), counts, sizeof(T));
  return together;
}

}  // namespace

void CellGrid::archive(Archive& a) {
  if (whole_) return save_whole(a);
  a.array("cell begins", begin_);
  a.array("cell ends", end_);
  a.array("images", images_);
  for (std::size_t d = 0; d < dimensions_; ++d) a.array("search positions", search_[d]);
  if (shared_) {
    SharedCells& s = *shared_;
    a.array("ranks", s.first);
    a.array("sent", s.sends);
    a.array("sent by rank", s.send_counts);
    a.array("received by rank", s.receive_counts);
    a.array("received", s.slots);
    a.array("own images", s.image_begin);
    for (auto& positions : s.image_search) a.array("search positions of own images", positions);
    if (a.loads()) {
      own_by_first(s);
      s.sort_out_own_images(static_cast<std::size_t>(ranks::active()->rank()));
    }
  }
  if (a.loads()) make_runs();
}

void CellGrid::save_whole(Archive& a) {
  SharedCells::Whole& whole = *whole_;
  a.array("cell begins", whole.begin);
  a.array("cell ends", whole.end);
  a.array("images", whole.images);
  for (std::size_t d = 0; d < dimensions_; ++d)
    a.rows("search positions", search_[d].data(), whole.rows, whole.beyond[d].data(), whole.beyond[d].size());
}

/// The first rank has the cells of all ranks, as one process has them, and their images. Each keeps its own particles.
void CellGrid::gather() {
  if (!shared_) return;
  const SharedCells& s = *shared_;
  const auto [from, to] = own_walk();
  std::vector<std::uint32_t> own;
  for (std::size_t w = from; w < to; ++w) own.push_back(end_[walk_[w]] - begin_[walk_[w]]);
  const std::vector<std::uint32_t> by_cell = gathered(own.data(), own.size());
  std::array<std::vector<float>, 3> beyond;
  for (std::size_t d = 0; d < dimensions_; ++d)
    beyond[d] = gathered(s.image_search[d].data(), s.image_search[d].size());
  // How many images of each rank's are before those of a halo cell.
  std::vector<std::size_t> next{0};
  for (const std::size_t count : ranks::each(s.image_search[0].size())) next.push_back(next.back() + count);
  const std::size_t n = from < to ? end_[walk_[to - 1]] : 0;
  SharedCells::Whole whole;
  whole.rows = {ranks::before(n), n, ranks::total(n)};
  if (ranks::is_first()) {
    place_whole(by_cell, whole);
    const std::size_t images = whole.images.size(), particles = static_cast<std::size_t>(whole.rows.all);
    const std::size_t room = std::max(images, particles <= 4096 ? particles : 0);  // as make_images()
    for (std::size_t d = 0; d < dimensions_; ++d) {
      whole.beyond[d].assign(room + 16, 0.0f);
      std::vector<std::size_t> at = next;
      for (const HaloCell& h : halo_cells_)
        for (std::uint32_t q = whole.begin[h.cell]; q < whole.end[h.cell]; ++q)
          whole.beyond[d][q - particles] = beyond[d][at[static_cast<std::size_t>(s.owner[h.source])]++];
    }
  }
  whole_ = std::move(whole);
}

/// From the particles in each walked cell: the cells of one process, and its images.
void CellGrid::place_whole(const std::vector<std::uint32_t>& by_cell, SharedCells::Whole& whole) const {
  whole.begin.assign(begin_.size(), 0);
  whole.end.assign(begin_.size(), 0);
  std::uint32_t total = 0;
  for (std::size_t w = 0; w < walk_.size(); ++w) {
    whole.begin[walk_[w]] = total;
    whole.end[walk_[w]] = total += by_cell[w];
  }
  for (const HaloCell& h : halo_cells_) {
    whole.begin[h.cell] = total;
    for (std::uint32_t k = whole.begin[h.source]; k < whole.end[h.source]; ++k) whole.images.push_back({k, h.shift});
    whole.end[h.cell] = total += whole.end[h.source] - whole.begin[h.source];
  }
}

void CellGrid::load_share(Archive& a, PhaseParticles& particles) {
  shared_.reset();
  const std::size_t cells = begin_.size();
  a.array("cell begins", begin_);
  a.array("cell ends", end_);
  if (begin_.size() != cells || end_.size() != cells)
    throw SceneError("the checkpoint does not fit this scene: its cells are others");
  a.parts<Image>("images", [](std::uint64_t, auto&&) {});  // they follow from the cells
  const auto [first, last] = take_own_cells();
  SharedCells& s = *shared_;
  const auto rank = ranks::available()->rank();
  s.image_begin.assign(1, 0);
  std::uint32_t own_images = 0;
  for (const HaloCell& halo : halo_cells_) {
    if (s.owner[halo.source] == rank) own_images += end_[halo.cell] - begin_[halo.cell];
    s.image_begin.push_back(own_images);
  }
  for (std::size_t d = 0; d < dimensions_; ++d)
    a.parts<float>("search positions", [&, first = first, last = last](std::uint64_t, auto&& read) {
      if (search_[d].capacity() < last - first) give_back(search_[d]);
      search_[d].resize(last - first);
      read(first, search_[d].data(), last - first);
      s.image_search[d].resize(own_images);
      for (std::size_t h = 0; h < halo_cells_.size(); ++h)
        read(begin_[halo_cells_[h].cell], s.image_search[d].data() + s.image_begin[h],
             s.image_begin[h + 1] - s.image_begin[h]);
    });
  give_back(images_);
  give_back(cell_of_);
  give_back(order_);
  particles.load_rows(a, first, last);
  make_runs();
}

}  // namespace barchan
