#include "algorithms/backface/plane_culler.h"

#include <algorithm>

namespace vislab::backface_culling {

void PlaneCuller::clear() {
  place_.clear();
  planes_.clear();
}

void PlaneCuller::add_mesh(MeshId id, const Mesh& mesh, const MeshFrame& frame,
                           const BuildContext&) {
  place_.resize(id + 1);
  place_[id] = planes_.size();
  planes_.emplace_back(mesh, frame);
}

std::span<const std::uint64_t> PlaneCuller::mark_mesh(const ObjectView& view) {
  test_ = find_eye(view, frame_of(view.mesh));
  return {};
}

void PlaneCuller::mark_range(const ObjectView& view, std::uint32_t first, std::uint32_t count,
                             std::uint64_t* back) {
  if (!test_) {
    std::fill_n(back, words_of(count), 0);
    return;
  }
  triangles_tested_ += count;
  mark_behind(planes_[place_[view.mesh]], *test_, first, count, back);
}

std::size_t PlaneCuller::mesh_bytes() const {
  std::size_t sum = place_.capacity() * sizeof(std::size_t);
  for (const PlaneArrays& planes : planes_) sum += sizeof(PlaneArrays) + planes.bytes();
  return sum;
}

}  // namespace vislab::backface_culling
