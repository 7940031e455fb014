// What makes a scene the one that a checkpoint is of.
#pragma once

#include <map>
#include <string>

#include "scene/scene.hpp"
#include "scene/toml.hpp"

namespace barchan {

/// The document less what a run that goes on may change: title, state, time.end, and all of [output] but the format.
/// The files that it names count by their checksums.
std::string identity_of(toml::table document, const std::map<std::string, std::string>& checksums = {});

/// CRC-32 and size of the files of surfaces and grains, by what names them: "fill 2, checksum of its file".
std::map<std::string, std::string> checksums_of_files(const Scene& scene);

/// One line a key that differs, "  time.safety: 0.5 then, 0.6 now\n"; empty when none does.
std::string difference(const std::string& then, const std::string& now);

}  // namespace barchan
