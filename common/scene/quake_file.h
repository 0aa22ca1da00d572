// The lumps of a Quake III world file, checked, in the file's own units.
// Source: "Unofficial Quake 3 Map Specs", Kekoa Proudfoot, 2000.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace vislab::quake {

using Vector = std::array<float, 3>;

struct Texture {
  char name[64];
  std::int32_t flags, contents;
};
struct PlaneRecord {
  Vector normal;
  float distance;
};
struct NodeRecord {
  std::int32_t plane, children[2], mins[3], maxs[3];
};
struct LeafRecord {
  std::int32_t cluster, area, mins[3], maxs[3], first_face, face_count, first_brush, brush_count;
};
struct ModelRecord {
  Vector mins, maxs;
  std::int32_t first_face, face_count, first_brush, brush_count;
};
struct Vertex {
  Vector position;
  float texture[4];
  Vector normal;
  std::uint8_t colour[4];
};
enum class FaceType : std::int32_t { polygon = 1, patch = 2, mesh = 3, billboard = 4 };
struct FaceRecord {
  std::int32_t texture, effect;
  FaceType type;
  std::int32_t first_vertex, vertex_count, first_mesh_vertex, mesh_vertex_count, lightmap[5];
  float lightmap_frame[9];
  Vector normal;
  std::int32_t size[2];
};

struct File {
  std::vector<std::map<std::string, std::string>> entities;
  std::vector<Texture> textures;
  std::vector<PlaneRecord> planes;
  std::vector<NodeRecord> nodes;
  std::vector<LeafRecord> leaves;
  std::vector<std::int32_t> leaf_faces;
  std::vector<ModelRecord> models;
  std::vector<Vertex> vertices;
  std::vector<std::int32_t> mesh_vertices;
  std::vector<FaceRecord> faces;
  std::int32_t cluster_count = 0, bytes_per_cluster = 0;
  std::vector<std::uint8_t> visible;
};

/// Reads and checks: afterwards every index and range is valid, every node is reached once at most
/// from node 0, every patch has an odd grid of 3 × 3 control points or more, leaves without a
/// cluster are as compilers make solid ones, every cluster has a leaf, and no bit of `visible` is
/// set beyond the last cluster. `where` begins messages. Throws InputError.
File read_file(const std::string& bytes, const std::string& where);

}  // namespace vislab::quake
