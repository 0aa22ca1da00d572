#include "experiments/matrix/matrix.h"

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <algorithm>
#include <optional>

#include "common/scene/error.h"
#include "experiments/matrix/resolution.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

/// Where a TOML value stands: "file.toml:12".
std::string place(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

void refuse_unknown_keys(const toml::table& table, const std::vector<std::string>& known,
                         const std::string& what, const std::string& file) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::ranges::find(known, name) == known.end()) {
      throw InputError(place(file, node) + ": " +
                       unknown_name("key of " + what, name, known).what());
    }
  }
}

template <typename T>
std::optional<T> value_of(const toml::table& table, std::string_view key, const std::string& type,
                          const std::string& file) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  const std::optional<T> value = node->value<T>();
  if (!value) throw InputError(place(file, *node) + ": " + std::string(key) + " must be " + type);
  return value;
}

int whole_number(const toml::node& node, std::string_view key, long long min, long long max,
                 const std::string& file) {
  const std::optional<long long> value = node.value_exact<std::int64_t>();
  if (!value || *value < min || *value > max) {
    throw InputError(place(file, node) + ": " + std::string(key) + " must be a whole number from " +
                     std::to_string(min) + " to " + std::to_string(max));
  }
  return static_cast<int>(*value);
}

/// Patterns of [[exclude]] and [[adjust]]; an empty pattern fits everything.
struct Pattern {
  std::string culler = "*", scene = "*", path = "*", resolution = "*";
};

struct Adjustment {
  Pattern pattern;
  std::optional<int> frames, rounds;
  std::optional<double> timeout_s;
};

/// A matrix file as it is written, before its lists are multiplied.
struct Description {
  std::string text;
  int rounds = 5;
  std::uint64_t seed = 1;
  int threads = 2;
  std::string draw = "osmesa";
  double timeout_s = 300.0;
  std::vector<std::string> cullers, scenes;
  std::vector<std::string> paths{""};
  std::vector<Viewport> resolutions{Viewport{}};
  std::vector<int> frames{60};
  std::vector<Pattern> excluded;
  std::vector<Adjustment> adjusted;
};

std::vector<std::string> text_list(const toml::node& node, std::string_view key,
                                   const std::string& file) {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty()) {
    throw InputError(place(file, node) + ": " + std::string(key) +
                     " must be a list of texts with at least one entry");
  }
  std::vector<std::string> list;
  for (const toml::node& entry : *array) {
    const std::optional<std::string> text = entry.value_exact<std::string>();
    if (!text) {
      throw InputError(place(file, entry) + ": " + std::string(key) + " must be a list of texts");
    }
    list.push_back(*text);
  }
  return list;
}

void read_lists(const toml::table& lists, Description& description, const std::string& file) {
  refuse_unknown_keys(lists, {"culler", "scene", "path", "resolution", "frames"}, "[lists]", file);
  if (const auto* node = lists.get("culler"))
    description.cullers = text_list(*node, "culler", file);
  if (const auto* node = lists.get("scene")) description.scenes = text_list(*node, "scene", file);
  if (const auto* node = lists.get("path")) description.paths = text_list(*node, "path", file);
  if (const auto* node = lists.get("resolution")) {
    description.resolutions.clear();
    for (const std::string& text : text_list(*node, "resolution", file)) {
      try {
        description.resolutions.push_back(parse_resolution(text));
      } catch (const InputError& error) {
        throw InputError(place(file, *node) + ": " + error.what());
      }
    }
  }
  if (const auto* node = lists.get("frames")) {
    const toml::array* array = node->as_array();
    if (array == nullptr || array->empty()) {
      throw InputError(place(file, *node) + ": frames must be a list of whole numbers");
    }
    description.frames.clear();
    for (const toml::node& entry : *array) {
      description.frames.push_back(whole_number(entry, "frames", 0, 100000, file));
    }
  }
}

const toml::array* tables(const toml::table& root, std::string_view key, const std::string& file) {
  const toml::node* node = root.get(key);
  if (node == nullptr) return nullptr;
  if (!node->is_array_of_tables()) {
    throw InputError(place(file, *node) + ": write [[" + std::string(key) + "]]");
  }
  return node->as_array();
}

Pattern read_pattern(const toml::table& table, const std::string& file) {
  Pattern pattern;
  const auto read = [&](std::string_view key, std::string& into) {
    if (auto text = value_of<std::string>(table, key, "a text", file)) into = *text;
  };
  read("culler", pattern.culler);
  read("scene", pattern.scene);
  read("path", pattern.path);
  read("resolution", pattern.resolution);
  return pattern;
}

fs::path find_matrix(const std::string& name_or_file, const fs::path& folder) {
  const fs::path named = folder / (name_or_file + ".toml");
  if (fs::is_regular_file(named)) return named;
  if (fs::is_regular_file(name_or_file)) return name_or_file;
  if (fs::exists(name_or_file)) throw InputError("matrix " + name_or_file + " is not a file");
  std::vector<std::string> known;
  for (const auto& [name, text] : list_matrices(folder)) known.push_back(name);
  throw unknown_name("matrix (or file)", name_or_file, known);
}

Description read_description(const fs::path& path, const fs::path& folder, int depth) {
  const std::string file = path.string();
  toml::table root;
  try {
    root = toml::parse_file(file);
  } catch (const toml::parse_error& error) {
    throw InputError(file + ":" + std::to_string(error.source().begin.line) + ": " +
                     std::string(error.description()));
  }
  refuse_unknown_keys(root,
                      {"description", "extends", "rounds", "seed", "threads", "draw", "timeout_s",
                       "lists", "exclude", "adjust"},
                      "a matrix", file);
  Description description;
  if (const auto base = value_of<std::string>(root, "extends", "the name of a matrix", file)) {
    if (depth > 8) throw InputError(file + ": matrices extend each other in a circle");
    description = read_description(find_matrix(*base, folder), folder, depth + 1);
  }
  if (auto text = value_of<std::string>(root, "description", "a text", file)) {
    description.text = *text;
  }
  if (const auto* node = root.get("rounds")) {
    description.rounds = whole_number(*node, "rounds", 1, 1000, file);
  }
  if (const auto* node = root.get("seed")) {
    description.seed = static_cast<std::uint64_t>(whole_number(*node, "seed", 0, 2147483647, file));
  }
  if (const auto* node = root.get("threads")) {
    description.threads = whole_number(*node, "threads", 1, 1024, file);
  }
  if (auto draw = value_of<std::string>(root, "draw", "a text", file)) {
    if (*draw != "osmesa" && *draw != "none") {
      throw InputError(place(file, *root.get("draw")) + ": " +
                       unknown_name("value of draw", *draw, {"osmesa", "none"}).what());
    }
    description.draw = *draw;
  }
  if (auto seconds = value_of<double>(root, "timeout_s", "a number of seconds", file)) {
    if (!(*seconds > 0.0)) {
      throw InputError(place(file, *root.get("timeout_s")) + ": timeout_s must be above 0");
    }
    description.timeout_s = *seconds;
  }
  if (const toml::node* lists = root.get("lists")) {
    if (!lists->is_table()) throw InputError(place(file, *lists) + ": write [lists]");
    read_lists(*lists->as_table(), description, file);
  }
  if (const toml::array* excluded = tables(root, "exclude", file)) {
    for (const toml::node& node : *excluded) {
      const toml::table& table = *node.as_table();
      refuse_unknown_keys(table, {"culler", "scene", "path", "resolution"}, "[[exclude]]", file);
      description.excluded.push_back(read_pattern(table, file));
    }
  }
  if (const toml::array* adjusted = tables(root, "adjust", file)) {
    for (const toml::node& node : *adjusted) {
      const toml::table& table = *node.as_table();
      refuse_unknown_keys(table, {"scene", "path", "resolution", "frames", "rounds", "timeout_s"},
                          "[[adjust]]", file);
      Adjustment adjustment{read_pattern(table, file), {}, {}, {}};
      if (const auto* n = table.get("frames")) {
        adjustment.frames = whole_number(*n, "frames", 0, 100000, file);
      }
      if (const auto* n = table.get("rounds")) {
        adjustment.rounds = whole_number(*n, "rounds", 1, 1000, file);
      }
      adjustment.timeout_s = value_of<double>(table, "timeout_s", "a number of seconds", file);
      description.adjusted.push_back(adjustment);
    }
  }
  return description;
}

std::string to_text(const Viewport& viewport) {
  return std::to_string(viewport.width) + "x" + std::to_string(viewport.height);
}

bool fits(const Pattern& pattern, const Block& block) {
  return matches(pattern.scene, block.scene) && matches(pattern.path, block.path) &&
         matches(pattern.resolution, to_text(block.viewport));
}

/// The anchors and the A/A control, then what is asked for, each chain once.
std::vector<BlockCuller> with_anchors(const std::vector<std::string>& chains,
                                      const Registry& registry) {
  std::vector<BlockCuller> cullers;
  for (const std::string& anchor : anchor_chains(registry)) cullers.push_back({anchor, 0});
  cullers.push_back({registry.canonical("none"), 1});
  for (const std::string& chain : chains) {
    if (std::ranges::find(cullers, chain, &BlockCuller::chain) == cullers.end()) {
      cullers.push_back({chain, 0});
    }
  }
  return cullers;
}

}  // namespace

std::string Block::title() const {
  return scene + (path.empty() ? "" : ", " + path) + ", " + to_text(viewport) +
         (device == "none" ? ", not drawn" : "");
}

std::vector<std::string> anchor_chains(const Registry& registry) {
  return {registry.canonical("none"), registry.canonical("oracle[level=object]"),
          registry.canonical("oracle[level=triangle]")};
}

bool matches(std::string_view pattern, std::string_view text) {
  const auto star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == text;
  if (text.substr(0, star) != pattern.substr(0, star)) return false;
  text.remove_prefix(star);
  pattern.remove_prefix(star + 1);
  for (std::size_t skip = 0; skip <= text.size(); ++skip) {
    if (matches(pattern, text.substr(skip))) return true;
  }
  return false;
}

Matrix load_matrix(const std::string& name_or_file, const fs::path& folder,
                   const Registry& registry) {
  const fs::path file = find_matrix(name_or_file, folder);
  const Description description = read_description(file, folder, 0);
  if (description.cullers.empty() || description.scenes.empty()) {
    throw InputError(file.string() + ": [lists] must name at least one culler and one scene");
  }
  Matrix matrix{file.stem().string(), description.text, {}};
  std::vector<std::string> chains;
  for (const std::string& culler : description.cullers) {
    try {
      registry.make(culler);
      chains.push_back(registry.canonical(culler));
    } catch (const InputError& error) {
      throw InputError(file.string() + ": " + error.what());
    }
  }
  for (const std::string& scene : description.scenes) {
    for (const std::string& path : description.paths) {
      for (const Viewport& viewport : description.resolutions) {
        for (const int frames : description.frames) {
          Block block{scene,
                      path,
                      viewport,
                      frames,
                      description.draw,
                      description.seed,
                      description.threads,
                      description.rounds,
                      description.timeout_s,
                      {}};
          for (const Adjustment& adjustment : description.adjusted) {
            if (!fits(adjustment.pattern, block)) continue;
            block.frames = adjustment.frames.value_or(block.frames);
            block.rounds = adjustment.rounds.value_or(block.rounds);
            block.timeout_s = adjustment.timeout_s.value_or(block.timeout_s);
          }
          std::vector<std::string> wanted;
          for (std::size_t i = 0; i < chains.size(); ++i) {
            const bool excluded =
                std::ranges::any_of(description.excluded, [&](const Pattern& pattern) {
                  return fits(pattern, block) && (matches(pattern.culler, description.cullers[i]) ||
                                                  matches(pattern.culler, chains[i]));
                });
            if (!excluded) wanted.push_back(chains[i]);
          }
          if (wanted.empty()) continue;
          block.cullers = with_anchors(wanted, registry);
          matrix.blocks.push_back(std::move(block));
        }
      }
    }
  }
  if (matrix.blocks.empty()) {
    throw InputError(file.string() + ": [[exclude]] leaves no cell over");
  }
  return matrix;
}

Matrix single_block(const std::string& chain, const Block& settings, const Registry& registry) {
  registry.make(chain);
  Block block = settings;
  block.cullers = with_anchors({registry.canonical(chain)}, registry);
  return {"", "", {std::move(block)}};
}

std::vector<std::pair<std::string, std::string>> list_matrices(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> matrices;
  if (!fs::is_directory(folder)) return matrices;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".toml") continue;
    std::string text;
    try {
      text = toml::parse_file(entry.path().string())["description"].value_or(std::string());
    } catch (const toml::parse_error& error) {
      text = "cannot be read: " + std::string(error.description());
    }
    matrices.emplace_back(entry.path().stem().string(), text);
  }
  std::ranges::sort(matrices);
  return matrices;
}

}  // namespace vislab
