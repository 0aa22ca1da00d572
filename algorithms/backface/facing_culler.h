// What all cullers of back faces share: which meshes may be tested, where the eye is for each
// object, and how answers become ranges of triangles. A method writes two functions: what it keeps
// of a mesh, and which of a mesh's triangles surely face away.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/mesh_eye.h"
#include "common/culler/culler.h"

namespace vislab::backface_culling {

/// The parameter `open` of every method: what to do with meshes that are not solid.
ParameterSpec open_parameter();
/// True for open=cull.
bool culls_open(const ParameterValues& values);

/// An object of this frame, as a test sees it.
struct ObjectView {
  const Frame& frame;
  ObjectId object;
  MeshId mesh;
  MeshEye eye;
};

/// Base of the family's cullers. Conservative if the tests are: meshes that are not solid are kept
/// whole (unless open=cull, which makes the culler approximate), and so are objects whose box may
/// hold the eye or touches the near region, from where the inside of a solid may be seen, and
/// objects whose transform is too near to singular.
class FacingCuller : public ICuller {
 public:
  /// `info` as the method describes itself; with open=cull its guarantee is lowered to approximate.
  FacingCuller(CullerInfo info, bool cull_open);

  const CullerInfo& info() const final { return info_; }
  void build(const Scene& scene, const BuildContext& context) final;
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) final;
  std::size_t bytes() const final;

 protected:
  /// Forget all meshes: a build begins.
  virtual void clear() = 0;
  /// Prepares a mesh that is to be tested. Called once for each such mesh, in their order; ids of
  /// meshes that are never tested are left out.
  virtual void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame,
                        const BuildContext& context) = 0;
  /// All meshes have been added: what a method prepares for each object.
  virtual void finish() {}
  /// A frame begins to be culled: what holds for all of its objects. Called by every cull().
  virtual void begin(const Frame& /*frame*/) {}
  /// An object's turn. Methods that decide about a whole mesh at once do so here and return a bit
  /// for every triangle of the mesh, valid until the next call; those that test triangle by
  /// triangle return nothing, and mark_range is asked.
  virtual std::span<const std::uint64_t> mark_mesh(const ObjectView& /*view*/) { return {}; }
  /// Writes words_of(count) words to `back`: bit i tells that triangle first + i surely faces away;
  /// bits beyond count are of no matter. Only called if mark_mesh returned nothing.
  virtual void mark_range(const ObjectView& /*view*/, std::uint32_t /*first*/,
                          std::uint32_t /*count*/, std::uint64_t* /*back*/) {}
  /// Memory of what add_mesh made.
  virtual std::size_t mesh_bytes() const = 0;

  const Scene& scene() const { return *scene_; }
  const MeshFrame& frame_of(MeshId mesh) const { return meshes_[mesh].frame; }

 private:
  struct TestedMesh {
    bool tested = false;  // else always kept whole
    MeshFrame frame;
  };

  bool cull_open_;
  CullerInfo info_;
  const Scene* scene_ = nullptr;
  std::vector<TestedMesh> meshes_;   // by mesh
  std::vector<std::uint64_t> back_;  // of one offered range
  std::vector<TriangleRange> kept_;
};

}  // namespace vislab::backface_culling
