#include "experiments/analysis/knees_file.h"

#include <cmath>
#include <sstream>

#include "experiments/matrix/toml_keys.h"

namespace vislab {
namespace {

using namespace toml_keys;

constexpr const char* opening =
    "# The knees that the cullers' defaults were chosen by, and what they were found from: see\n"
    "# experiments/analysis/knees_file.h. Written by `vislab knees --write`; do not edit. Texts "
    "that\n"
    "# explain a default stand in experiments/model_size.\n";

const std::vector<std::string>& provenance_keys() {
  static const std::vector<std::string> keys{"cpu",  "compiler", "revision",
                                             "date", "rounds",   "threads"};
  return keys;
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

/// Three significant digits are as many as are worth keeping.
std::string number(double value) {
  if (!std::isfinite(value)) return "nan";
  std::ostringstream text;
  text.precision(3);
  text << value;
  const std::string digits = text.str();
  return digits.find_first_of(".e") == std::string::npos ? digits + ".0" : digits;
}

void write_scene(const SizeSweep& sweep, const SizeVerdict& verdict, const SizeCurve& scene,
                 std::ostream& out) {
  const SizePoint& point = scene.points[verdict.method.default_value];
  const double best = scene.points[*scene.best].efficiency.value;
  out << "\n[[knee.scene]]\nscene = " << quoted(scene.scene) << '\n';
  if (!scene.path.empty()) out << "path = " << quoted(scene.path) << '\n';
  out << "knee = " << quoted(sweep.values[*scene.knee])
      << "\nbest = " << quoted(sweep.values[*scene.best])
      << "\ndefault_of_best = " << number(point.relative)
      << "\ndefault_of_best_low = " << number(point.efficiency.low / best)
      << "\ndefault_of_best_high = " << number(point.efficiency.high / best)
      << "\ndefault_efficiency = " << number(point.efficiency.value)
      << "\ndefault_wrong_pixels = " << point.wrong_pixels
      << "\ndefault_over = " << number(point.over) << "\ndefault_bytes = " << point.bytes
      << "\ndefault_build_ms = " << number(point.build_ms) << '\n';
}

void write_verdict(const SizeResult& result, const SizeVerdict& verdict, std::ostream& out) {
  const SizeSweep& sweep = result.sweep;
  out << "\n[[knee]]\ndial = " << quoted(sweep.dial)
      << "\nculler = " << quoted(verdict.method.culler)
      << "\nparameter = " << quoted(verdict.method.parameter)
      << "\nchain = " << quoted(verdict.method.chains[verdict.method.default_value])
      << "\ndefault = " << quoted(sweep.values[verdict.method.default_value])
      << "\nknee = " << quoted(sweep.values[*verdict.common.knee]) << "\nmay_be_knee = [";
  for (std::size_t i = 0; i < verdict.common.may_be_knee.size(); ++i) {
    out << (i == 0 ? "" : ", ") << quoted(sweep.values[verdict.common.may_be_knee[i]]);
  }
  out << "]\n";
  if (!verdict.default_is_knee()) {
    out << "off_knee = " << quoted(verdict.method.off_knee) << '\n';
  }
  if (!verdict.method.note.empty()) out << "note = " << quoted(verdict.method.note) << '\n';
  out << "sweep = " << quoted(sweep.name) << "\ncost = " << quoted(to_string(sweep.cost)) << '\n';
  for (const std::string& key : provenance_keys()) {
    const auto found = result.provenance.find(key);
    out << key << " = " << quoted(found == result.provenance.end() ? "" : found->second) << '\n';
  }
  out << "regenerate = " << quoted("vislab run model_size && vislab knees --write data/knees.toml")
      << '\n';
  for (const SizeCurve& scene : verdict.scenes) write_scene(sweep, verdict, scene, out);
}

/// "octree_depth (city: not run)" for each sweep that has a gap.
std::string gaps_of(const std::vector<SizeResult>& results) {
  std::string gaps;
  for (const SizeResult& result : results) {
    for (const SizeVerdict& verdict : result.verdicts) {
      const auto gap = std::ranges::find_if(
          verdict.common.points, [](const SizePoint& point) { return !point.was_measured(); });
      if (gap == verdict.common.points.end()) continue;
      const auto value = static_cast<std::size_t>(gap - verdict.common.points.begin());
      gaps += (gaps.empty() ? "" : ", ") + result.sweep.name + " (" + verdict.method.culler +
              " at " + result.sweep.setting(value) + ", " + gap->gap + ")";
      break;
    }
  }
  return gaps;
}

std::string text_of(const toml::table& table, std::string_view key, const std::string& file) {
  const auto text = value_of<std::string>(table, key, "a text", file);
  if (!text) throw InputError(place(file, table) + ": " + std::string(key) + " is missing");
  return *text;
}

}  // namespace

std::string knees_text(const std::vector<SizeResult>& results) {
  if (const std::string gaps = gaps_of(results); !gaps.empty()) {
    throw InputError("knees are written only when nothing is missing; missing are: " + gaps +
                     "; 'vislab run model_size' measures all");
  }
  std::ostringstream out;
  out << opening;
  for (const SizeResult& result : results) {
    for (const SizeVerdict& verdict : result.verdicts) write_verdict(result, verdict, out);
  }
  return out.str();
}

std::vector<CommittedKnee> read_knees(const std::filesystem::path& path) {
  const std::string file = path.string();
  const toml::table root = parse_file(path);
  refuse_unknown_keys(root, {"knee"}, "knees", file);
  const toml::array* const entries = tables(root, "knee", file);
  if (entries == nullptr) throw InputError(file + ": there is no [[knee]]");
  std::vector<CommittedKnee> knees;
  for (const toml::node& node : *entries) {
    const toml::table& table = *node.as_table();
    std::vector<std::string> known{"dial", "culler", "parameter", "chain",       "default",
                                   "knee", "note",   "sweep",     "may_be_knee", "off_knee",
                                   "cost", "scene",  "regenerate"};
    known.insert(known.end(), provenance_keys().begin(), provenance_keys().end());
    refuse_unknown_keys(table, known, "[[knee]]", file);
    CommittedKnee knee;
    knee.dial = text_of(table, "dial", file);
    knee.culler = text_of(table, "culler", file);
    knee.parameter = text_of(table, "parameter", file);
    knee.chain = text_of(table, "chain", file);
    knee.default_value = text_of(table, "default", file);
    knee.knee = text_of(table, "knee", file);
    knee.note = value_of<std::string>(table, "note", "a text", file).value_or("");
    knee.off_knee = value_of<std::string>(table, "off_knee", "a text", file).value_or("");
    knee.sweep = text_of(table, "sweep", file);
    if (const toml::node* const values = table.get("may_be_knee")) {
      knee.may_be_knee = text_list(*values, "may_be_knee", file);
    }
    for (const std::string& key : provenance_keys()) {
      knee.provenance[key] = text_of(table, key, file);
    }
    if (const toml::array* const scenes = tables(table, "scene", file)) {
      for (const toml::node& scene : *scenes) {
        knee.scenes.push_back(text_of(*scene.as_table(), "scene", file));
      }
    }
    knees.push_back(std::move(knee));
  }
  return knees;
}

}  // namespace vislab
