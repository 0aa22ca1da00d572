#include <array>

#include "common/judge/metrics.h"

namespace vislab {

std::span<const Metric> metrics() {
  using enum Metric::Better;
  static constexpr std::array table = {
      Metric{"false_px", "pixels", lower, "undisputed truth pixels whose triangle was left out"},
      Metric{"max_false_px", "pixels", lower, "most false pixels on a single object or triangle"},
      Metric{"false_objects", "count", lower,
             "visible in truth and left out: all undisputed samples lost"},
      Metric{"false_triangles", "count", lower,
             "visible in truth and left out: at least one undisputed sample lost"},
      Metric{"false_jittered", "samples", lower,
             "undisputed jittered samples whose triangle was left out"},
      Metric{"image_px", "pixels", lower, "undisputed ids that differ from the unculled image"},
      Metric{"disputed_image_px", "pixels", lower,
             "disputed ids that differ from the unculled image: excused, not false"},
      Metric{"surface_px", "pixels", lower,
             "undisputed pixels that a hidden-surface algorithm's own image gives to another "
             "triangle than truth"},
      Metric{"disputed_surface_px", "pixels", lower,
             "disputed pixels of that image: excused, not false"},
      Metric{"excused_px", "samples", lower,
             "disputed samples whose triangle was left out: excused, not false"},
      Metric{"disputed_px", "pixels", neither,
             "the error floor: pixels where rays and rasteriser may rightly differ"},
      Metric{"over", "ratio", lower, "triangles kept but invisible / truly visible"},
      Metric{"over_objects", "ratio", lower, "objects kept but invisible / truly visible"},
      Metric{"under", "ratio", lower, "triangles visible but left out / truly visible"},
      Metric{"region_misses", "rays", lower,
             "rays from sampled viewpoints of a cell that hit an object which is not in the cell's "
             "set"},
      Metric{"region_over", "ratio", lower,
             "objects in the cells' sets that no ray from the cell hits / objects that are hit; an "
             "upper bound"},
      Metric{"region_over_points", "ratio", lower,
             "objects in the cells' sets that no ray from a viewpoint hits / objects that are hit, "
             "summed over viewpoints; what a set for a whole cell costs"},
      Metric{"recall", "ratio", higher,
             "culled / cullable by a perfect method of its kind: back faces, what lies outside the "
             "frustum, or (all other methods) what is not visible"},
      Metric{"flicker", "toggles per frame", lower,
             "changes of an object's verdict that truth does not make / (frames - 1)"},
      Metric{"pop", "pixel frames", lower,
             "pixels missing after the true appearance, summed over frames"},
      Metric{"latency", "frames", lower,
             "most frames that an object is missing after its true appearance"},
      Metric{"build_ms", "ms", lower, "preprocessing"},
      Metric{"update_us", "us", lower, "per-frame update before the first cull"},
      Metric{"cull_us", "us", lower, "deciding what to draw"},
      Metric{"draw_ms", "ms", lower, "time inside calls of the device"},
      Metric{"frame_ms", "ms", lower, "wall time from update until everything is drawn"},
      Metric{"frame_ms_deviation", "ms", lower,
             "standard deviation of frame_ms over all frames but the first, and all rounds"},
      Metric{"modelled_frame_ms", "ms", lower,
             "test cost + submitted triangles * calibrated cost; for methods that use the device "
             "frame time / none's * that of none; not wall time"},
      Metric{"bytes", "bytes", lower, "memory of what build made"},
      Metric{"submitted_triangles", "count", lower, "triangles handed to the device"},
      Metric{"efficiency", "ratio", higher,
             "frame time of the oracle of the same level / frame time of the method, paired"},
  };
  return table;
}

}  // namespace vislab
