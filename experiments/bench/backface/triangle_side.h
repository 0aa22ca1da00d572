// A culler of triangles, or a chain of them, as one side of a contest.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "algorithms/all_cullers.h"
#include "algorithms/backface/back_bits.h"
#include "common/culler/culler.h"

namespace vislab {

/// Built, and called as the first stage of a chain is.
class TriangleSide {
 public:
  /// The scene outlives it.
  TriangleSide(const std::string& spec, const Scene& scene) : scene_(&scene) {
    register_all_cullers(registry_);
    culler_ = registry_.make(spec);
    BuildContext context;
    context.cullers = &registry_;
    culler_->build(scene, context);
    culler_->reset(1);
  }

  const ICuller& culler() const { return *culler_; }
  void cull(const Frame& frame) {
    sink_.runs.clear();
    culler_->cull(frame, Candidates::everything(), sink_);
  }
  /// Bits of the triangles of object 0 that the last cull() left out.
  std::vector<std::uint64_t> left_out() const {
    using namespace backface_culling;
    const std::uint32_t count = scene_->triangle_count(0);
    std::vector<std::uint64_t> bits(words_of(count), 0);
    for (const std::span<const TriangleRange> run : sink_.runs) {
      for (const TriangleRange& range : run) {
        if (range.object == 0) set_bits(bits, range.first, range.count);
      }
    }
    for (std::uint64_t& word : bits) word = ~word;
    if (count % 64 != 0) bits.back() &= (std::uint64_t{1} << (count % 64)) - 1;
    return bits;
  }

 private:
  struct Sink : DrawSink {
    std::vector<std::span<const TriangleRange>> runs;

    void everything() override { throw std::logic_error("a culler of the bench kept everything"); }
    void objects(std::span<const ObjectId>) override {
      throw std::logic_error("a culler of the bench kept whole objects");
    }
    void ranges(std::span<const TriangleRange> ranges) override { runs.push_back(ranges); }
    void flush() override {}
  };

  const Scene* scene_;
  Registry registry_;
  std::unique_ptr<ICuller> culler_;
  Sink sink_;
};

}  // namespace vislab
