// Spheres that sleep: grains of a bed that nothing disturbs. They stay where they are, like fixed ones, and pairs of
// two of them are not evaluated, until something wakes them.
//
// Who falls asleep: looks are sqrt(d/g)/4 apart. A grain that between two looks, twice, went less than 2.5e-4 d, and is
// slower than 1e-2 sqrt(g d), and whose acceleration by all but contacts changed by less than a tenth of g. So a grain
// that an impact far away shook sleeps again in less than sqrt(d/g).
// Who wakes: a grain whose forces are out of the balance in which it fell asleep by more than 0.3 of its weight, in a
// mean over sqrt(d/g)/30. So a short push wakes it whose impulse would give it 1e-2 sqrt(g d), the speed above which
// nobody falls asleep, and vibration wakes nobody.
// Forces of others that sleep do not change, so only those of grains that are awake are summed; what was out of balance
// before somebody else fell asleep or woke is not forgotten. And whom the wind, or another acceleration, pushes by more
// than a tenth of g beyond what it was.
#pragma once

#include <array>
#include <bit>
#include <span>
#include <vector>

#include "models/grains/sphere_pairs.hpp"
#include "models/grains/sphere_shares.hpp"
#include "models/workspace.hpp"

namespace barchan {

class SphereSleep {
 public:
  /// Spheres of a phase that may sleep.
  struct Part {
    std::size_t phase = 0, first = 0, count = 0;
    double diameter = 0.0;  // m, the mean one
  };

  void prepare(std::vector<Part> parts, const Layout& layout, double gravity);
  /// Gives what is kept by number its size; new ones are awake. `moving`: spheres of all phases; `all`: and fixed ones.
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
  /// Wakes those whom the last step of contacts disturbed, all of them at the border of chunks. Returns who woke, by
  /// sphere, until the next call. `shared`: other ranks have other chunks; who woke is told to all.
  std::span<const std::uint32_t> wake(std::span<const SphereChunk> chunks, const std::uint32_t* numbers, bool shared);
  /// Every rank gets what steps of contacts have found of those that sleep: a rank knows it of its own spheres.
  /// `numbers`: by sphere.
  void share(const SphereShares& shares, const std::uint32_t* numbers);
  /// Whether the last look let somebody fall asleep.
  bool some_fell_asleep() const { return fell_; }
  /// Takes over who sleeps, by sphere: flags(). Since the last settled() those whose neighbours changed count as fresh.
  void mark(const std::uint32_t* numbers);
  /// The same, where since the last settled() only those changed that the last wake() woke.
  void mark_woken();
  /// 1 of those that sleep, of fixed ones and of the two that pad; by sphere, as of the last mark(). Null: nobody may.
  const std::uint8_t* flags() const { return on() ? at_.data() : nullptr; }
  /// Whether a sphere fell asleep or woke since the last settled(); by sphere, as of the last mark().
  bool changed(std::size_t sphere) const { return changed_at_[sphere] != 0; }
  /// Gives a chunk what follows from the flags: the pairs that are evaluated, who moves, and who sleeps beside one that
  /// does. Keeps what is out of balance of those that sleep beside one that changed. Calls `beside` with each sphere of
  /// another chunk in a pair with one that changed.
  template <class F>
  void sort_out(const SphereSet& s, SphereChunk& chunk, F&& beside);
  /// All chunks are sorted out.
  void settled();
  bool sleeps(std::uint32_t number) const { return !asleep_.empty() && asleep_[number]; }
  const SleepStep* step(const std::uint32_t* numbers);

  void archive(Archive& a);

 private:
  bool pushed(Workspace& w, const std::uint32_t* numbers);
  void rouse(std::uint32_t number);
  void keep_balance(std::uint32_t number);
  template <class F>
  void each_axis(F&& f) const {
    for (std::size_t d = 0; d < dimensions_; ++d) f(d);
  }

  static constexpr double apart = 0.25;                          // of sqrt(d/g), looks
  static constexpr double most_way = 2.5e-4, most_speed = 1e-2;  // of d, of sqrt(g d)
  static constexpr double push = 0.1, unrest = 0.3;              // of g, of the weight
  static constexpr std::uint8_t looks = 2;

  std::vector<Part> parts_;
  const Layout* layout_ = nullptr;
  std::size_t moving_ = 0, dimensions_ = 2, numbers_ = 3, sleeping_ = 0;
  double gravity_ = 0.0, interval_ = 0.0, next_ = 0.0, lag_ = 0.0;  // m/s2, s, s
  std::array<double, 3> period_{};
  bool fell_ = false;
  std::vector<std::uint8_t> asleep_, calm_, wakes_;     // by number
  std::vector<std::uint8_t> changed_, fresh_;           // by number: who fell asleep or woke; whose neighbour did
  std::vector<double> place_, pull_, offset_, unrest_;  // m, m/s2, N (N m), N (N m); by number
  std::vector<std::uint8_t> at_, changed_at_;           // by sphere
  std::vector<std::uint32_t> woken_;                    // spheres, by the last wake()
  SleepStep step_;
};

template <class F>
void SphereSleep::sort_out(const SphereSet& s, SphereChunk& chunk, F&& beside) {
  constexpr std::size_t batch = SphereChunk::batch;
  constexpr std::uint8_t at_border = 1, beside_changed = 2;
  std::array<std::uint8_t, SphereChunk::most> mark{};
  const auto look = [&](std::uint32_t k, std::uint32_t other, bool live) {
    const bool own = k >= chunk.begin && k < chunk.end;
    if (changed_at_[other] && !own && k < s.moving) beside(k);
    if (!own || !at_[k]) return;
    std::uint8_t& of = mark[k - chunk.begin];
    of = static_cast<std::uint8_t>(of | (live ? at_border : 0) | (changed_at_[other] ? beside_changed : 0));
  };
  const std::size_t batches = chunk.touches.size();
  fit(chunk.live, batches);
  std::uint32_t any = 0;
  for (std::size_t q = 0; q < batches; ++q) {
    std::uint32_t bits = 0;
    for (std::size_t lane = 0; lane < batch; ++lane) {
      const std::uint32_t a = chunk.a[q * batch + lane], b = chunk.b[q * batch + lane];
      const bool live = !(at_[a] && at_[b]);
      bits |= std::uint32_t{live} << lane;
      if (!live && !changed_at_[a] && !changed_at_[b]) continue;
      look(a, b, live);
      look(b, a, live);
    }
    chunk.live[q] = static_cast<std::uint8_t>(bits);
    any |= bits;
  }
  for (const SphereChunk::AtWalls& at : chunk.walls)
    if (std::uint8_t& of = mark[at.sphere - chunk.begin]; at.moves != 0 && at_[at.sphere])
      of = static_cast<std::uint8_t>(of | at_border);
  chunk.any_live = any != 0;
  chunk.awake.clear();
  chunk.border.clear();
  for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
    if (!at_[k]) chunk.awake.push_back(static_cast<std::uint32_t>(k));
    const std::uint8_t of = mark[k - chunk.begin];
    if ((of & at_border) != 0) chunk.border.push_back(static_cast<std::uint32_t>(k));
    if ((of & beside_changed) != 0 || (at_[k] && changed_at_[k])) keep_balance(s.numbers[k]);
  }
  chunk.all_awake = chunk.awake.size() == chunk.end - chunk.begin;
  chunk.resting = 0.0;
  for (const SphereChunk::Group& group : chunk.groups)
    for (std::size_t q = group.first; q < group.end; ++q)
      chunk.resting += group.weight * std::popcount(static_cast<unsigned>(chunk.touches[q] & ~chunk.live[q] & 0xff));
}

}  // namespace barchan
