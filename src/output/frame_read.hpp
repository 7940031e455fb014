// Frames whose arrays are appended as raw bytes. Internal to src/output.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "output/frame.hpp"

namespace barchan {

/// The begin of the names of Frame::contacts, which stand in a file's field data.
inline constexpr std::string_view contact_arrays = "contact_";

/// The frame in the text of a .vtp or .vtu file (`suffix`). Nothing when the file appends no data: its arrays stand in
/// the XML itself. Throws OutputError when it is damaged; takes no more memory than the file can be the reason for.
std::optional<Frame> read_appended(std::string_view text, const std::string& suffix);

/// The unit of a field in the lines `NAME UNIT` of a file's field data; "" without one.
std::string unit_of(const std::string& field, const std::vector<std::string>& units);

}  // namespace barchan
