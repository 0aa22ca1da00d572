#include "common/scene/quake_world.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

#include "common/scene/error.h"
#include "common/scene/file_bytes.h"
#include "common/scene/quake_cells.h"
#include "common/scene/quake_faces.h"
#include "common/scene/quake_file.h"
#include "common/scene/quake_reach.h"
#include "common/scene/text_cursor.h"

namespace vislab {
namespace {

using quake::to_lab;

/// "x y z" in Quake units; nothing if the text is not three finite numbers.
std::optional<glm::dvec3> parse_point(const std::string& text) {
  TextCursor cursor(text);
  glm::dvec3 point(0.0);
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> number = cursor.next_number();
    if (!number || !std::isfinite(*number)) return std::nullopt;
    point[i] = *number;
  }
  return point;
}

std::string value_of(const std::map<std::string, std::string>& entity, const std::string& key) {
  const auto found = entity.find(key);
  return found == entity.end() ? std::string() : found->second;
}

Aabb box_of(const glm::vec3& a, const glm::vec3& b) {
  Aabb box;
  box.extend(a);
  box.extend(b);
  return box;
}

Aabb box_of(const std::int32_t (&mins)[3], const std::int32_t (&maxs)[3]) {
  // Whole units up to 2^24 are exact in float; the format's worlds end at 2^17.
  const auto corner = [](const std::int32_t(&p)[3]) {
    return to_lab({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  };
  return box_of(corner(mins), corner(maxs));
}

void copy_tree(const quake::File& file, QuakeWorld& world) {
  for (const quake::PlaneRecord& plane : file.planes) {
    const glm::dvec3 normal(plane.normal[0], plane.normal[2],
                            -static_cast<double>(plane.normal[1]));
    world.planes.push_back({normal, -static_cast<double>(plane.distance) * quake_unit_m});
  }
  for (const quake::NodeRecord& node : file.nodes) {
    world.nodes.push_back(
        {static_cast<std::uint32_t>(node.plane), node.children[0], node.children[1]});
  }
  for (const quake::LeafRecord& leaf : file.leaves) {
    world.leaves.push_back({leaf.cluster, leaf.area, box_of(leaf.mins, leaf.maxs), none_id});
  }
  world.entities = file.entities;
  world.cluster_count = static_cast<std::uint32_t>(file.cluster_count);
  world.bytes_per_cluster = static_cast<std::uint32_t>(file.bytes_per_cluster);
  world.visible = file.visible;
}

/// The eye of a player who stands at `origin` (Quake units): 26 units above it, lower where that is
/// inside a wall or ceiling; nothing if no such point lies in the open.
std::optional<QuakePlace> place_at(const QuakeWorld& world, const glm::dvec3& origin) {
  for (const double raise : {26.0, 8.0, 1.0}) {
    QuakePlace place;
    place.eye = glm::dvec3(origin.x, origin.z + raise, -origin.y) * quake_unit_m;
    place.leaf = world.leaf_at(place.eye);
    if (world.leaves[place.leaf].cluster >= 0) return place;
  }
  return std::nullopt;
}

void add_places(QuakeWorld& world) {
  for (const auto& entity : world.entities) {
    const std::string class_name = value_of(entity, "classname");
    const bool reachable = class_name.starts_with("info_player_") ||
                           class_name.starts_with("item_") || class_name.starts_with("weapon_") ||
                           class_name.starts_with("ammo_");
    // Players are put to the intermission point without having walked there.
    if (!reachable || class_name == "info_player_intermission") continue;
    const std::optional<glm::dvec3> origin = parse_point(value_of(entity, "origin"));
    if (!origin) continue;
    std::optional<QuakePlace> place = place_at(world, *origin);
    if (!place) continue;
    place->class_name = class_name;
    const std::string angle_text = value_of(entity, "angle");
    const std::optional<double> angle = TextCursor(angle_text).next_number();
    if (angle && std::isfinite(*angle)) place->heading_rad = *angle * std::numbers::pi / 180.0;
    world.places.push_back(*place);
  }
}

/// Gives the faces of each leaf, of no leaf, and of each brush model to objects.
class ObjectMaker {
 public:
  ObjectMaker(const quake::File& file, Scene& scene, QuakeWorld& world)
      : file_(file),
        scene_(scene),
        world_(world),
        taken_(file.faces.size(), 0),
        owner_(file.faces.size(), none_id) {}

  void make_all() {
    // A brush model's faces belong to it even if a leaf lists them.
    std::vector<std::vector<std::int32_t>> model_faces(file_.models.size());
    for (std::size_t m = 1; m < file_.models.size(); ++m) model_faces[m] = take_model(m);
    for (std::size_t i = 0; i < world_.leaves.size(); ++i) {
      const quake::LeafRecord& leaf = file_.leaves[i];
      std::vector<std::int32_t> faces;
      for (std::int32_t k = 0; k < leaf.face_count; ++k) {
        take(file_.leaf_faces[static_cast<std::size_t>(leaf.first_face + k)], faces);
      }
      world_.leaves[i].object =
          make(faces, "leaf " + std::to_string(i), glm::dvec3(0.0), static_cast<std::uint32_t>(i));
    }
    make(take_model(0), "world faces in no leaf", glm::dvec3(0.0), none_id);
    const std::size_t of_the_world = scene_.objects.size();
    for (std::size_t m = 1; m < file_.models.size(); ++m) add_brush_model(m, model_faces[m]);
    list_leaves(of_the_world);
  }

 private:
  void take(std::int32_t face, std::vector<std::int32_t>& faces) {
    if (taken_[static_cast<std::size_t>(face)]++ == 0) faces.push_back(face);
  }

  std::vector<std::int32_t> take_model(std::size_t index) {
    const quake::ModelRecord& model = file_.models[index];
    std::vector<std::int32_t> faces;
    for (std::int32_t k = 0; k < model.face_count; ++k) take(model.first_face + k, faces);
    return faces;
  }

  ObjectId make(const std::vector<std::int32_t>& faces, const std::string& name,
                const glm::dvec3& offset, std::uint32_t leaf) {
    Mesh mesh = quake::mesh_of_faces(file_, faces);
    if (mesh.triangles.empty()) return none_id;
    mesh.name = name;
    glm::dmat4x3 transform(1.0);
    transform[3] = offset;
    const auto id = static_cast<ObjectId>(scene_.objects.size());
    scene_.objects.push_back({static_cast<MeshId>(scene_.meshes.size()), transform, none_id});
    scene_.meshes.push_back(std::move(mesh));
    world_.leaf_of_object.push_back(leaf);
    for (const std::int32_t face : faces) {
      if (quake::is_drawn(file_, face)) owner_[static_cast<std::size_t>(face)] = id;
    }
    return id;
  }

  /// The first `count` objects are the world's; those behind them move.
  void list_leaves(std::size_t count) {
    std::vector<std::vector<std::uint32_t>> lists(scene_.objects.size());
    for (std::uint32_t i = 0; i < world_.leaves.size(); ++i) {
      if (world_.leaves[i].cluster < 0) continue;
      const quake::LeafRecord& leaf = file_.leaves[i];
      for (std::int32_t k = 0; k < leaf.face_count; ++k) {
        const std::int32_t face = file_.leaf_faces[static_cast<std::size_t>(leaf.first_face + k)];
        const ObjectId object = owner_[static_cast<std::size_t>(face)];
        if (object < count) lists[object].push_back(i);
      }
    }
    for (std::size_t i = 0; i < lists.size(); ++i) {
      std::vector<std::uint32_t>& leaves = lists[i];
      const Object& object = scene_.objects[i];
      if (i < count) {
        const Mesh& mesh = scene_.meshes[object.mesh];
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
          add_leaves_reached(world_, world_triangle(mesh, object.transform, t), leaves);
        }
      }
      std::ranges::sort(leaves);
      const auto repeated = std::ranges::unique(leaves);
      leaves.erase(repeated.begin(), repeated.end());
      world_.first_leaf.push_back(static_cast<std::uint32_t>(world_.leaf_lists.size()));
      world_.leaf_lists.insert(world_.leaf_lists.end(), leaves.begin(), leaves.end());
    }
    world_.first_leaf.push_back(static_cast<std::uint32_t>(world_.leaf_lists.size()));
  }

  void add_brush_model(std::size_t index, const std::vector<std::int32_t>& faces) {
    const quake::ModelRecord& model = file_.models[index];
    const std::string name = std::string("*").append(std::to_string(index));
    QuakeBrushModel entry;
    glm::dvec3 offset(0.0);
    for (const auto& entity : world_.entities) {
      if (value_of(entity, "model") != name) continue;
      entry.class_name = value_of(entity, "classname");
      const std::optional<glm::dvec3> origin = parse_point(value_of(entity, "origin"));
      if (origin) offset = glm::dvec3(origin->x, origin->z, -origin->y) * quake_unit_m;
      break;
    }
    glm::dmat4x3 placed(1.0);
    placed[3] = offset;
    entry.bounds = transformed(box_of(to_lab(model.mins), to_lab(model.maxs)), placed);
    entry.object = make(faces, "brush model " + name, offset, none_id);
    world_.brush_models.push_back(entry);
  }

  const quake::File& file_;
  Scene& scene_;
  QuakeWorld& world_;
  std::vector<std::uint8_t> taken_;
  std::vector<ObjectId> owner_;  // by face; none_id: not drawn
};

}  // namespace

std::uint32_t QuakeWorld::leaf_at(const glm::dvec3& point) const {
  std::int32_t at = 0;
  while (at >= 0) {
    const QuakeNode& node = nodes[static_cast<std::size_t>(at)];
    at = planes[node.plane].signed_distance(point) >= 0.0 ? node.front : node.back;
  }
  return static_cast<std::uint32_t>(-(at + 1));
}

bool QuakeWorld::sees(std::int32_t from, std::int32_t to) const {
  if (from < 0 || to < 0) return false;
  if (visible.empty()) return true;
  const std::size_t byte =
      static_cast<std::size_t>(from) * bytes_per_cluster + static_cast<std::size_t>(to) / 8;
  return (visible[byte] >> (static_cast<unsigned>(to) % 8U) & 1U) != 0;
}

std::string QuakeWorld::doubt_about_sets() const {
  if (visible.empty()) return "has no potentially visible sets";
  if (report.blind_clusters > 0) {
    return "has potentially visible sets that do not fit: " +
           std::to_string(report.blind_clusters) + " clusters do not see themselves";
  }
  if (report.unseen_neighbours > 0) {
    return "has potentially visible sets that do not fit: clusters at " +
           std::to_string(report.unseen_neighbours) + " openings do not see each other";
  }
  return "";
}

Scene import_quake_world(const std::filesystem::path& file, const QuakeCellLimits& limits) {
  const quake::File content = quake::read_file(read_bytes(file), file.string());
  Scene scene;
  scene.name = file.stem().string();
  auto world = std::make_shared<QuakeWorld>();
  copy_tree(content, *world);
  add_places(*world);
  ObjectMaker(content, scene, *world).make_all();
  if (scene.objects.empty()) {
    throw InputError(file.string() + " holds no face that is drawn; a scene needs at least one");
  }
  try {
    add_quake_cells(scene, *world, limits);
  } catch (const InputError& error) {
    throw InputError(file.string() + " " + error.what());
  }
  scene.quake = std::move(world);
  return scene;
}

void add_to_hash(ContentHash& hash, const QuakeWorld& world) {
  hash.add(world.planes.size());
  for (const Plane& plane : world.planes) {
    hash.add(plane.normal);
    hash.add(plane.d);
  }
  hash.add(world.nodes.size());
  for (const QuakeNode& node : world.nodes) {
    hash.add(node.plane);
    hash.add(node.front);
    hash.add(node.back);
  }
  hash.add(world.leaves.size());
  for (const QuakeLeaf& leaf : world.leaves) {
    hash.add(leaf.cluster);
    hash.add(leaf.area);
    hash.add(leaf.object);
  }
  hash.add(world.brush_models.size());
  for (const QuakeBrushModel& model : world.brush_models) {
    hash.add(model.object);
    hash.add(model.class_name);
  }
  hash.add(world.places.size());
  for (const QuakePlace& place : world.places) {
    hash.add(place.eye);
    hash.add(place.heading_rad);
  }
  hash.add_list(std::span<const std::uint32_t>(world.first_leaf));
  hash.add_list(std::span<const std::uint32_t>(world.leaf_lists));
  hash.add(world.bytes_per_cluster);
  hash.add_list(std::span<const std::uint8_t>(world.visible));
}

}  // namespace vislab
