// Experiment matrices: TOML files whose lists multiply into blocks of cells.
//
//   description = "…"
//   extends = "default"            optional: another matrix; what stands here replaces or adds
//   rounds = 5                     timed passes over each path
//   seed = 1
//   threads = 2
//   draw = "osmesa"                a device as in experiments/devices/device_spec.h; "none": cull
//                                  without drawing
//   timeout_s = 300                for one cell's pass over the path
//   [lists]                        every combination is one cell
//   culler = ["frustum.flat", "frustum.flat > backface.polygon"]
//   optional_culler = ["peer.bullet"]   left out, and said so, where this build does not have them
//   scene = ["dragon"]
//   optional_scene = ["oa_dm2"]         left out, and said so, where its package is not fetched
//   path = [""]                    "" = the scene's own
//   resolution = ["512x512"]
//   frames = [60]                  0 = as many as the path has
//   device = ["osmesa"]            instead of draw, if there are several
//   [[paths]]                      scenes that fit take these paths instead of those of [lists]
//   scene = "hares_*"
//   path = ["hares_still", "hares_walk"]
//   [[cullers]]                    blocks that fit have these chains, too
//   scene = "oa_dm2"               or path, resolution, device
//   culler = ["portal.polygon"]    and optional_culler; [lists] may then have none
//   [[exclude]]                    leaves out cells; * matches any text
//   culler = "occlusion.*"         or scene, path, resolution, device
//   scene = "hares_*"
//   [[adjust]]                     changes settings of blocks
//   scene = "hares_252"
//   frames = 12                    frames, rounds or timeout_s
//
// `none` (twice: the second is the A/A control), `oracle[level=object]` and
// `oracle[level=triangle]` stand in every block without being named.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "common/geometry/camera.h"

namespace vislab {

struct DataFolders;  // common/scene/library.h

/// A chain of a block; replicate 1 is the A/A control.
struct BlockCuller {
  std::string chain;  // canonical
  int replicate = 0;
};

/// The unit of work: scene × path × resolution × device, with its anchors in it.
struct Block {
  std::string scene;  // name or file
  std::string path;   // name, file, or "" for the scene's own
  Viewport viewport;
  int frames = 60;
  std::string device = "osmesa";  // as parse_device writes it
  std::uint64_t seed = 1;
  int threads = 2;
  int rounds = 5;
  double timeout_s = 300.0;
  std::vector<BlockCuller> cullers;  // anchors first
  std::string label = {};            // instead of the title made from the above

  /// "dragon, 512x512, osmesa"
  std::string title() const;
};

struct Matrix {
  std::string name;
  std::string description;
  std::vector<Block> blocks;
  std::vector<std::string> absent;  // optional cullers that this build does not have, as written
  std::vector<std::string> optional_scenes = {};
};

/// A scene that a matrix goes on without, and why.
struct UnfetchedScene {
  std::string scene;
  std::string package;
};

/// Takes out the blocks of optional scenes whose packages have not been fetched. Throws InputError
/// if an optional scene's description is wrong.
std::vector<UnfetchedScene> leave_out_unfetched(Matrix& matrix, const DataFolders& folders);

/// The chains that stand in every block, canonical, without the A/A control.
std::vector<std::string> anchor_chains(const Registry& registry);

/// The anchors and the A/A control, then `chains` (canonical), each once.
std::vector<BlockCuller> with_anchors(const std::vector<std::string>& chains,
                                      const Registry& registry);

/// `name_or_file` is NAME of `folder`/NAME.toml, or a file. Throws InputError that names file, line
/// or key, and what would be right. Cullers and their parameters are checked; scenes are not
/// loaded.
Matrix load_matrix(const std::string& name_or_file, const std::filesystem::path& folder,
                   const Registry& registry);

/// A matrix of one block from a chain and a scene.
Matrix single_block(const std::string& chain, const Block& settings, const Registry& registry);

/// Names and descriptions of the matrices in `folder`, sorted.
std::vector<std::pair<std::string, std::string>> list_matrices(const std::filesystem::path& folder);

/// Does the build have every stage of the chain? Throws InputError if the text is no chain.
bool is_registered(const std::string& chain, const Registry& registry);

/// Does `text` fit `pattern`, in which * stands for any text?
bool matches(std::string_view pattern, std::string_view text);

}  // namespace vislab
