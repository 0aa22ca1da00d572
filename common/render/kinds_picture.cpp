#include "common/render/kinds_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "common/render/canvas.h"
#include "common/render/osmesa_device.h"
#include "common/render/outside_view.h"

namespace vislab {
namespace {

constexpr Color paper = {255, 255, 255};
constexpr Color ink = {20, 20, 20};
constexpr Color grey = {110, 110, 110};
constexpr Color frustum_colour = {255, 255, 255};

// On paper a picture is about 17 cm wide, and a letter of 22 pixels one of 7 points.
constexpr double margin = 16.0;
constexpr double title_height = 50.0;
constexpr double title_size = 28.0;
constexpr double letter = 22.0;
constexpr int outside_width = 1000;
constexpr int outside_height = 760;
constexpr int eye_width = 420;
constexpr double legend_row = 62.0;
constexpr int supersampling = 2;
constexpr double surroundings = 0.1;     // shown around what is seen, of its diagonal
constexpr double largest_shown = 0.6;    // of all; larger objects do not count for what is shown
constexpr double headroom_m = 0.3;       // above the eye, where a scene with cells is cut
constexpr double longest_frustum = 0.6;  // of what is shown, along the view

constexpr std::array<Color, culling_kind_count> colours = {{{86, 180, 233},
                                                            {150, 150, 150},
                                                            {0, 158, 115},
                                                            {240, 228, 66},
                                                            {213, 94, 0},
                                                            {204, 121, 167}}};
constexpr std::array<const char*, culling_kind_count> names = {
    "drawn", "view frustum", "portal", "back-face", "occlusion", "detail"};

struct Region {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};

  void extend(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  glm::dvec3 corner(int i) const {
    return {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
            (i & 4) != 0 ? high.z : low.z};
  }
};

/// Ground that reaches to the border of everything would make all else small.
bool is_ground(const Aabb& box, const Region& all) {
  return glm::length(glm::dvec3(box.max) - glm::dvec3(box.min)) >
         largest_shown * glm::length(all.high - all.low);
}

/// What is in sight and some of what lies around it.
Region region_of(const KindsPictureInput& input) {
  const Scene& scene = *input.scene;
  const ObjectsView& objects = input.frame->objects;
  Region all;
  for (const ObjectId object : objects.shown) {
    all.extend(glm::dvec3(objects.bounds[object].min));
    all.extend(glm::dvec3(objects.bounds[object].max));
  }
  Region seen;
  for (const ObjectId object : objects.shown) {
    if (is_ground(objects.bounds[object], all)) continue;
    const Mesh& mesh = scene.mesh_of(object);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const CullingKind kind = input.kinds[scene.first_triangle(object) + i];
      if (kind != CullingKind::drawn && kind != CullingKind::detail) continue;
      for (const glm::dvec3& corner : world_triangle(mesh, objects.transforms[object], i)) {
        seen.extend(corner);
      }
    }
  }
  const glm::dvec3& eye = input.frame->camera.pose.eye;
  if (glm::any(glm::greaterThan(seen.low, seen.high))) seen = all;
  all.extend(eye);
  seen.extend(eye);
  const double around = surroundings * glm::length(seen.high - seen.low);
  return {glm::max(seen.low - around, all.low), glm::min(seen.high + around, all.high)};
}

/// Looks back at the eye from above and ahead of it, a little from the right.
Camera outside_camera(const Camera& seen, const Region& region, double aspect) {
  const glm::dvec3 up(0.0, 1.0, 0.0);
  glm::dvec3 ahead = -seen.pose.back - up * glm::dot(-seen.pose.back, up);
  ahead = glm::length(ahead) > 1e-6 ? glm::normalize(ahead) : seen.pose.up;
  const glm::dvec3 aside = glm::cross(ahead, up);
  const glm::dvec3 direction = glm::normalize(0.55 * ahead + 0.3 * aside + 1.2 * up);
  const glm::dvec3 center = 0.5 * (region.low + region.high);
  const double fov_y = 0.5;
  const double tan_y = std::tan(0.5 * fov_y);
  Camera camera;
  camera.pose = look_at(center + direction, center);
  double distance = 0.0;
  double radius = 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 offset = region.corner(i) - center;
    const double across = std::max(std::abs(glm::dot(offset, camera.pose.right)) / (tan_y * aspect),
                                   std::abs(glm::dot(offset, camera.pose.up)) / tan_y);
    distance = std::max(distance, across + glm::dot(offset, camera.pose.back));
    radius = std::max(radius, glm::length(offset));
  }
  distance *= 1.03;
  camera.pose.eye = center + direction * distance;
  camera.lens = perspective_lens(fov_y, aspect, 0.02 * distance, distance + 20.0 * radius);
  return camera;
}

/// The triangles to draw from outside: without what would hide the rooms of a scene with cells.
std::vector<TriangleRange> ranges_below(const KindsPictureInput& input, double ceiling) {
  std::vector<TriangleRange> ranges;
  const Scene& scene = *input.scene;
  for (const ObjectId object : input.frame->objects.shown) {
    const Mesh& mesh = scene.mesh_of(object);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      double lowest = std::numeric_limits<double>::infinity();
      for (const glm::dvec3& corner :
           world_triangle(mesh, input.frame->objects.transforms[object], i)) {
        lowest = std::min(lowest, corner.y);
      }
      if (lowest > ceiling) continue;
      if (!ranges.empty() && ranges.back().object == object &&
          ranges.back().first + ranges.back().count == i) {
        ++ranges.back().count;
      } else {
        ranges.push_back({object, i, 1});
      }
    }
  }
  return ranges;
}

/// Little light is taken away, for colours are to be told apart.
double shade_of(const Camera& camera, const std::array<glm::dvec3, 3>& corners) {
  const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const glm::dvec3 light = camera.lens.projection == Projection::orthographic
                               ? camera.pose.back
                               : camera.pose.eye - corners[0];
  const double lengths = glm::length(normal) * glm::length(light);
  return 0.68 + 0.32 * (lengths > 0.0 ? std::abs(glm::dot(normal, light)) / lengths : 0.0);
}

/// Drawn larger and averaged.
Image draw(const KindsPictureInput& input, const Camera& camera, const Viewport& viewport,
           const std::vector<TriangleRange>& ranges, bool only_front_faces) {
  Frame frame = *input.frame;
  frame.camera = camera;
  frame.viewport = {supersampling * viewport.width, supersampling * viewport.height};
  OsMesaDevice device;
  device.load(*input.scene);
  device.begin_frame(frame);
  if (only_front_faces) device.cull_back_faces(frame.objects.shown);
  device.draw_ids(ranges);
  const std::vector<std::uint32_t> ids = device.read_ids();
  Image image{viewport.width, viewport.height, {}};
  for (int y = viewport.height - 1; y >= 0; --y) {
    for (int x = 0; x < viewport.width; ++x) {
      std::array<double, 3> sum{};
      for (int k = 0; k < supersampling * supersampling; ++k) {
        const auto row = static_cast<std::size_t>(supersampling * y + k / supersampling);
        const auto column = static_cast<std::size_t>(supersampling * x + k % supersampling);
        const TriangleId id = ids[row * static_cast<std::size_t>(frame.viewport.width) + column];
        Color color = background_color;
        double shade = 1.0;
        if (id != none_id) {
          const ObjectId object = input.scene->object_of(id);
          color = colours[static_cast<std::size_t>(input.kinds[id])];
          shade = shade_of(
              camera, world_triangle(input.scene->mesh_of(object), frame.objects.transforms[object],
                                     id - input.scene->first_triangle(object)));
        }
        for (std::size_t c = 0; c < 3; ++c) sum[c] += shade * color[c];
      }
      for (const double channel : sum) {
        image.rgb.push_back(
            static_cast<std::uint8_t>(std::lround(channel / (supersampling * supersampling))));
      }
    }
  }
  return image;
}

void draw_frustum(Canvas& canvas, const Camera& outside, const Camera& seen, double depth,
                  double left, double top) {
  const Viewport viewport{outside_width, outside_height};
  const glm::dvec2 corner(left, top);
  WindowLine line{};
  canvas.clip(left, top, outside_width, outside_height);
  for (const auto& [from, to] : frustum_edges(seen, depth)) {
    if (project_line(outside, viewport, from, to, line)) {
      canvas.line(corner + line.from, corner + line.to, frustum_colour, 2.0);
    }
  }
  if (project_line(outside, viewport, seen.pose.eye, seen.pose.eye, line)) {
    canvas.disc(corner + line.from, 8.0, frustum_colour);
  }
  canvas.unclip();
}

}  // namespace

Image render_kinds_picture(const KindsPictureInput& input) {
  if (input.scene == nullptr || input.frame == nullptr ||
      input.kinds.size() != input.scene->triangle_count()) {
    throw std::logic_error("render_kinds_picture: a kind for each triangle is needed");
  }
  const Camera& seen = input.frame->camera;
  const double infinite = std::numeric_limits<double>::infinity();
  const double ceiling = input.scene->cells.empty() ? infinite : seen.pose.eye.y + headroom_m;
  const Region region = region_of(input);
  const Camera outside =
      outside_camera(seen, region, static_cast<double>(outside_width) / outside_height);
  const Image outside_image =
      draw(input, outside, {outside_width, outside_height}, ranges_below(input, ceiling), true);
  const Viewport& viewport = input.frame->viewport;
  const int eye_height = std::max(1, eye_width * viewport.height / viewport.width);
  const Image eye_image =
      draw(input, seen, {eye_width, eye_height}, ranges_below(input, infinite), false);

  const double top = title_height + letter + 8.0;
  const double right = 2.0 * margin + outside_width;
  const double legend_top = top + eye_height + margin;
  const double height =
      std::max(top + outside_height, legend_top + legend_row * culling_kind_count) + margin;
  Canvas canvas(static_cast<int>(right + eye_width + margin), static_cast<int>(height), paper);
  canvas.text(margin, 34.0, right + eye_width - 2.0 * margin, title_size, true, input.title);
  canvas.text(margin, top - 8.0, outside_width, letter, false,
              "from outside; white: the eye and its view frustum");
  canvas.text(right, top - 8.0, eye_width, letter, false, "from the eye");
  canvas.picture(outside_image, {0, 0}, {outside_width, outside_height}, margin, top, outside_width,
                 outside_height);
  canvas.picture(eye_image, {0, 0}, {eye_width, eye_height}, right, top, eye_width, eye_height);
  const double depth = std::min(
      seen.lens.far_m,
      std::max(2.0 * seen.lens.near_m, longest_frustum * glm::length(region.high - region.low)));
  draw_frustum(canvas, outside, seen, depth, margin, top);
  for (std::size_t i = 0; i < culling_kind_count; ++i) {
    const double y = legend_top + legend_row * static_cast<double>(i);
    canvas.fill(right, y, 40.0, 26.0, colours[i]);
    canvas.outline(right, y, 40.0, 26.0, grey, 1.0);
    canvas.text(right + 52.0, y + 20.0, eye_width - 52.0, letter, true, names[i]);
    canvas.text(right + 52.0, y + 45.0, eye_width - 52.0, letter, false, input.notes[i]);
  }
  canvas.outline(margin, top, outside_width, outside_height, ink, 1.0);
  return canvas.image();
}

}  // namespace vislab
