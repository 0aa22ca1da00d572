#include "experiments/matrix/sweep.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <tuple>

#include "common/judge/metrics.h"
#include "experiments/matrix/dial_gaps.h"
#include "experiments/matrix/resolution.h"
#include "experiments/matrix/toml_keys.h"
#include "experiments/results/files.h"
#include "experiments/results/hash.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;
using namespace toml_keys;
using namespace dial_gaps;

constexpr std::size_t fewest_values = 8;
constexpr const char* kept_folder = "sweep";  // in the sweep's folder: its text if not the lab's

/// The file's table. If it extends another sweep, that one's keys stand where it has none of its
/// own, but for what is measured and expected.
toml::table read_sweep_table(const fs::path& path, const fs::path& folder) {
  toml::table own = parse_file(path);
  const std::string file = path.string();
  const auto base = value_of<std::string>(own, "extends", "the name of a sweep", file);
  if (!base) return own;
  const fs::path base_file = folder / (*base + ".toml");
  if (!fs::is_regular_file(base_file)) {
    std::vector<std::string> known;
    for (const auto& [name, text] : list_sweeps(folder)) known.push_back(name);
    throw InputError(place(file, *own.get("extends")) + ": " +
                     unknown_name("sweep", *base, known).what());
  }
  toml::table table = parse_file(base_file);
  if (table.contains("extends")) {
    throw InputError(place(file, *own.get("extends")) + ": '" + *base +
                     "' extends another sweep itself; extend that one");
  }
  own.erase("extends");
  table.erase("limit");
  table.erase("expect");
  if (own.contains("cullers")) table.erase("optional_cullers");
  for (auto&& [key, node] : own) {
    node.visit(
        [&, name = key.str()](auto& value) { table.insert_or_assign(name, std::move(value)); });
  }
  return table;
}

const toml::table& table_at(const toml::table& root, std::string_view key,
                            const std::string& file) {
  const toml::node* node = root.get(key);
  if (node == nullptr || !node->is_table()) {
    throw InputError((node == nullptr ? file : place(file, *node)) + ": write [" +
                     std::string(key) + "], a table" +
                     (node == nullptr ? ", which is missing" : ""));
  }
  return *node->as_table();
}

std::string required_text(const toml::table& table, std::string_view key, const std::string& what,
                          const std::string& file) {
  const auto text = value_of<std::string>(table, key, "a text", file);
  if (!text) throw InputError(file + ": " + std::string(key) + " of " + what + " is missing");
  return *text;
}

std::vector<DialValue> read_dial(const toml::table& table, SweepDial& dial,
                                 const std::string& file) {
  refuse_unknown_keys(table, {"name", "unit", "values"}, "[dial]", file);
  dial.name = required_text(table, "name", "[dial]", file);
  dial.unit = value_of<std::string>(table, "unit", "a text", file).value_or("");
  const toml::node* const node = table.get("values");
  const toml::array* const list = node == nullptr ? nullptr : node->as_array();
  const auto wrong = [&](const std::string& right) {
    return InputError((node == nullptr ? file : place(file, *node)) +
                      ": values of [dial] must be " + right);
  };
  if (list == nullptr || list->size() < fewest_values) {
    throw wrong("a list of at least " + std::to_string(fewest_values) +
                " numbers from benign to adversarial");
  }
  std::vector<DialValue> values;
  for (const toml::node& entry : *list) {
    const std::optional<double> number = entry.is_number() ? entry.value<double>() : std::nullopt;
    if (!number || !std::isfinite(*number)) throw wrong("finite numbers");
    DialValue value{entry.value_exact<std::int64_t>(), *number, {}};
    value.text = value.whole ? std::to_string(*value.whole) : digits_of(*number);
    values.push_back(value);
    dial.values.push_back(value.number);
    dial.texts.push_back(value.text);
  }
  const bool ascending = dial.values[0] < dial.values[1];
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = dial.values[i] - dial.values[i - 1];
    if (!(ascending ? step > 0.0 : step < 0.0)) {
      throw wrong("in ascending or in descending order, each once");
    }
  }
  return values;
}

SweepLimit read_limit(const toml::table& table, const std::string& file) {
  refuse_unknown_keys(table,
                      {"metric", "counter", "at_most", "at_most_ratio", "at_least", "against"},
                      "[limit]", file);
  SweepLimit limit;
  const auto metric = value_of<std::string>(table, "metric", "a text", file);
  const auto counter = value_of<std::string>(table, "counter", "a text", file);
  if (metric && counter) {
    throw InputError(place(file, *table.get("counter")) +
                     ": [limit] takes a metric or a counter, not both");
  }
  limit.at_least = value_of<double>(table, "at_least", "a number", file);
  if (counter) limit = {*counter, true, {}, {}, {}, limit.at_least};
  if (metric) {
    const auto better = limit.at_least ? Metric::Better::higher : Metric::Better::lower;
    std::vector<std::string> known;
    for (const Metric& entry : metrics()) {
      if (entry.better == better) known.emplace_back(entry.name);
    }
    if (std::ranges::find(known, *metric) == known.end()) {
      const std::string kind = limit.at_least
                                   ? "metric that is better when higher, as at_least is for,"
                                   : "metric that is better when lower (others take at_least)";
      throw InputError(place(file, *table.get("metric")) + ": " +
                       unknown_name(kind, *metric, known).what());
    }
    limit.metric = *metric;
  }
  if (limit.at_least && !metric) {
    throw InputError(place(file, *table.get("at_least")) +
                     ": at_least needs a metric that is better when higher");
  }
  limit.at_most = value_of<double>(table, "at_most", "a number", file);
  limit.at_most_ratio = value_of<double>(table, "at_most_ratio", "a number", file);
  if (limit.at_most.has_value() + limit.at_most_ratio.has_value() + limit.at_least.has_value() >
      1) {
    throw InputError(place(file, *table.get(limit.at_most ? "at_most" : "at_most_ratio")) +
                     ": [limit] takes one of at_most, at_most_ratio and at_least");
  }
  if (limit.is_counter && !limit.at_most && !limit.at_most_ratio) {
    throw InputError(place(file, *table.get("counter")) +
                     ": a counter needs at_most or at_most_ratio");
  }
  return limit;
}

SweepExpectation read_expectation(const toml::table& table, const SweepDial& dial,
                                  const std::string& file) {
  refuse_unknown_keys(table, {"culler", "breaks", "source", "because", "hindsight"}, "[[expect]]",
                      file);
  SweepExpectation expectation;
  expectation.culler = required_text(table, "culler", "[[expect]]", file);
  expectation.source = required_text(table, "source", "[[expect]]", file);
  expectation.because = required_text(table, "because", "[[expect]]", file);
  expectation.hindsight = value_of<std::string>(table, "hindsight", "a text", file).value_or("");
  const toml::node* const breaks = table.get("breaks");
  if (breaks != nullptr && breaks->value_exact<std::string>() == "never") return expectation;
  const toml::array* const range = breaks == nullptr ? nullptr : breaks->as_array();
  const auto bound = [&](std::size_t i) { return (*range)[i].value<double>(); };
  if (range == nullptr || range->size() != 2 || !bound(0) || !bound(1)) {
    throw InputError(
        place(file, breaks == nullptr ? static_cast<const toml::node&>(table) : *breaks) +
        ": breaks must be \"never\" or two values of the dial, [first, last]");
  }
  expectation.never = false;
  std::tie(expectation.low, expectation.high) = std::minmax({*bound(0), *bound(1)});
  if (std::ranges::none_of(dial.values, [&](double value) {
        return value >= expectation.low && value <= expectation.high;
      })) {
    throw InputError(place(file, *breaks) + ": no value of the dial lies in the range of breaks");
  }
  return expectation;
}

/// Reads one sweep file and makes its blocks.
class SweepReader {
 public:
  SweepReader(const fs::path& path, const fs::path& folder, const fs::path& results,
              const Registry& registry)
      : file_(path.string()), root_(read_sweep_table(path, folder)), registry_(registry) {
    sweep_.name = path.stem().string();
    folder_ = results / "stress" / sweep_.name;
  }

  Sweep read() {
    std::vector<std::string> known{"description", "failure", "cullers", "optional_cullers",
                                   "resolution",  "frames",  "dial",    "scene",
                                   "path",        "limit",   "expect"};
    known.insert(known.end(), pass_keys.begin(), pass_keys.end());
    refuse_unknown_keys(root_, known, "a sweep", file_);
    sweep_.description = required_text(root_, "description", "a sweep", file_);
    sweep_.failure = required_text(root_, "failure", "a sweep", file_);
    values_ = read_dial(table_at(root_, "dial", file_), sweep_.dial, file_);
    if (root_.contains("limit")) sweep_.limit = read_limit(table_at(root_, "limit", file_), file_);
    read_block_settings();
    read_methods();
    read_against();
    read_expectations();
    make_blocks();
    return std::move(sweep_);
  }

 private:
  void read_block_settings() {
    PassSettings pass;
    const bool dialled_seed = read_seeds();
    read_pass_settings(root_, pass, file_);
    settings_.rounds = pass.rounds;
    if (!dialled_seed) seeds_.assign(values_.size(), pass.seed);
    settings_.threads = pass.threads;
    settings_.timeout_s = pass.timeout_s;
    for (const DialValue& value : values_) {
      devices_.push_back(
          canonical_device(replaced(pass.draw, value.text), root_.get("draw"), file_));
    }
    if (const auto* node = root_.get("frames")) {
      settings_.frames = whole_number(*node, "frames", 0, 100000, file_);
    }
    viewports_.assign(values_.size(), settings_.viewport);
    if (auto text = value_of<std::string>(root_, "resolution", "a text", file_)) {
      try {
        for (std::size_t i = 0; i < values_.size(); ++i) {
          viewports_[i] = parse_resolution(replaced(*text, values_[i].text));
        }
      } catch (const InputError& error) {
        throw InputError(place(file_, *root_.get("resolution")) + ": " + error.what());
      }
    }
  }

  /// If the dial is the seed. Then the key is taken out, as it is not a number.
  bool read_seeds() {
    const toml::node* const node = root_.get("seed");
    if (node == nullptr || node->value_exact<std::string>() != std::string(gap)) return false;
    for (const DialValue& value : values_) {
      if (!value.whole || *value.whole < 0) {
        throw InputError(place(file_, *node) +
                         ": a dial that is the seed needs whole values from 0 on, not " +
                         value.text);
      }
      seeds_.push_back(static_cast<std::uint64_t>(*value.whole));
    }
    root_.erase("seed");
    return true;
  }

  void read_methods() {
    const toml::node* const list = root_.get("cullers");
    if (list == nullptr) throw InputError(file_ + ": cullers, a list of texts, is missing");
    for (const std::string& text : text_list(*list, "cullers", file_)) add_method(text, *list);
    const toml::node* const optional = root_.get("optional_cullers");
    if (optional == nullptr) return;
    for (const std::string& text : text_list(*optional, "optional_cullers", file_)) {
      if (is_registered(replaced(text, values_.front().text), registry_)) {
        add_method(text, *optional);
      } else {
        sweep_.absent.push_back(text);
      }
    }
  }

  void add_method(const std::string& text, const toml::node& list) {
    SweepMethod method{replaced(text, "<" + sweep_.dial.name + ">"), {}, {}};
    for (const DialValue& value : values_) {
      const std::string chain = replaced(text, value.text);
      try {
        registry_.make(chain);
        method.chains.push_back(registry_.canonical(chain));
      } catch (const InputError& error) {
        throw InputError(place(file_, list) + ": " + error.what());
      }
    }
    sweep_.methods.push_back(std::move(method));
    written_.push_back(text);
  }

  /// Which method the others' figures are shares of, if [limit] says so.
  void read_against() {
    if (!root_.contains("limit")) return;
    const toml::table& limit = table_at(root_, "limit", file_);
    const auto against = value_of<std::string>(limit, "against", "a text", file_);
    if (!against) return;
    const auto found = std::ranges::find(written_, *against);
    if (found == written_.end()) {
      throw InputError(place(file_, *limit.get("against")) + ": " +
                       unknown_name("entry of cullers", *against, written_).what());
    }
    if (!sweep_.limit.at_most) {
      throw InputError(place(file_, *limit.get("against")) + ": against needs at_most");
    }
    sweep_.limit.against = static_cast<std::size_t>(found - written_.begin());
  }

  /// The first expectation whose pattern fits a method counts.
  void read_expectations() {
    const toml::array* const list = tables(root_, "expect", file_);
    if (list == nullptr) return;
    for (const toml::node& node : *list) {
      const SweepExpectation expectation = read_expectation(*node.as_table(), sweep_.dial, file_);
      const auto is_meant = [&](const std::string& culler) {
        return matches(expectation.culler, culler);
      };
      bool fits = std::ranges::any_of(sweep_.absent, is_meant);
      for (std::size_t i = 0; i < sweep_.methods.size(); ++i) {
        if (sweep_.methods[i].expectation || !is_meant(written_[i])) continue;
        fits = true;
        sweep_.methods[i].expectation = expectation;
      }
      if (fits) continue;
      const std::string what =
          std::ranges::any_of(written_, is_meant)
              ? "patterns before it fit all that '" + expectation.culler + "' fits"
              : unknown_name("pattern for an entry of cullers", expectation.culler, written_)
                    .what();
      throw InputError(place(file_, node) + ": " + what);
    }
  }

  /// The table's file at each value of the dial; one for all if the dial does not stand in it.
  std::vector<std::string> files_of(const toml::table& table, const std::string& suffix) {
    std::vector<std::string> texts;
    for (const DialValue& value : values_) texts.push_back(toml_text(substituted(table, value)));
    const bool same = std::ranges::count(texts, texts.front()) == std::ssize(texts);
    std::vector<std::string> files;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const std::string value = same ? "" : "-" + values_[i].text;
      files.push_back((folder_ / (sweep_.name + value + suffix + ".toml")).string());
      if (i == 0 || !same) sweep_.files.push_back({files.back(), texts[i]});
    }
    return files;
  }

  void make_blocks() {
    toml::table scene = table_at(root_, "scene", file_);
    scene.insert("description", sweep_.description);
    std::map<std::tuple<std::string, std::string, int, int, std::uint64_t, std::string>,
             std::size_t>
        known;
    std::vector<std::vector<std::string>> chains;
    const std::vector<std::string> scenes = files_of(scene, "");
    std::vector<std::string> paths(values_.size());
    if (root_.contains("path")) paths = files_of(table_at(root_, "path", file_), "-path");
    for (std::size_t i = 0; i < values_.size(); ++i) {
      Block block = settings_;
      block.scene = scenes[i];
      block.path = paths[i];
      block.viewport = viewports_[i];
      block.seed = seeds_[i];
      block.device = devices_[i];
      const auto [found, is_new] =
          known.try_emplace({block.scene, block.path, block.viewport.width, block.viewport.height,
                             block.seed, block.device},
                            sweep_.blocks.size());
      if (is_new) {
        block.label = sweep_.name + ": " + sweep_.dial.setting(i);
        sweep_.blocks.push_back(block);
        chains.emplace_back();
      } else {
        sweep_.blocks[found->second].label =
            sweep_.name + ": several values of " + sweep_.dial.name;
      }
      sweep_.block_of_value.push_back(found->second);
      for (const SweepMethod& method : sweep_.methods) {
        chains[found->second].push_back(method.chains[i]);
      }
    }
    for (std::size_t i = 0; i < chains.size(); ++i) {
      sweep_.blocks[i].cullers = with_anchors(chains[i], registry_);
    }
    for (std::size_t i = 0; i < values_.size(); ++i) {
      sweep_.conditions.push_back(conditions_of(sweep_.blocks[sweep_.block_of_value[i]]));
    }
  }

  std::string conditions_of(const Block& block) const {
    std::ostringstream text;
    for (const std::string& name : {block.scene, block.path}) {
      const auto file = std::ranges::find(sweep_.files, fs::path(name), &SweepFile::file);
      if (file != sweep_.files.end()) text << file->text;
      text << '\n';
    }
    text << block.viewport.width << 'x' << block.viewport.height << ' ' << block.frames << ' '
         << block.seed << ' ' << block.device;
    return hash_text(text.str());
  }

  std::string file_;
  toml::table root_;
  const Registry& registry_;
  fs::path folder_;
  std::vector<DialValue> values_;
  std::vector<std::string> written_;  // the cullers as they stand in the file
  Block settings_;
  std::vector<Viewport> viewports_;   // by value of the dial
  std::vector<std::string> devices_;  // likewise
  std::vector<std::uint64_t> seeds_;  // likewise
  Sweep sweep_;
};

/// "F9" before "F10".
auto failure_order(const Sweep& sweep) {
  std::string number;
  for (const char c : sweep.failure) {
    if (c >= '0' && c <= '9') number += c;
  }
  return std::tuple(number.size(), number, sweep.failure, sweep.name);
}

}  // namespace

std::string Sweep::figure_name() const {
  const std::string figure = limit.metric + (limit.is_counter ? " a frame" : "");
  return limit.against ? figure + " ÷ that of " + methods[*limit.against].culler : figure;
}

std::string SweepDial::setting(std::size_t value) const {
  return name + " = " + texts[value] + (unit.empty() ? "" : " " + unit);
}

Sweep load_sweep(const std::string& name_or_file, const fs::path& folder, const fs::path& results,
                 const Registry& registry) {
  const fs::path named = folder / (name_or_file + ".toml");
  if (fs::is_regular_file(named)) return SweepReader(named, folder, results, registry).read();
  if (const fs::path file = name_or_file; fs::is_regular_file(file)) {
    Sweep sweep = SweepReader(file, folder, results, registry).read();
    const fs::path of_the_lab = folder / (sweep.name + ".toml");
    if (fs::exists(of_the_lab) && fs::equivalent(file, of_the_lab)) return sweep;
    if (fs::exists(of_the_lab)) {
      throw InputError(file.string() + ": the lab has a sweep '" + sweep.name +
                       "'; give the file another name");
    }
    sweep.files.push_back(
        {results / "stress" / sweep.name / kept_folder / (sweep.name + ".toml"), read_file(file)});
    return sweep;
  }
  std::vector<std::string> known;
  for (const auto& [name, text] : list_sweeps(folder)) known.push_back(name);
  throw unknown_name("sweep (or file)", name_or_file, known);
}

std::vector<Sweep> load_sweeps(const fs::path& folder, const fs::path& results,
                               const Registry& registry) {
  std::vector<Sweep> sweeps;
  for (const auto& [name, text] : list_sweeps(folder)) {
    sweeps.push_back(load_sweep(name, folder, results, registry));
  }
  std::ranges::stable_sort(sweeps, {}, failure_order);
  return sweeps;
}

std::vector<Sweep> load_kept_sweeps(const fs::path& folder, const fs::path& results,
                                    const Registry& registry) {
  std::vector<fs::path> kept;
  std::error_code none;  // no such folder: no sweep was run
  for (const auto& entry : fs::directory_iterator(results / "stress", none)) {
    const std::string name = entry.path().filename().string();
    const fs::path file = entry.path() / kept_folder / (name + ".toml");
    if (fs::exists(file) && !fs::exists(folder / (name + ".toml"))) kept.push_back(file);
  }
  std::ranges::sort(kept);
  std::vector<Sweep> sweeps;
  for (const fs::path& file : kept) {
    sweeps.push_back(load_sweep(file.string(), folder, results, registry));
  }
  return sweeps;
}

std::vector<std::pair<std::string, std::string>> list_sweeps(const fs::path& folder) {
  return list_matrices(folder);  // both are TOML files with a description
}

bool is_sweep_file(const fs::path& file) {
  try {
    const toml::table table = toml::parse_file(file.string());
    return table.contains("dial") || table.contains("failure");
  } catch (const toml::parse_error&) {
    return false;
  }
}

void write_sweep_files(const Sweep& sweep) {
  for (const SweepFile& file : sweep.files) {
    std::error_code code;
    fs::create_directories(file.file.parent_path(), code);
    if (code) {
      throw InputError(file.file.parent_path().string() + " cannot be made: " + code.message() +
                       "; name another folder with --results");
    }
    if (fs::exists(file.file) && read_file(file.file) == file.text) continue;
    write_file(file.file, file.text);
  }
}

}  // namespace vislab
