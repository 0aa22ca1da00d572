// What a culler is offered and what it emits: objects or ranges of triangles, never copied.
#pragma once

#include <span>

#include "common/scene/frame.h"

namespace vislab {

/// What a culler may keep in one call of cull(). A view: the spans belong to whoever offers them
/// and hold until that call returns. No object or triangle is offered twice in a frame.
class Candidates {
 public:
  enum class Form { everything, objects, ranges };

  /// All objects that are shown now. O(1).
  static Candidates everything() { return {}; }
  /// The objects of these runs, in this order. A subtree of a hierarchy is one run.
  static Candidates of(std::span<const std::span<const ObjectId>> runs) {
    Candidates c;
    c.form_ = Form::objects;
    c.objects_ = runs;
    return c;
  }
  /// The triangles of these runs, in this order.
  static Candidates of(std::span<const std::span<const TriangleRange>> runs) {
    Candidates c;
    c.form_ = Form::ranges;
    c.ranges_ = runs;
    return c;
  }

  Form form() const { return form_; }
  /// Runs of objects; only for Form::objects.
  std::span<const std::span<const ObjectId>> object_runs() const { return objects_; }
  /// Runs of ranges; only for Form::ranges.
  std::span<const std::span<const TriangleRange>> range_runs() const { return ranges_; }

 private:
  Form form_ = Form::everything;
  std::span<const std::span<const ObjectId>> objects_;
  std::span<const std::span<const TriangleRange>> ranges_;
};

/// Calls f(std::span<const ObjectId>) for every run of candidate objects. For cullers of object
/// granularity, which are never offered ranges.
template <typename Function>
void for_each_object_run(const Candidates& candidates, const Frame& frame, Function&& f) {
  if (candidates.form() == Candidates::Form::everything) {
    f(frame.objects.shown);
  } else {
    for (std::span<const ObjectId> run : candidates.object_runs()) f(run);
  }
}

/// Calls f(TriangleRange) for every candidate, whole objects as one range each. For cullers of
/// triangle granularity.
template <typename Function>
void for_each_range(const Candidates& candidates, const Frame& frame, const Scene& scene,
                    Function&& f) {
  if (candidates.form() == Candidates::Form::ranges) {
    for (std::span<const TriangleRange> run : candidates.range_runs()) {
      for (const TriangleRange& range : run) f(range);
    }
    return;
  }
  for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
    for (const ObjectId object : run) f(TriangleRange{object, 0, scene.triangle_count(object)});
  });
}

/// Takes what a culler keeps, in draw order. Called from the thread of cull() only.
///
/// A culler emits a subset of its candidates, each triangle at most once. The spans it hands over
/// stay valid until flush() or until the emitter's next cull() or update().
class DrawSink {
 public:
  virtual ~DrawSink() = default;

  /// Everything offered is kept, in one word: only if the candidates were everything, and as the
  /// only emission of the call.
  virtual void everything() = 0;
  virtual void objects(std::span<const ObjectId> ids) = 0;
  virtual void ranges(std::span<const TriangleRange> ranges) = 0;
  /// When it returns, everything emitted has passed the later stages of the chain and, where the
  /// run draws, has been handed to the device. Only for stages that need an answer from the device.
  virtual void flush() = 0;
};

}  // namespace vislab
