#include "experiments/contract/contract_sink.h"

namespace vislab {

using Pause = AllocationCounter::Pause;

void ContractSink::start(const Scene& scene, const Frame& frame, const Candidates& candidates,
                         RenderDevice* device) {
  scene_ = &scene;
  frame_ = &frame;
  device_ = device;
  offered_everything_ = candidates.form() == Candidates::Form::everything;
  everything_ = false;
  thread_ = std::this_thread::get_id();
  emissions_ = 0;
  pending_.clear();
  emitted_.clear();
  fault_.clear();
}

void ContractSink::everything() {
  const Pause pause;
  if (!offered_everything_) blame("it emitted everything, but was offered a part");
  if (emissions_ > 0) blame("everything was not its only emission");
  emission();
  everything_ = true;
  pending_.push_back({frame_->objects.shown, {}});
}

void ContractSink::objects(std::span<const ObjectId> ids) {
  const Pause pause;
  emission();
  pending_.push_back({ids, {}});
}

void ContractSink::ranges(std::span<const TriangleRange> ranges) {
  const Pause pause;
  emission();
  pending_.push_back({{}, ranges});
}

void ContractSink::flush() {
  const Pause pause;
  read();
}

const std::vector<TriangleRange>& ContractSink::finish() {
  read();
  return emitted_;
}

void ContractSink::blame(const std::string& fault) {
  if (fault_.empty()) fault_ = fault;
}

void ContractSink::emission() {
  if (std::this_thread::get_id() != thread_) blame("it emitted from another thread");
  if (everything_) blame("everything was not its only emission");
  ++emissions_;
}

void ContractSink::read() {
  for (const Emission& emission : pending_) {
    for (const ObjectId object : emission.objects) {
      if (object >= scene_->object_count()) {
        blame("it emitted object " + std::to_string(object) + ", which does not exist");
        continue;
      }
      emitted_.push_back({object, 0, scene_->triangle_count(object)});
    }
    for (const TriangleRange& range : emission.ranges) {
      if (range.object >= scene_->object_count() ||
          range.count > scene_->triangle_count(range.object) ||
          range.first > scene_->triangle_count(range.object) - range.count) {
        blame("it emitted a range of triangles that does not exist in object " +
              std::to_string(range.object));
        continue;
      }
      emitted_.push_back(range);
    }
    if (device_ == nullptr || !fault_.empty()) continue;
    if (!emission.objects.empty()) device_->draw(emission.objects);
    if (!emission.ranges.empty()) device_->draw(emission.ranges);
  }
  pending_.clear();
}

void UncountedDevice::load(const Scene& scene) {
  const Pause pause;
  device_->load(scene);
}

void UncountedDevice::begin_frame(const Frame& frame) {
  const Pause pause;
  device_->begin_frame(frame);
}

void UncountedDevice::draw(std::span<const ObjectId> objects) {
  const Pause pause;
  device_->draw(objects);
}

void UncountedDevice::draw(std::span<const TriangleRange> ranges) {
  const Pause pause;
  device_->draw(ranges);
}

void UncountedDevice::cull_back_faces(std::span<const ObjectId> objects) {
  const Pause pause;
  device_->cull_back_faces(objects);
}

QueryId UncountedDevice::query(std::span<const Aabb> boxes) {
  const Pause pause;
  return device_->query(boxes);
}

void UncountedDevice::flush() {
  const Pause pause;
  device_->flush();
}

bool UncountedDevice::ready(QueryId query) {
  const Pause pause;
  return device_->ready(query);
}

std::uint64_t UncountedDevice::samples(QueryId query) {
  const Pause pause;
  return device_->samples(query);
}

void UncountedDevice::finish() {
  const Pause pause;
  device_->finish();
}

std::string UncountedDevice::description() const { return device_->description(); }

}  // namespace vislab
