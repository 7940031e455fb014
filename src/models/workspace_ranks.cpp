// What ranks tell each other of phases that are whole on every one of them.
#include "base/ranks.hpp"
#include "models/workspace.hpp"

namespace barchan {

namespace {

/// Every rank gets the items of `width` doubles of all particles from their owners: at(k) is where that of particle k
/// begins.
template <class At>
void share_items(const std::vector<std::int32_t>& owners, std::size_t width, At&& at) {
  if (owners.empty()) return;
  const std::int32_t own = ranks::active()->rank();
  std::vector<std::size_t> next(static_cast<std::size_t>(ranks::active()->size()) + 1, 0);
  std::vector<double> items;
  for (std::size_t k = 0; k < owners.size(); ++k) {
    next[static_cast<std::size_t>(owners[k]) + 1] += width;
    if (owners[k] == own) items.insert(items.end(), at(k), at(k) + width);
  }
  for (std::size_t r = 1; r < next.size(); ++r) next[r] += next[r - 1];
  ranks::join(items);
  for (std::size_t k = 0; k < owners.size(); ++k) {
    std::size_t& from = next[static_cast<std::size_t>(owners[k])];
    std::copy_n(items.begin() + static_cast<std::ptrdiff_t>(from), width, at(k));
    from += width;
  }
}

}  // namespace

void Workspace::share_field(std::size_t phase, Field field) {
  const auto& owners = neighbours.owners(phase);
  if (owners.empty()) return;
  PhaseParticles& p = particles(phase);
  for (int c = 0; c < p.components(field); ++c) {
    double* const column = p.column(field, c);
    share_items(owners, 1, [&](std::size_t k) { return column + k; });
  }
}

void Workspace::share_records(std::size_t phase, Record record) {
  const auto& owners = neighbours.owners(phase);
  if (owners.empty()) return;
  RecordArray& records = to_write(phase, record);
  share_items(owners, records.stride(), [&](std::size_t k) { return records[k]; });
}

}  // namespace barchan
