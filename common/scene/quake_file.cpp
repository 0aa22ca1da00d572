#include "common/scene/quake_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "common/scene/error.h"

namespace vislab::quake {
namespace {

constexpr float farthest_units = 131072.0F;  // the format's worlds end there

enum Lump {
  entities_lump = 0,
  textures_lump = 1,
  planes_lump = 2,
  nodes_lump = 3,
  leaves_lump = 4,
  leaf_faces_lump = 5,
  models_lump = 7,
  vertices_lump = 10,
  mesh_vertices_lump = 11,
  faces_lump = 13,
  visible_lump = 16,
  lump_count = 17
};

static_assert(sizeof(Texture) == 72 && sizeof(PlaneRecord) == 16 && sizeof(NodeRecord) == 36 &&
              sizeof(LeafRecord) == 48 && sizeof(ModelRecord) == 40 && sizeof(Vertex) == 44 &&
              sizeof(FaceRecord) == 104);

class LumpReader {
 public:
  LumpReader(const std::string& bytes, const std::string& where) : bytes_(bytes), where_(where) {
    constexpr std::size_t header = 8 + 8 * lump_count;
    if (bytes.size() < 8 || bytes.compare(0, 4, "IBSP") != 0) {
      fail("is not a Quake III world: it must begin with IBSP");
    }
    std::int32_t version = 0;
    std::memcpy(&version, bytes.data() + 4, 4);
    if (version != 0x2e) {
      fail("has version " + std::to_string(version) + "; Quake III worlds have version 46");
    }
    if (bytes.size() < header) fail("ends within its header");
    std::memcpy(directory_, bytes.data() + 8, sizeof directory_);
  }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(where_ + " " + what); }

  std::string raw(Lump lump, const std::string& name) const {
    const std::int64_t offset = directory_[lump][0];
    const std::int64_t length = directory_[lump][1];
    if (offset < 0 || length < 0 || offset + length > static_cast<std::int64_t>(bytes_.size())) {
      fail("is cut short or damaged: its " + name + " lie at bytes " + std::to_string(offset) +
           " to " + std::to_string(offset + length) + ", but it has " +
           std::to_string(bytes_.size()));
    }
    return bytes_.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
  }

  template <typename Record>
  std::vector<Record> records(Lump lump, const std::string& name) const {
    static_assert(std::is_trivially_copyable_v<Record>);
    const std::string data = raw(lump, name);
    if (data.size() % sizeof(Record) != 0) {
      fail("is damaged: the size of its " + name + " is not a multiple of " +
           std::to_string(sizeof(Record)));
    }
    std::vector<Record> list(data.size() / sizeof(Record));
    if (!list.empty()) std::memcpy(list.data(), data.data(), data.size());
    return list;
  }

  /// Throws unless first, …, first + count - 1 are indices into a list of `size`.
  void require_range(std::int64_t first, std::int64_t count, std::size_t size,
                     const std::string& what) const {
    if (first < 0 || count < 0 || first + count > static_cast<std::int64_t>(size)) {
      fail("is damaged: " + what + " " + std::to_string(first) + " and " + std::to_string(count) +
           " from there are out of range; there are " + std::to_string(size));
    }
  }

 private:
  const std::string& bytes_;
  const std::string& where_;
  std::int32_t directory_[lump_count][2];
};

/// Entities are blocks { "key" "value" … }.
std::vector<std::map<std::string, std::string>> parse_entities(const std::string& text,
                                                               const LumpReader& reader) {
  std::vector<std::map<std::string, std::string>> entities;
  std::vector<std::string> pending;  // a key that waits for its value
  bool open = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '\0') break;
    if (c == '{') {
      if (open) reader.fail("is damaged: an entity begins within another");
      open = true;
      entities.emplace_back();
    } else if (c == '}') {
      if (!open || !pending.empty()) reader.fail("is damaged: an entity ends out of place");
      open = false;
    } else if (c == '"') {
      const std::size_t end = text.find('"', at + 1);
      if (!open || end == std::string::npos) reader.fail("is damaged: entity text out of place");
      const std::string word = text.substr(at + 1, end - at - 1);
      at = end;
      if (pending.empty()) {
        pending.push_back(word);
      } else {
        entities.back()[pending.back()] = word;
        pending.clear();
      }
    }
  }
  if (open) reader.fail("is damaged: its last entity does not end");
  return entities;
}

void require_plane(const File& file, std::int32_t index, const LumpReader& reader) {
  const PlaneRecord& plane = file.planes[static_cast<std::size_t>(index)];
  const double length = std::hypot(plane.normal[0], plane.normal[1], plane.normal[2]);
  if (!(std::abs(length - 1.0) < 1e-3)) {
    reader.fail("is damaged: the normal of plane " + std::to_string(index) + " has the length " +
                std::to_string(length) + " instead of 1");
  }
  if (!(std::abs(plane.distance) <= 2.0F * farthest_units)) {
    reader.fail("is damaged: plane " + std::to_string(index) + " is " +
                std::to_string(plane.distance) + " units from the origin; worlds end at " +
                std::to_string(farthest_units));
  }
}

void require_vertices(const File& file, const FaceRecord& face, const LumpReader& reader) {
  for (std::int32_t i = 0; i < face.vertex_count; ++i) {
    const auto at = static_cast<std::size_t>(face.first_vertex + i);
    for (const float coordinate : file.vertices[at].position) {
      if (std::abs(coordinate) <= farthest_units) continue;
      reader.fail("is damaged: vertex " + std::to_string(at) + " of a face is at " +
                  std::to_string(coordinate) + "; coordinates are numbers up to " +
                  std::to_string(farthest_units));
    }
  }
}

/// The tree's nodes and leaves, each reached at most once, so that descending always ends. By leaf:
/// whether it is reached.
std::vector<std::uint8_t> check_tree(const File& file, const LumpReader& reader) {
  if (file.nodes.empty()) reader.fail("has no BSP node");
  if (file.leaves.empty()) reader.fail("has no BSP leaf");
  std::vector<std::uint8_t> reached(file.nodes.size(), 0);
  std::vector<std::uint8_t> leaf_reached(file.leaves.size(), 0);
  std::vector<std::int64_t> pending{0};
  while (!pending.empty()) {
    const auto index = static_cast<std::size_t>(pending.back());
    pending.pop_back();
    if (reached[index]++ != 0) {
      reader.fail("is damaged: BSP node " + std::to_string(index) + " has two parents");
    }
    const NodeRecord& node = file.nodes[index];
    reader.require_range(node.plane, 1, file.planes.size(), "plane");
    require_plane(file, node.plane, reader);
    for (const std::int64_t child : node.children) {
      if (child >= 0) {
        reader.require_range(child, 1, file.nodes.size(), "BSP node");
        pending.push_back(child);
      } else {
        reader.require_range(-(child + 1), 1, file.leaves.size(), "BSP leaf");
        // All that is solid may be one leaf.
        const auto leaf = static_cast<std::size_t>(-(child + 1));
        if (leaf_reached[leaf] != 0 && file.leaves[leaf].cluster >= 0) {
          reader.fail("is damaged: BSP leaf " + std::to_string(leaf) + " has two parents");
        }
        leaf_reached[leaf] = 1;
      }
    }
  }
  return leaf_reached;
}

void check_faces(const File& file, const LumpReader& reader) {
  for (const FaceRecord& face : file.faces) {
    reader.require_range(face.texture, 1, file.textures.size(), "texture");
    reader.require_range(face.first_vertex, face.vertex_count, file.vertices.size(), "vertex");
    require_vertices(file, face, reader);
    switch (face.type) {
      case FaceType::polygon:
      case FaceType::mesh:
        reader.require_range(face.first_mesh_vertex, face.mesh_vertex_count,
                             file.mesh_vertices.size(), "mesh vertex");
        if (face.mesh_vertex_count % 3 != 0) {
          reader.fail("is damaged: a face's mesh vertices are no whole triangles");
        }
        for (std::int32_t i = 0; i < face.mesh_vertex_count; ++i) {
          const auto at = static_cast<std::size_t>(face.first_mesh_vertex + i);
          reader.require_range(file.mesh_vertices[at], 1,
                               static_cast<std::size_t>(face.vertex_count), "vertex of a face");
        }
        break;
      case FaceType::patch: {
        const std::int64_t width = face.size[0];
        const std::int64_t height = face.size[1];
        if (width < 3 || height < 3 || width % 2 == 0 || height % 2 == 0 ||
            width > face.vertex_count || height > face.vertex_count ||
            width * height != face.vertex_count) {
          reader.fail("is damaged: a patch of " + std::to_string(width) + " by " +
                      std::to_string(height) + " control points with " +
                      std::to_string(face.vertex_count) + " vertices");
        }
        break;
      }
      case FaceType::billboard:
        break;
      default:
        reader.fail("is damaged: a face of the unknown type " +
                    std::to_string(static_cast<std::int32_t>(face.type)));
    }
  }
}

void read_visible(File& file, const LumpReader& reader) {
  const std::string data = reader.raw(visible_lump, "visibility sets");
  if (data.empty()) return;
  if (data.size() < 8) reader.fail("is damaged: its visibility sets have no header");
  std::memcpy(&file.cluster_count, data.data(), 4);
  std::memcpy(&file.bytes_per_cluster, data.data() + 4, 4);
  const std::int64_t rows = file.cluster_count;
  const std::int64_t row = file.bytes_per_cluster;
  if (rows < 0 || row < 0 || row * 8 < rows ||
      rows * row + 8 > static_cast<std::int64_t>(data.size())) {
    reader.fail("is damaged: visibility sets of " + std::to_string(rows) + " clusters with " +
                std::to_string(row) + " bytes each do not fit into " + std::to_string(data.size()) +
                " bytes");
  }
  file.visible.assign(data.begin() + 8, data.begin() + 8 + rows * row);
  // Rows are whole bytes; bits beyond the last cluster name none, and nobody behind this looks.
  for (std::int64_t r = 0; r < rows; ++r) {
    const auto begin = file.visible.begin() + static_cast<std::ptrdiff_t>(r * row);
    std::fill(begin + static_cast<std::ptrdiff_t>((rows + 7) / 8),
              begin + static_cast<std::ptrdiff_t>(row), std::uint8_t{0});
    if (rows % 8 != 0) {
      std::uint8_t& last = begin[static_cast<std::ptrdiff_t>(rows / 8)];
      last = static_cast<std::uint8_t>(last & ((1U << (rows % 8)) - 1U));
    }
  }
}

/// A leaf that was damaged into a solid one would be taken for a wall, and all beyond it for
/// hidden. Compilers give solid leaves no area and no face, and number no cluster that has no leaf.
/// (They do leave solid leaves without brushes, in the void around a world.) The leaves that the
/// tree does not reach are the brush models', and one that is empty by custom.
void check_clusters(const File& file, const std::vector<std::uint8_t>& reached,
                    const LumpReader& reader) {
  std::vector<std::uint8_t> used(static_cast<std::size_t>(file.cluster_count), 0);
  for (std::size_t i = 0; i < file.leaves.size(); ++i) {
    const LeafRecord& leaf = file.leaves[i];
    reader.require_range(leaf.first_face, leaf.face_count, file.leaf_faces.size(), "leaf face");
    if (leaf.cluster < -1 || (!file.visible.empty() && leaf.cluster >= file.cluster_count)) {
      reader.fail("is damaged: a leaf in cluster " + std::to_string(leaf.cluster) + " of " +
                  std::to_string(file.cluster_count));
    }
    if (leaf.cluster < 0 && (leaf.face_count > 0 || leaf.area != -1)) {
      reader.fail("is damaged: leaf " + std::to_string(i) +
                  " is in no cluster, so it must be solid, but it has " +
                  std::to_string(leaf.face_count) + " faces and area " + std::to_string(leaf.area) +
                  "; solid leaves have no face and area -1");
    }
    if (reached[i] != 0 && leaf.cluster >= 0 && !file.visible.empty()) {
      used[static_cast<std::size_t>(leaf.cluster)] = 1;
    }
  }
  const auto unused = std::ranges::find(used, std::uint8_t{0});
  if (unused != used.end()) {
    reader.fail("is damaged: no leaf of its BSP tree is in cluster " +
                std::to_string(unused - used.begin()) + " of " +
                std::to_string(file.cluster_count) + "; every cluster must have one");
  }
}

}  // namespace

File read_file(const std::string& bytes, const std::string& where) {
  const LumpReader reader(bytes, where);
  File file;
  file.entities = parse_entities(reader.raw(entities_lump, "entities"), reader);
  file.textures = reader.records<Texture>(textures_lump, "textures");
  file.planes = reader.records<PlaneRecord>(planes_lump, "planes");
  file.nodes = reader.records<NodeRecord>(nodes_lump, "nodes");
  file.leaves = reader.records<LeafRecord>(leaves_lump, "leaves");
  file.leaf_faces = reader.records<std::int32_t>(leaf_faces_lump, "leaf faces");
  file.models = reader.records<ModelRecord>(models_lump, "models");
  file.vertices = reader.records<Vertex>(vertices_lump, "vertices");
  file.mesh_vertices = reader.records<std::int32_t>(mesh_vertices_lump, "mesh vertices");
  file.faces = reader.records<FaceRecord>(faces_lump, "faces");
  read_visible(file, reader);

  const std::vector<std::uint8_t> reached = check_tree(file, reader);
  check_faces(file, reader);
  if (file.models.empty()) reader.fail("has no model; the first one is the world itself");
  check_clusters(file, reached, reader);
  for (const std::int32_t face : file.leaf_faces) {
    reader.require_range(face, 1, file.faces.size(), "face");
  }
  for (const ModelRecord& model : file.models) {
    reader.require_range(model.first_face, model.face_count, file.faces.size(), "face");
  }
  return file;
}

}  // namespace vislab::quake
