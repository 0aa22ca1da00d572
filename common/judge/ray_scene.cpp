#include "common/judge/ray_scene.h"

#include <tbb/task_arena.h>

#include <cstring>
#include <stdexcept>

#include "common/scene/error.h"

namespace vislab {
namespace {

/// After this many rebuilds of the merged geometry every object gets its own: a path on which
/// objects start to move one after another must not rebuild the whole scene for each.
constexpr int departure_limit = 4;

const char* instruction_set() {
  if (__builtin_cpu_supports("avx2")) return "avx2";
  if (__builtin_cpu_supports("avx")) return "avx";
  throw InputError(
      "this processor has no AVX: truth is traced in packets of eight rays, which need it");
}

void require_instruction_set(const std::string& name) {
  const bool has = name == "sse2" || (name == "avx" && __builtin_cpu_supports("avx")) ||
                   (name == "avx2" && __builtin_cpu_supports("avx2"));
  if (!has) {
    throw InputError("rays, instruction_set: this processor cannot run '" + name +
                     "'; sse2, avx and avx2 are known");
  }
}

void report_error(void* /*user*/, RTCError code, const char* text) {
  throw std::runtime_error("Embree error " + std::to_string(static_cast<int>(code)) + ": " +
                           (text != nullptr ? text : ""));
}

glm::vec3* vertex_buffer(RTCGeometry geometry, std::size_t count) {
  return static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), count));
}

glm::uvec3* index_buffer(RTCGeometry geometry, std::size_t count) {
  return static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), count));
}

}  // namespace

std::string ray_engine() {
  return std::string("embree ") + RTC_VERSION_STRING + " " + instruction_set() + " robust";
}

RayScene::RayScene(const Scene& scene, RayEngine engine)
    : scene_(&scene),
      engine_(std::move(engine)),
      scene_flags_((engine_.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE) |
                   RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION),
      instanced_(scene.triangle_count() > flat_triangle_limit) {
  if (engine_.instruction_set.empty()) engine_.instruction_set = instruction_set();
  require_instruction_set(engine_.instruction_set);
  const std::size_t count = scene.object_count();
  first_triangle_.resize(count);
  for (ObjectId object = 0; object < count; ++object) {
    first_triangle_[object] = scene.first_triangle(object);
  }
}

RayScene::~RayScene() {
  for (RTCGeometry geometry : geometries_) {
    if (geometry != nullptr) rtcReleaseGeometry(geometry);
  }
  if (top_ != nullptr) rtcReleaseScene(top_);
  for (RTCScene scene : mesh_scenes_) rtcReleaseScene(scene);
  if (device_ != nullptr) rtcReleaseDevice(device_);
}

void RayScene::follow(const ObjectsView& objects) {
  const std::size_t count = scene_->object_count();
  shown_wanted_.assign(count, 0);
  for (const ObjectId object : objects.shown) shown_wanted_[object] = 1;
  if (device_ == nullptr) {
    transforms_.assign(objects.transforms.begin(), objects.transforms.end());
    shown_ = shown_wanted_;
    build();
    return;
  }
  bool departed = false;
  bool changed = false;
  for (ObjectId object = 0; object < count; ++object) {
    const bool moved = transforms_[object] != objects.transforms[object];
    const bool toggled = shown_[object] != shown_wanted_[object];
    if (!moved && !toggled) continue;
    changed = true;
    transforms_[object] = objects.transforms[object];
    shown_[object] = shown_wanted_[object];
    if (!instanced_ && apart_[object] == 0) {
      apart_[object] = 1;
      departed = true;
      continue;
    }
    RTCGeometry geometry = geometries_[object];
    if (moved && instanced_) {
      const glm::dmat4x3& m = transforms_[object];
      const glm::dmat4x3 relative(m[0], m[1], m[2], m[3] - scene_->origin());
      const glm::mat4x3 rounded(relative);
      rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &rounded);
    } else if (moved) {
      set_object_vertices(object);
    }
    if (shown_[object] != 0) {
      rtcEnableGeometry(geometry);
    } else {
      rtcDisableGeometry(geometry);
    }
    rtcCommitGeometry(geometry);
  }
  if (departed) {
    if (++departures_ > departure_limit) apart_.assign(count, 1);
    build_merged();
  } else if (changed) {
    commit();
  }
}

std::array<glm::dvec3, 3> RayScene::triangle(TriangleId id) const {
  const ObjectId object = scene_->object_of(id);
  return world_triangle(scene_->mesh_of(object), transforms_[object], id - first_triangle_[object]);
}

void RayScene::build() {
  device_ = rtcNewDevice(("isa=" + engine_.instruction_set).c_str());
  if (device_ == nullptr) {
    throw std::runtime_error("Embree gives no device, error " +
                             std::to_string(static_cast<int>(rtcGetDeviceError(nullptr))));
  }
  rtcSetDeviceErrorFunction(device_, report_error, nullptr);
  geometries_.assign(scene_->object_count(), nullptr);
  if (instanced_) {
    build_instances();
    return;
  }
  // Objects that are hidden from the start stay apart, so that showing them rebuilds nothing.
  apart_.resize(scene_->object_count());
  for (std::size_t i = 0; i < apart_.size(); ++i) apart_[i] = shown_[i] == 0 ? 1 : 0;
  build_merged();
}

void RayScene::build_instances() {
  tbb::task_arena one_thread(1);
  for (const Mesh& mesh : scene_->meshes) {
    RTCScene mesh_scene = rtcNewScene(device_);
    rtcSetSceneFlags(mesh_scene, static_cast<RTCSceneFlags>(scene_flags_));
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::memcpy(vertex_buffer(geometry, mesh.positions.size()), mesh.positions.data(),
                mesh.positions.size() * sizeof(glm::vec3));
    std::memcpy(index_buffer(geometry, mesh.triangles.size()), mesh.triangles.data(),
                mesh.triangles.size() * sizeof(glm::uvec3));
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(mesh_scene, geometry, merged_geometry);
    rtcReleaseGeometry(geometry);
    one_thread.execute([&] { rtcJoinCommitScene(mesh_scene); });
    mesh_scenes_.push_back(mesh_scene);
  }
  top_ = rtcNewScene(device_);
  rtcSetSceneFlags(top_, static_cast<RTCSceneFlags>(scene_flags_));
  for (ObjectId object = 0; object < geometries_.size(); ++object) {
    RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, mesh_scenes_[scene_->objects[object].mesh]);
    const glm::dmat4x3& m = transforms_[object];
    const glm::mat4x3 rounded(glm::dmat4x3(m[0], m[1], m[2], m[3] - scene_->origin()));
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &rounded);
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(top_, instance, object);
    if (shown_[object] == 0) rtcDisableGeometry(instance);
    geometries_[object] = instance;
  }
  commit();
}

void RayScene::build_merged() {
  if (top_ != nullptr) rtcReleaseScene(top_);
  top_ = rtcNewScene(device_);
  const std::size_t count = scene_->object_count();
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (ObjectId object = 0; object < count; ++object) {
    if (apart_[object] != 0) continue;
    vertices += scene_->mesh_of(object).positions.size();
    triangles += scene_->mesh_of(object).triangles.size();
  }
  merged_ids_.clear();
  if (triangles > 0) {
    RTCGeometry merged = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    glm::vec3* vertex = vertex_buffer(merged, vertices);
    glm::uvec3* index = index_buffer(merged, triangles);
    const bool everything = triangles == scene_->triangle_count();
    if (!everything) merged_ids_.reserve(triangles);
    std::uint32_t base = 0;
    for (ObjectId object = 0; object < count; ++object) {
      if (apart_[object] != 0) continue;
      const Mesh& mesh = scene_->mesh_of(object);
      for (const glm::vec3& p : mesh.positions) {
        *vertex++ = glm::vec3(transforms_[object] * glm::dvec4(p, 1.0) - scene_->origin());
      }
      for (const glm::uvec3& t : mesh.triangles) *index++ = t + base;
      base += static_cast<std::uint32_t>(mesh.positions.size());
      for (std::uint32_t i = 0; !everything && i < mesh.triangles.size(); ++i) {
        merged_ids_.push_back(first_triangle_[object] + i);
      }
    }
    rtcCommitGeometry(merged);
    rtcAttachGeometryByID(top_, merged, merged_geometry);
    rtcReleaseGeometry(merged);
  }
  bool any_apart = false;
  for (ObjectId object = 0; object < count; ++object) {
    if (apart_[object] == 0) continue;
    any_apart = true;
    if (geometries_[object] == nullptr) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      const Mesh& mesh = scene_->mesh_of(object);
      vertex_buffer(geometry, mesh.positions.size());
      std::memcpy(index_buffer(geometry, mesh.triangles.size()), mesh.triangles.data(),
                  mesh.triangles.size() * sizeof(glm::uvec3));
      geometries_[object] = geometry;
    }
    set_object_vertices(object);
    rtcCommitGeometry(geometries_[object]);
    rtcAttachGeometryByID(top_, geometries_[object], object + 1);
    if (shown_[object] == 0) rtcDisableGeometry(geometries_[object]);
    if (shown_[object] != 0) rtcEnableGeometry(geometries_[object]);
  }
  // A dynamic scene keeps a tree for each geometry, so that a moved object rebuilds its own only.
  const int flags = scene_flags_ | (any_apart ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE);
  rtcSetSceneFlags(top_, static_cast<RTCSceneFlags>(flags));
  commit();
}

void RayScene::set_object_vertices(ObjectId object) {
  const Mesh& mesh = scene_->mesh_of(object);
  RTCGeometry geometry = geometries_[object];
  auto* vertex =
      static_cast<glm::vec3*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
  for (const glm::vec3& p : mesh.positions) {
    *vertex++ = glm::vec3(transforms_[object] * glm::dvec4(p, 1.0) - scene_->origin());
  }
  rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
}

void RayScene::commit() {
  tbb::task_arena one_thread(1);
  one_thread.execute([&] { rtcJoinCommitScene(top_); });
}

}  // namespace vislab
