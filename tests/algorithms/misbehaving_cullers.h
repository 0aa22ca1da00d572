// Cullers that break one rule of the contract each, so that the contract check itself is tested.
// Test-only.
#pragma once

#include <memory>

#include "common/culler/registry.h"
#include "common/scene/error.h"

namespace vislab {

enum class Misdeed {
  emits_twice,           // the first object twice
  emits_unoffered,       // object 0, offered or not
  emits_everything,      // says "everything" when it was offered a part
  forgets_declared,      // every second answer is empty, but declared stateless
  depends_on_threads,    // with two threads it leaves everything out
  allocates,             // in each call of cull()
  overwrites_emission,   // changes the memory behind a span that it emitted
  has_poor_sets,         // of cells: empty ones
  needs_device_silently  // refuses to build without a device, but does not declare it
};

class MisbehavingCuller : public ICuller {
 public:
  explicit MisbehavingCuller(Misdeed misdeed) : misdeed_(misdeed) {
    // It keeps all that it is offered.
    if (misdeed == Misdeed::has_poor_sets) info_.guarantee = Guarantee::conservative;
  }

  static CullerInfo describe() {
    CullerInfo info;
    info.name = "misbehaving";
    info.family = "misbehaving";
    info.summary = "Breaks one rule.";
    info.guarantee = Guarantee::approximate;
    info.cost = "O(candidates)";
    info.limits = "Breaks one rule.";
    info.sources = {"tests"};
    return info;
  }

  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext& context) override;
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override;
  bool region(CellId cell, DrawSink&) override {
    return misdeed_ == Misdeed::has_poor_sets && cell < cell_count_;
  }

 private:
  CullerInfo info_ = describe();
  Misdeed misdeed_;
  int threads_ = 1;
  std::size_t cell_count_ = 0;
  std::uint64_t calls_ = 0;
  std::vector<ObjectId> kept_;
};

inline void MisbehavingCuller::build(const Scene& scene, const BuildContext& context) {
  if (misdeed_ == Misdeed::needs_device_silently && context.device == nullptr) {
    throw InputError("misbehaving: it wants a device");
  }
  threads_ = context.threads;
  cell_count_ = scene.cells.size();
  kept_.reserve(scene.object_count() + 1);
}

inline void MisbehavingCuller::cull(const Frame& frame, const Candidates& candidates,
                                    DrawSink& out) {
  kept_.clear();
  for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
    kept_.insert(kept_.end(), run.begin(), run.end());
  });
  ++calls_;
  switch (misdeed_) {
    case Misdeed::emits_twice:
      if (!kept_.empty()) kept_.push_back(kept_.front());
      break;
    case Misdeed::emits_unoffered:
      kept_.assign(1, 0);
      break;
    case Misdeed::emits_everything:
      out.everything();
      return;
    case Misdeed::forgets_declared:
      if (calls_ % 2 == 0) kept_.clear();
      break;
    case Misdeed::depends_on_threads:
      if (threads_ > 1) kept_.clear();
      break;
    case Misdeed::allocates:
      std::vector<ObjectId>(kept_).swap(kept_);
      kept_.reserve(kept_.size() + 64);
      break;
    case Misdeed::overwrites_emission:
      out.objects(kept_);
      for (ObjectId& object : kept_) object = kept_.front();
      return;
    case Misdeed::has_poor_sets:
    case Misdeed::needs_device_silently:
      break;
  }
  out.objects(kept_);
}

}  // namespace vislab
