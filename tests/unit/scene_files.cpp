// Every scene of scenes/ reads and makes particles; those of scenes/verification are what their heads say.
#include <gtest/gtest.h>

#include <filesystem>

#include "base/errors.hpp"
#include "checks/reader.hpp"
#include "simulation/settle.hpp"
#include "start/generate.hpp"

namespace barchan {
namespace {

const std::filesystem::path scenes = std::filesystem::path(BARCHAN_SOURCE_DIR) / "scenes";

std::vector<ParticleBlock> particles_of(const char* file, const std::vector<std::string>& overrides = {}) {
  return make_particles(read_scene((scenes / file).string(), overrides));
}

TEST(SceneFiles, AllReadAndMakeParticles) {
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes)) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    try {
      Scene scene = read_scene(entry.path().string());
      EXPECT_FALSE(scene.title.empty()) << entry.path();
      // EveryScene.RunsInTheProgram lets them settle and relax, which takes minutes in a sanitizer.
      bool relaxes = false;
      for (Fill& fill : scene.fills) {
        if (fill.packing == Packing::settled) fill.packing = Packing::hexagonal;
        relaxes = relaxes || fill.packing == Packing::relaxed;
      }
      if (relaxes) continue;
      const auto blocks = make_particles(scene);
      for (std::size_t k = 0; k < blocks.size(); ++k) {
        const bool column = scene.phases[k].kind() == PhaseKind::column;
        EXPECT_EQ(blocks[k].position.empty(), column) << entry.path() << ": " << scene.phases[k].name;
      }
    } catch (const SceneError& error) { ADD_FAILURE() << error.what(); }
  }
  EXPECT_GE(count, 7);
}

TEST(SceneFiles, Counts) {
  EXPECT_EQ(particles_of("verification/taylor_green.toml").at(0).position.size(), 2500u);
  for (const char* file : {"verification/poiseuille.toml", "verification/couette.toml"}) {
    const auto blocks = particles_of(file);
    EXPECT_EQ(blocks.at(0).position.size(), 16u * 25u) << file;
    EXPECT_EQ(blocks.at(1).position.size() + (blocks.size() > 2 ? blocks[2].position.size() : 0u), 16u * 6u) << file;
  }
  EXPECT_EQ(particles_of("verification/still_column.toml").at(0).position.size(), 16u * 50u);
  for (const char* radius : {"1.0", "2.4"}) {
    const auto pair =
        particles_of("verification/two_particle_impact.toml", {std::string("interactions.a-b=") + radius});
    EXPECT_EQ(pair.at(0).velocity.at(0)[0], 10.0);
    EXPECT_NEAR(pair.at(1).position.at(0)[0] - pair.at(0).position.at(0)[0], 2.5e-3, 1e-15);
    const auto cubes = particles_of("paper/impact_cubes.toml", {std::string("interactions.a-b=") + radius});
    EXPECT_EQ(cubes.at(0).position.size(), 1331u);
    EXPECT_EQ(cubes.at(1).position.size(), 1331u);
  }
}

}  // namespace
}  // namespace barchan
