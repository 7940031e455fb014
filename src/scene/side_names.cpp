#include "scene/side_names.hpp"

#include "scene/words.hpp"

namespace barchan {

namespace {

constexpr SideNames y_is_up{{{"left", "right"}, {"bottom", "top"}, {"back", "front"}}};
constexpr SideNames z_is_up{{{"left", "right"}, {"front", "back"}, {"bottom", "top"}}};

template <class Name>
std::string word_in_table(Name name) {
  for (const Word& word : words_of<Name>)
    if (word.meaning == static_cast<int>(name)) return std::string(word.word);
  return "";
}

}  // namespace

std::size_t up_axis(const Domain& domain) {
  return domain.gravity[1] == 0.0 && domain.gravity[2] < 0.0 && !domain.periodic[2] ? 2 : 1;
}
std::size_t across_axis(const Domain& domain) { return 3 - up_axis(domain); }

const SideNames& side_names(const Domain& domain) { return up_axis(domain) == 2 ? z_is_up : y_is_up; }

SideAt side_at(const Domain& domain, std::string_view name) {
  const SideNames& names = side_names(domain);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true})
      if (names[axis][upper ? 1 : 0] == name) return {axis, upper};
  return {};
}
SideAt side_at(const Domain& domain, Side side) { return side_at(domain, word_of(side)); }
SideAt side_at(const Domain& domain, Flank flank) { return side_at(domain, word_of(flank)); }

std::string word_of(Side side) { return word_in_table(side); }
std::string word_of(Flank flank) { return word_in_table(flank); }

}  // namespace barchan
