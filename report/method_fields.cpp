#include "report/method_fields.h"

#include <algorithm>
#include <cctype>

#include "report/format.h"

namespace vislab {
namespace {

Fields parameter_fields(const ParameterSpec& parameter) {
  Fields row;
  row.values["parameter"] = markdown_code(parameter.name);
  row.values["default"] = markdown_code(parameter.default_value);
  row.values["allowed"] = markdown_text(parameter.allowed());
  row.values["unit"] = parameter.unit.empty() ? "–" : markdown_text(parameter.unit);
  row.values["parameter_stage"] =
      parameter.stage == ParameterSpec::Stage::build ? "build" : "query";
  row.values["meaning"] = markdown_text(parameter.meaning);
  return row;
}

std::vector<Fields> source_fields(const std::vector<std::string>& sources) {
  std::vector<Fields> entries;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    Fields entry;
    entry.values["source"] = markdown_text(sources[i]);
    entry.values["plain_source"] = sources[i];
    entry.values["separator"] = i + 1 < sources.size() ? "; " : "";
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::string lower_case(std::string_view text) {
  std::string result;
  for (const char c : text) {
    result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return result;
}

struct BibliographyKey {
  std::string key, author, year;
};

/// Keys of the form author + year, in the order of the file.
std::vector<BibliographyKey> bibliography_keys(std::string_view bibliography) {
  std::vector<BibliographyKey> keys;
  for (std::size_t at = 0; (at = bibliography.find('@', at)) != std::string_view::npos; ++at) {
    const std::size_t open = bibliography.find('{', at);
    const std::size_t comma = bibliography.find(',', at);
    if (open == std::string_view::npos || comma == std::string_view::npos || comma < open) continue;
    const std::string key(bibliography.substr(open + 1, comma - open - 1));
    const std::size_t digits = key.find_first_of("0123456789");
    if (digits == std::string::npos || digits == 0) continue;
    keys.push_back({key, key.substr(0, digits), key.substr(digits)});
  }
  return keys;
}

/// What a method of the kind leaves out, as a reader would say it.
std::string words_for(Culls culls) {
  switch (culls) {
    case Culls::back_faces:
      return "what faces away";
    case Culls::outside_frustum:
      return "what lies outside the frustum";
    case Culls::hidden:
      break;
  }
  return "all that is invisible";
}

}  // namespace

std::vector<Fields> method_fields(const ReportInput& input) {
  std::vector<Fields> methods;
  if (input.cullers == nullptr) return methods;
  for (const auto& [name, entry] : input.cullers->entries()) {
    const CullerInfo& info = entry.info;
    Fields fields;
    fields.values["name"] = markdown_code(info.name);
    fields.values["summary"] = markdown_text(info.summary);
    fields.values["guarantee"] = markdown_text(to_string(info.guarantee));
    fields.values["repeatability"] = std::string(to_string(info.repeatability));
    fields.values["granularity"] = std::string(to_string(info.granularity));
    fields.values["culls"] = words_for(info.culls);
    fields.values["space"] = std::string(to_string(info.space));
    fields.values["stage"] = std::string(to_string(info.stage));
    fields.flag("needs_device", info.needs_device);
    fields.flag("needs_truth", info.needs_truth);
    fields.values["cost"] = markdown_text(info.cost);
    fields.values["limits"] = markdown_text(info.limits);
    fields.lists["sources"] = source_fields(info.sources);
    fields.flag("has_parameters", !info.parameters.empty());
    for (const ParameterSpec& parameter : info.parameters) {
      fields.lists["parameters"].push_back(parameter_fields(parameter));
    }
    methods.push_back(std::move(fields));
  }
  return methods;
}

void cite_sources(std::string_view bibliography, std::vector<Fields>& methods) {
  const std::vector<BibliographyKey> keys = bibliography_keys(bibliography);
  for (Fields& method : methods) {
    for (Fields& source : method.lists["sources"]) {
      const std::string plain = lower_case(source.values["plain_source"]);
      for (const BibliographyKey& key : keys) {
        if (plain.find(key.author) == std::string::npos) continue;
        if (plain.find(key.year) == std::string::npos) continue;
        source.values["source"] += " [@" + key.key + "]";
      }
    }
  }
}

}  // namespace vislab
