#include "common/render/gl_camera.h"

namespace vislab {

const char* const camera_shader_source = R"(#version 450 core
layout(location = 0) uniform vec3 eye_high;
layout(location = 1) uniform vec3 eye_low;
layout(location = 2) uniform mat4 clip_from_rotated;
vec3 relative_to_eye(vec3 world) {
  precise vec3 from_eye = (world - eye_high) - eye_low;
  return from_eye;
}
vec4 clip_position(vec3 world) {
  precise vec4 position = clip_from_rotated * vec4(relative_to_eye(world), 1.0);
  return position;
}
)";

void set_camera(const GlFunctions& gl, GLuint program, const Camera& camera,
                const glm::dvec3& origin) {
  Camera at_origin = camera;
  at_origin.pose.eye = glm::dvec3(0.0);
  const glm::mat4 clip(at_origin.view_projection());
  const glm::dvec3 eye = camera.pose.eye - origin;
  const glm::vec3 high(eye);
  const glm::vec3 low(eye - glm::dvec3(high));
  gl.ProgramUniform3fv(program, 0, 1, &high.x);
  gl.ProgramUniform3fv(program, 1, 1, &low.x);
  gl.ProgramUniformMatrix4fv(program, 2, 1, GL_FALSE, &clip[0].x);
}

}  // namespace vislab
