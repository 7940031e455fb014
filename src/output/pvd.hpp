// ParaView's list of a series' files: one line a frame with its time.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "output/series.hpp"

namespace barchan {

/// Replaces the .pvd by rename. Times have 17 significant digits, so that they are read back bit for bit; files are
/// relative to the .pvd. Throws OutputError. (read_pvd is declared in series.hpp.)
void write_pvd(const std::filesystem::path& pvd, const std::vector<SeriesWriter::Entry>& entries);

/// The entries of the text of a .pvd. Throws OutputError.
std::vector<SeriesWriter::Entry> parse_pvd(std::string_view text);

}  // namespace barchan
