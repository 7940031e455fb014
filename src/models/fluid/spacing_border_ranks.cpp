// Of models/fluid/spacing_border.hpp on several ranks: every rank knows all members about the border, and passes the
// same on; each takes its own particles away.
#include "engine/exchange.hpp"
#include "models/fluid/spacing_border.hpp"

namespace barchan {

/// The members of all ranks, with what they are made of.
void SpacingBorder::join_ranks() {
  std::vector<Detail> details;
  for (const Member& m : members_) {
    Detail& detail = details.emplace_back();
    detail.values = values_of(m);
    detail.kept = kept_of(m);
    detail.x = stands_at(m);
    detail.rank = Exchange().rank();
    detail.place = static_cast<std::int64_t>(m.place);
  }
  Exchange().join(members_);
  Exchange().join(details);
  details_ = std::move(details);
  for (std::size_t k = 0; k < members_.size(); ++k) members_[k].place = static_cast<std::uint32_t>(k);
}

Vec3 SpacingBorder::stands_at(const Member& m) const {
  if (!details_.empty()) return details_[m.place].x;
  const PhaseParticles& p = w_->particles(m.coarse ? coarse_ : fine_);
  Vec3 x{};
  for (int d = 0; d < p.dimensions(); ++d) x[static_cast<std::size_t>(d)] = p.column(Field::position, d)[m.place];
  return x;
}

std::optional<std::size_t> SpacingBorder::place_here(const Member& m) const {
  if (details_.empty()) return m.place;
  const Detail& detail = details_[m.place];
  if (detail.rank != Exchange().rank()) return std::nullopt;
  return static_cast<std::size_t>(detail.place);
}

}  // namespace barchan
