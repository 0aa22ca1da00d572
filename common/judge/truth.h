// Ground truth by ray casting: which triangle is seen at every sample of a frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/culler/visible_set.h"
#include "common/scene/frame.h"

namespace vislab {

struct TruthSettings {
  int jitter_per_pixel = 16;  // samples of set J in each pixel, stratified; at least 1
  std::uint64_t seed = 1;     // of set J
  int threads = 2;            // at least 1; does not change the answer
};

/// How many samples of set J hit a triangle.
struct TriangleHits {
  TriangleId triangle = 0;
  std::uint32_t hits = 0;
  /// Hits at least 1/128 pixel from every edge of the triangle.
  std::uint32_t clear_hits = 0;

  friend bool operator==(const TriangleHits&, const TriangleHits&) = default;
};

/// What a frame shows. Sample set C are the pixel centres; J are seeded, stratified, jittered
/// samples.
struct FrameTruth {
  Viewport viewport;
  std::vector<TriangleId>
      ids;  // C: width * height, row by row from the bottom; none_id = background
  std::vector<TriangleHits> hits;  // J: by ascending triangle
  std::uint64_t jittered_samples = 0;

  /// Triangles that any sample of C or J hits, ascending. O(pixels log triangles).
  std::vector<TriangleId> visible() const;

  friend bool operator==(const FrameTruth&, const FrameTruth&) = default;
};

/// Traces the frames of one scene. Uses Embree (robust, 8-wide coherent packets) on
/// settings.threads threads. Both sides of every triangle are seen. The answers do not depend on
/// the number of threads. Not for use from several threads at once.
class RayCaster {
 public:
  /// The scene outlives the caster. The acceleration structure is built when it is first needed,
  /// O(n log n). Throws InputError for settings out of range or a processor without AVX.
  RayCaster(const Scene& scene, const TruthSettings& settings);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  const Scene& scene() const;

  /// Rays between the near and the far plane (planar distances). Follows moved and hidden objects.
  FrameTruth trace(const Frame& frame);

  /// First hit among some of the triangles; none_id if nothing is hit. `depth` is planar, metres.
  struct Hit {
    TriangleId triangle = none_id;
    double depth = 0.0;
  };
  /// First hits at window positions (pixels, as in Viewport) among the triangles of `kept` only, or
  /// among all that are shown if it is null. O(triangles) for the filter, then as fast as trace().
  std::vector<Hit> cast(const Frame& frame, std::span<const glm::dvec2> window_px,
                        const VisibleSet* kept);

  /// A sample of J and what it hits.
  struct Sample {
    glm::dvec2 window_px;
    TriangleId triangle = none_id;
  };
  /// The samples of J that hit one of `triangles` (ascending). Traces again the part of the image
  /// that these triangles can cover.
  std::vector<Sample> jittered_hits(const Frame& frame, std::span<const TriangleId> triangles);

  /// Embree's version and instruction set: part of the key of cached truth.
  static std::string engine();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Key of a frame's truth: scene, object state, camera, viewport, settings, engine. 32 hexadecimal
/// digits. O(objects).
std::string truth_key(const Frame& frame, const Scene& scene, const TruthSettings& settings);

/// Truth of frames kept in files (compressed, written to a temporary name and renamed), one file a
/// key.
class TruthStore {
 public:
  explicit TruthStore(std::filesystem::path folder);  // made when something is written
  /// Empty if it is not there; a file that cannot be read is treated as not there.
  std::optional<FrameTruth> load(const std::string& key) const;
  /// Throws WriteError if it cannot be written.
  void save(const std::string& key, const FrameTruth& truth) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace vislab
