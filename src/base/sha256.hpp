// The checksum SHA-256 (FIPS 180-4): who states it for a text has read the text.
#pragma once

#include <string>
#include <string_view>

namespace barchan {

/// In 64 hexadecimal digits.
std::string sha256(std::string_view text);

}  // namespace barchan
