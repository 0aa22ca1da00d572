#include "common/render/colored_view.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "common/render/osmesa_device.h"
#include "common/scene/transform.h"

namespace vislab {
namespace {

constexpr Color left_away = {0, 0, 0};
constexpr double edge_shade = 0.45;

constexpr std::array<Color, cycled_colors> colors = {{{230, 159, 0},
                                                      {0, 114, 178},
                                                      {240, 228, 66},
                                                      {213, 94, 0},
                                                      {86, 180, 233},
                                                      {0, 158, 115},
                                                      {204, 121, 167}}};

/// What a device sees: the triangle of each pixel and its depth, rows from below.
struct Layer {
  std::vector<std::uint32_t> triangles;
  std::vector<float> depths;
};

Layer seen(const Scene& scene, const Frame& frame, std::span<const ObjectId> objects,
           bool only_front_faces) {
  OsMesaDevice device;
  device.load(scene);
  device.begin_frame(frame);
  if (only_front_faces) device.cull_back_faces(objects);
  std::vector<TriangleRange> ranges;
  ranges.reserve(objects.size());
  for (const ObjectId object : objects) ranges.push_back({object, 0, scene.triangle_count(object)});
  device.draw_ids(ranges);
  return {device.read_ids(), device.read_depth()};
}

/// How much light a triangle gets that comes from the eye. Little is taken away, for colours are to
/// be told apart.
double shade_of(const Camera& camera, const Mesh& mesh, const glm::dmat4x3& transform,
                std::uint32_t triangle) {
  const auto corners = world_triangle(mesh, transform, triangle);
  const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const glm::dvec3 light = camera.lens.projection == Projection::orthographic
                               ? camera.pose.back
                               : camera.pose.eye - corners[0];
  const double lengths = glm::length(normal) * glm::length(light);
  const double facing = lengths > 0.0 ? std::abs(glm::dot(normal, light)) / lengths : 0.0;
  return 0.7 + 0.3 * facing;
}

Color shaded(const Color& color, double share) {
  Color result{};
  for (std::size_t k = 0; k < 3; ++k) {
    result[k] = static_cast<std::uint8_t>(std::lround(color[k] * share));
  }
  return result;
}

/// A cube from -1 to 1, stretched to each box. Flat boxes get a thousandth of their size.
Scene scene_of(std::span<const ColoredBox> boxes) {
  Scene scene;
  scene.name = "boxes";
  Mesh cube;
  cube.name = "cube";
  for (int i = 0; i < 8; ++i) {
    cube.positions.emplace_back((i & 1) != 0 ? 1.0F : -1.0F, (i & 2) != 0 ? 1.0F : -1.0F,
                                (i & 4) != 0 ? 1.0F : -1.0F);
  }
  cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  scene.meshes.push_back(cube);
  for (const ColoredBox& box : boxes) {
    const glm::dvec3 half = box.box.half_size();
    const double longest = std::max({half.x, half.y, half.z, 1e-6});
    const glm::dvec3 size = glm::max(half, glm::dvec3(1e-3 * longest));
    Object object;
    object.transform = glm::dmat4x3(glm::dvec3(size.x, 0.0, 0.0), glm::dvec3(0.0, size.y, 0.0),
                                    glm::dvec3(0.0, 0.0, size.z), box.box.center());
    scene.objects.push_back(object);
  }
  scene.finish();
  return scene;
}

/// Which of a cube's faces a pixel shows; faces are pairs of triangles.
std::uint32_t face_at(const Layer& layer, std::size_t pixel) {
  const std::uint32_t triangle = layer.triangles[pixel];
  return triangle == none_id ? none_id : triangle / 2;
}

class Picture {
 public:
  explicit Picture(const Viewport& viewport) : viewport_(viewport) {
    image_.width = viewport.width;
    image_.height = viewport.height;
    image_.rgb.resize(std::size_t{3} * viewport.width * viewport.height);
    depths_.assign(std::size_t{1} * viewport.width * viewport.height, 2.0F);
    for (std::size_t pixel = 0; pixel < depths_.size(); ++pixel) set(pixel, background_color);
  }

  std::size_t pixels() const { return depths_.size(); }
  /// `pixel` counts rows from below.
  void draw(std::size_t pixel, float depth, const Color& color) {
    if (depth >= depths_[pixel]) return;
    depths_[pixel] = depth;
    set(pixel, color);
  }
  Image take() { return std::move(image_); }

 private:
  void set(std::size_t pixel, const Color& color) {
    const auto width = static_cast<std::size_t>(viewport_.width);
    const std::size_t row = static_cast<std::size_t>(viewport_.height) - 1 - pixel / width;
    std::ranges::copy(
        color, image_.rgb.begin() + static_cast<std::ptrdiff_t>(3 * (row * width + pixel % width)));
  }

  Viewport viewport_;
  Image image_;
  std::vector<float> depths_;
};

void draw_objects(const Scene& scene, const Frame& frame, std::span<const Color> object_colors,
                  bool only_front_faces, Picture& picture) {
  std::vector<ObjectId> drawn;
  for (const ObjectId object : frame.objects.shown) {
    if (object_colors[object] != left_away) drawn.push_back(object);
  }
  if (drawn.empty()) return;
  const Layer layer = seen(scene, frame, drawn, only_front_faces);
  for (std::size_t pixel = 0; pixel < picture.pixels(); ++pixel) {
    const TriangleId triangle = layer.triangles[pixel];
    if (triangle == none_id) continue;
    const ObjectId object = scene.object_of(triangle);
    const double shade =
        shade_of(frame.camera, scene.mesh_of(object), frame.objects.transforms[object],
                 triangle - scene.first_triangle(object));
    picture.draw(pixel, layer.depths[pixel], shaded(object_colors[object], shade));
  }
}

void draw_boxes(const Frame& frame, std::span<const ColoredBox> all, Picture& picture) {
  std::vector<ColoredBox> boxes;
  for (const ColoredBox& box : all) {
    if (box.box.valid()) boxes.push_back(box);
  }
  if (boxes.empty()) return;
  const Scene scene = scene_of(boxes);
  const SceneState state(scene);
  Frame placed = frame;
  placed.objects = state.view();
  const Layer layer = seen(scene, placed, placed.objects.shown, false);
  const auto width = static_cast<std::size_t>(frame.viewport.width);
  for (std::size_t pixel = 0; pixel < picture.pixels(); ++pixel) {
    const TriangleId triangle = layer.triangles[pixel];
    if (triangle == none_id) continue;
    const ObjectId box = scene.object_of(triangle);
    const bool on_edge = (pixel % width > 0 && face_at(layer, pixel - 1) != triangle / 2) ||
                         (pixel >= width && face_at(layer, pixel - width) != triangle / 2);
    const double shade =
        on_edge ? edge_shade
                : shade_of(frame.camera, scene.mesh_of(box), placed.objects.transforms[box],
                           triangle - scene.first_triangle(box));
    picture.draw(pixel, layer.depths[pixel], shaded(boxes[box].color, shade));
  }
}

}  // namespace

Color cycled_color(std::size_t index) { return colors[index % colors.size()]; }

Image draw_colored(const Scene& scene, const Frame& frame, std::span<const Color> object_colors,
                   std::span<const ColoredBox> boxes, bool only_front_faces) {
  if (object_colors.size() != scene.object_count()) {
    throw std::logic_error("draw_colored: a colour for each object is needed");
  }
  Picture picture(frame.viewport);
  draw_objects(scene, frame, object_colors, only_front_faces, picture);
  draw_boxes(frame, boxes, picture);
  return picture.take();
}

}  // namespace vislab
