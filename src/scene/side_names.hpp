// The sides of the domain by their names, and the axis of heights.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "scene/scene.hpp"

namespace barchan {

/// The axis of heights: y; z where gravity is along -z, or has no part along y and one along -z, and z is not periodic.
/// Beds, grains that settle or enter, "bottom" and "top" follow it.
std::size_t up_axis(const Domain& domain);
/// The third axis, beside x and that of heights.
std::size_t across_axis(const Domain& domain);

/// By axis and whether it is the upper side.
using SideNames = std::array<std::array<const char*, 2>, 3>;
/// {"left", "right"} along x, {"bottom", "top"} along the axis of heights. Along the third the names are those of one
/// who looks with x to the right and heights upwards: {"back", "front"} along z, {"front", "back"} along y.
const SideNames& side_names(const Domain& domain);

struct SideAt {
  std::size_t axis = 0;
  bool upper = false;
};
/// Where the side with a name is; the name is one of the words of Side.
SideAt side_at(const Domain& domain, std::string_view name);
SideAt side_at(const Domain& domain, Side side);
SideAt side_at(const Domain& domain, Flank flank);

/// "left"
std::string word_of(Side side);
std::string word_of(Flank flank);

}  // namespace barchan
