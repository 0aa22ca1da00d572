#include "common/scene/assimp_reader.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <map>
#include <stdexcept>
#include <utility>

#include "common/scene/weld.h"

namespace vislab {
namespace {

Mesh mesh_from(const aiMesh& source) {
  Mesh mesh;
  mesh.name = source.mName.C_Str();
  mesh.positions.reserve(source.mNumVertices);
  for (unsigned v = 0; v < source.mNumVertices; ++v) {
    const aiVector3D& p = source.mVertices[v];
    mesh.positions.emplace_back(p.x, p.y, p.z);
  }
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines; larger polygons were triangulated
    mesh.triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
  }
  return mesh;
}

/// One vertex for each position, in the order of first use in the file. Indices out of range stay
/// so, for Scene::finish to refuse.
void join_vertices(Mesh& mesh) {
  const std::vector<std::uint32_t> representative = weld_positions(mesh.positions);
  std::vector<std::uint32_t> renumbered(mesh.positions.size());
  std::uint32_t kept = 0;
  for (std::uint32_t v = 0; v < representative.size(); ++v) {
    if (representative[v] == v) {
      mesh.positions[kept] = mesh.positions[v];
      renumbered[v] = kept++;
    } else {
      renumbered[v] = renumbered[representative[v]];
    }
  }
  mesh.positions.resize(kept);
  for (glm::uvec3& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = triangle[corner];
      triangle[corner] = vertex < renumbered.size() ? renumbered[vertex] : none_id;
    }
  }
}

glm::dmat4 matrix_from(const aiMatrix4x4& m) {
  return {{m.a1, m.b1, m.c1, m.d1},
          {m.a2, m.b2, m.c2, m.d2},
          {m.a3, m.b3, m.c3, m.d3},
          {m.a4, m.b4, m.c4, m.d4}};
}

/// Collects the objects of a node tree; meshes are taken over when an object first uses them.
class Collector {
 public:
  Collector(const aiScene& source, Scene& scene) : source_(source), scene_(scene) {}

  void add(const aiNode& node, const glm::dmat4& parent) {
    const glm::dmat4 world = parent * matrix_from(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add_object(node.mMeshes[i], world);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(*node.mChildren[i], world);
  }

 private:
  void add_object(unsigned index, const glm::dmat4& world) {
    if (index >= source_.mNumMeshes) throw std::runtime_error("a node names a mesh out of range");
    auto found = meshes_.find(index);
    if (found == meshes_.end()) {
      Mesh mesh = mesh_from(*source_.mMeshes[index]);
      join_vertices(mesh);
      MeshId id = none_id;
      if (!mesh.triangles.empty()) {
        id = static_cast<MeshId>(scene_.meshes.size());
        scene_.meshes.push_back(std::move(mesh));
      }
      found = meshes_.emplace(index, id).first;
    }
    if (found->second == none_id) return;
    scene_.objects.push_back({found->second, glm::dmat4x3(world), none_id});
  }

  const aiScene& source_;
  Scene& scene_;
  std::map<unsigned, MeshId> meshes_;
};

}  // namespace

Scene read_with_assimp(const std::string& file, const std::optional<std::string>& bytes,
                       const std::string& format) {
  Assimp::Importer importer;
  constexpr unsigned steps = aiProcess_Triangulate;
  const aiScene* source =
      bytes ? importer.ReadFileFromMemory(bytes->data(), bytes->size(), steps, format.c_str())
            : importer.ReadFile(file, steps);
  if (source == nullptr) throw std::runtime_error(importer.GetErrorString());
  if ((source->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0 || source->mRootNode == nullptr) {
    throw std::runtime_error("the file holds no complete scene");
  }
  Scene scene;
  Collector(*source, scene).add(*source->mRootNode, glm::dmat4(1.0));
  return scene;
}

}  // namespace vislab
