#include "common/render/gl_scene.h"

#include <algorithm>
#include <cstring>

#include "common/render/handedness.h"

namespace vislab {
void StreamBuffer::upload(const GlFunctions& gl, GLuint name, const void* data, std::size_t bytes) {
  if (bytes > capacity_) {
    capacity_ = bytes + bytes / 2;
    gl.NamedBufferData(name, static_cast<GLsizeiptr>(capacity_), nullptr, GL_STREAM_DRAW);
  }
  gl.NamedBufferSubData(name, 0, static_cast<GLsizeiptr>(bytes), data);
}

GlScene::GlScene(const GlFunctions& gl) : gl_(gl) {
  gl_.CreateBuffers(buffer_count, buffers_.data());
  gl_.CreateVertexArrays(1, &vertex_array_);
  gl_.VertexArrayVertexBuffer(vertex_array_, 0, buffers_[vertices], 0, sizeof(glm::vec3));
  gl_.EnableVertexArrayAttrib(vertex_array_, 0);
  gl_.VertexArrayAttribFormat(vertex_array_, 0, 3, GL_FLOAT, GL_FALSE, 0);
  gl_.VertexArrayAttribBinding(vertex_array_, 0, 0);
  gl_.EnableVertexArrayAttrib(vertex_array_, 1);
  gl_.VertexArrayAttribIFormat(vertex_array_, 1, 2, GL_UNSIGNED_INT, 0);
  gl_.VertexArrayAttribBinding(vertex_array_, 1, 1);
  gl_.VertexArrayBindingDivisor(vertex_array_, 1, 1);
  gl_.VertexArrayElementBuffer(vertex_array_, buffers_[indices]);
}

GlScene::~GlScene() {
  gl_.DeleteVertexArrays(1, &vertex_array_);
  gl_.DeleteBuffers(buffer_count, buffers_.data());
}

void GlScene::load(const Scene& scene) {
  scene_ = &scene;
  places_.clear();
  std::size_t vertex_count = 0;
  index_count_ = 0;
  for (const Mesh& mesh : scene.meshes) {
    places_.push_back({static_cast<GLuint>(index_count_), static_cast<GLint>(vertex_count)});
    vertex_count += mesh.positions.size();
    index_count_ += 3 * mesh.triangles.size();
  }
  gl_.NamedBufferData(buffers_[vertices], static_cast<GLsizeiptr>(vertex_count * sizeof(glm::vec3)),
                      nullptr, GL_STATIC_DRAW);
  for (std::size_t m = 0; m < places_.size(); ++m) {
    const std::vector<glm::vec3>& positions = scene.meshes[m].positions;
    const std::size_t first = static_cast<std::size_t>(places_[m].base_vertex);
    gl_.NamedBufferSubData(buffers_[vertices], static_cast<GLintptr>(first * sizeof(glm::vec3)),
                           static_cast<GLsizeiptr>(positions.size() * sizeof(glm::vec3)),
                           positions.data());
  }
  compacted_capacity_ = 0;
  reserve_indices(1024);

  std::vector<Instance> objects(scene.object_count());
  for (ObjectId object = 0; object < objects.size(); ++object) objects[object] = {object, object};
  gl_.NamedBufferData(buffers_[object_instances],
                      static_cast<GLsizeiptr>(objects.size() * sizeof(Instance)), objects.data(),
                      GL_STATIC_DRAW);
  gl_.NamedBufferData(buffers_[transforms],
                      static_cast<GLsizeiptr>(objects.size() * sizeof(TransformRows)), nullptr,
                      GL_DYNAMIC_DRAW);
  uploaded_.clear();
  turn_of_.assign(scene.object_count(), Turn::any);
  one_sided_.clear();
}

void GlScene::reserve_indices(std::size_t compacted) {
  if (compacted <= compacted_capacity_) return;
  compacted_capacity_ = compacted + compacted / 2;
  const std::size_t total = index_count_ + compacted_capacity_;
  gl_.NamedBufferData(buffers_[indices], static_cast<GLsizeiptr>(total * sizeof(std::uint32_t)),
                      nullptr, GL_DYNAMIC_DRAW);
  for (std::size_t m = 0; m < places_.size(); ++m) {
    const std::vector<glm::uvec3>& triangles = scene_->meshes[m].triangles;
    gl_.NamedBufferSubData(
        buffers_[indices], static_cast<GLintptr>(places_[m].first_index * sizeof(std::uint32_t)),
        static_cast<GLsizeiptr>(triangles.size() * sizeof(glm::uvec3)), triangles.data());
  }
}

void GlScene::update_transforms(std::span<const glm::dmat4x3> current) {
  std::size_t first = 0;
  std::size_t end = current.size();
  if (uploaded_.size() != current.size()) {
    uploaded_.assign(current.begin(), current.end());
  } else {
    const auto same = [&](std::size_t i) {
      return std::memcmp(&uploaded_[i], &current[i], sizeof(glm::dmat4x3)) == 0;
    };
    while (first < end && same(first)) ++first;
    while (end > first && same(end - 1)) --end;
    for (std::size_t i = first; i < end; ++i) uploaded_[i] = current[i];
  }
  if (first == end) return;
  const glm::dvec3 origin = scene_->origin();
  rows_.clear();
  for (std::size_t i = first; i < end; ++i) {
    const glm::dmat4x3& m = current[i];
    TransformRows& rows = rows_.emplace_back();
    for (int r = 0; r < 3; ++r) {
      rows[static_cast<std::size_t>(r)] = glm::vec4(m[0][r], m[1][r], m[2][r], m[3][r] - origin[r]);
    }
  }
  gl_.NamedBufferSubData(buffers_[transforms], static_cast<GLintptr>(first * sizeof(TransformRows)),
                         static_cast<GLsizeiptr>(rows_.size() * sizeof(TransformRows)),
                         rows_.data());
}

void GlScene::bind(bool each_range) {
  gl_.BindVertexArray(vertex_array_);
  gl_.VertexArrayVertexBuffer(vertex_array_, 1,
                              buffers_[each_range ? range_instances : object_instances], 0,
                              sizeof(Instance));
  gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers_[transforms]);
  gl_.BindBuffer(GL_DRAW_INDIRECT_BUFFER, buffers_[commands]);
}

void GlScene::cull_back_faces(std::span<const ObjectId> objects) {
  for (const ObjectId object : objects) {
    if (turn_of_[object] != Turn::any) continue;
    const double side = handedness(uploaded_[object]);
    if (side == 0.0) continue;
    turn_of_[object] = side > 0.0 ? Turn::counter_clockwise : Turn::clockwise;
    one_sided_.push_back(object);
  }
}

void GlScene::draw_both_sides() {
  for (const ObjectId object : one_sided_) turn_of_[object] = Turn::any;
  one_sided_.clear();
}

void GlScene::select(Turn turn) {
  if (turn == Turn::any) {
    gl_.Disable(GL_CULL_FACE);
    return;
  }
  gl_.Enable(GL_CULL_FACE);
  gl_.CullFace(GL_BACK);
  gl_.FrontFace(turn == Turn::clockwise ? GL_CW : GL_CCW);
}

void GlScene::add_command(const DrawCommand& command, ObjectId object) {
  commands_.push_back(command);
  turns_.push_back(turn_of_[object]);
}

void GlScene::draw_commands() {
  if (commands_.empty()) return;
  command_stream_.upload(gl_, buffers_[commands], commands_.data(),
                         commands_.size() * sizeof(DrawCommand));
  Turn selected = Turn::any;
  for (std::size_t begin = 0; begin < commands_.size();) {
    std::size_t end = begin + 1;
    while (end < commands_.size() && turns_[end] == turns_[begin]) ++end;
    if (turns_[begin] != selected) select(selected = turns_[begin]);
    gl_.MultiDrawElementsIndirect(
        GL_TRIANGLES, GL_UNSIGNED_INT,
        reinterpret_cast<const void*>(begin * sizeof(DrawCommand)),  // offset into the buffer
        static_cast<GLsizei>(end - begin), sizeof(DrawCommand));
    begin = end;
  }
  if (selected != Turn::any) select(Turn::any);
}

void GlScene::draw(std::span<const ObjectId> objects) {
  commands_.clear();
  turns_.clear();
  for (const ObjectId object : objects) {
    const MeshPlace& place = places_[scene_->objects[object].mesh];
    add_command(
        {3 * scene_->triangle_count(object), 1, place.first_index, place.base_vertex, object},
        object);
  }
  draw_commands();
}

void GlScene::draw(std::span<const TriangleRange> ranges) {
  commands_.clear();
  turns_.clear();
  compacted_.clear();
  for (std::size_t begin = 0; begin < ranges.size();) {
    // The ranges that belong together, and whether they are one piece of the mesh.
    const ObjectId object = ranges[begin].object;
    std::size_t end = begin + 1;
    std::uint32_t next = ranges[begin].first + ranges[begin].count;
    bool one_piece = true;
    for (; end < ranges.size() && ranges[end].object == object; ++end) {
      one_piece = one_piece && ranges[end].first == next;
      next = ranges[end].first + ranges[end].count;
    }
    const MeshPlace& place = places_[scene_->objects[object].mesh];
    DrawCommand command{0, 1, 0, place.base_vertex, object};
    if (one_piece) {
      command.first_index = place.first_index + 3 * ranges[begin].first;
      command.count = 3 * (next - ranges[begin].first);
    } else {
      const glm::uvec3* const triangles = scene_->mesh_of(object).triangles.data();
      const std::size_t start = compacted_.size();
      for (std::size_t i = begin; i < end; ++i) {
        const glm::uvec3* const piece = triangles + ranges[i].first;
        compacted_.insert(compacted_.end(), piece, piece + ranges[i].count);
      }
      command.first_index = static_cast<GLuint>(index_count_ + 3 * start);
      command.count = static_cast<GLuint>(3 * (compacted_.size() - start));
    }
    if (command.count > 0) add_command(command, object);
    begin = end;
  }
  if (!compacted_.empty()) {
    reserve_indices(3 * compacted_.size());
    gl_.NamedBufferSubData(
        buffers_[indices], static_cast<GLintptr>(index_count_ * sizeof(std::uint32_t)),
        static_cast<GLsizeiptr>(compacted_.size() * sizeof(glm::uvec3)), compacted_.data());
  }
  draw_commands();
}

void GlScene::draw_each_range(std::span<const TriangleRange> ranges) {
  if (ranges.empty()) return;
  commands_.clear();
  turns_.clear();
  range_instances_.clear();
  for (const TriangleRange& range : ranges) {
    const MeshPlace& place = places_[scene_->objects[range.object].mesh];
    add_command({3 * range.count, 1, place.first_index + 3 * range.first, place.base_vertex,
                 static_cast<GLuint>(range_instances_.size())},
                range.object);
    range_instances_.push_back({range.object, scene_->first_triangle(range.object) + range.first});
  }
  range_stream_.upload(gl_, buffers_[range_instances], range_instances_.data(),
                       range_instances_.size() * sizeof(Instance));
  draw_commands();
}

}  // namespace vislab
