// The meshes and eyes that all contests of clusters share.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/scene/frame.h"

namespace vislab {

/// One mesh: a sphere of 1,002,252 triangles, smooth ("sphere"), or with "low" or "high" bumps
/// (bumpy_sphere_mesh), or the first of a scene of data/scenes, as it was fetched. 64 eyes look at
/// its middle from all around, three times as far from it as half the longest side of its box.
/// Which triangles are back faces is decided in double with a bound on its error; where that
/// decides nothing, by no means often, a triangle must be kept.
class FacingWorld {
 public:
  /// Of a name above. Shared as long as somebody has it. Not for several threads. Throws
  /// InputError if a scene is not there.
  static std::shared_ptr<const FacingWorld> of(const std::string& name);

  /// Names of scenes with closed scanned meshes; none if their package has not been fetched.
  static std::vector<std::string> scanned();

  const Scene& scene() const { return scene_; }
  const Mesh& mesh() const { return scene_.meshes[0]; }
  std::size_t eye_count() const { return cameras_.size(); }
  const Camera& camera(std::size_t eye) const { return cameras_[eye]; }
  Frame frame(std::size_t eye) const;

  /// Bits of the triangles that are seen from behind.
  std::span<const std::uint64_t> back(std::size_t eye) const { return back_[eye]; }
  /// How many those are, over all eyes.
  std::uint64_t back_count() const { return back_count_; }

 private:
  explicit FacingWorld(const std::string& name);

  Scene scene_;
  std::unique_ptr<SceneState> state_;
  std::vector<Camera> cameras_;
  std::vector<std::vector<std::uint64_t>> back_;
  std::uint64_t back_count_ = 0;
};

/// What was left out of the triangles of a world, eye by eye.
struct LeftOut {
  std::uint64_t back = 0;
  std::uint64_t not_back = 0;  // wrong

  /// Bits of the triangles that were left out for an eye.
  void count(const FacingWorld& world, std::size_t eye, std::span<const std::uint64_t> left_out);
  double share(const FacingWorld& world) const;  // of the back faces
};

}  // namespace vislab
