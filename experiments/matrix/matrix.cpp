#include "experiments/matrix/matrix.h"

#include <algorithm>
#include <optional>

#include "common/scene/error.h"
#include "common/scene/packages.h"
#include "experiments/matrix/resolution.h"
#include "experiments/matrix/toml_keys.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;
using namespace toml_keys;

/// Patterns of [[exclude]] and [[adjust]]; an empty pattern fits everything.
struct Pattern {
  std::string culler = "*", scene = "*", path = "*", resolution = "*", device = "*";
};

/// Paths of the scenes that fit, instead of those of the lists.
struct OwnPaths {
  std::string scene;
  std::vector<std::string> paths;
};

/// Chains that only the blocks that fit have, besides those of the lists.
struct OwnCullers {
  Pattern pattern;
  std::vector<std::string> cullers, optional_cullers;
};

struct Adjustment {
  Pattern pattern;
  std::optional<int> frames, rounds;
  std::optional<double> timeout_s;
};

/// A matrix file as it is written, before its lists are multiplied.
struct Description {
  std::string text;
  PassSettings pass;
  std::vector<std::string> cullers, optional_cullers, scenes, optional_scenes;
  std::vector<std::string> paths{""};
  std::vector<Viewport> resolutions{Viewport{}};
  std::vector<int> frames{60};
  std::vector<std::string> devices;  // canonical; empty: the one of `pass`
  std::vector<OwnPaths> own_paths;
  std::vector<OwnCullers> own_cullers;
  std::vector<Pattern> excluded;
  std::vector<Adjustment> adjusted;
};

void read_lists(const toml::table& lists, Description& description, const std::string& file) {
  refuse_unknown_keys(lists,
                      {"culler", "optional_culler", "scene", "optional_scene", "path", "resolution",
                       "frames", "device"},
                      "[lists]", file);
  if (const auto* node = lists.get("culler"))
    description.cullers = text_list(*node, "culler", file);
  if (const auto* node = lists.get("optional_culler")) {
    description.optional_cullers = text_list(*node, "optional_culler", file);
  }
  if (const auto* node = lists.get("scene")) description.scenes = text_list(*node, "scene", file);
  if (const auto* node = lists.get("optional_scene")) {
    description.optional_scenes = text_list(*node, "optional_scene", file);
  }
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
  if (const auto* node = lists.get("device")) {
    description.devices.clear();
    for (const std::string& text : text_list(*node, "device", file)) {
      description.devices.push_back(canonical_device(text, node, file));
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

/// All but the culler.
Pattern read_place(const toml::table& table, const std::string& file) {
  Pattern pattern;
  const auto read = [&](std::string_view key, std::string& into) {
    if (auto text = value_of<std::string>(table, key, "a text", file)) into = *text;
  };
  read("scene", pattern.scene);
  read("path", pattern.path);
  read("resolution", pattern.resolution);
  read("device", pattern.device);
  return pattern;
}

Pattern read_pattern(const toml::table& table, const std::string& file) {
  Pattern pattern = read_place(table, file);
  if (auto text = value_of<std::string>(table, "culler", "a text", file)) pattern.culler = *text;
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
  const toml::table root = parse_file(path);
  std::vector<std::string> known{"description", "extends", "lists", "paths",
                                 "cullers",     "exclude", "adjust"};
  known.insert(known.end(), pass_keys.begin(), pass_keys.end());
  refuse_unknown_keys(root, known, "a matrix", file);
  Description description;
  if (const auto base = value_of<std::string>(root, "extends", "the name of a matrix", file)) {
    if (depth > 8) throw InputError(file + ": matrices extend each other in a circle");
    description = read_description(find_matrix(*base, folder), folder, depth + 1);
  }
  if (auto text = value_of<std::string>(root, "description", "a text", file)) {
    description.text = *text;
  }
  read_pass_settings(root, description.pass, file);
  if (root.contains("draw")) {
    description.pass.draw = canonical_device(description.pass.draw, root.get("draw"), file);
    description.devices.clear();  // of a matrix that this one extends
  }
  if (const toml::node* lists = root.get("lists")) {
    if (!lists->is_table()) throw InputError(place(file, *lists) + ": write [lists]");
    read_lists(*lists->as_table(), description, file);
  }
  if (const toml::array* own_paths = tables(root, "paths", file)) {
    for (const toml::node& node : *own_paths) {
      const toml::table& table = *node.as_table();
      refuse_unknown_keys(table, {"scene", "path"}, "[[paths]]", file);
      const auto scene = value_of<std::string>(table, "scene", "a text", file);
      const toml::node* const paths = table.get("path");
      if (!scene || paths == nullptr) {
        throw InputError(place(file, node) + ": [[paths]] needs a scene and a list of paths");
      }
      description.own_paths.push_back({*scene, text_list(*paths, "path", file)});
    }
  }
  if (const toml::array* own_cullers = tables(root, "cullers", file)) {
    for (const toml::node& node : *own_cullers) {
      const toml::table& table = *node.as_table();
      refuse_unknown_keys(table,
                          {"scene", "path", "resolution", "device", "culler", "optional_culler"},
                          "[[cullers]]", file);
      OwnCullers own;
      if (const toml::node* n = table.get("culler")) own.cullers = text_list(*n, "culler", file);
      if (const toml::node* n = table.get("optional_culler")) {
        own.optional_cullers = text_list(*n, "optional_culler", file);
      }
      if (own.cullers.empty() && own.optional_cullers.empty()) {
        throw InputError(place(file, node) + ": [[cullers]] needs a list of cullers");
      }
      own.pattern = read_place(table, file);
      description.own_cullers.push_back(std::move(own));
    }
  }
  if (const toml::array* excluded = tables(root, "exclude", file)) {
    for (const toml::node& node : *excluded) {
      const toml::table& table = *node.as_table();
      refuse_unknown_keys(table, {"culler", "scene", "path", "resolution", "device"}, "[[exclude]]",
                          file);
      description.excluded.push_back(read_pattern(table, file));
    }
  }
  if (const toml::array* adjusted = tables(root, "adjust", file)) {
    for (const toml::node& node : *adjusted) {
      const toml::table& table = *node.as_table();
      refuse_unknown_keys(
          table, {"scene", "path", "resolution", "device", "frames", "rounds", "timeout_s"},
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

/// A chain as it is written, which [[exclude]] may name, and in full.
struct WantedChain {
  std::string written, canonical;
};

/// Optional ones that the build does not have go to `absent`.
std::vector<WantedChain> chains_of(const std::vector<std::string>& cullers,
                                   const std::vector<std::string>& optional_cullers,
                                   const Registry& registry, const std::string& file,
                                   std::vector<std::string>& absent) {
  std::vector<WantedChain> chains;
  const auto add = [&](const std::string& culler, bool optional) {
    try {
      if (optional && !is_registered(culler, registry)) {
        if (std::ranges::find(absent, culler) == absent.end()) absent.push_back(culler);
        return;
      }
      registry.make(culler);
      chains.push_back({culler, registry.canonical(culler)});
    } catch (const InputError& error) {
      throw InputError(file + ": " + error.what());
    }
  };
  for (const std::string& culler : cullers) add(culler, false);
  for (const std::string& culler : optional_cullers) add(culler, true);
  return chains;
}

std::string to_text(const Viewport& viewport) {
  return std::to_string(viewport.width) + "x" + std::to_string(viewport.height);
}

bool fits(const Pattern& pattern, const Block& block) {
  return matches(pattern.scene, block.scene) && matches(pattern.path, block.path) &&
         matches(pattern.resolution, to_text(block.viewport)) &&
         matches(pattern.device, block.device);
}

/// The last entry that fits counts.
const std::vector<std::string>& paths_of(const std::string& scene, const Description& description) {
  const std::vector<std::string>* paths = &description.paths;
  for (const OwnPaths& own : description.own_paths) {
    if (matches(own.scene, scene)) paths = &own.paths;
  }
  return *paths;
}

}  // namespace

bool is_registered(const std::string& chain, const Registry& registry) {
  return std::ranges::all_of(parse_chain(chain), [&](const CullerSpec& stage) {
    return registry.entries().contains(stage.name);
  });
}

std::string Block::title() const {
  if (!label.empty()) return label;
  return scene + (path.empty() ? "" : ", " + path) + ", " + to_text(viewport) +
         (device == "none"     ? ", not drawn"
          : device == "osmesa" ? ""
                               : ", " + device);
}

std::vector<std::string> anchor_chains(const Registry& registry) {
  return {registry.canonical("none"), registry.canonical("oracle[level=object]"),
          registry.canonical("oracle[level=triangle]")};
}

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
  if ((description.cullers.empty() && description.own_cullers.empty()) ||
      description.scenes.empty()) {
    throw InputError(file.string() + ": [lists] must name at least one culler and one scene");
  }
  Matrix matrix{file.stem().string(), description.text, {}, {}, description.optional_scenes};
  const std::vector<WantedChain> everywhere = chains_of(
      description.cullers, description.optional_cullers, registry, file.string(), matrix.absent);
  std::vector<std::vector<WantedChain>> own_chains;  // as description.own_cullers
  for (const OwnCullers& own : description.own_cullers) {
    own_chains.push_back(
        chains_of(own.cullers, own.optional_cullers, registry, file.string(), matrix.absent));
  }
  std::vector<std::string> devices = description.devices;
  if (devices.empty()) devices.push_back(description.pass.draw);
  const auto add_block = [&](Block block) {
    for (const Adjustment& adjustment : description.adjusted) {
      if (!fits(adjustment.pattern, block)) continue;
      block.frames = adjustment.frames.value_or(block.frames);
      block.rounds = adjustment.rounds.value_or(block.rounds);
      block.timeout_s = adjustment.timeout_s.value_or(block.timeout_s);
    }
    std::vector<WantedChain> chains = everywhere;
    for (std::size_t i = 0; i < own_chains.size(); ++i) {
      if (!fits(description.own_cullers[i].pattern, block)) continue;
      chains.insert(chains.end(), own_chains[i].begin(), own_chains[i].end());
    }
    std::vector<std::string> wanted;
    for (const WantedChain& chain : chains) {
      const bool excluded = std::ranges::any_of(description.excluded, [&](const Pattern& pattern) {
        return fits(pattern, block) &&
               (matches(pattern.culler, chain.written) || matches(pattern.culler, chain.canonical));
      });
      if (!excluded) wanted.push_back(chain.canonical);
    }
    if (wanted.empty()) return;
    block.cullers = with_anchors(wanted, registry);
    matrix.blocks.push_back(std::move(block));
  };
  std::vector<std::string> scenes = description.scenes;
  scenes.insert(scenes.end(), description.optional_scenes.begin(),
                description.optional_scenes.end());
  for (const std::string& scene : scenes) {
    for (const std::string& path : paths_of(scene, description)) {
      for (const Viewport& viewport : description.resolutions) {
        for (const int frames : description.frames) {
          for (const std::string& device : devices) {
            add_block({scene,
                       path,
                       viewport,
                       frames,
                       device,
                       description.pass.seed,
                       description.pass.threads,
                       description.pass.rounds,
                       description.pass.timeout_s,
                       {}});
          }
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
  return {"", "", {std::move(block)}, {}};
}

std::vector<UnfetchedScene> leave_out_unfetched(Matrix& matrix, const DataFolders& folders) {
  std::vector<UnfetchedScene> unfetched;
  for (const std::string& scene : matrix.optional_scenes) {
    const std::vector<std::string> missing = missing_packages(scene, folders);
    if (missing.empty()) continue;
    unfetched.push_back({scene, missing.front()});
    std::erase_if(matrix.blocks, [&](const Block& block) { return block.scene == scene; });
  }
  return unfetched;
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
