// Tables of text, as spreadsheets and other programs write them: fields, headings, units. Internal to src/scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/units.hpp"

namespace barchan {

/// The text without the byte-order mark of UTF-8 that programs of Windows begin a file with.
std::string_view without_mark(std::string_view text);
/// Why a file is no text that we read; "" where it may be one.
std::string why_no_text(std::string_view bytes);

/// The fields of a line, without the blanks about them: between semicolons where the line has one, else between tabs
/// or commas, else, with `blanks_part`, between blanks. A field in double quotes may hold any of these; "" in it is a
/// quote. Nothing: a quote is not closed, or something stands behind it.
std::optional<std::vector<std::string>> fields_of(std::string_view line, bool blanks_part);

/// The heading of a column: its name, and its unit in brackets, as in "y [mm]" and "y (mm)".
struct ColumnHead {
  std::string name;
  std::optional<std::string> unit;  // nothing: the heading names none
};
/// Of a field. A unit of this quantity behind a blank, "_", "/" or " in " counts too, as in "y_mm" and "y in mm".
ColumnHead head_of(std::string_view field, Quantity quantity);

/// A name is made of words: letters, "_", "-" and blanks, and begins with a letter. "O.5", "l" and "nan" are damaged
/// numbers.
bool is_name(std::string_view name);

/// What to say of a field where a number is expected: "\"0,5\" is no finite number; expected a decimal point ...".
std::string no_number(std::string_view field);

}  // namespace barchan
