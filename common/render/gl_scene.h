// A scene's meshes and transforms on the device, and the commands that draw parts of it. For .cpp
// files of this folder only.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/render/gl_functions.h"
#include "common/scene/frame.h"

namespace vislab {

/// A device buffer that grows and never shrinks, so that a second pass does not allocate.
class StreamBuffer {
 public:
  void upload(const GlFunctions& gl, GLuint name, const void* data, std::size_t bytes);

 private:
  std::size_t capacity_ = 0;
};

/// Draws with whatever program is in use, which reads
///   location 0: vec3 position, mesh frame;
///   location 1: uvec2 {object, id}, one for each draw;
///   shader storage 0: three rows of the affine transform (vec4) by object, to the world minus
///   Scene::origin().
/// All functions expect the context to be current.
class GlScene {
 public:
  explicit GlScene(const GlFunctions& gl);
  ~GlScene();
  GlScene(const GlScene&) = delete;
  GlScene& operator=(const GlScene&) = delete;

  /// Replaces the scene, which outlives its use. Transforms are on the device only after update.
  void load(const Scene& scene);
  /// Null before the first load.
  const Scene* scene() const { return scene_; }
  /// Uploads what lies between the first and the last transform that differ from those of the last
  /// update. O(objects).
  void update_transforms(std::span<const glm::dmat4x3> transforms);

  /// From now on draw and draw_each_range leave out the triangles of these objects that are seen
  /// from behind, for the transforms of the last update.
  void cull_back_faces(std::span<const ObjectId> objects);
  /// Those objects, in the order in which they were first named.
  std::span<const ObjectId> one_sided() const { return one_sided_; }
  /// Ends that for all objects. O(objects named since).
  void draw_both_sides();

  /// Makes the buffers current for draw (`each_range` false: id = object) or for draw_each_range
  /// (true: id = id of the range's first triangle).
  void bind(bool each_range);
  void draw(std::span<const ObjectId> objects);
  /// One draw an object for ranges of one object that follow each other. If they are not one piece
  /// of the mesh, their indices are copied together: 12 bytes a triangle.
  void draw(std::span<const TriangleRange> ranges);
  /// One draw a range, so that gl_PrimitiveID counts from the range's first triangle.
  void draw_each_range(std::span<const TriangleRange> ranges);

 private:
  /// What glMultiDrawElementsIndirect reads.
  struct DrawCommand {
    GLuint count = 0;
    GLuint instances = 1;
    GLuint first_index = 0;
    GLint base_vertex = 0;
    GLuint base_instance = 0;
  };
  struct MeshPlace {
    GLuint first_index = 0;
    GLint base_vertex = 0;
  };
  struct Instance {
    std::uint32_t object = 0;
    std::uint32_t id = 0;
  };
  /// Which triangles of an object are drawn: those that turn this way in the window.
  enum class Turn : std::uint8_t { any, counter_clockwise, clockwise };
  using TransformRows = std::array<glm::vec4, 3>;
  enum BufferName {
    vertices,
    indices,  // all meshes' indices, then room for compacted ones
    object_instances,
    range_instances,
    transforms,
    commands,
    buffer_count
  };

  void reserve_indices(std::size_t compacted);
  void add_command(const DrawCommand& command, ObjectId object);
  /// One call of the device for each run of commands that draw triangles of the same turn.
  void draw_commands();
  void select(Turn turn);

  const GlFunctions& gl_;
  std::array<GLuint, buffer_count> buffers_{};
  GLuint vertex_array_ = 0;
  const Scene* scene_ = nullptr;
  std::vector<MeshPlace> places_;       // by mesh
  std::vector<glm::dmat4x3> uploaded_;  // transforms on the device
  std::size_t index_count_ = 0;         // of all meshes
  std::size_t compacted_capacity_ = 0;  // indices

  std::vector<TransformRows> rows_;
  std::vector<DrawCommand> commands_;
  std::vector<Turn> turns_;          // of each command
  std::vector<Turn> turn_of_;        // by object
  std::vector<ObjectId> one_sided_;  // those whose turn is not any
  std::vector<glm::uvec3> compacted_;
  std::vector<Instance> range_instances_;
  StreamBuffer command_stream_;
  StreamBuffer range_stream_;
};

}  // namespace vislab
