// What the table of keys says to editors and to readers.
#pragma once

#include <string>

namespace barchan {

/// JSON schema (draft 4, which editors of TOML read) of a scene file, from the same table of keys that the reader
/// checks against.
std::string scene_schema();

/// The keys of every section as Markdown tables, with an example each.
std::string scene_tables();

}  // namespace barchan
