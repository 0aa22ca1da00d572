// ICuller: the interface that every visibility method of the lab stands behind.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/culler/candidates.h"
#include "common/culler/cost_table.h"
#include "common/culler/parameters.h"
#include "common/render/device.h"

namespace vislab {

/// What a culler promises about what it leaves out. Ordered from strong to weak.
enum class Guarantee {
  conservative,  // never leaves out anything visible, at any resolution
  image_exact,   // never changes a pixel of the image at the frame's resolution
  approximate,   // may leave visible things out; its limits say by which dial
  erroneous      // a documented wrong variant, kept as a negative control
};

/// When the same answer comes again. Ordered from strong to weak.
enum class Repeatability {
  stateless,  // same frame, same answer
  path,       // same path after reset(seed), same answers
  timing      // answers depend on time; only the image is the same
};

/// What it decides about. Ordered from coarse to fine.
enum class Granularity { object, triangle };

/// What a perfect method of this kind would leave out; the denominator of recall.
enum class Culls { back_faces, outside_frustum, hidden };

enum class Space { object, image };

/// Where in the pipeline it saves work.
enum class PipelineStage { application, geometry, raster };

std::string_view to_string(Guarantee value);
std::string_view to_string(Repeatability value);
std::string_view to_string(Granularity value);
std::string_view to_string(Culls value);
std::string_view to_string(Space value);
std::string_view to_string(PipelineStage value);

/// Everything that `vislab describe`, the report and the contract tests know of a method.
struct CullerInfo {
  std::string name;  // "family.variant"
  std::string family;
  std::string summary;  // the idea in one or two sentences
  Guarantee guarantee = Guarantee::conservative;
  Repeatability repeatability = Repeatability::stateless;
  Granularity granularity = Granularity::object;
  Culls culls = Culls::hidden;
  Space space = Space::object;
  PipelineStage stage = PipelineStage::application;
  bool needs_device = false;  // asks the graphics device, so the run has to draw
  bool needs_truth = false;   // an oracle
  std::vector<ParameterSpec> parameters;
  std::string cost;    // per frame, in the size of its input
  std::string limits;  // what it does not handle; where it fails
  std::vector<std::string> sources;
};

/// What is truly visible in each frame of a path, prepared before anything is timed. For oracles
/// only.
class TruthSource {
 public:
  virtual ~TruthSource() = default;
  /// Ascending ids of the visible objects. Valid as long as the source.
  virtual std::span<const ObjectId> visible_objects(std::uint64_t frame_index) const = 0;
  /// The visible triangles as ranges, by ascending object and triangle. Valid as long as the
  /// source.
  virtual std::span<const TriangleRange> visible_triangles(std::uint64_t frame_index) const = 0;
};

class Registry;

/// What a culler may not fetch itself. Everything outlives the culler.
struct BuildContext {
  const Registry* cullers = nullptr;   // to make other cullers; null in minimal set-ups
  const TruthSource* truth = nullptr;  // null unless oracles are to run
  RenderDevice* device = nullptr;      // null when nothing is drawn
  const CostTable* costs = nullptr;    // as measured here; null: CostTable::typical()
  int threads = 1;                     // how many the culler may use
};

/// Deterministic counts since build(), by name: "plane_tests", "queries", … The harness takes the
/// differences from frame to frame.
using Counters = std::vector<std::pair<std::string_view, std::uint64_t>>;

/// A visibility method. A first culler writes three functions: info, build and cull.
class ICuller {
 public:
  virtual ~ICuller() = default;

  /// Constant for the life of the culler; depends on its parameters (a variant may promise less).
  virtual const CullerInfo& info() const = 0;

  /// Preprocessing; timed. The scene outlives the culler. Throws InputError if the context lacks
  /// what the culler needs.
  virtual void build(const Scene& scene, const BuildContext& context) = 0;

  /// Decides about everything offered before it returns; emits what is to be drawn. May be called
  /// for several disjoint batches of one frame: state is keyed on frame.index. No allocation on the
  /// second pass over the same path.
  virtual void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) = 0;

  /// Called before every path and every round: forget the past.
  virtual void reset(std::uint64_t /*seed*/) {}
  /// Called once per frame before the first cull, even without changes; timed.
  virtual void update(const Frame& /*frame*/, const Changes& /*changes*/) {}
  /// From-region methods: emits the set of a cell and returns true.
  virtual bool region(CellId /*cell*/, DrawSink& /*out*/) { return false; }
  /// Hidden-surface algorithms: the image that the last cull() painted, which is what they are
  /// judged by beside the set: the triangle that owns each pixel, row by row from the bottom,
  /// none_id for the background. Empty for methods that paint none. Valid until the next cull().
  virtual std::span<const TriangleId> surface_image() const { return {}; }
  /// Memory that it holds now beside the scene: what build() made, and all lists and buffers that
  /// it keeps from frame to frame. What is published is the answer after build(): buffers of an
  /// image's size, which the first frame makes, are not in it.
  virtual std::size_t bytes() const { return 0; }
  virtual Counters counters() const { return {}; }
};

}  // namespace vislab
