// A velocity by height from a file: what is read, and what is refused.
#include "start/velocity_profile.hpp"

#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "start/flow_ends.hpp"

namespace barchan {
namespace {

TEST(VelocityProfile, IsLinearBetweenRowsAndConstantBeyondThem) {
  const VelocityProfile profile(
      "x [m], y [m] ,velocity_mean_x [m/s],pressure_mean [Pa],velocity_mean_y [m/s]\n"
      "0,0.1,1,7,0.5\n\n0, 0.3 ,3,7,-0.5\r\n0,0.4,3.5,7,0\n",
      "");
  EXPECT_EQ(profile(0.0), (Vec3{1.0, 0.5, 0.0}));
  EXPECT_NEAR(profile(0.2)[0], 2.0, 1e-15);
  EXPECT_NEAR(profile(0.2)[1], 0.0, 1e-15);
  EXPECT_NEAR(profile(0.35)[0], 3.25, 1e-15);
  EXPECT_EQ(profile(9.0), (Vec3{3.5, 0.0, 0.0}));
  EXPECT_EQ(VelocityProfile("y,velocity_x,velocity_z\n0,1,2\n1,1,2\n", "")(0.5), (Vec3{1.0, 0.0, 2.0}));
}

std::string refusal(const std::string& text) {
  try {
    const VelocityProfile profile(text, "\"a.csv\" ");
  } catch (const SceneError& e) { return e.what(); }
  return "";
}

TEST(VelocityProfile, RefusesWhatIsNone) {
  const std::string head = "y,velocity_x\n";
  EXPECT_EQ(refusal(""), "\"a.csv\" is empty; expected a table with the names of its columns in the first line");
  EXPECT_NE(refusal("y,u\n0,1\n1,1\n").find("has no column y and velocity_mean_x (or velocity_x)"), std::string::npos);
  EXPECT_NE(refusal("yield,velocity_x\n0,1\n1,1\n").find("has no column y"), std::string::npos);
  EXPECT_NE(refusal(head + "0,1\n").find("fewer than two rows"), std::string::npos);
  EXPECT_NE(refusal(head + "0,1\n1\n").find("line 3 has 1 fields; expected 2"), std::string::npos);
  EXPECT_NE(refusal(head + "0,1\n1,2,3\n").find("line 3 has 3 fields"), std::string::npos);
  EXPECT_NE(refusal(head + "0,1\n0,2\n").find("line 3 is not higher"), std::string::npos);
  for (const char* word : {"nan", "inf", "1e400", "a", "", "1x"})
    EXPECT_NE(refusal(head + "0,1\n1," + word + "\n").find("is no finite number"), std::string::npos) << word;
  EXPECT_THROW(read_velocity_profile("/nowhere/a.csv", ""), SceneError);
  EXPECT_THROW(read_velocity_profile("/tmp", ""), SceneError);
}

TEST(VelocityProfile, IsWhatAnInflowGives) {
  const Scene scene = parse_scene(R"toml(spacing = 0.1
[domain]
size = [1, 1]
periodic = ["y"]
[phases.air]
kind = "fluid"
density = 1
sound-speed = 30
[interactions]
air-air = 2.1
[[fill]]
phase = "air"
shape = "the-rest"
[[inflow]]
phase = "air"
side = "left"
velocity = { profile = "profiles/one.csv" }
[time]
end = 1
)toml",
                                  BARCHAN_SOURCE_DIR "/tests/cli/scene.toml");
  const GivenVelocity velocity(scene, flow_ends(scene).front());
  EXPECT_NEAR(velocity({-0.1, 0.35, 0.0}, 0.0)[0], 1.5, 1e-15);
  EXPECT_NEAR(velocity({-0.1, 0.75, 0.0}, 3.0)[0], 2.25, 1e-15);
}

}  // namespace
}  // namespace barchan
