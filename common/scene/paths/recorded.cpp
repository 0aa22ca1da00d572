#include "common/scene/paths/recorded.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/scene/error.h"
#include "common/scene/file_bytes.h"

namespace vislab {
namespace {

using nlohmann::json;

glm::dvec3 read_point(const json& value, const std::string& where) {
  glm::dvec3 point(0.0);
  bool right = value.is_array() && value.size() == 3;
  for (int i = 0; right && i < 3; ++i) {
    const json& number = value[static_cast<std::size_t>(i)];
    right = number.is_number() && std::isfinite(number.get<double>());
    if (right) point[i] = number.get<double>();
  }
  if (!right) throw InputError(where + " must be three finite numbers [x, y, z]");
  return point;
}

void require_keys(const json& object, const std::vector<std::string>& known,
                  const std::string& where) {
  if (!object.is_object()) throw InputError(where + " must be an object");
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw InputError(where + ": " + unknown_name("key", key, known).what());
    }
  }
}

Pose read_pose(const json& frame, const std::string& where) {
  require_keys(frame, {"eye", "target", "up"}, where);
  if (!frame.contains("eye") || !frame.contains("target")) {
    throw InputError(where + " needs an eye and a target");
  }
  const glm::dvec3 eye = read_point(frame["eye"], where + ": eye");
  const glm::dvec3 target = read_point(frame["target"], where + ": target");
  glm::dvec3 up(0.0, 1.0, 0.0);
  if (frame.contains("up")) up = read_point(frame["up"], where + ": up");
  if (eye == target || up == glm::dvec3(0.0)) {
    throw InputError(where + ": the target must differ from the eye, and up from zero");
  }
  return look_at(eye, target, up);
}

}  // namespace

std::vector<Pose> read_recorded_poses(const std::filesystem::path& file) {
  const json content = json::parse(read_bytes(file), nullptr, false);
  const std::string where = file.string();
  if (content.is_discarded()) throw InputError(where + " is not JSON, or it is cut short");
  require_keys(content, {"frames"}, where);
  if (!content.contains("frames") || !content["frames"].is_array() || content["frames"].empty()) {
    throw InputError(where + ": `frames` must be a list of one pose or more");
  }
  std::vector<Pose> poses;
  for (const json& frame : content["frames"]) {
    poses.push_back(read_pose(frame, where + ", frame " + std::to_string(poses.size())));
  }
  return poses;
}

}  // namespace vislab
