// Hashes of the sources that answers depend on, so that a mended method is measured again and an
// untouched one is not.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace vislab {

/// By family: hash of its folder and of the layers below it. Written at build time.
const std::map<std::string, std::string, std::less<>>& family_source_hashes();
/// Hash of the judge and the layers below it. Written at build time.
const std::string& judge_source_hash();

/// Hash for a chain: of the hashes of its stages' families.
std::string chain_source_hash(std::string_view canonical_chain);

}  // namespace vislab
