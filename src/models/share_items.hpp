// What one rank has computed becomes known to all.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "engine/exchange.hpp"

namespace barchan {

/// Every rank gets items of `width` values from their owners: at(k) is where item k begins, owners[k] the rank that has
/// it. All ranks know all owners. Without owners nothing is shared.
template <class At>
void share_items(const std::vector<std::int32_t>& owners, std::size_t width, At&& at) {
  if (owners.empty() || !Exchange().is_shared()) return;
  const std::int32_t own = Exchange().rank();
  std::vector<std::size_t> next(static_cast<std::size_t>(Exchange().size()) + 1, 0);
  std::vector<std::remove_cvref_t<decltype(*at(0))>> items;
  for (std::size_t k = 0; k < owners.size(); ++k) {
    next[static_cast<std::size_t>(owners[k]) + 1] += width;
    if (owners[k] == own) items.insert(items.end(), at(k), at(k) + width);
  }
  for (std::size_t r = 1; r < next.size(); ++r) next[r] += next[r - 1];
  Exchange().join(items);
  for (std::size_t k = 0; k < owners.size(); ++k) {
    std::size_t& from = next[static_cast<std::size_t>(owners[k])];
    std::copy_n(items.begin() + static_cast<std::ptrdiff_t>(from), width, at(k));
    from += width;
  }
}

}  // namespace barchan
