// How every program of the lab takes world positions to clip space. For .cpp files of this folder
// only.
#pragma once

#include <glm/glm.hpp>

#include "common/geometry/camera.h"
#include "common/render/gl_functions.h"

namespace vislab {

/// Start of a vertex shader: declares `vec4 clip_position(vec3 world)`, with `world` relative to
/// the scene's origin. `precise` and one expression for all give the same depth bits whichever
/// program draws. The eye comes as a sum of two floats, so that subtracting it loses as little as
/// in double.
extern const char* const camera_shader_source;

/// Sets the camera of a program that starts with camera_shader_source. `origin` is Scene::origin().
void set_camera(const GlFunctions& gl, GLuint program, const Camera& camera,
                const glm::dvec3& origin);

}  // namespace vislab
