#include "common/scene/mesh_import.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <cstring>

#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

const std::string tetrahedron_off =
    "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string tetrahedron_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string tetrahedron_obj =
    "# four faces\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf -3 -2 -1\n";

std::string binary_ply() {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nelement face 4\n"
      "property list uchar int vertex_indices\nend_header\n";
  const float positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  bytes.append(reinterpret_cast<const char*>(positions), sizeof positions);
  for (const auto& face : {std::array<std::int32_t, 3>{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    bytes += '\3';
    bytes.append(reinterpret_cast<const char*>(face.data()), sizeof face);
  }
  return bytes;
}

std::string binary_stl() {
  std::string bytes(84, '\0');
  bytes[80] = 1;
  const float facet[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  bytes.append(reinterpret_cast<const char*>(facet), sizeof facet);
  bytes.append(2, '\0');
  return bytes;
}

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

class MeshImport : public testing::Test {
 protected:
  Scene import(const std::string& name, const std::string& content) {
    Scene scene = import_mesh_file(folder_.write(name, content));
    scene.finish();
    return scene;
  }
  std::string refused(const std::string& name, const std::string& content) {
    const std::filesystem::path file = folder_.write(name, content);
    std::string message = input_error([&]() {
      Scene scene = import_mesh_file(file);
      scene.finish();
    });
    return message;
  }
  /// Cuts the content at every length and expects that no cut passes for the whole mesh.
  void expect_no_cut_passes(const std::string& name, const std::string& content,
                            std::size_t shortest_whole) {
    for (std::size_t size = 1; size < shortest_whole; size += 1 + size / 40) {
      SCOPED_TRACE(size);
      EXPECT_TRUE(says(refused(name, content.substr(0, size)), name));
    }
  }

  TemporaryFolder folder_;
};

/// The corners of all triangles in their order: what a file says, whatever numbers its vertices
/// get.
std::vector<glm::vec3> corners_of(const Scene& scene) {
  std::vector<glm::vec3> corners;
  for (const glm::uvec3& triangle : scene.meshes[0].triangles) {
    for (int i = 0; i < 3; ++i) corners.push_back(scene.meshes[0].positions[triangle[i]]);
  }
  return corners;
}

TEST_F(MeshImport, ReadsTheSameTetrahedronFromEveryFormat) {
  const std::vector<glm::vec3> expected = corners_of(import("t.off", tetrahedron_off));
  EXPECT_EQ(corners_of(import("t.ply", tetrahedron_ply)), expected);
  EXPECT_EQ(corners_of(import("t.obj", tetrahedron_obj)), expected);
  EXPECT_EQ(corners_of(import("b.ply", binary_ply())), expected);
  EXPECT_EQ(corners_of(import("t.ply.gz", gzipped(tetrahedron_ply))), expected);
  EXPECT_EQ(corners_of(import("T.OFF", tetrahedron_off)), expected);
}

TEST_F(MeshImport, SkipsTheByteOrderMarkOfAnObjFile) {
  const std::string text = tetrahedron_obj.substr(tetrahedron_obj.find('v'));
  const std::vector<glm::vec3> expected = corners_of(import("plain.obj", text));
  const std::string marked = "\xEF\xBB\xBF" + text;
  EXPECT_EQ(corners_of(import("marked.obj", marked)), expected);
  EXPECT_EQ(corners_of(import("marked.obj.gz", gzipped(marked))), expected);
}

TEST_F(MeshImport, JoinsVerticesAndKeepsTriangles) {
  const Scene scene = import("t.off", tetrahedron_off);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].positions.size(), 4U);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 4U);
  EXPECT_TRUE(scene.meshes[0].closed);
}

TEST_F(MeshImport, KeepsVerticesApartThatAreNotAtEqualPositions) {
  std::string small = tetrahedron_off;
  for (std::size_t at = 0; (at = small.find('1', at)) != std::string::npos; ++at) {
    // Only coordinates: the corners of faces come after the fourth vertex.
    if (at > small.find("0 0 1")) break;
    small.replace(at, 1, "1e-9");
  }
  EXPECT_EQ(import("small.off", small).meshes[0].positions.size(), 4U);
}

TEST_F(MeshImport, CutsPolygonsIntoTriangles) {
  const Scene scene = import("q.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  EXPECT_EQ(scene.triangle_count(), 2U);
  EXPECT_EQ(scene.report.open_meshes, 1U);
}

TEST_F(MeshImport, MakesNodesObjectsThatShareTheirMeshEvenMirrored) {
  std::string buffer;
  const float positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::uint16_t indices[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  buffer.append(reinterpret_cast<const char*>(positions), sizeof positions);
  buffer.append(reinterpret_cast<const char*>(indices), sizeof indices);
  folder_.write("buffer.bin", buffer);
  const Scene scene = import("scene.gltf", R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2]}],
    "nodes": [{"mesh": 0, "translation": [5, 0, 0], "children": [1]},
              {"mesh": 0, "scale": [2, 2, 2]},
              {"mesh": 0, "scale": [-1, 1, 1]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "buffers": [{"uri": "buffer.bin", "byteLength": 72}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                    {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 1]},
                  {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]})");
  ASSERT_EQ(scene.object_count(), 3U);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_TRUE(scene.meshes[0].closed);
  EXPECT_EQ(scene.objects[1].transform * glm::dvec4(1.0, 0.0, 0.0, 1.0), glm::dvec3(7.0, 0.0, 0.0));
  EXPECT_FLOAT_EQ(scene.bounds().min.x, -1.0F);
}

TEST_F(MeshImport, RefusesTruncatedFiles) {
  expect_no_cut_passes("t.off", tetrahedron_off, tetrahedron_off.size() - 1);
  expect_no_cut_passes("t.ply", tetrahedron_ply, tetrahedron_ply.size() - 1);
  expect_no_cut_passes("b.ply", binary_ply(), binary_ply().size());
  expect_no_cut_passes("t.stl", binary_stl(), binary_stl().size());
  const std::string packed = gzipped(tetrahedron_ply);
  expect_no_cut_passes("t.ply.gz", packed, packed.size());
}

TEST_F(MeshImport, RefusesObjFilesThatEndWithinAFace) {
  EXPECT_TRUE(says(refused("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2"), "three corners"));
  EXPECT_TRUE(says(refused("u.obj", "v 0 0 0\nv 1 0"), "vertex 2 is not three numbers"));
}

TEST_F(MeshImport, RefusesIndicesOutOfRange) {
  const std::string out_of_range = "is out of range";
  EXPECT_TRUE(says(refused("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), out_of_range));
  EXPECT_TRUE(says(refused("b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), out_of_range));
  EXPECT_TRUE(says(refused("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), out_of_range));
  EXPECT_TRUE(says(refused("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"), out_of_range));
  EXPECT_TRUE(says(refused("e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n"), out_of_range));
  std::string ply = tetrahedron_ply;
  ply.replace(ply.find("3 1 2 3"), 7, "3 1 2 4");
  EXPECT_TRUE(says(refused("f.ply", ply), out_of_range));
  std::string binary = binary_ply();
  binary[binary.size() - 1] = '\x7f';
  EXPECT_TRUE(says(refused("g.ply", binary), out_of_range));
}

TEST_F(MeshImport, RefusesUsedVerticesThatAreNotFinite) {
  for (const std::string bad : {"nan", "inf", "-inf", "1e999"}) {
    std::string ply = tetrahedron_ply;
    ply.replace(ply.find("1 0 0"), 1, bad);
    EXPECT_TRUE(says(refused("n.ply", ply), "NaN or infinite")) << bad;
  }
  std::string binary = binary_ply();
  const std::uint32_t not_a_number = 0x7fc00000;
  std::memcpy(binary.data() + binary.find("end_header\n") + 11, &not_a_number, 4);
  EXPECT_TRUE(says(refused("b.ply", binary), "NaN or infinite"));
}

TEST_F(MeshImport, CountsUnusedVerticesThatAreNotFinite) {
  std::string ply = tetrahedron_ply;
  ply.replace(ply.find("vertex 4"), 8, "vertex 5");
  ply.replace(ply.find("0 0 1\n"), 6, "0 0 1\nnan nan nan\n");
  const Scene scene = import("unused.ply", ply);
  EXPECT_EQ(scene.report.unused_bad_vertices, 1U);
  EXPECT_EQ(scene.content_hash(), import("t.ply", tetrahedron_ply).content_hash());
}

TEST_F(MeshImport, RefusesFilesWithoutATriangle) {
  EXPECT_TRUE(says(refused("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), "points.off"));
  EXPECT_TRUE(says(refused("nothing.obj", "# nothing\n"), "nothing.obj"));
}

TEST_F(MeshImport, RefusesWhatIsNotAFile) {
  EXPECT_TRUE(says(input_error([&]() { import_mesh_file(folder_.path() / "absent.ply"); }),
                   "does not exist"));
  EXPECT_TRUE(says(input_error([&]() { import_mesh_file(folder_.path()); }), "is a directory"));
  EXPECT_TRUE(says(refused("empty.ply", ""), "is empty"));
  const std::filesystem::path pipe = folder_.path() / "pipe.ply";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_TRUE(says(input_error([&]() { import_mesh_file(pipe); }), "not a regular file"));
}

TEST_F(MeshImport, RefusesFormatsThatNobodyReads) {
  EXPECT_TRUE(says(refused("notes.txt", "hello\n"), "cannot be imported"));
  EXPECT_TRUE(says(refused("notes", "hello\n"), "no extension"));
  EXPECT_TRUE(says(refused("wrong.ply", "hello\n"), "begins with the line ply"));
  EXPECT_TRUE(says(refused("wrong.ply.gz", "hello\n"), "not whole gzip data"));
  EXPECT_TRUE(says(refused("wrong.gltf", "{\"asset\": "), "cannot be imported"));
}

TEST_F(MeshImport, SurvivesAnImporterThatHangs) {
  // Nobody ever writes into the pipe that the importer opens as the materials of the mesh.
  ASSERT_EQ(mkfifo((folder_.path() / "pipe.mtl").c_str(), 0600), 0);
  const std::filesystem::path file =
      folder_.write("hanging.obj", "mtllib pipe.mtl\n" + tetrahedron_obj);
  EXPECT_TRUE(says(input_error([&]() { import_mesh_file(file, 1); }), "did not finish within 1 s"));
}

TEST_F(MeshImport, SurvivesAnImporterThatCrashes) {
  // Nodes nested so deep that the importer's recursion leaves its stack.
  std::string nodes = "{\"mesh\": 0}";
  constexpr int depth = 300'000;
  for (int i = 1; i < depth; ++i) nodes += ",{\"children\": [" + std::to_string(i - 1) + "]}";
  const std::string gltf =
      "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [" +
      std::to_string(depth - 1) + "]}], \"nodes\": [" + nodes + "]}";
  EXPECT_TRUE(says(refused("deep.gltf", gltf), "cannot be imported: it "));
}

TEST_F(MeshImport, DoesNotBelieveHeadersThatPromiseTheSky) {
  std::string ply = tetrahedron_ply;
  ply.replace(ply.find("vertex 4"), 8, "vertex 4000000000");
  EXPECT_TRUE(says(refused("sky.ply", ply), "the header promises 4000000000"));
  EXPECT_TRUE(says(refused("sky.off", "OFF\n4000000000 1 0\n0 0 0\n"), "promises 4000000000"));
}

}  // namespace
}  // namespace vislab
