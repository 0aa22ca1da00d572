// A cell of an experiment matrix: one chain on one scene and path, and everything measured of it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/culler/culler.h"
#include "common/geometry/camera.h"
#include "common/judge/region_truth.h"
#include "common/render/gpu_model.h"

namespace vislab {

/// What determines a cell's answers. Cells are named by the hash of this.
struct CellKey {
  std::string chain;       // canonical: all parameters written out
  std::string scene_hash;  // Scene::content_hash
  std::string path_hash;   // Path::content_hash
  Viewport viewport;
  std::uint64_t seed = 1;
  std::string device = "osmesa";  // as parse_device writes it; "none": nothing is drawn
  int threads = 2;
  std::string simd;     // instruction set that run-time dispatch chose
  std::string sources;  // hash of the sources that the chain's families depend on
  int replicate = 0;    // 1 = the A/A control: the same chain once more in the same block
  /// 32 hexadecimal digits.
  std::string id() const;
};

/// Samples of one pass over the path, by frame.
struct Round {
  std::string session;  // which run of the block measured it: rounds pair within a session
  int number = 0;       // of the round in that session
  std::vector<double> update_us, cull_us, draw_ms, frame_ms;
};

/// Frame times of a block's anchors (none, oracle) in the same round as this cell's.
struct AnchorRound {
  std::string session;
  int number = 0;
  std::vector<double> frame_ms;
};

/// Deterministic part of a frame's answer.
struct CellFrame {
  std::string set;    // VisibleSet::hash
  std::string truth;  // truth_key
  std::uint64_t submitted_triangles = 0;
  std::map<std::string, std::uint64_t> counters;
  std::uint64_t draws = 0;   // runs of emitted ranges of one object
  std::uint64_t pieces = 0;  // contiguous ranges that these are made of
  /// Hash of the set of triangles whose backs the device left out; "" if none.
  std::string one_sided = {};
  /// Hash of the image that a hidden-surface algorithm painted itself; "" if it paints none.
  std::string surface = {};
};

struct ResultCell {
  CellKey key;
  // Names for people; not part of the key.
  std::string culler;  // Registry::short_name
  std::string scene;
  std::string path;
  std::string scene_description;
  std::string scene_source;  // the name or file that the scene was loaded by
  std::string path_source;   // likewise; "" = the scene's own path
  std::uint64_t scene_objects = 0, scene_triangles = 0;
  double moving_objects = 0.0;  // a frame: mean over the path

  enum class Status { running, done, failed } status = Status::running;
  std::string reason;  // of a failure: "timed out after 300 s", "out of memory", …

  Guarantee guarantee = Guarantee::conservative;
  Repeatability repeatability = Repeatability::stateless;
  Granularity granularity = Granularity::object;
  Culls culls = Culls::hidden;
  bool asks_device = false;  // uses the device while it culls: asks it, or sets what it draws

  double build_ms = 0.0;
  std::uint64_t bytes = 0;
  std::vector<CellFrame> frames;
  std::vector<Round> rounds;
  std::map<std::string, std::vector<AnchorRound>> anchors;  // by the anchor's canonical chain
  std::map<std::string, std::string> context;               // machine, compiler, revision, …
  /// What drawing and testing cost when it was measured; none in results from before it was.
  std::optional<CostTable> costs;
  /// The dials of a modelled device, fitted ones included; none on other devices.
  std::optional<GpuModel> device_model = {};
  /// Of methods that know what is seen from anywhere in a cell: their sets against region truth, by
  /// CellKey::seed. Without witnesses.
  std::optional<RegionVerdict> regions = {};
};

std::string to_string(ResultCell::Status status);

/// Hash of what the judge has to judge: the sets and truths of all frames.
std::string answer_hash(const ResultCell& cell);

/// Of the cells that this program writes.
inline constexpr int cell_format_version = 2;

/// The version of the format of a cell's JSON text; 0 if it does not say.
int cell_format(const std::string& json);

/// JSON text, and back. parse_cell gives nothing for text of another version of the format, and
/// throws InputError that names `where` and what is wrong for anything else that is no cell.
std::string to_json(const ResultCell& cell);
std::optional<ResultCell> parse_cell(const std::string& json, const std::string& where);

}  // namespace vislab
