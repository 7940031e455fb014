// Arrays on cache-line boundaries, the only storage of particle data.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace barchan {

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{64})); }
  void deallocate(T* p, std::size_t) { ::operator delete (p, std::align_val_t{64}); }
  template <class U>
  bool operator==(const CacheLineAllocator<U>&) const {
    return true;
  }
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

/// Empties a vector and gives its memory back, which `values = {}` does not.
template <class Vector>
void give_back(Vector& values) {
  Vector().swap(values);
}

}  // namespace barchan
