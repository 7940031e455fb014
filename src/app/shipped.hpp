// What comes along with the program: scenes, ParaView states, and where they lie.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace barchan {

struct ShippedScene {
  std::string name;  // as in `barchan run NAME`: dune, paper/dune, verification/couette
  std::filesystem::path file;
  std::string title, state;  // of the scene file
  std::string shows;         // the first sentence of its head
};

struct ShippedState {
  std::string name;  // as in the scene's key `state`
  std::filesystem::path file;
  std::string shows;  // the words before the first colon of its head
};

/// In the order of their names; those of scenes/ come before those of its folders.
std::vector<ShippedScene> shipped_scenes();
std::vector<ShippedState> shipped_states();

/// The file of the scene that a person names: a file as it is, else the scene of that name that comes along. A word
/// that ends in .toml is always a file. `gresho` also finds `verification/gresho`, where no other scene has this name.
/// Throws SceneError when there is neither, and names the nearest.
std::string scene_file(const std::string& word);

}  // namespace barchan
