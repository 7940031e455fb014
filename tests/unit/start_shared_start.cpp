// A start that ranks share out: what all of them make, one rank after another, are the particles of one process, bit
// for bit, and no rank has many more than its part. Faults are told in the words of one process.
#include "start/shared_start.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <sstream>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "simulation/settle.hpp"
#include "simulation/simulation.hpp"
#include "start/generate.hpp"
#include "start/lattice.hpp"
#include "unit/forked_ranks.hpp"

namespace barchan {
namespace {

using forked::on_ranks;

/// A box of 2 m by 1 m by, in three dimensions, 0.8 m, with the phases that the fills name: water, oil, sand, wall.
std::string tank(int dimensions, const std::string& periodic, const std::string& fills) {
  const bool flat = dimensions == 2;
  std::string text = std::string("dimensions = ") + (flat ? "2" : "3") + "\nspacing = " + (flat ? "0.05" : "0.1") +
                     "\n[domain]\nsize = " + (flat ? "[2, 1]" : "[2, 1, 0.8]") + "\nperiodic = [" + periodic +
                     "]\ngravity = " + (flat ? "[0, -1]" : "[0, -1, 0]") + "\n[time]\nend = 1\n";
  const std::vector<std::pair<std::string, std::string>> phases{
      {"water", "kind = \"fluid\"\ndensity = 1000\nsound-speed = 20\n"},
      {"oil", "kind = \"fluid\"\ndensity = 800\nsound-speed = 20\n"},
      {"sand", "kind = \"grains\"\ndensity = 100000\nrestitution = 0.5\n"},
      {"wall", "kind = \"wall\"\n"}};
  std::string entries = "[interactions]\nkernel = \"wendland-c2\"\n", before;
  for (const auto& [name, keys] : phases) {
    if (fills.find("\"" + name + "\"") == std::string::npos) continue;
    text.append("[phases.").append(name).append("]\n").append(keys);
    if (name != "wall") entries.append(name).append("-").append(name).append(" = 2.6\n");
    std::istringstream others(before);
    for (std::string other; others >> other;) entries.append(other).append("-").append(name).append(" = 2.6\n");
    before.append(name).append(" ");
  }
  return text + entries + fills;
}

const std::string walls = "[[fill]]\nphase = \"wall\"\nshape = { sides = [\"bottom\", \"top\"] }\n";
const std::string rest = "[[fill]]\nphase = \"oil\"\nshape = \"the-rest\"\n";
const std::string disc = "[[fill]]\nphase = \"water\"\nshape = { disc = { centre = [0.925, 0.525], radius = 0.33 } }\n";

const std::string ball =
    "[[fill]]\nphase = \"water\"\nshape = { sphere = { centre = [0.95, 0.45, 0.35], radius = 0.33 } }\n";

template <class T>
void put(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

/// The particles of a phase: on ranks one rank after another.
struct Made {
  std::string position, velocity, pressure;
  std::size_t total = 0, most = 0, first_wrong = 0;
};

std::string answer_of(const ParticleBlock& block) {
  const std::array<std::size_t, 4> head{block.first(), block.count(), block.position.size(), block.pressure.size()};
  std::string bytes;
  put(bytes, head.data(), head.size());
  put(bytes, block.position.data(), block.position.size());
  put(bytes, block.velocity.data(), block.velocity.size());
  put(bytes, block.pressure.data(), block.pressure.size());
  return bytes;
}

Made joined(const std::vector<std::string>& answers) {
  Made all;
  for (const std::string& answer : answers) {
    std::array<std::size_t, 4> head{};
    std::memcpy(head.data(), answer.data(), sizeof head);
    const auto [first, total, count, pressures] = head;
    if (first != all.position.size() / sizeof(Vec3)) ++all.first_wrong;
    all.total = total;
    all.most = std::max(all.most, count);
    all.position += answer.substr(sizeof head, count * sizeof(Vec3));
    all.velocity += answer.substr(sizeof head + count * sizeof(Vec3), count * sizeof(Vec3));
    all.pressure += answer.substr(sizeof head + 2 * count * sizeof(Vec3), pressures * sizeof(double));
  }
  return all;
}

/// Compares all phases with those that one process makes.
void expect_the_same(const Scene& scene, int ranks, const std::string& name) {
  const std::vector<ParticleBlock> whole = generate(scene);
  const auto answers = on_ranks(ranks, [&] {
    std::string all;
    for (const ParticleBlock& block : make_particles(scene)) {
      const std::string one = answer_of(block);
      const std::size_t size = one.size();
      put(all, &size, 1);
      all += one;
    }
    return all;
  });
  std::vector<std::size_t> at(answers.size(), 0);
  for (std::size_t p = 0; p < whole.size(); ++p) {
    const std::string which = name + ", " + scene.phases[p].name + ", ranks: " + std::to_string(ranks);
    std::vector<std::string> parts;
    for (std::size_t r = 0; r < answers.size(); ++r) {
      std::size_t size = 0;
      std::memcpy(&size, answers[r].data() + at[r], sizeof size);
      parts.push_back(answers[r].substr(at[r] + sizeof size, size));
      at[r] += sizeof size + size;
    }
    if (scene.phases[p].kind() != PhaseKind::fluid) {
      for (const std::string& part : parts) EXPECT_TRUE(part == answer_of(whole[p])) << which;
      continue;
    }
    const Made one = joined({answer_of(whole[p])}), all = joined(parts);
    EXPECT_EQ(all.total, whole[p].position.size()) << which;
    EXPECT_EQ(all.first_wrong, 0u) << which;
    EXPECT_TRUE(all.position == one.position) << which;
    EXPECT_TRUE(all.velocity == one.velocity) << which;
    EXPECT_TRUE(all.pressure == one.pressure) << which;
    EXPECT_LE(static_cast<double>(all.most), 1.26 * (static_cast<double>(all.total) / ranks + 1.0)) << which;
  }
}

TEST(SharedStart, ALatticeInPartsIsTheLattice) {
  for (const Packing packing : {Packing::square, Packing::hexagonal})
    for (const int dimensions : {2, 3}) {
      const auto part = [&](const ranks::Share& share) {
        return lattice(packing, dimensions, 0.1, {0.05, 0.05, 0.05}, {0, 0, 0}, {1.3, 0.7, 0.5}, share);
      };
      const std::vector<Vec3> whole = part({});
      for (const std::size_t count : {2u, 3u, 7u, 1000u}) {
        std::vector<Vec3> all;
        for (std::size_t k = 0; k < count; ++k) {
          const std::vector<Vec3> one = part({k, count});
          EXPECT_LE(one.size(), whole.size() / count + 1);
          all.insert(all.end(), one.begin(), one.end());
        }
        EXPECT_EQ(all, whole);
      }
    }
}

TEST(SharedStart, FillsOfEveryKind) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"one fluid, disturbed",
       tank(2, "",
            walls + "[[fill]]\nphase = \"water\"\nshape = \"the-rest\"\nperturb = 0.1\nseed = 7\n"
                    "velocity = [\"sin(x)*y\", 0.1]\n")},
      {"a disc in another fluid",
       tank(2, "\"x\", \"y\"", disc + "perturb = 0.2\npressure = \"1+x\"\n" + rest + "perturb = 0.1\n")},
      {"walls after a fluid", tank(2, "", disc + walls + rest)},
      {"three dimensions", tank(3, "", ball + "perturb = 0.1\n" + walls + rest)},
      {"points",
       tank(2, "",
            "[[fill]]\nphase = \"water\"\nshape = { points = [[0.5, 0.5], [1.0, 0.7], [1.5, 0.2]] }\n" + walls + rest)},
      {"a formula",
       tank(2, "\"x\"",
            "[[fill]]\nphase = \"water\"\nshape = { formula = \"0.3+0.2*sin(pi*x)-y\" }\npressure = \"hydrostatic\"\n" +
                rest)},
      {"relaxed places", tank(2, "", disc + "packing = \"relaxed\"\n" + rest)},
  };
  for (const auto& [name, text] : cases)
    for (const int ranks : {2, 3, 5}) expect_the_same(parse_scene(text, "tank.toml"), ranks, name);
}

/// Scenes that come along, with open ends, fitted ground, two spacings, zones and walls that move.
TEST(SharedStart, ScenesThatComeAlong) {
  for (const char* name : {"verification/open_channel", "verification/two_spacings", "verification/two_phase_column",
                           "verification/piston", "verification/sinking_disc"}) {
    const Scene scene = read_scene(std::string(BARCHAN_SOURCE_DIR) + "/scenes/" + name + ".toml");
    EXPECT_EQ(why_start_is_whole(scene), "") << name;
    expect_the_same(scene, 3, name);
  }
}

TEST(SharedStart, WhatEveryRankMakesWhole) {
  const auto why = [](const std::string& text) { return why_start_is_whole(parse_scene(text, "tank.toml")); };
  EXPECT_EQ(why(tank(2, "", disc + rest)), "");
  const std::string random = "[[fill]]\nphase = \"sand\"\nshape = \"the-rest\"\npacking = \"random\"\n";
  EXPECT_EQ(why(tank(2, "", disc + random)), "fill.1 has random places next to a fluid");
  EXPECT_EQ(why(tank(2, "", random + disc)), "");
  EXPECT_EQ(why(tank(2, "", random)), "there is no fluid");
}

/// What one process says of a scene, and what each rank says.
void expect_the_same_words(const std::string& text, const std::string& part) {
  const Scene scene = parse_scene(text, "tank.toml");
  const auto told = [&] {
    try {
      make_plan(scene, make_particles(scene));
    } catch (const SceneError& error) { return std::string(error.what()); }
    return std::string();
  };
  const std::string one = told();
  EXPECT_NE(one.find(part), std::string::npos) << one;
  for (const std::string& answer : on_ranks(3, told)) EXPECT_EQ(answer, one);
}

TEST(SharedStart, FaultsAreToldInTheSameWords) {
  expect_the_same_words(tank(2, "", disc + "velocity = [\"sqrt(0.5-y)\", 0]\n" + rest), "the formula");
  expect_the_same_words(
      tank(2, "", disc + "[[fill]]\nphase = \"oil\"\nshape = { box = { min = [0.92, 0.6], max = [1.8, 0.9] } }\n"),
      "overlaps fill.0");
  expect_the_same_words(
      tank(2, "",
           disc + walls + "[[fill]]\nphase = \"wall\"\nshape = { box = { min = [0.92, 0.6], max = [1.8, 0.9] } }\n"),
      "overlaps fill.0");
  expect_the_same_words(
      tank(2, "", "[[fill]]\nphase = \"water\"\nshape = { disc = { centre = [0.9, 0.9], radius = 0.33 } }\n" + rest),
      "lies outside the domain");
  expect_the_same_words(tank(2, "", "[[fill]]\nphase = \"water\"\nshape = { formula = \"-1\" }\n" + rest),
                        "no particle of phase");
}

/// Plan, first sort and steps: a row of history is the same, to the bit.
std::string history_after(const Scene& scene, int steps) {
  const auto blocks = make_particles(scene);
  const Plan plan = make_plan(scene, blocks);
  Simulation simulation(scene, plan, blocks);
  for (int k = 0; k < steps; ++k) simulation.step(1.0);
  const std::vector<double> row = simulation.history_row();
  std::string bytes = plan.warnings.empty() ? "" : plan.warnings.front();
  for (const PlanPhase& p : plan.phases) bytes += p.name + p.enclosure;
  put(bytes, &plan.largest_speed, 1);
  put(bytes, row.data(), row.size());
  return bytes;
}

TEST(SharedStart, StepsFollowAsInOneProcess) {
  const std::string dam =
      "[[fill]]\nphase = \"water\"\nshape = { box = { min = [0, 0], max = [0.8, 0.6] } }\npressure = "
      "\"hydrostatic\"\n" +
      walls;
  const std::vector<std::string> cases{
      tank(2, "", dam), tank(2, "\"x\"", walls + disc + "perturb = 0.1\n" + rest + "velocity = [\"sin(pi*y)\", 0]\n"),
      tank(3, "\"x\", \"z\"", ball + walls + rest)};
  for (const std::string& text : cases) {
    const Scene scene = parse_scene(text, "tank.toml");
    const std::string one = history_after(scene, 4);
    for (const int ranks : {2, 3})
      for (const std::string& answer : on_ranks(ranks, [&] { return history_after(scene, 4); }))
        EXPECT_TRUE(answer == one) << text;
  }
  const Scene scene = read_scene(std::string(BARCHAN_SOURCE_DIR) + "/scenes/verification/open_channel.toml");
  const std::string one = history_after(scene, 2);
  for (const std::string& answer : on_ranks(2, [&] { return history_after(scene, 2); })) EXPECT_TRUE(answer == one);
}

}  // namespace
}  // namespace barchan
