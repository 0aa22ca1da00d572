#include "common/culler/registry.h"

#include <stdexcept>

#include "common/culler/chain.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\n") - first + 1);
}

/// Splits at `separator`; "a,,b" has an empty middle part.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto end = text.find(separator);
    parts.push_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

InputError wrong(std::string_view text, const std::string& what) {
  return InputError("culler '" + std::string(text) + "': " + what +
                    "; a culler is written family.variant[parameter=value,...], stages of a chain "
                    "are joined by ' > '");
}

CullerSpec parse_stage(std::string_view stage, std::string_view whole) {
  CullerSpec spec;
  const auto open = stage.find('[');
  spec.name = trimmed(stage.substr(0, open));
  if (spec.name.empty()) throw wrong(whole, "a stage has no name");
  if (spec.name.find_first_of("],= \t") != std::string::npos) {
    throw wrong(whole, "'" + spec.name + "' is not a name");
  }
  if (open == std::string_view::npos) return spec;
  if (stage.back() != ']') throw wrong(whole, "a '[' is not closed at the end of its stage");
  const std::string_view inside = stage.substr(open + 1, stage.size() - open - 2);
  if (inside.find_first_of("[]") != std::string_view::npos) throw wrong(whole, "nested brackets");
  for (const std::string_view part : split(inside, ',')) {
    const auto equals = part.find('=');
    if (equals == std::string_view::npos) {
      throw wrong(whole, "'" + std::string(part) + "' is not parameter=value");
    }
    const std::string name(trimmed(part.substr(0, equals)));
    const std::string value(trimmed(part.substr(equals + 1)));
    if (!spec.parameters.emplace(name, value).second) {
      throw wrong(whole, "parameter " + name + " is given twice");
    }
  }
  return spec;
}

std::string written(const CullerEntry& entry, const ParameterValues& values, bool with_defaults) {
  std::string parameters;
  for (const ParameterSpec& spec : entry.info.parameters) {
    const std::string& value = values.choice(spec.name);
    if (!with_defaults && value == spec.default_value) continue;
    parameters += (parameters.empty() ? "" : ",") + spec.name + "=" + value;
  }
  return parameters.empty() ? entry.info.name : entry.info.name + "[" + parameters + "]";
}

std::string written(const Registry& registry, std::string_view text, bool with_defaults) {
  std::string result;
  for (const CullerSpec& spec : parse_chain(text)) {
    const CullerEntry& entry = registry.entry(spec.name);
    const ParameterValues values(spec.name, entry.info.parameters, spec.parameters);
    result += (result.empty() ? "" : " > ") + written(entry, values, with_defaults);
  }
  return result;
}

}  // namespace

std::vector<CullerSpec> parse_chain(std::string_view text) {
  std::vector<CullerSpec> stages;
  for (const std::string_view stage : split(text, '>')) stages.push_back(parse_stage(stage, text));
  return stages;
}

void Registry::add(CullerEntry entry) {
  const std::string name = entry.info.name;
  if (!entries_.emplace(name, std::move(entry)).second) {
    throw std::logic_error("two cullers are called " + name);
  }
}

const CullerEntry& Registry::entry(std::string_view name) const {
  const auto it = entries_.find(name);
  if (it != entries_.end()) return it->second;
  std::vector<std::string> known;
  for (const auto& [known_name, entry] : entries_) known.push_back(known_name);
  throw unknown_name("culler", std::string(name), known);
}

std::unique_ptr<ICuller> Registry::make(std::string_view text) const {
  std::vector<std::unique_ptr<ICuller>> stages;
  for (const CullerSpec& spec : parse_chain(text)) {
    const CullerEntry& known = entry(spec.name);
    stages.push_back(
        known.make(ParameterValues(spec.name, known.info.parameters, spec.parameters)));
  }
  return stages.size() == 1 ? std::move(stages.front()) : make_chain(std::move(stages));
}

std::string Registry::canonical(std::string_view text) const { return written(*this, text, true); }

std::string Registry::short_name(std::string_view text) const {
  return written(*this, text, false);
}

}  // namespace vislab
