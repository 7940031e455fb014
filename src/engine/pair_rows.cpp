// What a pair list does beside the search (pair_list.cpp, which is compiled once for each instruction set).
#include <string>

#include "base/errors.hpp"
#include "engine/pair_list.hpp"

namespace barchan {

std::uint32_t PairList::dummy_index(std::size_t particles, std::size_t images) {
  if (particles > last_index || images > last_index - particles)
    throw SceneError("a phase of " + std::to_string(particles) + " particles and " + std::to_string(images) +
                     " periodic images is too large: a list of neighbours counts to " + std::to_string(last_index) +
                     "; expected a larger spacing or a smaller domain");
  return static_cast<std::uint32_t>(particles + images);
}

std::size_t PairList::prepare(std::size_t size_a, std::size_t padding) {
  padding_ = padding;
  const std::size_t needed = (size_a + chunk - 1) / chunk;
  if (chunks_.size() != needed) chunks_.resize(needed);
  return needed;
}

void PairList::build_chunk(const Search& search, std::size_t number) {
  search_chunk(chunks_[number], search, number, padding_);
}

void PairList::make_scratch(int dimensions) { make_search_scratch(dimensions); }

std::uint64_t PairList::entries() const {
  std::uint64_t total = 0;
  for (const auto& c : chunks_) total += c.entries;
  return total;
}

std::uint64_t PairList::padded_entries() const {
  std::uint64_t total = 0;
  for (const auto& c : chunks_) total += c.begin.empty() ? 0 : c.begin.back();
  return total;
}

std::size_t PairList::bytes() const {
  std::size_t total = 0;
  for (const auto& c : chunks_) total += c.index.capacity() * 4 + c.begin.capacity() * 4;
  return total;
}

}  // namespace barchan
