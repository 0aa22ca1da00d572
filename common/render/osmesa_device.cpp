#include "common/render/osmesa_device.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "common/render/gl_camera.h"
#include "common/render/gl_scene.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

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

// llvmpipe sorts commands into squares of 64 x 64 pixels (bins) and, once 36 MB are full, hands
// them over on its own. A query that this cuts in two counts wrongly (seen: 200,000 samples for a
// box outside of the image, the 2,780th query in a row at 512 x 512; Mesa 22.3). So what waits is
// kept below a quarter of that. Queries are estimated generously, and so are usual triangles; one
// that covers the whole image takes up to three times its estimate (seen: 15 bytes a bin).
constexpr std::size_t most_waiting_bytes = std::size_t{9} << 20U;
constexpr std::size_t query_bytes_a_bin = 256;
constexpr std::size_t least_triangle_bytes = 512;
constexpr std::size_t triangle_bytes_a_bin = 8;
constexpr int bin_size = 64;

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
  void cull_back_faces(std::span<const ObjectId> objects);
  std::span<const ObjectId> one_sided() const { return scene_.one_sided(); }
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
  void make_box_array(const GlFunctions& gl);
  void resize(const GlFunctions& gl, const Viewport& viewport);
  void select(const GlFunctions& gl, ProgramName program);
  void require_frame() const;
  std::size_t triangle_bytes() const {
    return std::max(least_triangle_bytes, triangle_bytes_a_bin * bins_);
  }
  void make_room(const GlFunctions& gl, std::size_t boxes);
  GLuint query_name(QueryId query) const;
  template <typename Value>
  std::vector<Value> read(GLenum format, GLenum type, const char* where);

  GlContext context_;
  GlScene scene_{context_.make_current()};
  std::array<GLuint, program_count> programs_{};
  GLuint framebuffer_ = 0;
  std::array<GLuint, 2> renderbuffers_{};
  GLint largest_side_ = 0;
  std::vector<GLuint> query_names_;
  std::uint32_t queries_used_ = 0;
  std::uint32_t frame_ = 0;  // counts begin_frame

  bool in_frame_ = false;
  Viewport viewport_{0, 0};
  std::size_t bins_ = 0;           // that the image has
  std::size_t waiting_bytes_ = 0;  // handed to OpenGL since the last flush, estimated
  int selected_ = -1;              // a ProgramName, or -1 if the state must be set anew

  GLuint box_array_ = 0;
  GLuint box_corners_ = 0;
  GLuint box_elements_ = 0;
  std::size_t box_capacity_ = 0;
  std::vector<std::array<glm::vec3, 8>> corners_;
  StreamBuffer corner_stream_;
};

OsMesaDevice::Implementation::Implementation() {
  const GlFunctions& gl = context_.make_current();
  require_queries(gl);
  gl.CreateFramebuffers(1, &framebuffer_);
  make_programs();
  make_box_array(gl);
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
  try {
    const GlFunctions& gl = context_.make_current();
    gl.DeleteQueries(static_cast<GLsizei>(query_names_.size()), query_names_.data());
    gl.DeleteRenderbuffers(2, renderbuffers_.data());
    gl.DeleteFramebuffers(1, &framebuffer_);
    gl.DeleteVertexArrays(1, &box_array_);
    for (const GLuint program : programs_) gl.DeleteProgram(program);
    gl.DeleteBuffers(1, &box_corners_);
    gl.DeleteBuffers(1, &box_elements_);
  } catch (const std::runtime_error&) {
    // A context that is lost has taken all that with it.
  }
}

void OsMesaDevice::Implementation::make_programs() {
  const std::string camera = camera_shader_source;
  programs_[object_program] =
      context_.program(camera + object_vertex_source, object_fragment_source);
  programs_[triangle_program] =
      context_.program(camera + object_vertex_source, triangle_fragment_source);
  programs_[box_program] = context_.program(camera + box_vertex_source, box_fragment_source);
}

void OsMesaDevice::Implementation::make_box_array(const GlFunctions& gl) {
  gl.CreateBuffers(1, &box_corners_);
  gl.CreateBuffers(1, &box_elements_);
  gl.CreateVertexArrays(1, &box_array_);
  gl.VertexArrayVertexBuffer(box_array_, 0, box_corners_, 0, sizeof(glm::vec3));
  gl.EnableVertexArrayAttrib(box_array_, 0);
  gl.VertexArrayAttribFormat(box_array_, 0, 3, GL_FLOAT, GL_FALSE, 0);
  gl.VertexArrayAttribBinding(box_array_, 0, 0);
  gl.VertexArrayElementBuffer(box_array_, box_elements_);
}

void OsMesaDevice::Implementation::load(const Scene& scene) {
  context_.make_current();
  in_frame_ = false;
  scene_.load(scene);
  context_.check("load");
}

void OsMesaDevice::Implementation::begin_frame(const Frame& frame) {
  if (scene_.scene() == nullptr) throw std::logic_error("OsMesaDevice: begin_frame before load");
  if (frame.objects.transforms.size() != scene_.scene()->object_count()) {
    throw std::logic_error("OsMesaDevice: the frame shows another scene than the one loaded");
  }
  const GlFunctions& gl = context_.make_current();
  if (frame.viewport != viewport_) resize(gl, frame.viewport);
  for (const GLuint program : programs_) {
    set_camera(gl, program, frame.camera, scene_.scene()->origin());
  }
  scene_.update_transforms(frame.objects.transforms);
  scene_.draw_both_sides();

  gl.DepthMask(GL_TRUE);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  selected_ = -1;
  const GLuint nothing[4] = {none_id, none_id, none_id, none_id};
  const GLfloat far_depth = 1.0F;
  gl.ClearBufferuiv(GL_COLOR, 0, nothing);
  gl.ClearBufferfv(GL_DEPTH, 0, &far_depth);
  queries_used_ = 0;
  ++frame_;
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
  const auto bins_of = [](int pixels) {
    return static_cast<std::size_t>((pixels + bin_size - 1) / bin_size);
  };
  bins_ = bins_of(viewport.width) * bins_of(viewport.height);
}

void OsMesaDevice::Implementation::require_frame() const {
  if (!in_frame_) throw std::logic_error("OsMesaDevice: used before begin_frame");
}

void OsMesaDevice::Implementation::select(const GlFunctions& gl, ProgramName program) {
  if (selected_ == program) return;
  const bool asks = program == box_program;
  gl.UseProgram(programs_[program]);
  if (asks) {
    gl.BindVertexArray(box_array_);
  } else {
    scene_.bind(program == triangle_program);
  }
  gl.DepthMask(asks ? GL_FALSE : GL_TRUE);
  gl.ColorMask(!asks, !asks, !asks, !asks);
  gl.DepthFunc(asks ? GL_LEQUAL : GL_LESS);
  // Of a box only the front: whatever sample a back face covers is covered by a nearer front face.
  if (asks) {
    gl.Enable(GL_CULL_FACE);
    gl.CullFace(GL_BACK);
    gl.FrontFace(GL_CCW);
  } else {
    gl.Disable(GL_CULL_FACE);
  }
  selected_ = program;
}

void OsMesaDevice::Implementation::draw(std::span<const ObjectId> objects) {
  require_frame();
  select(context_.make_current(), object_program);
  scene_.draw(objects);
  for (const ObjectId object : objects) {
    waiting_bytes_ += triangle_bytes() * scene_.scene()->triangle_count(object);
  }
  context_.check("draw");
}

void OsMesaDevice::Implementation::draw(std::span<const TriangleRange> ranges) {
  require_frame();
  select(context_.make_current(), object_program);
  scene_.draw(ranges);
  for (const TriangleRange& range : ranges) waiting_bytes_ += triangle_bytes() * range.count;
  context_.check("draw");
}

void OsMesaDevice::Implementation::cull_back_faces(std::span<const ObjectId> objects) {
  require_frame();
  scene_.cull_back_faces(objects);
}

void OsMesaDevice::Implementation::draw_ids(std::span<const TriangleRange> ranges) {
  require_frame();
  select(context_.make_current(), triangle_program);
  scene_.draw_each_range(ranges);
  for (const TriangleRange& range : ranges) waiting_bytes_ += triangle_bytes() * range.count;
  context_.check("draw_ids");
}

/// Hands over what waits if a query might not fit beside it.
void OsMesaDevice::Implementation::make_room(const GlFunctions& gl, std::size_t boxes) {
  const std::size_t bytes = query_bytes_a_bin * bins_ + triangle_bytes() * 12 * boxes;
  if (waiting_bytes_ + bytes > most_waiting_bytes) {
    gl.Flush();
    waiting_bytes_ = 0;
  }
  waiting_bytes_ += bytes;
}

QueryId OsMesaDevice::Implementation::query(std::span<const Aabb> boxes) {
  require_frame();
  const GlFunctions& gl = context_.make_current();
  make_room(gl, boxes.size());
  select(gl, box_program);
  corners_.clear();
  for (const Aabb& box : boxes) {
    std::array<glm::vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
      const glm::dvec3 corner((i & 1) != 0 ? box.max.x : box.min.x,
                              (i & 2) != 0 ? box.max.y : box.min.y,
                              (i & 4) != 0 ? box.max.z : box.min.z);
      corners[i] = glm::vec3(corner - scene_.scene()->origin());
    }
    corners_.push_back(corners);
  }
  if (boxes.size() > box_capacity_) {
    box_capacity_ = 2 * boxes.size();
    std::vector<std::uint32_t> elements;
    for (std::uint32_t box = 0; box < box_capacity_; ++box) {
      for (const std::uint32_t corner : box_indices) elements.push_back(8 * box + corner);
    }
    gl.NamedBufferData(box_elements_,
                       static_cast<GLsizeiptr>(elements.size() * sizeof(std::uint32_t)),
                       elements.data(), GL_STATIC_DRAW);
  }
  if (queries_used_ == query_names_.size()) {
    query_names_.resize(query_names_.size() + 64);
    gl.CreateQueries(GL_SAMPLES_PASSED, 64, &query_names_[queries_used_]);
  }
  const QueryId id{frame_, queries_used_++};
  gl.BeginQuery(GL_SAMPLES_PASSED, query_names_[id.index]);
  if (!boxes.empty()) {
    corner_stream_.upload(gl, box_corners_, corners_.data(), corners_.size() * sizeof(corners_[0]));
    gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(36 * boxes.size()), GL_UNSIGNED_INT,
                    nullptr);
  }
  gl.EndQuery(GL_SAMPLES_PASSED);
  context_.check("query");
  return id;
}

GLuint OsMesaDevice::Implementation::query_name(QueryId query) const {
  if (query.frame != frame_ || query.index >= queries_used_) {
    throw std::logic_error("OsMesaDevice: no such query in this frame");
  }
  return query_names_[query.index];
}

void OsMesaDevice::Implementation::flush() {
  context_.make_current().Flush();
  waiting_bytes_ = 0;
  context_.check("flush");
}

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
  waiting_bytes_ = 0;
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
void OsMesaDevice::cull_back_faces(std::span<const ObjectId> objects) {
  implementation_->cull_back_faces(objects);
}
std::span<const ObjectId> OsMesaDevice::one_sided() const { return implementation_->one_sided(); }
QueryId OsMesaDevice::query(std::span<const Aabb> boxes) { return implementation_->query(boxes); }
void OsMesaDevice::flush() { implementation_->flush(); }
bool OsMesaDevice::ready(QueryId query) { return implementation_->ready(query); }
std::uint64_t OsMesaDevice::samples(QueryId query) { return implementation_->samples(query); }
void OsMesaDevice::finish() { implementation_->finish(); }
std::string OsMesaDevice::description() const { return implementation_->description(); }
std::vector<std::uint32_t> OsMesaDevice::read_ids() { return implementation_->read_ids(); }
std::vector<float> OsMesaDevice::read_depth() { return implementation_->read_depth(); }

}  // namespace vislab
