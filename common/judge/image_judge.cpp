#include "common/judge/image_judge.h"

#include <algorithm>
#include <stdexcept>

#include "common/render/osmesa_device.h"

namespace vislab {

struct ImageJudge::Impl {
  const Scene& scene;
  OsMesaDevice device;
  std::vector<TriangleRange> ranges;
  std::vector<TriangleId> full;  // ids of the full image
  const FrameTruth* truth = nullptr;

  explicit Impl(const Scene& s) : scene(s) { device.load(scene); }

  std::vector<TriangleId> draw(const Frame& frame, std::span<const ObjectId> one_sided) {
    device.begin_frame(frame);
    device.cull_back_faces(one_sided);
    device.draw_ids(ranges);
    return device.read_ids();
  }

  /// Number of differing pixels: disputed, undisputed.
  std::array<std::uint64_t, 2> compare(const Frame& frame,
                                       const std::vector<TriangleId>& ids) const {
    if (truth == nullptr || full.size() != ids.size() || full.size() != truth->ids.size()) {
      throw std::logic_error("the image judge was not started on this frame");
    }
    std::array<std::uint64_t, 2> counts{};
    Disputes disputes(frame, scene, DepthSteps::device);
    const auto width = static_cast<std::size_t>(frame.viewport.width);
    for (std::size_t i = 0; i < full.size(); ++i) {
      if (full[i] == ids[i]) continue;
      const glm::dvec2 window_px(static_cast<double>(i % width) + 0.5,
                                 static_cast<double>(i / width) + 0.5);
      ++counts[disputes.excuse_pixel(window_px, full[i], ids[i], truth->ids[i]) ? 0 : 1];
    }
    return counts;
  }
};

ImageJudge::ImageJudge(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}

ImageJudge::~ImageJudge() = default;

void ImageJudge::start(const Frame& frame, const FrameTruth& truth) {
  impl_->truth = &truth;
  impl_->ranges.clear();
  for (const ObjectId object : frame.objects.shown) {
    impl_->ranges.push_back({object, 0, impl_->scene.triangle_count(object)});
  }
  impl_->full = impl_->draw(frame, {});
}

ShownImage ImageJudge::full_image() const { return {impl_->full, DepthSteps::device}; }

ImageVerdict ImageJudge::judge(const Frame& frame, const VisibleSet& kept,
                               std::span<const ObjectId> one_sided) {
  const Scene& scene = impl_->scene;
  impl_->ranges.clear();
  for (const VisibleSet::Run& run : kept.runs()) {
    // A run may go on through several objects.
    for (std::uint32_t done = 0; done < run.count;) {
      const ObjectId object = scene.object_of(run.first + done);
      const std::uint32_t first = run.first + done - scene.first_triangle(object);
      const std::uint32_t count = std::min(run.count - done, scene.triangle_count(object) - first);
      impl_->ranges.push_back({object, first, count});
      done += count;
    }
  }
  const auto [disputed, undisputed] = impl_->compare(frame, impl_->draw(frame, one_sided));
  return {undisputed, disputed};
}

ImageJudge::Floor ImageJudge::error_floor(const Frame& frame) {
  const auto [disputed, undisputed] = impl_->compare(frame, impl_->truth->ids);
  return {disputed, undisputed};
}

ShownImage shown_image(Guarantee guarantee, std::span<const TriangleId> painted,
                       const ImageJudge* device) {
  if (!painted.empty()) return {painted};
  if (guarantee == Guarantee::image_exact && device != nullptr) return device->full_image();
  return {};
}

}  // namespace vislab
