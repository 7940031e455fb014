// A step allocates nothing: operator new is counted through two hundred steps of each kind of scene, with sorting and
// searching among them, after a warm-up in which the lists have found their sizes.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "physics/flags.hpp"
#include "physics/small_scenes.hpp"

namespace {

std::atomic<long> allocations{0};

void* tried(std::size_t size, std::size_t alignment) {
  ++allocations;
  return alignment > 0 ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                       : std::malloc(size);
}

void* counted(std::size_t size, std::size_t alignment) {
  void* p = tried(size, alignment);
  if (p == nullptr && size > 0) throw std::bad_alloc();
  return p;
}

}  // namespace

// NOLINTBEGIN: the program's own allocation functions. They are not inlined: g++ 12 warns (mismatched-new-delete) where
// it sees std::malloc in one of them and operator delete in its caller. The nothrow forms stand here too
// (std::stable_sort calls them): the address sanitizer's own would not fit these operators delete.
[[gnu::noinline]] void* operator new(std::size_t size) { return counted(size, 0); }
[[gnu::noinline]] void* operator new[](std::size_t size) { return counted(size, 0); }
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t a) {
  return counted(size, static_cast<std::size_t>(a));
}
[[gnu::noinline]] void* operator new[](std::size_t size, std::align_val_t a) {
  return counted(size, static_cast<std::size_t>(a));
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return tried(size, 0); }
[[gnu::noinline]] void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return tried(size, 0); }
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
// NOLINTEND

namespace barchan {
namespace {

TEST(Allocations, AreCounted) {
  const long before = allocations;
  const auto text = std::make_unique<std::string>(1000, 'x');
  const AlignedVector<double> array(100);
  EXPECT_EQ(allocations, before + 3);
}

class Steps : public ::testing::TestWithParam<small::Named> {};

TEST_P(Steps, AllocateNothing) {
  const auto run = small::simulation(*GetParam().text);
  long rebuilds = run->searches();
  int warm_up = 0;  // until the particles have been sorted anew a few times
  while (warm_up < 100 || run->searches() < rebuilds + 3) {
    run->step(1.0);
    ASSERT_LT(++warm_up, 2000);
  }
  rebuilds = run->searches();
  const long before = allocations;
  for (int k = 0; k < 200; ++k) {
    run->step(1.0);
    ASSERT_EQ(allocations, before) << "in step " << k << " after " << run->searches() - rebuilds << " searches";
  }
  EXPECT_GT(run->searches(), rebuilds) << "the test is meant to see a search";
}

// They are searched anew too seldom for the test above.
TEST(StepsOfSpheres, AllocateNothingOnABodyInSpace) {
  const auto run = small::simulation(small::spheres_on_block_3d);
  for (int k = 0; k < 400; ++k) run->step(1.0);
  const long before = allocations;
  for (int k = 0; k < 400; ++k) {
    run->step(1.0);
    ASSERT_EQ(allocations, before) << "in step " << k;
  }
}

TEST(StepsWithBooksOfEnergy, AllocateNothing) {
  for (const auto* text : {&small::dam, &small::plain_dam}) {
    const auto run = small::simulation(*text, {"phases.water.energy-budget=true"});
    for (int k = 0; k < 300; ++k) run->step(1.0);
    const long before = allocations;
    for (int k = 0; k < 200; ++k) {
      run->step(1.0);
      ASSERT_EQ(allocations, before) << "in step " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Steps,
    ::testing::Values(small::Named{"Dune", &small::dune}, small::Named{"TurbulentDune", &small::turbulent_dune},
                      small::Named{"HeldDune", &small::held_dune}, small::Named{"Dam", &small::dam},
                      small::Named{"PlainDam", &small::plain_dam}, small::Named{"TwoFluids", &small::two_fluids},
                      small::Named{"Channel", &small::channel}, small::Named{"Squares", &small::squares},
                      small::Named{"Grains", &small::grains}, small::Named{"BlownGrains", &small::blown_grains},
                      small::Named{"Spheres", &small::spheres}, small::Named{"Drowned", &small::drowned},
                      small::Named{"DrownedConsistent", &small::drowned_consistent},
                      small::Named{"DrownedBallConsistent", &small::drowned_ball_consistent},
                      small::Named{"Flag", &small::flag}, small::Named{"Jelly", &small::jelly},
                      small::Named{"Rigid", &small::rigid}, small::Named{"Paddle", &small::paddle},
                      small::Named{"Drum", &small::drum}, small::Named{"SpheresOnBlock", &small::spheres_on_block},
                      small::Named{"HertzianSpheres", &small::hertzian_spheres}),
    [](const auto& s) { return std::string(s.param.name); });

}  // namespace
}  // namespace barchan
