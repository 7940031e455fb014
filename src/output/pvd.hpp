// ParaView's list of a series' files: one line a frame with its time.
#pragma once

#include <filesystem>
#include <vector>

#include "output/series.hpp"

namespace barchan {

/// Replaces the .pvd by rename. Times have 17 significant digits, so that they are read back bit for bit; files are
/// relative to the .pvd. Throws OutputError. (read_pvd is declared in series.hpp.)
void write_pvd(const std::filesystem::path& pvd, const std::vector<SeriesWriter::Entry>& entries);

}  // namespace barchan
