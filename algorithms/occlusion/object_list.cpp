#include "algorithms/occlusion/object_list.h"

#include <algorithm>
#include <tuple>

namespace vislab::occlusion_culling {

void ObjectList::fill(const Frame& frame, const Candidates& candidates) {
  view_.start(frame);
  listed_.clear();
  for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
    for (const ObjectId object : run) {
      const Aabb& box = frame.objects.bounds[object];
      ListedObject listed;
      const BoxPlace place = view_.place(box, listed.asked);
      if (place == BoxPlace::outside) {
        ++outside_;
        continue;
      }
      listed.nearness = nearness(frame.camera, box);
      listed.object = object;
      listed.askable = place == BoxPlace::askable;
      listed_.push_back(listed);
    }
  });
  std::ranges::sort(listed_, [](const ListedObject& a, const ListedObject& b) {
    return std::tie(a.nearness, a.object) < std::tie(b.nearness, b.object);
  });
}

bool KeptObjects::emit(DrawSink& out) {
  if (emitted_ == kept_.size()) return false;
  out.objects(std::span<const ObjectId>(kept_).subspan(emitted_));
  emitted_ = kept_.size();
  return true;
}

}  // namespace vislab::occlusion_culling
