// portal.frustum: narrowed frusta in space.
//
// Idea: a portal is clipped in space by the planes of the frustum that it is seen through; the
//   planes through the eye and the edges of what remains are the frustum behind it, whose near
//   plane is the portal's own.
// Guarantee: conservative. Planes are taken as moved outward, edges too short to have a direction
//   give no plane, and a portal that more planes have cut than there is room for is not cut by
//   more, which only keeps more.
// Cost: as the walk (portal_walk.h), with one clip of a polygon in space by at most `most_sides`
//   planes for each portal.
// Limits: those of portal.polygon; and a box beside a corner of what is left of the view, which is
//   outside of none of its planes by itself, is kept, where portal.polygon asks the upright
//   rectangle too. The near plane leaves out what lies before a portal, which only matters where
//   objects reach out of cells.
// Sources: Luebke and Georges 1995, figure 5 ("portal culling frustums"); Zachmann slides 77-89.

#include <algorithm>
#include <array>

#include "algorithms/portal/convex_cut.h"
#include "algorithms/portal/portal_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace portal_culling;

/// By how much planes are taken as moved outward, and by how much more for each metre before the
/// eye: what the rounding of corners makes of a plane through the eye.
constexpr double plane_slack_m = 1e-6;
constexpr double plane_slack_per_metre = 1e-6;
/// The least sine of the angle that an edge is seen under for its plane to be made.
constexpr double least_sine = 1e-9;

/// Corners relative to the eye, counter-clockwise seen from it.
struct SpacePolygon {
  static constexpr std::uint32_t capacity = 24;

  std::array<glm::dvec3, capacity> corners;
  std::uint32_t count = 0;

  /// False if it is as a whole outside.
  bool cut(const Plane& plane) {
    std::array<double, capacity> distance;
    for (std::uint32_t i = 0; i < count; ++i) distance[i] = plane.signed_distance(corners[i]);
    std::array<glm::dvec3, capacity> kept;
    std::uint32_t kept_count = 0;
    const Cut cut = cut_convex<glm::dvec3>(std::span(corners).first(count),
                                           std::span(distance).first(count), kept, kept_count);
    if (cut == Cut::in_two) {
      std::copy_n(kept.begin(), kept_count, corners.begin());
      count = kept_count;
    }
    return cut != Cut::all_outside;
  }
};

/// Planes relative to the eye, moved outward.
struct NarrowFrustum {
  static constexpr std::uint32_t most_sides = SpacePolygon::capacity;

  std::array<Plane, most_sides> sides;
  std::uint32_t side_count = 0;
  Plane near;
};

class FrustumRule {
 public:
  using View = NarrowFrustum;

  void build(const PortalGraph& graph) { graph_ = &graph; }

  void start(const Camera& camera) {
    camera_ = camera;
    forward_ = -camera.pose.back;
    whole_.near = {forward_, plane_slack_m - camera.lens.near_m};
    whole_.side_count = 0;
    const Lens& lens = camera.lens;
    SpacePolygon window;
    for (const glm::dvec2& p :
         {glm::dvec2(lens.left, lens.bottom), glm::dvec2(lens.right, lens.bottom),
          glm::dvec2(lens.right, lens.top), glm::dvec2(lens.left, lens.top)}) {
      window.corners[window.count++] =
          camera.pose.right * p.x + camera.pose.up * p.y + forward_ * lens.near_m;
    }
    add_sides(window, whole_);
  }

  void whole(View& view) const { view = whole_; }

  bool narrow(std::uint32_t id, const View& view, View& left) {
    const Opening& opening = graph_->opening(id);
    const std::span<const glm::dvec3> corners = graph_->corners(opening);
    left.near = {-opening.plane.normal,
                 plane_slack_m - opening.plane.signed_distance(camera_.pose.eye)};
    left.side_count = 0;
    if (corners.size() > SpacePolygon::capacity) {
      std::copy_n(view.sides.begin(), view.side_count, left.sides.begin());
      left.side_count = view.side_count;
      return true;
    }
    SpacePolygon polygon;
    for (const glm::dvec3& corner : corners) {
      polygon.corners[polygon.count++] = corner - camera_.pose.eye;
    }
    if (!polygon.cut(whole_.near) || !polygon.cut(view.near)) return false;
    for (std::uint32_t i = 0; i < view.side_count; ++i) {
      if (!polygon.cut(view.sides[i])) return false;
    }
    add_sides(polygon, left);
    return true;
  }

  void prepare(const View& view) { asked_ = &view; }
  bool meets(const Aabb& box) const {
    const auto outside = [&](const Plane& plane) {
      return plane.signed_distance(p_vertex(plane, box) - camera_.pose.eye) < 0.0;
    };
    if (outside(asked_->near)) return false;
    for (std::uint32_t i = 0; i < asked_->side_count; ++i) {
      if (outside(asked_->sides[i])) return false;
    }
    return true;
  }
  std::size_t bytes() const { return 0; }

 private:
  /// The planes through the polygon's edges and the eye (for orthographic cameras: along the view).
  void add_sides(const SpacePolygon& polygon, View& view) const {
    const bool perspective = camera_.lens.projection == Projection::perspective;
    for (std::uint32_t i = 0; i < polygon.count; ++i) {
      const glm::dvec3& a = polygon.corners[i];
      const glm::dvec3& b = polygon.corners[i + 1 == polygon.count ? 0 : i + 1];
      const glm::dvec3 normal = perspective ? glm::cross(b, a) : glm::cross(b - a, forward_);
      const double length = glm::length(normal);
      const double scale = perspective ? glm::length(a) * glm::length(b) : 1.0;
      if (!(length > least_sine * scale)) continue;
      // Leaning outward: a slack that grows with the distance before the eye.
      Plane side{normal / length + forward_ * (perspective ? plane_slack_per_metre : 0.0),
                 plane_slack_m};
      if (!perspective) side.d -= glm::dot(side.normal, a);
      view.sides[view.side_count++] = side;
    }
  }

  const PortalGraph* graph_ = nullptr;
  Camera camera_;
  glm::dvec3 forward_{0.0, 0.0, -1.0};
  NarrowFrustum whole_;
  const NarrowFrustum* asked_ = nullptr;
};

CullerInfo describe() {
  CullerInfo info = portal_culler_info("portal.frustum");
  info.summary =
      "Follows portals from cell to cell with a frustum in space, narrowed to the planes through "
      "the eye and the portal's edges, and keeps the objects whose boxes reach into it.";
  info.cost =
      "a clip of a polygon in space for each way through a portal that is open to the "
      "view, and a test of the box for each object of the cells beyond";
  info.limits =
      std::string("Keeps boxes beside the corners of doors that are rolled. ") + limits_of_walks;
  return info;
}

}  // namespace

namespace cullers {

CullerEntry portal_frustum() {
  return {describe(), [](const ParameterValues&) {
            return std::make_unique<WalkingCuller<FrustumRule>>(describe());
          }};
}

}  // namespace cullers
}  // namespace vislab
