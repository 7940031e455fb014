// Spheres that sleep: grains of a bed that nothing disturbs. They stay where they are, like fixed ones, and pairs of
// two of them are not evaluated, until something wakes them.
//
// Who falls asleep: looks are sqrt(d/g) apart. A grain that between two looks, twice, went less than 1e-3 d, and is
// slower than 1e-2 sqrt(g d), and whose acceleration by all but contacts changed by less than a tenth of g.
// Who wakes: a grain whose forces are out of the balance in which it fell asleep by more than 0.3 of its weight.
// Forces of others that sleep do not change, so only those of grains that are awake are summed; what was out of balance
// before somebody else fell asleep or woke is not forgotten. And whom the wind, or another acceleration, pushes by more
// than a tenth of g beyond what it was.
#pragma once

#include <array>
#include <vector>

#include "models/grains/sphere_work.hpp"
#include "models/workspace.hpp"

namespace barchan {

class SphereSleep {
 public:
  /// Spheres of a phase that may sleep.
  struct Part {
    std::size_t phase = 0, first = 0, count = 0;
    double diameter = 0.0;  // m, the mean one
  };

  /// `all`: spheres of all phases and fixed ones.
  void prepare(std::vector<Part> parts, std::size_t all, const Layout& layout, double gravity);
  /// Gives what is kept by number its size; new ones are awake. `moving`: spheres of all phases.
  void make_room(std::vector<Part> parts, std::size_t moving, std::size_t all);
  /// Spheres have other numbers, `to` by the one before, or are gone (ContactMemory::gone).
  void renumber(const std::vector<std::uint32_t>& to, std::size_t moving);
  /// Wakes those; numbers may be there twice, and of fixed ones.
  void wake(const std::vector<std::uint32_t>& numbers);
  /// Fixed spheres that count as awake: of a wall that travels, so that whom it disturbs wakes. After make_room.
  void keep_awake(std::size_t first, std::size_t count);
  bool on() const { return !parts_.empty(); }
  std::size_t sleeping() const { return sleeping_; }

  /// Before a step: lets spheres fall asleep and wakes those that are pushed. `numbers`: by sphere. Adds the energy of
  /// motion that went (J). Whether any did either.
  bool look(Workspace& w, const std::uint32_t* numbers, double& lost);
  /// Wakes those whom the last step of contacts disturbed.
  void wake();
  /// Before the first step with other sleepers: keeps what is out of balance.
  void begin_again();
  /// 1 of those that sleep, and of fixed ones; by sphere. Null while nobody sleeps.
  const std::uint8_t* by_sphere(const std::uint32_t* numbers);
  bool sleeps(std::uint32_t number) const { return !asleep_.empty() && asleep_[number]; }
  const SleepStep* step(const std::uint32_t* numbers, bool fresh);

  void archive(Archive& a);

 private:
  bool pushed(Workspace& w, const std::uint32_t* numbers);
  template <class F>
  void each_axis(F&& f) const {
    for (std::size_t d = 0; d < dimensions_; ++d) f(d);
  }

  static constexpr double most_way = 1e-3, most_speed = 1e-2;  // of d, of sqrt(g d)
  static constexpr double push = 0.1, unrest = 0.3;            // of g, of the weight
  static constexpr std::uint8_t looks = 2;

  std::vector<Part> parts_;
  const Layout* layout_ = nullptr;
  std::size_t moving_ = 0, dimensions_ = 2, numbers_ = 3, sleeping_ = 0;
  double gravity_ = 0.0, interval_ = 0.0, next_ = 0.0;  // m/s2, s, s
  std::array<double, 3> period_{};
  std::vector<std::uint8_t> asleep_, calm_, wakes_;     // by number
  std::vector<double> place_, pull_, offset_, unrest_;  // m, m/s2, N (N m), N (N m); by number
  std::vector<std::uint8_t> at_;                        // by sphere
  SleepStep step_;
};

}  // namespace barchan
