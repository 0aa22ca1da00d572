#include "common/render/gl_functions.h"

#include <stdexcept>

// osmesa.h includes gl.h, whose declarations clash with glcorearb.h: keep it out, and define the
// one macro that osmesa.h takes from it.
#define __gl_h_
#define GLAPIENTRY APIENTRY
#include <GL/osmesa.h>

namespace vislab {
namespace {

GLuint compile(const GlFunctions& gl, GLenum stage, const std::string& source) {
  const GLuint shader = gl.CreateShader(stage);
  const char* text = source.c_str();
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint compiled = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == 0) {
    char log[2048] = {};
    gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
    gl.DeleteShader(shader);
    throw std::runtime_error(std::string("a shader does not compile: ") + log);
  }
  return shader;
}

}  // namespace

std::string gl_error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_CONTEXT_LOST:
      return "GL_CONTEXT_LOST: the graphics context is gone";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    default:
      return "OpenGL error " + std::to_string(error);
  }
}

void require_queries(const GlFunctions& gl) {
  GLint bits = 0;
  gl.GetQueryiv(GL_SAMPLES_PASSED, GL_QUERY_COUNTER_BITS, &bits);
  if (bits == 0) {
    throw std::runtime_error(
        "the graphics device has no occlusion queries (its counters of samples have no bits); Mesa "
        "22.3 or newer has");
  }
}

GlContext::GlContext() {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            0,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            4,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            5,
                            0};
  context_ = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context_ == nullptr) {
    throw std::runtime_error("OSMesa gives no OpenGL 4.5 core context; Mesa 22.3 or newer does");
  }
  // The context's version vouches for every function: OSMesaGetProcAddress itself returns non-null
  // for names that do not exist.
#define VISLAB_GL_LOAD(type, name) \
  gl_.name = reinterpret_cast<PFN##type##PROC>(OSMesaGetProcAddress("gl" #name));
  VISLAB_GL_FUNCTIONS(VISLAB_GL_LOAD)
#undef VISLAB_GL_LOAD
  make_current();
}

GlContext::~GlContext() {
  if (OSMesaGetCurrentContext() == context_) OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
  OSMesaDestroyContext(static_cast<OSMesaContext>(context_));
}

const GlFunctions& GlContext::make_current() {
  if (OSMesaGetCurrentContext() != context_ &&
      OSMesaMakeCurrent(static_cast<OSMesaContext>(context_), default_target_, GL_UNSIGNED_BYTE, 1,
                        1) == 0) {
    throw std::runtime_error("the graphics context is lost: OSMesa cannot make it current");
  }
  return gl_;
}

void GlContext::check(const char* where) const {
  const GLenum error = gl_.GetError();
  if (error != GL_NO_ERROR) {
    throw std::runtime_error(std::string(where) + ": " + gl_error_name(error));
  }
}

GLuint GlContext::program(const std::string& vertex, const std::string& fragment) const {
  const GLuint vertex_shader = compile(gl_, GL_VERTEX_SHADER, vertex);
  const GLuint fragment_shader = compile(gl_, GL_FRAGMENT_SHADER, fragment);
  const GLuint program = gl_.CreateProgram();
  gl_.AttachShader(program, vertex_shader);
  gl_.AttachShader(program, fragment_shader);
  gl_.LinkProgram(program);
  gl_.DeleteShader(vertex_shader);
  gl_.DeleteShader(fragment_shader);
  GLint linked = 0;
  gl_.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == 0) {
    char log[2048] = {};
    gl_.GetProgramInfoLog(program, sizeof log, nullptr, log);
    throw std::runtime_error(std::string("shaders do not link: ") + log);
  }
  return program;
}

}  // namespace vislab
