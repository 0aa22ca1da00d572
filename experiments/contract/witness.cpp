#include "experiments/contract/witness.h"

#include <algorithm>
#include <vector>

#include "common/judge/disputed.h"
#include "common/render/osmesa_device.h"
#include "common/render/surface_picture.h"

namespace vislab {
namespace {

/// Owners of all pixels, as they should be and as they are, and which of them are wrong.
struct Comparison {
  std::vector<TriangleId> right, drawn;
  std::vector<std::uint8_t> wrong;
};

glm::dvec2 centre_of(std::size_t pixel, const Viewport& viewport) {
  const auto width = static_cast<std::size_t>(viewport.width);
  return {static_cast<double>(pixel % width) + 0.5, static_cast<double>(pixel / width) + 0.5};
}

std::vector<TriangleId> first_hits(RayCaster& caster, const Frame& frame,
                                   const std::vector<glm::dvec2>& places, const VisibleSet& kept) {
  std::vector<TriangleId> triangles;
  for (const RayCaster::Hit& hit : caster.cast(frame, places, &kept)) {
    triangles.push_back(hit.triangle);
  }
  return triangles;
}

Comparison by_rays(Scenario& scenario, const Frame& frame, const VisibleSet& drawn) {
  Comparison images;
  images.right = scenario.truth().frame(frame.index).ids;
  std::vector<glm::dvec2> centres;
  for (std::size_t i = 0; i < images.right.size(); ++i) {
    centres.push_back(centre_of(i, frame.viewport));
  }
  images.drawn = first_hits(scenario.caster(), frame, centres, drawn);
  Disputes disputes(frame, scenario.scene());
  for (std::size_t i = 0; i < images.right.size(); ++i) {
    const TriangleId seen = images.right[i];
    images.wrong.push_back(seen != none_id && !drawn.contains(seen) &&
                           !disputes(centres[i], seen, images.drawn[i]));
  }
  return images;
}

std::vector<TriangleId> ids_of(OsMesaDevice& device, const Scene& scene, const Frame& frame,
                               const VisibleSet& drawn, std::span<const ObjectId> one_sided) {
  std::vector<TriangleRange> ranges;
  for (const ObjectId object : frame.objects.shown) {
    const TriangleId first = scene.first_triangle(object);
    for (TriangleId t = first; t < first + scene.triangle_count(object); ++t) {
      if (drawn.contains(t)) ranges.push_back({object, t - first, 1});
    }
  }
  device.begin_frame(frame);
  device.cull_back_faces(one_sided);
  device.draw_ids(ranges);
  return device.read_ids();
}

Comparison by_device(Scenario& scenario, const Frame& frame, const VisibleSet& drawn,
                     std::span<const ObjectId> one_sided) {
  const Scene& scene = scenario.scene();
  std::vector<VisibleSet::Run> all;
  for (const ObjectId object : frame.objects.shown) {
    all.push_back({scene.first_triangle(object), scene.triangle_count(object)});
  }
  OsMesaDevice device;
  device.load(scene);
  Comparison images;
  images.right = ids_of(device, scene, frame, VisibleSet(std::move(all)), {});
  images.drawn = ids_of(device, scene, frame, drawn, one_sided);
  const std::vector<TriangleId>& rays = scenario.truth().frame(frame.index).ids;
  Disputes disputes(frame, scene, DepthSteps::device);
  for (std::size_t i = 0; i < images.right.size(); ++i) {
    const TriangleId right = images.right[i];
    const TriangleId shown = images.drawn[i];
    images.wrong.push_back(right != shown && !disputes.excuse_pixel(centre_of(i, frame.viewport),
                                                                    right, shown, rays[i]));
  }
  return images;
}

/// A sample of J that lost what it sees: the first undisputed one, or else the first.
std::optional<Witness> lost_sample(Scenario& scenario, const Frame& frame,
                                   const VisibleSet& drawn) {
  std::vector<TriangleId> lost = scenario.truth().frame(frame.index).visible();
  std::erase_if(lost, [&](TriangleId triangle) { return drawn.contains(triangle); });
  const std::vector<RayCaster::Sample> samples = scenario.caster().jittered_hits(frame, lost);
  std::vector<glm::dvec2> places;
  for (const RayCaster::Sample& sample : samples) places.push_back(sample.window_px);
  const std::vector<TriangleId> instead = first_hits(scenario.caster(), frame, places, drawn);
  Disputes disputes(frame, scenario.scene());
  std::optional<Witness> found;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool disputed = disputes(places[i], samples[i].triangle, instead[i]);
    if (found && disputed) continue;
    found.emplace();
    found->window_px = places[i];
    found->triangle = samples[i].triangle;
    found->instead = instead[i];
    if (!disputed) break;
  }
  return found;
}

Image picture_of(const Scenario& scenario, const Frame& frame, const Comparison& images,
                 const Witness& witness, SeenBy judge, const std::string& title) {
  const auto x = static_cast<int>(witness.window_px.x);
  const auto y = static_cast<int>(witness.window_px.y);
  const std::string pixel = "pixel " + std::to_string(x) + ", " + std::to_string(y);
  const char* const seen = judge == SeenBy::rays ? "as rays see it" : "as the device draws it";
  const std::vector<SurfacePanel> panels{
      {"Right", seen, images.right, {}},
      {"Without what was left out", seen, images.drawn, {}},
      {"Where it is wrong", "the first: " + pixel + " from the lower left", images.right,
       images.wrong}};
  return render_surface_picture(
      scenario.scene(), frame.viewport,
      title + ", " + scenario.name() + ", frame " + std::to_string(frame.index), panels);
}

}  // namespace

std::optional<Witness> find_witness(Scenario& scenario, std::size_t index, const VisibleSet& drawn,
                                    std::span<const ObjectId> one_sided, SeenBy judge,
                                    const std::string& title) {
  const Frame frame = scenario.frame(index);
  Comparison images = judge == SeenBy::rays ? by_rays(scenario, frame, drawn)
                                            : by_device(scenario, frame, drawn, one_sided);
  std::optional<Witness> witness;
  const auto first = std::ranges::find(images.wrong, 1);
  if (first != images.wrong.end()) {
    const auto pixel = static_cast<std::size_t>(first - images.wrong.begin());
    witness.emplace();
    witness->window_px = centre_of(pixel, frame.viewport);
    witness->triangle = images.right[pixel];
    witness->instead = images.drawn[pixel];
    witness->wrong_px = static_cast<std::uint64_t>(std::ranges::count(images.wrong, 1));
  } else if (judge == SeenBy::rays) {
    witness = lost_sample(scenario, frame, drawn);
    if (!witness) return witness;
    const auto pixel = static_cast<std::size_t>(witness->window_px.y) *
                           static_cast<std::size_t>(frame.viewport.width) +
                       static_cast<std::size_t>(witness->window_px.x);
    images.wrong.at(std::min(pixel, images.wrong.size() - 1)) = 1;
  } else {
    return witness;
  }
  witness->scene = scenario.name();
  witness->frame = index;
  if (witness->triangle != none_id) witness->object = scenario.scene().object_of(witness->triangle);
  witness->picture = picture_of(scenario, frame, images, *witness, judge, title);
  return witness;
}

}  // namespace vislab
