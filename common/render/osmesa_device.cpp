#include "common/render/osmesa_device.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "common/render/gl_functions.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

/// World to clip space, shared by every program. `precise` and the same expression everywhere give
/// the same depth bits whichever program draws. The eye comes as a sum of two floats, so that the
/// subtraction is as good as in double.
const char* const camera_source = R"(#version 450 core
layout(location = 0) uniform vec3 eye_high;
layout(location = 1) uniform vec3 eye_low;
layout(location = 2) uniform mat4 clip_from_rotated;
vec4 clip_position(vec3 world) {
  precise vec3 from_eye = (world - eye_high) - eye_low;
  precise vec4 position = clip_from_rotated * vec4(from_eye, 1.0);
  return position;
}
)";

const char* const object_vertex_source = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in uvec2 instance;  // object, id of its first triangle that is drawn
layout(std430, binding = 0) readonly buffer Transforms { vec4 rows[]; };
flat out uint id;
invariant gl_Position;
void main() {
  uint row = 3u * instance.x;
  vec4 x = rows[row];
  vec4 y = rows[row + 1u];
  vec4 z = rows[row + 2u];
  precise vec3 world = vec3(x.x * position.x + x.y * position.y + x.z * position.z + x.w,
                            y.x * position.x + y.y * position.y + y.z * position.z + y.w,
                            z.x * position.x + z.y * position.y + z.z * position.z + z.w);
  gl_Position = clip_position(world);
  id = instance.y;
}
)";

const char* const object_fragment_source = R"(#version 450 core
flat in uint id;
out uint color;
void main() { color = id; }
)";

const char* const triangle_fragment_source = R"(#version 450 core
flat in uint id;
out uint color;
void main() { color = id + uint(gl_PrimitiveID); }
)";

const char* const box_vertex_source = R"(
layout(location = 0) in vec3 position;
invariant gl_Position;
void main() { gl_Position = clip_position(position); }
)";

const char* const box_fragment_source = R"(#version 450 core
void main() {}
)";

/// Corner i of a box takes max.x if bit 0 is set, max.y for bit 1, max.z for bit 2.
constexpr std::array<std::uint32_t, 36> box_indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5,
                                                       0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3,
                                                       0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};

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

using TransformRows = std::array<glm::vec4, 3>;

TransformRows rows_of(const glm::dmat4x3& transform, const glm::dvec3& origin) {
  TransformRows rows;
  for (int i = 0; i < 3; ++i) {
    rows[i] =
        glm::vec4(transform[0][i], transform[1][i], transform[2][i], transform[3][i] - origin[i]);
  }
  return rows;
}

/// A device buffer that grows and never shrinks, so that a second pass does not allocate.
class StreamBuffer {
 public:
  void upload(const GlFunctions& gl, GLuint name, const void* data, std::size_t bytes) {
    if (bytes > capacity_) {
      capacity_ = bytes + bytes / 2;
      gl.NamedBufferData(name, static_cast<GLsizeiptr>(capacity_), nullptr, GL_STREAM_DRAW);
    }
    gl.NamedBufferSubData(name, 0, static_cast<GLsizeiptr>(bytes), data);
  }

 private:
  std::size_t capacity_ = 0;
};

enum BufferName {
  vertices,
  indices,    // all meshes' indices, then room for compacted ones
  instances,  // one Instance an object
  transforms,
  commands,
  range_instances,
  box_corners,
  box_elements,
  buffer_count
};
enum ProgramName { object_program, triangle_program, box_program, program_count };

}  // namespace

class OsMesaDevice::Implementation {
 public:
  Implementation();
  ~Implementation();

  void load(const Scene& scene);
  void begin_frame(const Frame& frame);
  void draw(std::span<const ObjectId> objects);
  void draw(std::span<const TriangleRange> ranges);
  void draw_ids(std::span<const TriangleRange> ranges);
  QueryId query(std::span<const Aabb> boxes);
  void flush();
  bool ready(QueryId query);
  std::uint64_t samples(QueryId query);
  void finish();
  std::string description();
  std::vector<std::uint32_t> read_ids();
  std::vector<float> read_depth();

 private:
  void make_programs();
  void make_vertex_arrays(const GlFunctions& gl);
  void resize(const GlFunctions& gl, const Viewport& viewport);
  void set_camera(const GlFunctions& gl, const Camera& camera);
  void update_transforms(const GlFunctions& gl, std::span<const glm::dmat4x3> current);
  void reserve_indices(const GlFunctions& gl, std::size_t compacted);
  void select(const GlFunctions& gl, ProgramName program);
  void draw_commands(const GlFunctions& gl);
  void require_frame() const;
  GLuint query_name(QueryId query) const;
  template <typename Value>
  std::vector<Value> read(GLenum format, GLenum type, const char* where);

  GlContext context_;
  std::array<GLuint, buffer_count> buffers_{};
  std::array<GLuint, program_count> programs_{};
  GLuint object_array_ = 0;
  GLuint box_array_ = 0;
  GLuint framebuffer_ = 0;
  std::array<GLuint, 2> renderbuffers_{};
  GLint largest_side_ = 0;
  std::vector<GLuint> query_names_;
  std::size_t queries_used_ = 0;

  const Scene* scene_ = nullptr;
  bool in_frame_ = false;
  Viewport viewport_{0, 0};
  int selected_ = -1;  // a ProgramName, or -1 if the state must be set anew
  std::vector<MeshPlace> places_;
  std::vector<glm::dmat4x3> uploaded_;  // transforms on the device
  std::size_t index_count_ = 0;         // of all meshes
  std::size_t compacted_capacity_ = 0;
  std::size_t box_capacity_ = 0;

  std::vector<TransformRows> rows_;
  std::vector<DrawCommand> commands_;
  std::vector<glm::uvec3> compacted_;
  std::vector<Instance> range_instances_;
  std::vector<std::array<glm::vec3, 8>> corners_;
  StreamBuffer command_stream_;
  StreamBuffer range_stream_;
  StreamBuffer corner_stream_;
};

OsMesaDevice::Implementation::Implementation() {
  const GlFunctions& gl = context_.make_current();
  gl.CreateBuffers(buffer_count, buffers_.data());
  gl.CreateFramebuffers(1, &framebuffer_);
  make_programs();
  make_vertex_arrays(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl.Enable(GL_DEPTH_TEST);
  gl.Disable(GL_DITHER);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
  GLint renderbuffer_limit = 0;
  gl.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer_limit);
  GLint viewport_limits[2] = {};
  gl.GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport_limits);
  largest_side_ = std::min({renderbuffer_limit, viewport_limits[0], viewport_limits[1]});
  context_.check("making the device");
}

OsMesaDevice::Implementation::~Implementation() {
  const GlFunctions& gl = context_.make_current();
  gl.DeleteQueries(static_cast<GLsizei>(query_names_.size()), query_names_.data());
  gl.DeleteRenderbuffers(2, renderbuffers_.data());
  gl.DeleteFramebuffers(1, &framebuffer_);
  gl.DeleteVertexArrays(1, &object_array_);
  gl.DeleteVertexArrays(1, &box_array_);
  for (const GLuint program : programs_) gl.DeleteProgram(program);
  gl.DeleteBuffers(buffer_count, buffers_.data());
}

void OsMesaDevice::Implementation::make_programs() {
  const std::string camera = camera_source;
  programs_[object_program] =
      context_.program(camera + object_vertex_source, object_fragment_source);
  programs_[triangle_program] =
      context_.program(camera + object_vertex_source, triangle_fragment_source);
  programs_[box_program] = context_.program(camera + box_vertex_source, box_fragment_source);
}

void OsMesaDevice::Implementation::make_vertex_arrays(const GlFunctions& gl) {
  gl.CreateVertexArrays(1, &object_array_);
  gl.VertexArrayVertexBuffer(object_array_, 0, buffers_[vertices], 0, sizeof(glm::vec3));
  gl.EnableVertexArrayAttrib(object_array_, 0);
  gl.VertexArrayAttribFormat(object_array_, 0, 3, GL_FLOAT, GL_FALSE, 0);
  gl.VertexArrayAttribBinding(object_array_, 0, 0);
  gl.EnableVertexArrayAttrib(object_array_, 1);
  gl.VertexArrayAttribIFormat(object_array_, 1, 2, GL_UNSIGNED_INT, 0);
  gl.VertexArrayAttribBinding(object_array_, 1, 1);
  gl.VertexArrayBindingDivisor(object_array_, 1, 1);
  gl.VertexArrayElementBuffer(object_array_, buffers_[indices]);

  gl.CreateVertexArrays(1, &box_array_);
  gl.VertexArrayVertexBuffer(box_array_, 0, buffers_[box_corners], 0, sizeof(glm::vec3));
  gl.EnableVertexArrayAttrib(box_array_, 0);
  gl.VertexArrayAttribFormat(box_array_, 0, 3, GL_FLOAT, GL_FALSE, 0);
  gl.VertexArrayAttribBinding(box_array_, 0, 0);
  gl.VertexArrayElementBuffer(box_array_, buffers_[box_elements]);
}

void OsMesaDevice::Implementation::load(const Scene& scene) {
  const GlFunctions& gl = context_.make_current();
  scene_ = nullptr;  // stays so if something below fails
  in_frame_ = false;

  places_.clear();
  std::size_t vertex_count = 0;
  index_count_ = 0;
  for (const Mesh& mesh : scene.meshes) {
    places_.push_back({static_cast<GLuint>(index_count_), static_cast<GLint>(vertex_count)});
    vertex_count += mesh.positions.size();
    index_count_ += 3 * mesh.triangles.size();
  }
  gl.NamedBufferData(buffers_[vertices], static_cast<GLsizeiptr>(vertex_count * sizeof(glm::vec3)),
                     nullptr, GL_STATIC_DRAW);
  for (std::size_t m = 0; m < places_.size(); ++m) {
    const std::vector<glm::vec3>& positions = scene.meshes[m].positions;
    gl.NamedBufferSubData(
        buffers_[vertices], static_cast<GLintptr>(places_[m].base_vertex * sizeof(glm::vec3)),
        static_cast<GLsizeiptr>(positions.size() * sizeof(glm::vec3)), positions.data());
  }

  std::vector<Instance> objects(scene.object_count());
  for (ObjectId object = 0; object < objects.size(); ++object) objects[object] = {object, object};
  gl.NamedBufferData(buffers_[instances],
                     static_cast<GLsizeiptr>(objects.size() * sizeof(Instance)), objects.data(),
                     GL_STATIC_DRAW);
  gl.NamedBufferData(buffers_[transforms],
                     static_cast<GLsizeiptr>(objects.size() * sizeof(TransformRows)), nullptr,
                     GL_DYNAMIC_DRAW);
  uploaded_.clear();

  scene_ = &scene;
  compacted_capacity_ = 0;
  reserve_indices(gl, 1024);
  context_.check("load");
}

void OsMesaDevice::Implementation::reserve_indices(const GlFunctions& gl, std::size_t compacted) {
  if (compacted <= compacted_capacity_) return;
  compacted_capacity_ = compacted + compacted / 2;
  const std::size_t total = index_count_ + compacted_capacity_;
  gl.NamedBufferData(buffers_[indices], static_cast<GLsizeiptr>(total * sizeof(std::uint32_t)),
                     nullptr, GL_DYNAMIC_DRAW);
  for (std::size_t m = 0; m < places_.size(); ++m) {
    const std::vector<glm::uvec3>& triangles = scene_->meshes[m].triangles;
    gl.NamedBufferSubData(
        buffers_[indices], static_cast<GLintptr>(places_[m].first_index * sizeof(std::uint32_t)),
        static_cast<GLsizeiptr>(triangles.size() * sizeof(glm::uvec3)), triangles.data());
  }
}

void OsMesaDevice::Implementation::begin_frame(const Frame& frame) {
  if (scene_ == nullptr) throw std::logic_error("OsMesaDevice: begin_frame before load");
  if (frame.objects.transforms.size() != scene_->object_count()) {
    throw std::logic_error("OsMesaDevice: the frame shows another scene than the one loaded");
  }
  const GlFunctions& gl = context_.make_current();
  if (frame.viewport != viewport_) resize(gl, frame.viewport);
  set_camera(gl, frame.camera);
  update_transforms(gl, frame.objects.transforms);

  gl.DepthMask(GL_TRUE);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  selected_ = -1;
  const GLuint nothing[4] = {none_id, none_id, none_id, none_id};
  const GLfloat far_depth = 1.0F;
  gl.ClearBufferuiv(GL_COLOR, 0, nothing);
  gl.ClearBufferfv(GL_DEPTH, 0, &far_depth);
  queries_used_ = 0;
  in_frame_ = true;
  context_.check("begin_frame");
}

void OsMesaDevice::Implementation::resize(const GlFunctions& gl, const Viewport& viewport) {
  if (viewport.width < 1 || viewport.height < 1 || viewport.width > largest_side_ ||
      viewport.height > largest_side_) {
    throw InputError("the resolution " + std::to_string(viewport.width) + "x" +
                     std::to_string(viewport.height) + " cannot be drawn: each side must be 1 to " +
                     std::to_string(largest_side_) + " pixels");
  }
  viewport_ = {0, 0};
  gl.DeleteRenderbuffers(2, renderbuffers_.data());
  gl.CreateRenderbuffers(2, renderbuffers_.data());
  gl.NamedRenderbufferStorage(renderbuffers_[0], GL_R32UI, viewport.width, viewport.height);
  gl.NamedRenderbufferStorage(renderbuffers_[1], GL_DEPTH_COMPONENT32F, viewport.width,
                              viewport.height);
  gl.NamedFramebufferRenderbuffer(framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                  renderbuffers_[0]);
  gl.NamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                  renderbuffers_[1]);
  gl.NamedFramebufferDrawBuffer(framebuffer_, GL_COLOR_ATTACHMENT0);
  gl.NamedFramebufferReadBuffer(framebuffer_, GL_COLOR_ATTACHMENT0);
  context_.check("allocating the image");
  if (gl.CheckNamedFramebufferStatus(framebuffer_, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("the device cannot draw to 32-bit ids with 32-bit depth");
  }
  gl.Viewport(0, 0, viewport.width, viewport.height);
  viewport_ = viewport;
}

void OsMesaDevice::Implementation::set_camera(const GlFunctions& gl, const Camera& camera) {
  Camera at_origin = camera;
  at_origin.pose.eye = glm::dvec3(0.0);
  const glm::mat4 clip(at_origin.view_projection());
  const glm::dvec3 eye = camera.pose.eye - scene_->origin();
  const glm::vec3 high(eye);
  const glm::vec3 low(eye - glm::dvec3(high));
  for (const GLuint program : programs_) {
    gl.ProgramUniform3fv(program, 0, 1, &high.x);
    gl.ProgramUniform3fv(program, 1, 1, &low.x);
    gl.ProgramUniformMatrix4fv(program, 2, 1, GL_FALSE, &clip[0].x);
  }
}

void OsMesaDevice::Implementation::update_transforms(const GlFunctions& gl,
                                                     std::span<const glm::dmat4x3> current) {
  const bool all = uploaded_.size() != current.size();
  std::size_t first = 0;
  std::size_t end = current.size();
  if (all) {
    uploaded_.assign(current.begin(), current.end());
  } else {
    const auto same = [&](std::size_t i) {
      return std::memcmp(&uploaded_[i], &current[i], sizeof(glm::dmat4x3)) == 0;
    };
    while (first < end && same(first)) ++first;
    while (end > first && same(end - 1)) --end;
    std::copy(current.begin() + static_cast<std::ptrdiff_t>(first),
              current.begin() + static_cast<std::ptrdiff_t>(end),
              uploaded_.begin() + static_cast<std::ptrdiff_t>(first));
  }
  if (first == end) return;
  rows_.clear();
  for (std::size_t i = first; i < end; ++i) rows_.push_back(rows_of(current[i], scene_->origin()));
  gl.NamedBufferSubData(buffers_[transforms], static_cast<GLintptr>(first * sizeof(TransformRows)),
                        static_cast<GLsizeiptr>(rows_.size() * sizeof(TransformRows)),
                        rows_.data());
}

void OsMesaDevice::Implementation::require_frame() const {
  if (!in_frame_) throw std::logic_error("OsMesaDevice: used before begin_frame");
}

void OsMesaDevice::Implementation::select(const GlFunctions& gl, ProgramName program) {
  if (selected_ == program) return;
  const bool asks = program == box_program;
  gl.UseProgram(programs_[program]);
  gl.BindVertexArray(asks ? box_array_ : object_array_);
  gl.DepthMask(asks ? GL_FALSE : GL_TRUE);
  gl.ColorMask(!asks, !asks, !asks, !asks);
  gl.DepthFunc(asks ? GL_LEQUAL : GL_LESS);
  if (!asks) {
    gl.VertexArrayVertexBuffer(object_array_, 1,
                               buffers_[program == object_program ? instances : range_instances], 0,
                               sizeof(Instance));
    gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers_[transforms]);
    gl.BindBuffer(GL_DRAW_INDIRECT_BUFFER, buffers_[commands]);
  }
  selected_ = program;
}

void OsMesaDevice::Implementation::draw_commands(const GlFunctions& gl) {
  if (commands_.empty()) return;
  command_stream_.upload(gl, buffers_[commands], commands_.data(),
                         commands_.size() * sizeof(DrawCommand));
  gl.MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, nullptr,
                               static_cast<GLsizei>(commands_.size()), sizeof(DrawCommand));
}

void OsMesaDevice::Implementation::draw(std::span<const ObjectId> objects) {
  require_frame();
  const GlFunctions& gl = context_.make_current();
  select(gl, object_program);
  commands_.clear();
  for (const ObjectId object : objects) {
    const MeshPlace& place = places_[scene_->objects[object].mesh];
    commands_.push_back(
        {3 * scene_->triangle_count(object), 1, place.first_index, place.base_vertex, object});
  }
  draw_commands(gl);
  context_.check("draw");
}

void OsMesaDevice::Implementation::draw(std::span<const TriangleRange> ranges) {
  require_frame();
  const GlFunctions& gl = context_.make_current();
  select(gl, object_program);
  commands_.clear();
  compacted_.clear();
  for (std::size_t begin = 0; begin < ranges.size();) {
    const ObjectId object = ranges[begin].object;
    // The ranges that belong together, and whether they are one piece of the mesh.
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
      const std::vector<glm::uvec3>& triangles = scene_->mesh_of(object).triangles;
      const std::size_t start = compacted_.size();
      for (std::size_t i = begin; i < end; ++i) {
        const glm::uvec3* const piece = triangles.data() + ranges[i].first;
        compacted_.insert(compacted_.end(), piece, piece + ranges[i].count);
      }
      command.first_index = static_cast<GLuint>(index_count_ + 3 * start);
      command.count = static_cast<GLuint>(3 * (compacted_.size() - start));
    }
    if (command.count > 0) commands_.push_back(command);
    begin = end;
  }
  if (!compacted_.empty()) {
    reserve_indices(gl, 3 * compacted_.size());
    gl.NamedBufferSubData(
        buffers_[indices], static_cast<GLintptr>(index_count_ * sizeof(std::uint32_t)),
        static_cast<GLsizeiptr>(compacted_.size() * sizeof(glm::uvec3)), compacted_.data());
  }
  draw_commands(gl);
  context_.check("draw");
}

void OsMesaDevice::Implementation::draw_ids(std::span<const TriangleRange> ranges) {
  require_frame();
  const GlFunctions& gl = context_.make_current();
  select(gl, triangle_program);
  commands_.clear();
  range_instances_.clear();
  for (const TriangleRange& range : ranges) {
    const MeshPlace& place = places_[scene_->objects[range.object].mesh];
    commands_.push_back({3 * range.count, 1, place.first_index + 3 * range.first, place.base_vertex,
                         static_cast<GLuint>(range_instances_.size())});
    range_instances_.push_back({range.object, scene_->first_triangle(range.object) + range.first});
  }
  if (!ranges.empty()) {
    range_stream_.upload(gl, buffers_[range_instances], range_instances_.data(),
                         range_instances_.size() * sizeof(Instance));
  }
  draw_commands(gl);
  context_.check("draw_ids");
}

QueryId OsMesaDevice::Implementation::query(std::span<const Aabb> boxes) {
  require_frame();
  const GlFunctions& gl = context_.make_current();
  select(gl, box_program);
  corners_.clear();
  for (const Aabb& box : boxes) {
    std::array<glm::vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
      const glm::dvec3 corner((i & 1) != 0 ? box.max.x : box.min.x,
                              (i & 2) != 0 ? box.max.y : box.min.y,
                              (i & 4) != 0 ? box.max.z : box.min.z);
      corners[i] = glm::vec3(corner - scene_->origin());
    }
    corners_.push_back(corners);
  }
  if (boxes.size() > box_capacity_) {
    box_capacity_ = 2 * boxes.size();
    std::vector<std::uint32_t> elements;
    for (std::uint32_t box = 0; box < box_capacity_; ++box) {
      for (const std::uint32_t corner : box_indices) elements.push_back(8 * box + corner);
    }
    gl.NamedBufferData(buffers_[box_elements],
                       static_cast<GLsizeiptr>(elements.size() * sizeof(std::uint32_t)),
                       elements.data(), GL_STATIC_DRAW);
  }
  if (queries_used_ == query_names_.size()) {
    query_names_.resize(query_names_.size() + 64);
    gl.CreateQueries(GL_SAMPLES_PASSED, 64, &query_names_[queries_used_]);
  }
  const auto id = static_cast<QueryId>(queries_used_++);
  gl.BeginQuery(GL_SAMPLES_PASSED, query_names_[id]);
  if (!boxes.empty()) {
    corner_stream_.upload(gl, buffers_[box_corners], corners_.data(),
                          corners_.size() * sizeof(corners_[0]));
    gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(36 * boxes.size()), GL_UNSIGNED_INT,
                    nullptr);
  }
  gl.EndQuery(GL_SAMPLES_PASSED);
  context_.check("query");
  return id;
}

GLuint OsMesaDevice::Implementation::query_name(QueryId query) const {
  if (query >= queries_used_) throw std::logic_error("OsMesaDevice: no such query in this frame");
  return query_names_[query];
}

void OsMesaDevice::Implementation::flush() { context_.make_current().Flush(); }

bool OsMesaDevice::Implementation::ready(QueryId query) {
  GLuint64 available = 0;
  const GLuint name = query_name(query);
  context_.make_current().GetQueryObjectui64v(name, GL_QUERY_RESULT_AVAILABLE, &available);
  context_.check("ready");
  return available != 0;
}

std::uint64_t OsMesaDevice::Implementation::samples(QueryId query) {
  GLuint64 count = 0;
  const GLuint name = query_name(query);
  context_.make_current().GetQueryObjectui64v(name, GL_QUERY_RESULT, &count);
  context_.check("samples");
  return count;
}

void OsMesaDevice::Implementation::finish() {
  context_.make_current().Finish();
  context_.check("finish");
}

std::string OsMesaDevice::Implementation::description() {
  const GlFunctions& gl = context_.make_current();
  const auto text = [&](GLenum name) {
    return std::string(reinterpret_cast<const char*>(gl.GetString(name)));
  };
  return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
}

template <typename Value>
std::vector<Value> OsMesaDevice::Implementation::read(GLenum format, GLenum type,
                                                      const char* where) {
  require_frame();
  std::vector<Value> values(static_cast<std::size_t>(viewport_.width) * viewport_.height);
  context_.make_current().ReadPixels(0, 0, viewport_.width, viewport_.height, format, type,
                                     values.data());
  context_.check(where);
  return values;
}

std::vector<std::uint32_t> OsMesaDevice::Implementation::read_ids() {
  return read<std::uint32_t>(GL_RED_INTEGER, GL_UNSIGNED_INT, "read_ids");
}

std::vector<float> OsMesaDevice::Implementation::read_depth() {
  return read<float>(GL_DEPTH_COMPONENT, GL_FLOAT, "read_depth");
}

OsMesaDevice::OsMesaDevice() : implementation_(std::make_unique<Implementation>()) {}
OsMesaDevice::~OsMesaDevice() = default;
void OsMesaDevice::load(const Scene& scene) { implementation_->load(scene); }
void OsMesaDevice::begin_frame(const Frame& frame) { implementation_->begin_frame(frame); }
void OsMesaDevice::draw(std::span<const ObjectId> objects) { implementation_->draw(objects); }
void OsMesaDevice::draw(std::span<const TriangleRange> ranges) { implementation_->draw(ranges); }
void OsMesaDevice::draw_ids(std::span<const TriangleRange> ranges) {
  implementation_->draw_ids(ranges);
}
QueryId OsMesaDevice::query(std::span<const Aabb> boxes) { return implementation_->query(boxes); }
void OsMesaDevice::flush() { implementation_->flush(); }
bool OsMesaDevice::ready(QueryId query) { return implementation_->ready(query); }
std::uint64_t OsMesaDevice::samples(QueryId query) { return implementation_->samples(query); }
void OsMesaDevice::finish() { implementation_->finish(); }
std::string OsMesaDevice::description() const { return implementation_->description(); }
std::vector<std::uint32_t> OsMesaDevice::read_ids() { return implementation_->read_ids(); }
std::vector<float> OsMesaDevice::read_depth() { return implementation_->read_depth(); }

}  // namespace vislab
