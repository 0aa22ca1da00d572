#include "common/scene/library.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>
#include <variant>

#include "common/scene/cell_check.h"
#include "common/scene/description.h"
#include "common/scene/error.h"
#include "common/scene/file_bytes.h"
#include "common/scene/mesh_import.h"
#include "common/scene/orientation.h"
#include "common/scene/quake_world.h"
#include "common/scene/simplify.h"

namespace vislab {
namespace {

/// The descriptions in a folder, sorted by name.
std::vector<std::filesystem::path> descriptions_in(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  if (error) throw InputError(folder.string() + " cannot be read; it should hold descriptions");
  std::sort(files.begin(), files.end());
  return files;
}

std::filesystem::path located(const FileSource& source, const SceneDescription& scene,
                              const DataFolders& folders) {
  if (source.package.empty()) return scene.folder / source.file;
  std::filesystem::path file = folders.cache / source.package / source.file;
  if (!std::filesystem::exists(file)) {
    throw InputError("scene " + scene.name + ": " + file.string() +
                     " is missing, because package " + source.package +
                     " has not been fetched; `./lab setup` fetches it");
  }
  return file;
}

/// Turns z up: y becomes -z.
glm::dmat3 upright(bool z_up) {
  return z_up ? glm::dmat3({1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}) : glm::dmat3(1.0);
}

/// The mesh turned upright, sheared and stretched, turned to its heading, and put on its place.
glm::dmat4x3 placement(const PlacedMesh& placed, const Mesh& mesh) {
  glm::dmat3 turn = rotation({0.0, 1.0, 0.0}, placed.heading_rad);
  for (int axis = 0; axis < 3; ++axis) turn[axis] *= placed.scale[axis];
  turn[2] += turn[0] * placed.shear[1] + turn[1] * placed.shear[2];
  turn[1] += turn[0] * placed.shear[0];
  if (placed.z_up) turn = turn * upright(true);
  const glm::dvec3 half = bounds_of(mesh.positions).half_size();
  turn *= 0.5 * placed.size_m / std::max({half.x, half.y, half.z});
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  for (const glm::vec3& position : mesh.positions) {
    const glm::dvec3 p = turn * glm::dvec3(position);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 foot(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
  return {turn[0], turn[1], turn[2], placed.at - foot};
}

glm::dmat4x3 turned_up(const ModelSource& model, const Object& object) {
  return model.z_up ? upright(true) * object.transform : object.transform;
}

/// Has the scene the same mesh in the same place already, but for rounding in what placed it?
bool has_twin(const Scene& scene, const Object& object, const Mesh& mesh) {
  constexpr double rounding_m = 1e-5;
  for (const Object& other : scene.objects) {
    const Mesh& known = scene.meshes[other.mesh];
    if (known.triangles != mesh.triangles || known.positions.size() != mesh.positions.size()) {
      continue;
    }
    bool same = true;
    for (std::size_t i = 0; same && i < mesh.positions.size(); ++i) {
      const glm::dvec3 a = object.transform * glm::dvec4(mesh.positions[i], 1.0);
      const glm::dvec3 b = other.transform * glm::dvec4(known.positions[i], 1.0);
      same = glm::distance(a, b) <= rounding_m;
    }
    if (same) return true;
  }
  return false;
}

/// Makes the scene that a description names; one overload for each source.
class Maker {
 public:
  Maker(const SceneDescription& scene, const DataFolders& folders)
      : scene_(scene), folders_(folders) {}

  Scene operator()(const ModelSource& model) const {
    Scene scene = model_of(model.mesh);
    for (Object& object : scene.objects) object.transform = turned_up(model, object);
    return scene;
  }
  Scene operator()(const std::vector<ModelSource>& models) const {
    Scene all;
    for (const ModelSource& model : models) {
      const Scene scene = model_of(model.mesh);
      for (Object object : scene.objects) {
        object.transform = turned_up(model, object);
        const Mesh& mesh = scene.meshes[object.mesh];
        const glm::dvec3 half =
            transformed(bounds_of(mesh.positions), object.transform).half_size();
        if (2.0 * std::max({half.x, half.y, half.z}) > model.largest_m) continue;
        if (has_twin(all, object, mesh)) continue;
        object.mesh = static_cast<MeshId>(all.meshes.size());
        all.meshes.push_back(mesh);
        all.objects.push_back(object);
      }
    }
    if (all.objects.empty()) {
      throw InputError("scene " + scene_.name +
                       ": `largest_m` leaves no object; it must be larger");
    }
    return all;
  }
  Scene operator()(const QuakeSource& quake) const {
    return import_quake_world(located(quake.source, scene_, folders_), quake.cells);
  }
  Scene operator()(const std::vector<PlacedMesh>& placed) const {
    Scene scene;
    std::vector<ShapeSource> known;
    for (const PlacedMesh& one : placed) {
      const auto found = std::find(known.begin(), known.end(), one.mesh);
      const auto mesh = static_cast<MeshId>(found - known.begin());
      if (found == known.end()) {
        known.push_back(one.mesh);
        scene.meshes.push_back(mesh_of(one.mesh));
      }
      scene.objects.push_back({mesh, placement(one, scene.meshes[mesh]), none_id});
    }
    return scene;
  }
  Scene operator()(const HaresSource& hares) const {
    return make_hares(mesh_of(hares.mesh), hares.parameters);
  }
  Scene operator()(const MeshFieldSource& field) const {
    return make_mesh_field(mesh_of(field.mesh), field.parameters);
  }
  Scene operator()(const HousesParameters& houses) const { return make_houses(houses); }
  Scene operator()(const AsteroidBeltParameters& belt) const { return make_asteroid_belt(belt); }
  Scene operator()(const BoxFieldParameters& field) const { return make_box_field(field); }
  Scene operator()(const BumpySphereParameters& sphere) const { return make_bumpy_sphere(sphere); }
  Scene operator()(const CityParameters& city) const { return make_city(city); }
  Scene operator()(const GrazingSlabsParameters& slabs) const { return make_grazing_slabs(slabs); }
  Scene operator()(const RoomRingParameters& ring) const { return make_room_ring(ring); }
  Scene operator()(const SceneMaker& make) const { return make(); }

 private:
  Scene model_of(const MeshSource& mesh) const {
    Scene scene = import_mesh_file(located(mesh.source, scene_, folders_));
    if (mesh.simplify_triangles > 0) {
      if (scene.meshes.size() != 1) {
        throw InputError("scene " + scene_.name + ": only a file with a single mesh can be " +
                         "simplified; this one has " + std::to_string(scene.meshes.size()));
      }
      // finish() refuses broken meshes, which must not reach the simplifier.
      scene.finish();
      scene.meshes[0] = simplified(scene.meshes[0], mesh.simplify_triangles);
    }
    return scene;
  }

  Mesh mesh_of(const ShapeSource& shape) const {
    return std::visit([&](const auto& source) { return made(source); }, shape);
  }
  Mesh made(const MeshSource& source) const {
    Scene scene = model_of(source);
    if (scene.meshes.size() != 1) {
      throw InputError("scene " + scene_.name + ": " + source.source.file + " has " +
                       std::to_string(scene.meshes.size()) + " meshes; it must have a single one");
    }
    // finish() refuses broken meshes, which must not reach what places them.
    scene.finish();
    return std::move(scene.meshes[0]);
  }
  Mesh made(const RibbedSphereSource& sphere) const {
    return ribbed_sphere_mesh(sphere.meridians, sphere.parallels, sphere.ribs);
  }
  Mesh made(const BumpySphereParameters& sphere) const { return bumpy_sphere_mesh(sphere); }

  const SceneDescription& scene_;
  const DataFolders& folders_;
};

/// What walks through portals rely on. Whether surfaces close the cells, rays have to say.
void require_fitting_portals(const Scene& scene) {
  const CellCheck check = check_cells(scene);
  const auto refuse = [](const CellFault& fault, const std::string& what) {
    if (fault.count == 0) return;
    std::ostringstream text;
    text << fault.count << " of the [[portals]] " << what << "; the first is that from cell "
         << fault.cell << " to cell " << fault.other << " at " << fault.place.x << ' '
         << fault.place.y << ' ' << fault.place.z
         << ". Each must lie where both of its cells end, and face the one that it leads from";
    throw InputError(text.str());
  };
  refuse(check.gaps, "have no cell before or behind them");
  refuse(check.off, "are not on their cells' common boundary");
}

LoadedScene load_described(const std::filesystem::path& file, const DataFolders& folders) {
  const SceneDescription description = read_scene_description(file);
  LoadedScene loaded;
  loaded.scene = std::visit(Maker(description, folders), description.source);
  if (!description.cells.cells.empty()) {
    loaded.scene.cells = description.cells.cells;
    loaded.scene.portals = description.cells.portals;
    require_fitting_portals(loaded.scene);
  }
  if (description.offset != glm::dvec3(0.0)) {
    if (!loaded.scene.cells.empty() || loaded.scene.quake) {
      throw InputError("scene " + description.name +
                       ": `offset` is not for scenes with cells, which keep their places");
    }
    for (Object& object : loaded.scene.objects) object.transform[3] += description.offset;
  }
  loaded.scene.name = description.name;
  loaded.default_path = description.default_path;
  loaded.description = description.description;
  return loaded;
}

LoadedScene load_file(const std::filesystem::path& file, const DataFolders& folders) {
  require_file(file);
  const std::string extension = lower_extension(file);
  if (extension == "toml") return load_described(file, folders);
  if (extension == "bsp") return {import_quake_world(file), "", ""};
  return {import_mesh_file(file), "", ""};
}

}  // namespace

std::vector<SceneSummary> list_scenes(const DataFolders& folders) {
  std::vector<SceneSummary> scenes;
  for (const std::filesystem::path& file : descriptions_in(folders.data / "scenes")) {
    const SceneDescription scene = read_scene_description(file);
    scenes.push_back({scene.name, scene.description, scene.default_path});
  }
  return scenes;
}

LoadedScene load_scene(const std::string& name_or_file, const DataFolders& folders) {
  const std::filesystem::path described = folders.data / "scenes" / (name_or_file + ".toml");
  const bool is_name = name_or_file.find_first_of("/.") == std::string::npos;
  LoadedScene loaded;
  try {
    if (is_name && std::filesystem::exists(described)) {
      loaded = load_described(described, folders);
    } else if (is_name && !std::filesystem::exists(name_or_file)) {
      std::vector<std::string> known;
      for (const auto& file : descriptions_in(folders.data / "scenes")) {
        known.push_back(file.stem().string());
      }
      throw unknown_name("scene or file", name_or_file, known);
    } else {
      loaded = load_file(name_or_file, folders);
    }
    loaded.scene.finish();
  } catch (const InputError& error) {
    const std::string text = error.what();
    if (text.find(name_or_file) != std::string::npos) throw;
    throw InputError("scene " + name_or_file + ": " + text);
  }
  return loaded;
}

}  // namespace vislab
