#include "common/scene/quake_faces.h"

#include "common/scene/weld.h"

namespace vislab::quake {
namespace {

constexpr std::int32_t not_drawn_flag = 0x80;  // SURF_NODRAW

/// Cells along each side of a biquadratic patch. Neighbours share control points and this number,
/// so their common edges get the same vertices.
constexpr int cells_per_patch = 4;

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.triangles.emplace_back(a, c, b);  // clockwise in the file
}

void add_polygons(const File& file, const FaceRecord& face, Mesh& mesh) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::int32_t i = 0; i < face.vertex_count; ++i) {
    mesh.positions.push_back(
        to_lab(file.vertices[static_cast<std::size_t>(face.first_vertex + i)].position));
  }
  const auto vertex = [&](std::int32_t i) {
    const auto at = static_cast<std::size_t>(face.first_mesh_vertex + i);
    return base + static_cast<std::uint32_t>(file.mesh_vertices[at]);
  };
  for (std::int32_t i = 0; i < face.mesh_vertex_count; i += 3) {
    add_triangle(mesh, vertex(i), vertex(i + 1), vertex(i + 2));
  }
}

/// A quadratic Bezier curve at k / cells_per_patch. The weights are multiples of 1/16 and the sum
/// is in double, so that a curve run through backwards gives the same points.
glm::dvec3 curve_point(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int k) {
  const double t = static_cast<double>(k) / cells_per_patch;
  const double s = 1.0 - t;
  return a * (s * s) + c * (t * t) + b * (2.0 * s * t);
}

void add_patch(const File& file, const FaceRecord& face, Mesh& mesh) {
  const int width = face.size[0];
  const int height = face.size[1];
  const auto control = [&](int column, int row) {
    const auto at = static_cast<std::size_t>(face.first_vertex + row * width + column);
    return glm::dvec3(to_lab(file.vertices[at].position));
  };
  const int columns = (width - 1) / 2 * cells_per_patch + 1;
  const int rows = (height - 1) / 2 * cells_per_patch + 1;
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (int row = 0; row < rows; ++row) {
    // The last point of one patch is the first of the next; both give the same.
    const int patch_row = std::min(row / cells_per_patch, (height - 3) / 2);
    const int k_row = row - patch_row * cells_per_patch;
    for (int column = 0; column < columns; ++column) {
      const int patch_column = std::min(column / cells_per_patch, (width - 3) / 2);
      const int k_column = column - patch_column * cells_per_patch;
      glm::dvec3 across[3];
      for (int i = 0; i < 3; ++i) {
        const int control_row = 2 * patch_row + i;
        across[i] = curve_point(control(2 * patch_column, control_row),
                                control(2 * patch_column + 1, control_row),
                                control(2 * patch_column + 2, control_row), k_column);
      }
      mesh.positions.emplace_back(curve_point(across[0], across[1], across[2], k_row));
    }
  }
  const auto vertex = [&](int column, int row) {
    return base + static_cast<std::uint32_t>(row * columns + column);
  };
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const std::uint32_t a = vertex(column, row);
      const std::uint32_t b = vertex(column + 1, row);
      const std::uint32_t c = vertex(column + 1, row + 1);
      const std::uint32_t d = vertex(column, row + 1);
      add_triangle(mesh, a, b, c);
      add_triangle(mesh, a, c, d);
    }
  }
}

bool collapsed(const glm::uvec3& t) { return t.x == t.y || t.y == t.z || t.z == t.x; }

}  // namespace

glm::vec3 to_lab(const Vector& p) {
  constexpr float scale = 1.0F / 32.0F;
  return {p[0] * scale, p[2] * scale, -p[1] * scale};
}

bool is_drawn(const File& file, std::int32_t face) {
  const FaceRecord& record = file.faces[static_cast<std::size_t>(face)];
  const Texture& texture = file.textures[static_cast<std::size_t>(record.texture)];
  return (texture.flags & not_drawn_flag) == 0 && record.type != FaceType::billboard;
}

Mesh mesh_of_faces(const File& file, const std::vector<std::int32_t>& faces) {
  Mesh raw;
  std::vector<std::uint8_t> of_patch;  // by triangle
  for (const std::int32_t index : faces) {
    if (!is_drawn(file, index)) continue;
    const FaceRecord& face = file.faces[static_cast<std::size_t>(index)];
    const bool patch = face.type == FaceType::patch;
    if (patch) {
      add_patch(file, face, raw);
    } else {
      add_polygons(file, face, raw);
    }
    of_patch.resize(raw.triangles.size(), patch ? 1 : 0);
  }

  Mesh mesh;
  const std::vector<std::uint32_t> representative = weld_positions(raw.positions);
  std::vector<std::uint32_t> renumbered(raw.positions.size());
  for (std::size_t v = 0; v < raw.positions.size(); ++v) {
    if (representative[v] == v) {
      renumbered[v] = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(raw.positions[v]);
    } else {
      renumbered[v] = renumbered[representative[v]];
    }
  }
  for (std::size_t t = 0; t < raw.triangles.size(); ++t) {
    const glm::uvec3& old = raw.triangles[t];
    const glm::uvec3 triangle(renumbered[old.x], renumbered[old.y], renumbered[old.z]);
    // A patch whose edge is drawn together to a point has cells without area there.
    if (of_patch[t] != 0 && collapsed(triangle)) continue;
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace vislab::quake
