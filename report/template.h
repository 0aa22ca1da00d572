// Templates: text with gaps, so that the report's words stand in files and its figures do not.
//
//   {{name}}                 the value of that name
//   {{#name}} … {{/name}}    the text between once for each entry of the list of that name
//   {{^name}} … {{/name}}    the text between if that list is empty
//
// (a part of the Mustache language). Names are looked up in the innermost entry first, then
// outwards. A tag of a section that stands alone on its line leaves no line behind. Values are put
// in as they are.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace vislab {

/// What fills a template: values, and lists of the same for sections.
struct Fields {
  std::map<std::string, std::string, std::less<>> values;
  std::map<std::string, std::vector<Fields>, std::less<>> lists;

  /// A section that stands there once, or not at all.
  void flag(const std::string& name, bool is_set) {
    lists[name] = std::vector<Fields>(is_set ? 1 : 0);
  }
};

/// The filled text. Throws InputError that names `where` and the line if the template is malformed
/// or asks for a name that is not in the fields.
std::string fill_template(std::string_view text, const Fields& fields, const std::string& where);

/// The text of a template's file. Throws InputError that names it if it cannot be read.
std::string read_template(const std::filesystem::path& file);

}  // namespace vislab
