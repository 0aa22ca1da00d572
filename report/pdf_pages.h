// Where the parts of a printed page stand: named places in a PDF file as chromium writes it.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace vislab {

/// The page, from 1, of each named destination (the id of an element that a link points to). Reads
/// PDF with a plain table of cross-references and a plain dictionary of destinations; of any other
/// file, and of what is cut off, it gives nothing. O(length of the file's tables).
std::map<std::string, int> named_pages(std::string_view pdf);

}  // namespace vislab
