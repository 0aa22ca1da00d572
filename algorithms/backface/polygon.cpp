// backface.polygon: leaves out triangles that face away from the eye, one test a triangle.
//
// Idea: a triangle of a closed solid that is seen from behind is hidden by the solid itself. The
//   eye (orthographic: the direction to the viewer) is taken into the mesh's frame once per object.
//   An affine map takes the inside of a solid to the inside of its image, so turned, sheared,
//   scaled and mirrored objects need nothing else. What is asked of a triangle is the choice
//   `form`: hesse          Is the eye behind its plane? Planes are stored, four floats each.
//   computed       The sign of n.v, v from the eye to a vertex, with the normal of eq. 2.1 made of
//                  the vertices each time. With vertices counter-clockwise seen from outside, as
//                  here, that normal points inward, and n.v < 0 says back.
//   stored_normal  The same with a stored normal (three floats) and a vertex of the mesh.
//   vertex_normals The textbook's rule where vertices have normals of their own: back only if all
//                  three point away. (Its wire drawing turns that round and draws an edge if one of
//                  its vertices is seen.) Normals are sums over the triangles around a vertex, each
//                  as long as its area.
// Guarantee: conservative. Only solid meshes are tested: closed, outward and free of
//   self-intersection (other meshes are kept whole, unless open=cull; a surface that crosses itself
//   can show its back to the outside, as those of the scenes cow and man do). A triangle goes only
//   if the eye is behind its plane by more than the error of the test, and an object that may hold
//   the eye or be cut by the near plane is kept whole. A triangle seen exactly edge-on is kept: the
//   textbook and Zachmann's slide 8 call it front, his slide 20 calls it back.
//   vertex_normals is approximate: in hollows all three normals can point away from an eye that
//   sees the triangle's front.
// Cost: O(candidate triangles); one 3 x 3 inverse an object. Memory: hesse 16 bytes a triangle of a
//   mesh, computed none, stored_normal 12 bytes a triangle, vertex_normals 12 bytes a vertex;
//   instances share it.
// Limits: of a solid from far away half of the faces, from near by more; nothing for meshes that
//   are open or cross or touch themselves anywhere; does not see that objects hide each other.
//   Short runs of kept triangles make long lists of ranges.
// Sources: textbook chapter 17, Culling (in German), 17.1 (Hesse form; e = 0 is front; normals of
//   vertices); Zachmann slides 7-10; Kowalka 2016, 2.2.2, eq. 2.1 (normal of a polygon).

#include <algorithm>
#include <limits>

#include "algorithms/backface/plane_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.polygon";
  info.family = "backface";
  info.summary =
      "Leaves out the triangles of solid meshes that face away from the eye, by one plane test a "
      "triangle in the mesh's own frame.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  info.parameters = {
      ParameterSpec::choice(
          "form", "hesse", {"hesse", "computed", "stored_normal", "vertex_normals"},
          ParameterSpec::Stage::build,
          "what is asked of a triangle: hesse its stored plane; computed its normal, made of the "
          "vertices each time, without memory; stored_normal its stored normal and a vertex; "
          "vertex_normals the stored normals of its vertices, which all have to point away, and "
          "sometimes do where its front is seen"),
      open_parameter()};
  info.cost = "O(candidate triangles): one plane test each, and a 3 x 3 inverse an object";
  info.limits =
      "Of a solid from far away half of the faces at best, from near by more; keeps meshes that "
      "are open or cross themselves, and "
      "objects around the eye, whole. With open=cull the backs that such meshes show disappear; "
      "with form=vertex_normals front faces in hollows do.";
  info.sources = {
      "Textbook chapter 17, Culling (in German), 17.1: back faces from the Hesse form of their "
      "planes",
      "Zachmann, Computer-Graphik 2, SS 2012, slides 7-10",
      "Kowalka 2016 (thesis, HAW Hamburg), 2.2.2, eq. 2.1"};
  return info;
}

CullerInfo describe_approximate() {
  CullerInfo info = describe();
  info.guarantee = Guarantee::approximate;
  return info;
}

/// From a point of the mesh to the eye; orthographic: the direction to the viewer.
glm::dvec3 to_eye(const MeshEye& eye, const MeshFrame& frame, const glm::vec3& point) {
  return glm::dvec3(eye.position) - eye.position.w * (glm::dvec3(point) - frame.middle);
}

class CountingCuller : public FacingCuller {
 public:
  using FacingCuller::FacingCuller;
  Counters counters() const override { return {{"triangles_tested", triangles_tested_}}; }

 protected:
  void mark_range(const ObjectView& view, std::uint32_t first, std::uint32_t count,
                  std::uint64_t* back) final {
    triangles_tested_ += count;
    mark(view, first, count, back);
  }
  virtual void mark(const ObjectView& view, std::uint32_t first, std::uint32_t count,
                    std::uint64_t* back) = 0;

 private:
  std::uint64_t triangles_tested_ = 0;
};

class Hesse : public PlaneCuller {
 public:
  explicit Hesse(bool cull_open) : PlaneCuller(describe(), cull_open) {}

 protected:
  std::optional<PlaneTest> find_eye(const ObjectView& view, const MeshFrame& frame) override {
    return plane_test(view.eye, frame);
  }
};

/// Triangle by triangle in double.
template <typename Behind>
void mark_each(std::uint32_t first, std::uint32_t count, std::uint64_t* back, Behind&& behind) {
  std::fill_n(back, words_of(count), 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    back[i / 64] |= std::uint64_t{behind(first + i)} << (i % 64);
  }
}

class Computed : public CountingCuller {
 public:
  explicit Computed(bool cull_open) : CountingCuller(describe(), cull_open) {}

 protected:
  void clear() override {}
  void add_mesh(MeshId, const Mesh&, const MeshFrame&, const BuildContext&) override {}
  void mark(const ObjectView& view, std::uint32_t first, std::uint32_t count,
            std::uint64_t* back) override {
    const Mesh& mesh = scene().meshes[view.mesh];
    const MeshFrame& frame = frame_of(view.mesh);
    const double limit = behind_limit(view.eye, frame);
    mark_each(first, count, back, [&](std::uint32_t triangle) {
      const glm::uvec3& corners = mesh.triangles[triangle];
      const glm::vec3& v2 = mesh.positions[corners.z];
      const glm::dvec3 a = glm::dvec3(mesh.positions[corners.y]) - glm::dvec3(v2);
      const glm::dvec3 b = glm::dvec3(mesh.positions[corners.x]) - glm::dvec3(v2);
      const glm::dvec3 forward(a.y * b.z, a.z * b.x, a.x * b.y);
      const glm::dvec3 backward(a.z * b.y, a.x * b.z, a.y * b.x);
      const glm::dvec3 sizes = glm::abs(forward) + glm::abs(backward);
      // n.v with v = v2 - eye; its error is that of scaled_plane times what that divides by.
      const double value = -glm::dot(forward - backward, to_eye(view.eye, frame, v2));
      return value < -limit * (sizes.x + sizes.y + sizes.z);
    });
  }
  std::size_t mesh_bytes() const override { return 0; }
};

class StoredNormal : public CountingCuller {
 public:
  explicit StoredNormal(bool cull_open) : CountingCuller(describe(), cull_open) {}

 protected:
  void clear() override {
    first_.clear();
    normals_.clear();
  }
  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame, const BuildContext&) override {
    first_.resize(id + 1);
    first_[id] = normals_.size();
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      normals_.emplace_back(glm::dvec3(scaled_plane(mesh, frame, i)));
    }
  }
  void mark(const ObjectView& view, std::uint32_t first, std::uint32_t count,
            std::uint64_t* back) override {
    const Mesh& mesh = scene().meshes[view.mesh];
    const MeshFrame& frame = frame_of(view.mesh);
    const glm::vec3* normals = normals_.data() + first_[view.mesh];
    // The normal's rounding to float, half an epsilon at most, comes on top; twice that is taken.
    const double reach = view.eye.magnitude() + view.eye.position.w * frame.size;
    const double limit =
        behind_limit(view.eye, frame) + std::numeric_limits<float>::epsilon() * reach;
    mark_each(first, count, back, [&](std::uint32_t triangle) {
      const glm::vec3& vertex = mesh.positions[mesh.triangles[triangle].x];
      return glm::dot(glm::dvec3(normals[triangle]), to_eye(view.eye, frame, vertex)) < -limit;
    });
  }
  std::size_t mesh_bytes() const override {
    return normals_.capacity() * sizeof(glm::vec3) + first_.capacity() * sizeof(std::size_t);
  }

 private:
  std::vector<std::size_t> first_;  // by mesh, in normals_
  std::vector<glm::vec3> normals_;  // by triangle
};

class VertexNormals : public CountingCuller {
 public:
  explicit VertexNormals(bool cull_open) : CountingCuller(describe_approximate(), cull_open) {}

 protected:
  void clear() override {
    first_.clear();
    normals_.clear();
  }
  void add_mesh(MeshId id, const Mesh& mesh, const MeshFrame&, const BuildContext&) override {
    first_.resize(id + 1);
    first_[id] = normals_.size();
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
    for (const glm::uvec3& corners : mesh.triangles) {
      const glm::dvec3 a(mesh.positions[corners.x]);
      const glm::dvec3 normal = glm::cross(glm::dvec3(mesh.positions[corners.y]) - a,
                                           glm::dvec3(mesh.positions[corners.z]) - a);
      for (int corner = 0; corner < 3; ++corner) sums[corners[corner]] += normal;
    }
    for (const glm::dvec3& sum : sums) {
      const double length = glm::length(sum);
      normals_.emplace_back(length > 0.0 ? sum / length : sum);
    }
  }
  void mark(const ObjectView& view, std::uint32_t first, std::uint32_t count,
            std::uint64_t* back) override {
    const Mesh& mesh = scene().meshes[view.mesh];
    const MeshFrame& frame = frame_of(view.mesh);
    const glm::vec3* normals = normals_.data() + first_[view.mesh];
    const auto away = [&](std::uint32_t vertex) {
      return glm::dot(glm::dvec3(normals[vertex]),
                      to_eye(view.eye, frame, mesh.positions[vertex])) < 0.0;
    };
    mark_each(first, count, back, [&](std::uint32_t triangle) {
      const glm::uvec3& corners = mesh.triangles[triangle];
      return away(corners.x) && away(corners.y) && away(corners.z);
    });
  }
  std::size_t mesh_bytes() const override {
    return normals_.capacity() * sizeof(glm::vec3) + first_.capacity() * sizeof(std::size_t);
  }

 private:
  std::vector<std::size_t> first_;  // by mesh, in normals_
  std::vector<glm::vec3> normals_;  // by vertex
};

}  // namespace

namespace cullers {

CullerEntry backface_polygon() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            const bool open = culls_open(values);
            const std::string& form = values.choice("form");
            if (form == "computed") return std::make_unique<Computed>(open);
            if (form == "stored_normal") return std::make_unique<StoredNormal>(open);
            if (form == "vertex_normals") return std::make_unique<VertexNormals>(open);
            return std::make_unique<Hesse>(open);
          }};
}

}  // namespace cullers
}  // namespace vislab
