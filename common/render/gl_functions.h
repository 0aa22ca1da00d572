// The part of OpenGL 4.5 that the lab uses, loaded from OSMesa, and a context to call it in.
// For .cpp files of this folder only: GL types must not spread through headers.
#pragma once

#include <GL/glcorearb.h>

#include <string>

namespace vislab {

// One line a function: its type (as in glcorearb.h, without PFN and PROC) and its name without
// "gl".
#define VISLAB_GL_FUNCTIONS(F)                                    \
  F(GLATTACHSHADER, AttachShader)                                 \
  F(GLBEGINQUERY, BeginQuery)                                     \
  F(GLBINDBUFFER, BindBuffer)                                     \
  F(GLBINDBUFFERBASE, BindBufferBase)                             \
  F(GLBINDFRAMEBUFFER, BindFramebuffer)                           \
  F(GLBINDVERTEXARRAY, BindVertexArray)                           \
  F(GLCLEAR, Clear)                                               \
  F(GLCLEARBUFFERFV, ClearBufferfv)                               \
  F(GLCLEARBUFFERUIV, ClearBufferuiv)                             \
  F(GLCHECKNAMEDFRAMEBUFFERSTATUS, CheckNamedFramebufferStatus)   \
  F(GLCOLORMASK, ColorMask)                                       \
  F(GLCOMPILESHADER, CompileShader)                               \
  F(GLCREATEBUFFERS, CreateBuffers)                               \
  F(GLCREATEFRAMEBUFFERS, CreateFramebuffers)                     \
  F(GLCREATEPROGRAM, CreateProgram)                               \
  F(GLCREATEQUERIES, CreateQueries)                               \
  F(GLCREATERENDERBUFFERS, CreateRenderbuffers)                   \
  F(GLCREATESHADER, CreateShader)                                 \
  F(GLCREATEVERTEXARRAYS, CreateVertexArrays)                     \
  F(GLCULLFACE, CullFace)                                         \
  F(GLDELETEBUFFERS, DeleteBuffers)                               \
  F(GLDELETEFRAMEBUFFERS, DeleteFramebuffers)                     \
  F(GLDELETEPROGRAM, DeleteProgram)                               \
  F(GLDELETEQUERIES, DeleteQueries)                               \
  F(GLDELETERENDERBUFFERS, DeleteRenderbuffers)                   \
  F(GLDELETESHADER, DeleteShader)                                 \
  F(GLDELETEVERTEXARRAYS, DeleteVertexArrays)                     \
  F(GLDEPTHFUNC, DepthFunc)                                       \
  F(GLDEPTHMASK, DepthMask)                                       \
  F(GLDISABLE, Disable)                                           \
  F(GLDRAWARRAYS, DrawArrays)                                     \
  F(GLDRAWELEMENTS, DrawElements)                                 \
  F(GLENABLE, Enable)                                             \
  F(GLENABLEVERTEXARRAYATTRIB, EnableVertexArrayAttrib)           \
  F(GLENDQUERY, EndQuery)                                         \
  F(GLFINISH, Finish)                                             \
  F(GLFLUSH, Flush)                                               \
  F(GLFRONTFACE, FrontFace)                                       \
  F(GLGETERROR, GetError)                                         \
  F(GLGETINTEGERV, GetIntegerv)                                   \
  F(GLGETPROGRAMINFOLOG, GetProgramInfoLog)                       \
  F(GLGETPROGRAMIV, GetProgramiv)                                 \
  F(GLGETQUERYIV, GetQueryiv)                                     \
  F(GLGETQUERYOBJECTUI64V, GetQueryObjectui64v)                   \
  F(GLGETSHADERINFOLOG, GetShaderInfoLog)                         \
  F(GLGETSHADERIV, GetShaderiv)                                   \
  F(GLGETSTRING, GetString)                                       \
  F(GLLINKPROGRAM, LinkProgram)                                   \
  F(GLMULTIDRAWELEMENTSINDIRECT, MultiDrawElementsIndirect)       \
  F(GLNAMEDBUFFERDATA, NamedBufferData)                           \
  F(GLNAMEDBUFFERSUBDATA, NamedBufferSubData)                     \
  F(GLNAMEDFRAMEBUFFERDRAWBUFFER, NamedFramebufferDrawBuffer)     \
  F(GLNAMEDFRAMEBUFFERREADBUFFER, NamedFramebufferReadBuffer)     \
  F(GLNAMEDFRAMEBUFFERRENDERBUFFER, NamedFramebufferRenderbuffer) \
  F(GLNAMEDRENDERBUFFERSTORAGE, NamedRenderbufferStorage)         \
  F(GLPIXELSTOREI, PixelStorei)                                   \
  F(GLPROGRAMUNIFORM3FV, ProgramUniform3fv)                       \
  F(GLPROGRAMUNIFORMMATRIX4FV, ProgramUniformMatrix4fv)           \
  F(GLREADPIXELS, ReadPixels)                                     \
  F(GLSHADERSOURCE, ShaderSource)                                 \
  F(GLUSEPROGRAM, UseProgram)                                     \
  F(GLVERTEXARRAYATTRIBBINDING, VertexArrayAttribBinding)         \
  F(GLVERTEXARRAYATTRIBFORMAT, VertexArrayAttribFormat)           \
  F(GLVERTEXARRAYATTRIBIFORMAT, VertexArrayAttribIFormat)         \
  F(GLVERTEXARRAYBINDINGDIVISOR, VertexArrayBindingDivisor)       \
  F(GLVERTEXARRAYELEMENTBUFFER, VertexArrayElementBuffer)         \
  F(GLVERTEXARRAYVERTEXBUFFER, VertexArrayVertexBuffer)           \
  F(GLVIEWPORT, Viewport)

struct GlFunctions {
#define VISLAB_GL_MEMBER(type, name) PFN##type##PROC name = nullptr;
  VISLAB_GL_FUNCTIONS(VISLAB_GL_MEMBER)
#undef VISLAB_GL_MEMBER
};

/// Throws std::runtime_error if the context cannot count samples: OpenGL allows counters of no
/// bits, which answer every query with 0, as if everything were hidden.
void require_queries(const GlFunctions& gl);

/// The name of an error of glGetError.
std::string gl_error_name(GLenum error);

/// An OpenGL 4.5 core context that draws in memory, and its functions. It is used by one thread at
/// a time; several contexts may be used in one or in several threads.
class GlContext {
 public:
  /// Throws std::runtime_error if the system's OSMesa does not give OpenGL 4.5.
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Makes the context current in this thread; does nothing if it is already. Every group of calls
  /// starts with it, because another context may have been used in between. Throws
  /// std::runtime_error if the context is lost.
  const GlFunctions& make_current();

  /// Throws std::runtime_error with the name of the first OpenGL error since the last check.
  void check(const char* where) const;

  /// Links a program of two shaders. Throws std::runtime_error with the compiler's message.
  GLuint program(const std::string& vertex, const std::string& fragment) const;

 private:
  void* context_ = nullptr;
  unsigned char default_target_[4] =
      {};  // OSMesa wants one; everything is drawn to own framebuffers
  GlFunctions gl_;
};

}  // namespace vislab
