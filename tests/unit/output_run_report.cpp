#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "output/run_report.hpp"
#include "unit/output_example.hpp"

namespace barchan {
namespace {

using namespace example;

RunReport report() {
  RunReport r;
  r.version = "1.2.3";
  r.scene_title = "Wind \"over\" a dune";
  r.particles = {{"air", 1000}, {"sand", 200}};
  r.pairs = {{"air-sand", 1234}};
  r.fields = {{"air", {"position", "velocity"}}};
  r.passes = {"sort", "pairs", "momentum"};
  r.steps = 10;
  r.seconds = {{"sort", 0.5}, {"pairs", 0.25}, {"momentum", 2.0}};
  r.time_step_limits = {{"sound", 9}, {"contact", 1}};
  r.budgets = {{"momentum drift", 1e-14}, {"broken", std::nan("")}};
  r.end_reason = "end";
  return r;
}

TEST(RunReport, HoldsWhatTheContractNames) {
  const TemporaryDirectory directory;
  write_run_report(directory / "run.json", report());
  std::ifstream stream(directory / "run.json");
  const auto json = nlohmann::ordered_json::parse(stream);
  for (const char* key : {"version", "particles", "pairs", "steps", "seconds", "particle_steps_per_second",
                          "pair_interactions_per_second", "end_reason", "budgets"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["particles"]["sand"], 200);
  EXPECT_EQ(json["pairs"]["air-sand"], 1234);
  EXPECT_EQ(json["fields"]["air"][1], "velocity");
  EXPECT_EQ(json["scene"]["title"], "Wind \"over\" a dune");
  EXPECT_EQ(json["time_step_limits"]["sound"], 9);
  EXPECT_EQ(json["budgets"]["momentum drift"], 1e-14);
  EXPECT_TRUE(json["budgets"]["broken"].is_null());
  std::vector<std::string> passes;
  for (const auto& item : json["seconds"].items()) passes.push_back(item.key());
  EXPECT_EQ(passes, report().passes);  // the order of the step, not of the alphabet
}

TEST(RunReport, WithNothingInItIsStillADocument) {
  const auto json = nlohmann::json::parse(to_json(RunReport{}));
  EXPECT_TRUE(json["particles"].is_object());
  EXPECT_TRUE(json["seconds"].is_object());
  EXPECT_TRUE(json["passes"].is_array());
}

TEST(RunReport, ThatCannotBeWrittenSaysWhy) {
  const TemporaryDirectory directory;
  expect_output_error([&] { write_run_report(directory / "nowhere" / "run.json", report()); },
                      {"run.json", "No such file"});
}

}  // namespace
}  // namespace barchan
