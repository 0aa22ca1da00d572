// Hashes of text, for the names of results.
#pragma once

#include <string>
#include <string_view>

namespace vislab {

/// 128-bit hash (XXH3) as 32 hexadecimal digits.
std::string hash_text(std::string_view text);

}  // namespace vislab
