#include "common/render/class_view.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "common/render/gl_camera.h"
#include "common/scene/error.h"
#include "common/scene/transform.h"

namespace vislab {
namespace {

const char* const vertex_source = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in uint triangle_class;
out vec3 from_eye;
flat out uint kind;
void main() {
  from_eye = relative_to_eye(position);
  kind = triangle_class;
  gl_Position = clip_position(position);
}
)";

const char* const fragment_source = R"(#version 450 core
layout(location = 3) uniform vec3 colors[4];
layout(location = 7) uniform vec3 parallel_light;  // zero: the light is at the eye
in vec3 from_eye;
flat in uint kind;
out vec4 color;
void main() {
  vec3 normal = cross(dFdx(from_eye), dFdy(from_eye));
  vec3 light = dot(parallel_light, parallel_light) > 0.0 ? parallel_light : from_eye;
  float lengths = length(normal) * length(light);
  float facing = lengths > 0.0 ? abs(dot(normal, light)) / lengths : 0.0;
  color = vec4(colors[kind] * mix(0.55, 1.0, facing), 1.0);
}
)";

struct Vertex {
  glm::vec3 position;  // world minus the scene's origin
  std::uint32_t triangle_class;
};

constexpr std::size_t batch_triangles = 65536;

/// Averages blocks of factor * factor pixels and turns the rows over, so that the top comes first.
Image reduced(const std::vector<std::uint8_t>& rgba, const Viewport& size, int factor) {
  Image image{size.width, size.height, {}};
  image.rgb.reserve(std::size_t{3} * size.width * size.height);
  const std::size_t stride = std::size_t{4} * size.width * factor;
  const auto samples = static_cast<unsigned>(factor * factor);
  for (int row = size.height - 1; row >= 0; --row) {
    for (int column = 0; column < size.width; ++column) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        unsigned sum = samples / 2;
        for (int y = 0; y < factor; ++y) {
          for (int x = 0; x < factor; ++x) {
            sum += rgba[static_cast<std::size_t>(row * factor + y) * stride +
                        std::size_t{4} * (column * factor + x) + channel];
          }
        }
        image.rgb.push_back(static_cast<std::uint8_t>(sum / samples));
      }
    }
  }
  return image;
}

}  // namespace

class ClassView::Implementation {
 public:
  Implementation();
  ~Implementation();
  Image draw(const Scene& scene, const ObjectsView& objects, std::span<const TriangleClass> classes,
             const Camera& camera, const Viewport& viewport, const Options& options);

 private:
  void start_image(const GlFunctions& gl, const Viewport& size);
  void draw_batch(const GlFunctions& gl);

  GlContext context_;
  GLuint program_ = 0;
  GLuint vertex_array_ = 0;
  GLuint vertex_buffer_ = 0;
  GLuint framebuffer_ = 0;
  std::array<GLuint, 2> renderbuffers_{};
  std::vector<Vertex> batch_;
};

ClassView::Implementation::Implementation() {
  const GlFunctions& gl = context_.make_current();
  program_ = context_.program(std::string(camera_shader_source) + vertex_source, fragment_source);
  gl.CreateBuffers(1, &vertex_buffer_);
  gl.CreateVertexArrays(1, &vertex_array_);
  gl.VertexArrayVertexBuffer(vertex_array_, 0, vertex_buffer_, 0, sizeof(Vertex));
  gl.EnableVertexArrayAttrib(vertex_array_, 0);
  gl.VertexArrayAttribFormat(vertex_array_, 0, 3, GL_FLOAT, GL_FALSE, 0);
  gl.VertexArrayAttribBinding(vertex_array_, 0, 0);
  gl.EnableVertexArrayAttrib(vertex_array_, 1);
  gl.VertexArrayAttribIFormat(vertex_array_, 1, 1, GL_UNSIGNED_INT, sizeof(glm::vec3));
  gl.VertexArrayAttribBinding(vertex_array_, 1, 0);
  gl.CreateFramebuffers(1, &framebuffer_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LESS);
  gl.CullFace(GL_BACK);
  context_.check("making the picture's device");
}

ClassView::Implementation::~Implementation() {
  const GlFunctions& gl = context_.make_current();
  gl.DeleteRenderbuffers(2, renderbuffers_.data());
  gl.DeleteFramebuffers(1, &framebuffer_);
  gl.DeleteVertexArrays(1, &vertex_array_);
  gl.DeleteBuffers(1, &vertex_buffer_);
  gl.DeleteProgram(program_);
}

void ClassView::Implementation::start_image(const GlFunctions& gl, const Viewport& size) {
  GLint limit = 0;
  gl.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  if (size.width < 1 || size.height < 1 || size.width > limit || size.height > limit) {
    throw InputError("a picture of " + std::to_string(size.width) + "x" +
                     std::to_string(size.height) +
                     " pixels cannot be drawn: each side must be 1 to " + std::to_string(limit));
  }
  gl.DeleteRenderbuffers(2, renderbuffers_.data());
  gl.CreateRenderbuffers(2, renderbuffers_.data());
  gl.NamedRenderbufferStorage(renderbuffers_[0], GL_RGBA8, size.width, size.height);
  gl.NamedRenderbufferStorage(renderbuffers_[1], GL_DEPTH_COMPONENT32F, size.width, size.height);
  gl.NamedFramebufferRenderbuffer(framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                  renderbuffers_[0]);
  gl.NamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                  renderbuffers_[1]);
  gl.NamedFramebufferDrawBuffer(framebuffer_, GL_COLOR_ATTACHMENT0);
  gl.NamedFramebufferReadBuffer(framebuffer_, GL_COLOR_ATTACHMENT0);
  gl.Viewport(0, 0, size.width, size.height);
  std::array<GLfloat, 4> background{};
  for (std::size_t i = 0; i < 3; ++i) background[i] = background_color[i] / 255.0F;
  const GLfloat far_depth = 1.0F;
  gl.ClearBufferfv(GL_COLOR, 0, background.data());
  gl.ClearBufferfv(GL_DEPTH, 0, &far_depth);
}

void ClassView::Implementation::draw_batch(const GlFunctions& gl) {
  gl.NamedBufferData(vertex_buffer_, static_cast<GLsizeiptr>(batch_.size() * sizeof(Vertex)),
                     batch_.data(), GL_STREAM_DRAW);
  gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(batch_.size()));
  batch_.clear();
}

Image ClassView::Implementation::draw(const Scene& scene, const ObjectsView& objects,
                                      std::span<const TriangleClass> classes, const Camera& camera,
                                      const Viewport& viewport, const Options& options) {
  const GlFunctions& gl = context_.make_current();
  const Viewport size{viewport.width * options.supersampling,
                      viewport.height * options.supersampling};
  start_image(gl, size);
  set_camera(gl, program_, camera, scene.origin());
  std::array<glm::vec3, triangle_class_count> colors;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const Color& color = class_colors[i];
    colors[i] = glm::vec3(color[0], color[1], color[2]) / 255.0F;
  }
  gl.ProgramUniform3fv(program_, 3, static_cast<GLsizei>(colors.size()), &colors[0].x);
  const glm::vec3 light(camera.lens.projection == Projection::orthographic ? camera.pose.back
                                                                           : glm::dvec3(0.0));
  gl.ProgramUniform3fv(program_, 7, 1, &light.x);
  gl.UseProgram(program_);
  gl.BindVertexArray(vertex_array_);
  if (options.only_front_faces) {
    gl.Enable(GL_CULL_FACE);
  } else {
    gl.Disable(GL_CULL_FACE);
  }

  batch_.clear();
  for (const ObjectId object : objects.shown) {
    const Mesh& mesh = scene.mesh_of(object);
    const bool mirrored = determinant(objects.transforms[object]) < 0.0;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto triangle_class =
          static_cast<std::uint32_t>(classes[scene.first_triangle(object) + i]);
      auto corners = world_triangle(mesh, objects.transforms[object], i);
      if (mirrored) std::swap(corners[1], corners[2]);  // so that its outside stays in front
      for (const glm::dvec3& corner : corners) {
        batch_.push_back({glm::vec3(corner - scene.origin()), triangle_class});
      }
      if (batch_.size() == 3 * batch_triangles) draw_batch(gl);
    }
  }
  if (!batch_.empty()) draw_batch(gl);

  std::vector<std::uint8_t> rgba(std::size_t{4} * size.width * size.height);
  gl.ReadPixels(0, 0, size.width, size.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  context_.check("drawing a picture");
  return reduced(rgba, viewport, options.supersampling);
}

ClassView::ClassView() : implementation_(std::make_unique<Implementation>()) {}
ClassView::~ClassView() = default;
Image ClassView::draw(const Scene& scene, const ObjectsView& objects,
                      std::span<const TriangleClass> classes, const Camera& camera,
                      const Viewport& viewport, const Options& options) {
  return implementation_->draw(scene, objects, classes, camera, viewport, options);
}

}  // namespace vislab
