// The frames that a modelled graphics processor is fitted to OSMesa with.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/render/device.h"

namespace vislab {

/// A scene of few meshes and many objects, half of which the camera does not see, and frames of it.
class FitWorks {
 public:
  FitWorks();
  FitWorks(const FitWorks&) = delete;
  FitWorks& operator=(const FitWorks&) = delete;

  const Scene& scene() const { return scene_; }
  const Frame& frame() const { return frame_; }

  struct Step {
    enum class Kind { draw, ask, flush, read } kind = Kind::draw;
    std::vector<ObjectId> objects = {};  // to draw
    std::vector<Aabb> boxes = {};        // of one query
  };
  struct Work {
    std::string name;
    std::vector<Step> steps;
  };
  const std::vector<Work>& works() const { return works_; }

 private:
  void add_objects();
  void add_drawings();
  void add_queries();

  Scene scene_;
  std::unique_ptr<SceneState> state_;
  Frame frame_;
  std::vector<Work> works_;
};

/// Draws and asks; `submitted` is called before the first wait. Waits for all that was asked, and
/// for the end.
template <typename Function>
void run_work(RenderDevice& device, const Frame& frame, const FitWorks::Work& work,
              Function&& submitted) {
  device.begin_frame(frame);
  std::vector<QueryId> asked;
  bool told = false;
  const auto tell = [&] {
    if (!told) submitted();
    told = true;
  };
  for (const FitWorks::Step& step : work.steps) {
    switch (step.kind) {
      case FitWorks::Step::Kind::draw:
        device.draw(std::span<const ObjectId>(step.objects));
        break;
      case FitWorks::Step::Kind::ask:
        asked.push_back(device.query(step.boxes));
        break;
      case FitWorks::Step::Kind::flush:
        tell();
        device.flush();
        break;
      case FitWorks::Step::Kind::read:
        tell();
        for (const QueryId query : asked) device.samples(query);
        asked.clear();
        break;
    }
  }
  tell();
  device.finish();
}

}  // namespace vislab
