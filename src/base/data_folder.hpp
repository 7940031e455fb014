// Where the shipped files of the program are: scenes and ParaView states.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace barchan {

/// The folder with scenes/ and pvstate/: PREFIX/share/barchan of an installed program, found from where the program
/// itself lies; of a program in the build folder of a source tree, or in a folder of that, the tree. Empty: there is
/// none.
std::filesystem::path data_folder();

/// Names of the states in pvstate/, in order: what a scene may name in its key `state`. Empty without a data folder.
std::vector<std::string> names_of_states();

}  // namespace barchan
