// What ranks tell each other of phases that are whole on every one of them.
#include "models/share_items.hpp"
#include "models/workspace.hpp"

namespace barchan {

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

void Workspace::share_values(std::size_t phase, std::vector<Vec3>& values) const {
  share_items(neighbours.owners(phase), 3, [&](std::size_t k) { return values[k].data(); });
}

}  // namespace barchan
