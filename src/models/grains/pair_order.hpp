// The order of the pairs in the lists of a chunk, between two searches.
#pragma once

#include "models/grains/sphere_work.hpp"

namespace barchan {

/// Puts the pairs of each group in order: those that are evaluated and touch, those that are evaluated, others. A batch
/// costs the same whether one of its pairs touches or eight do, and lists that are not made anew for long, because most
/// grains rest, mix them: in a bed under saltation four of eight touched, and a third fewer batches do after it.
/// `numbers`: of the memory of a pair; `far`: the first of the two spheres that pad the lists. For chunks whose spheres
/// may sleep (`live` has a byte a batch).
void order_pairs(SphereChunk& chunk, std::size_t numbers, std::uint32_t far);

}  // namespace barchan
