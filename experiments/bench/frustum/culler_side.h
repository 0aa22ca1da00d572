// A culler of the registry as one side of a contest.
#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "algorithms/all_cullers.h"
#include "common/culler/culler.h"

namespace vislab {

/// The ids of all runs, in one list.
inline std::vector<ObjectId> joined(std::span<const std::span<const ObjectId>> runs) {
  std::vector<ObjectId> ids;
  for (const std::span<const ObjectId> run : runs) ids.insert(ids.end(), run.begin(), run.end());
  return ids;
}

/// One bit an object in the order of ids, 64 to a word. Throws std::logic_error if an id comes
/// twice.
inline std::vector<std::uint64_t> bits_of(std::span<const ObjectId> ids, std::size_t count) {
  std::vector<std::uint64_t> words((count + 63) / 64, 0);
  for (const ObjectId object : ids) {
    const std::uint64_t bit = std::uint64_t{1} << (object % 64);
    if ((words[object / 64] & bit) != 0) throw std::logic_error("an object was kept twice");
    words[object / 64] |= bit;
  }
  return words;
}

/// Built, and called as the first stage of a chain is.
class CullerSide {
 public:
  /// The scene outlives it.
  CullerSide(const std::string& spec, const Scene& scene) {
    register_all_cullers(registry_);
    culler_ = registry_.make(spec);
    BuildContext context;
    context.cullers = &registry_;
    culler_->build(scene, context);
    culler_->reset(1);
  }

  void update(const Frame& frame, const Changes& changes) { culler_->update(frame, changes); }
  void cull(const Frame& frame) {
    sink_.runs.clear();
    culler_->cull(frame, Candidates::everything(), sink_);
  }
  /// What the last cull() kept.
  std::span<const std::span<const ObjectId>> runs() const { return sink_.runs; }

 private:
  struct Sink : DrawSink {
    std::vector<std::span<const ObjectId>> runs;

    void everything() override { throw std::logic_error("a culler of the bench kept everything"); }
    void objects(std::span<const ObjectId> ids) override { runs.push_back(ids); }
    void ranges(std::span<const TriangleRange>) override {
      throw std::logic_error("a culler of the bench emitted triangles");
    }
    void flush() override {}
  };

  Registry registry_;
  std::unique_ptr<ICuller> culler_;
  Sink sink_;
};

}  // namespace vislab
