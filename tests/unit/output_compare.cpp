// The comparison finds what was planted, names the particle, and does not depend on the order of particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "output/compare.hpp"
#include "output/series.hpp"
#include "unit/output_example.hpp"

namespace barchan {
namespace {

using namespace example;

/// Finite numbers only, ids 100, 99, ..., so that the last particle has the lowest.
Frame plain_frame(std::size_t n) {
  Frame f = frame(n);
  for (std::size_t k = 0; k < n; ++k) f.id[k] = 100 - static_cast<std::int64_t>(k);
  for (auto& value : f.fields[1].values) value = 1.225;
  return f;
}

/// The same particles in another order.
Frame shuffled(const Frame& f) {
  std::vector<std::size_t> order(f.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  Frame g = f;
  for (std::size_t k = 0; k < f.size(); ++k) {
    const std::size_t from = order[k];
    g.id[k] = f.id[from];
    g.phase[k] = f.phase[from];
    for (std::size_t c = 0; c < 3; ++c) g.points[3 * k + c] = f.points[3 * from + c];
    for (std::size_t field = 0; field < f.fields.size(); ++field) {
      const auto components = static_cast<std::size_t>(f.fields[field].components);
      for (std::size_t c = 0; c < components; ++c)
        g.fields[field].values[components * k + c] = f.fields[field].values[components * from + c];
    }
  }
  return g;
}

const FieldDifference& of(const FrameDifference& difference, const std::string& field) {
  const auto found =
      std::find_if(difference.fields.begin(), difference.fields.end(), [&](auto& d) { return d.field == field; });
  if (found == difference.fields.end()) throw std::runtime_error("no field " + field);
  return *found;
}

TEST(Compare, FramesThatDifferInOrderAloneAreSame) {
  const auto difference = compare(plain_frame(50), shuffled(plain_frame(50)), 0.0);
  EXPECT_TRUE(difference.same);
  EXPECT_EQ(difference.fields.size(), 6u);  // position, phase and four fields
  for (const auto& d : difference.fields) {
    EXPECT_EQ(d.largest, 0.0) << d.field;
    EXPECT_EQ(d.first_id, -1) << d.field;
  }
}

TEST(Compare, FindsAPlantedDifferenceAndNamesTheParticle) {
  const std::size_t n = 50;
  const Frame a = plain_frame(n);
  Frame b = a;
  b.fields[1].values[7] += 0.05;   // id 93
  b.fields[1].values[20] -= 0.02;  // id 80, the lowest
  b.fields[1].values[40] += 1e-9;  // id 60, below the tolerance
  const auto difference = compare(a, shuffled(b), 1e-6);
  EXPECT_FALSE(difference.same);
  const auto& d = of(difference, "density");
  EXPECT_EQ(d.first_id, 80);
  EXPECT_EQ(d.first_a, 1.225);
  EXPECT_EQ(d.first_b, 1.225 - 0.02);
  EXPECT_EQ(d.scale, 1.225);
  EXPECT_NEAR(d.largest, 0.05 / 1.225, 1e-12);
  EXPECT_NEAR(d.l1, 0.07 / 1.225 / n, 1e-9);
  EXPECT_NEAR(d.l2, std::sqrt((0.05 * 0.05 + 0.02 * 0.02) / n) / 1.225, 1e-9);
  EXPECT_EQ(of(difference, "velocity").largest, 0.0);
  EXPECT_TRUE(compare(a, b, 0.05).same);
}

TEST(Compare, OfAVectorNamesTheComponentThatDiffersMost) {
  const Frame a = plain_frame(10);
  Frame b = a;
  b.fields[0].values[3 * 4 + 0] += 0.1;
  b.fields[0].values[3 * 4 + 2] += 0.3;
  const auto difference = compare(a, b, 0.0);
  const auto& d = of(difference, "velocity");
  EXPECT_EQ(d.first_id, 96);
  EXPECT_EQ(d.first_a, a.fields[0].values[14]);
  EXPECT_EQ(d.first_b, b.fields[0].values[14]);
}

TEST(Compare, IsAbsoluteWhereAIsZero) {
  Frame a = plain_frame(10);
  std::fill(a.fields[3].values.begin(), a.fields[3].values.end(), 0.0);
  Frame b = a;
  b.fields[3].values[0] = 1e-3;
  const auto difference = compare(a, b, 1e-4);
  EXPECT_EQ(of(difference, "marker").scale, 0.0);
  EXPECT_EQ(of(difference, "marker").largest, 1e-3);
}

TEST(Compare, TakesNanForDifferentFromEveryNumberOnly) {
  Frame a = plain_frame(10);
  a.fields[1].values[2] = std::nan("");
  a.fields[1].values[3] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(compare(a, a, 0.0).same);
  Frame b = a;
  b.fields[1].values[2] = 1.225;
  const auto difference = compare(a, b, 1e3);
  EXPECT_EQ(of(difference, "density").first_id, 98);
  EXPECT_TRUE(std::isinf(of(difference, "density").largest));
}

TEST(Compare, RemarksOnWhatOnlyOneHas) {
  const Frame a = plain_frame(10);
  Frame b = a;
  b.id[9] = 500;  // id 91 is gone, 500 is new
  b.fields[3].name = "mark";
  b.fields[0].components = 1;
  b.fields[0].values.resize(10);
  b.time *= 2;
  b.phase_names[0] = "water";
  const auto difference = compare(a, b, 1e-6);
  EXPECT_FALSE(difference.same);
  std::string remarks;
  for (const auto& remark : difference.remarks) remarks += remark + "\n";
  for (const char* words :
       {"1 particle is only in A, the first has id 91", "1 particle is only in B, the first has id 500",
        "only A has the field 'marker'", "only B has the field 'mark'", "3 components in A, 1 in B", "the times differ",
        "the phases"})
    EXPECT_NE(remarks.find(words), std::string::npos) << words << "\n" << remarks;
}

TEST(Compare, RemarksOnAnIdThatIsThereTwice) {
  Frame a = plain_frame(10);
  a.id[3] = a.id[4];
  EXPECT_FALSE(compare(a, a, 0.0).same);
}

TEST(Compare, FramesWithoutParticlesAreSame) {
  EXPECT_TRUE(compare(plain_frame(0), plain_frame(0), 0.0).same);
  EXPECT_FALSE(compare(plain_frame(0), plain_frame(1), 0.0).same);
}

TEST(Compare, SaysItInWordsAndInJson) {
  const Frame a = plain_frame(10);
  Frame b = a;
  b.fields[1].values[5] = 1.5;  // id 95
  const std::vector differences{compare(a, a, 0.0), compare(a, b, 0.0)};
  const std::string text = to_text(differences);
  EXPECT_NE(text.find("density differs first at particle 95: 1.2250000000000001 against 1.5"), std::string::npos)
      << text;

  const auto json = nlohmann::json::parse(to_json(differences));
  EXPECT_EQ(json.at("same"), false);
  ASSERT_EQ(json.at("frames").size(), 2u);
  EXPECT_EQ(json["frames"][0]["same"], true);
  const auto& density = json["frames"][1]["fields"].at("density");
  EXPECT_EQ(density.at("first").at("id"), 95);
  EXPECT_EQ(density.at("first").at("b"), 1.5);
  EXPECT_NEAR(density.at("largest").get<double>(), 0.275 / 1.225, 1e-12);
  EXPECT_FALSE(json["frames"][1]["fields"].at("velocity").contains("first"));
}

TEST(Compare, ReadsFramesAndSeries) {
  const TemporaryDirectory directory;
  {
    SeriesWriter a(directory / "a", "dune", FrameFormat::vtp, true),
        b(directory / "b", "sand", FrameFormat::vtu, false);
    for (int k = 0; k < 3; ++k) a.write(frame(20, k)), b.write(frame(20, k));
    a.finish();
    b.finish();
  }
  const auto a = directory / "a" / "dune.pvd", b = directory / "b" / "sand.pvd";
  EXPECT_TRUE(compare_files(directory / "a" / "dune_000001.vtp", directory / "b" / "sand_000001.vtu", 0.0).at(0).same);
  auto differences = compare_files(a, b, 0.0);
  ASSERT_EQ(differences.size(), 3u);
  for (const auto& difference : differences) EXPECT_TRUE(difference.same);

  auto entries = read_pvd(a);
  entries.resize(1);
  { SeriesWriter shorter(directory / "a", "dune", FrameFormat::vtp, true, entries); }
  differences = compare_files(a, b, 0.0);
  ASSERT_EQ(differences.size(), 2u);
  EXPECT_FALSE(differences.back().same);
  EXPECT_NE(to_text(differences).find("A has 1 frames, B has 3"), std::string::npos);

  // Every second frame of the one is one of the other: those of one time are compared. A folder stands for its series.
  {
    SeriesWriter c(directory / "c", "rare", FrameFormat::vtp, true);
    for (const int k : {0, 2}) c.write(frame(20, k));
    c.finish();
  }
  differences = compare_files(directory / "b", directory / "c", 0.0);
  ASSERT_EQ(differences.size(), 3u);
  EXPECT_TRUE(differences[0].same && differences[1].same);
  EXPECT_EQ(differences[1].time_a, differences[1].time_b);
  EXPECT_NE(to_text(differences).find("A has 3 frames, B has 2; the 2 of the same times"), std::string::npos);
  expect_output_error([&] { compare_files(directory.path, b, 0.0); }, {"with 0 series"});

  expect_output_error([&] { compare_files(a, directory / "b" / "sand_000001.vtu", 0.0); }, {"one is a series"});
  expect_output_error([&] { compare_files(a, directory / "none.pvd", 0.0); }, {"none.pvd"});
}

}  // namespace
}  // namespace barchan
