#include "algorithms/portal/portal_culler.h"

#include <algorithm>
#include <utility>

namespace vislab::portal_culling {

CullerInfo portal_culler_info(std::string name) {
  CullerInfo info;
  info.name = std::move(name);
  info.family = "portal";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::hidden;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.sources = {"Luebke and Georges 1995, Portals and Mirrors",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 77-89"};
  return info;
}

void PortalCuller::build(const Scene& scene, const BuildContext&) {
  graph_.build(scene);
  places_.build(scene, graph_);
  offered_.resize(scene.object_count());
  marks_.assign(scene.object_count(), {});
  reached_.assign(graph_.cell_count(), 0);
  cull_ = 0;
  kept_.reserve(scene.object_count());
  sorted_.resize(scene.object_count());
  start_cells_.reserve(64);
}

void PortalCuller::start_marks() {
  if (++cull_ != 0) return;
  marks_.assign(marks_.size(), {});
  reached_.assign(reached_.size(), 0);
  cull_ = 1;
}

void PortalCuller::cull(const Frame& frame, const Candidates& candidates, DrawSink& out) {
  frustum_ = frustum_of(frame.camera);
  start_marks();
  kept_.clear();
  if (!keep_by_portals(frame, candidates)) {
    // A frame may come in several batches.
    if (frame.index != last_outside_) ++outside_;
    last_outside_ = frame.index;
    kept_.clear();
    keep_in_frustum(frame, candidates);
  }
  sort_kept();
  out.objects(std::span(sorted_).first(kept_.size()));
}

/// False if portals do not tell what is seen.
bool PortalCuller::keep_by_portals(const Frame& frame, const Candidates& candidates) {
  if (!find_start(frame.camera, start_cells_)) return false;
  everything_ = candidates.form() == Candidates::Form::everything;
  if (!everything_) {
    offered_.clear();
    for (const std::span<const ObjectId> run : candidates.object_runs()) {
      for (const ObjectId object : run) offered_.insert(object);
    }
  }
  sees_gap_ = false;
  walk(frame, start_cells_);
  if (sees_gap_) return false;
  const std::uint32_t last =
      kept_.empty() ? 0 : std::ranges::max_element(kept_, {}, &Kept::depth)->depth + 1;
  places_.for_each_free([&](ObjectId object) {
    Mark& mark = mark_of(object, frame);
    if (mark.state == State::in_frustum) keep(object, mark, last);
  });
  return true;
}

void PortalCuller::keep_in_frustum(const Frame& frame, const Candidates& candidates) {
  for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
    for (const ObjectId object : run) {
      if (in_frustum(object, frame)) kept_.push_back({object, 0});
    }
  });
}

void PortalCuller::sort_kept() {
  place_of_depth_.clear();
  for (const Kept& kept : kept_) {
    if (kept.depth + 2 > place_of_depth_.size()) place_of_depth_.resize(kept.depth + 2, 0);
    ++place_of_depth_[kept.depth + 1];
  }
  for (std::size_t i = 1; i < place_of_depth_.size(); ++i) {
    place_of_depth_[i] += place_of_depth_[i - 1];
  }
  for (const Kept& kept : kept_) sorted_[place_of_depth_[kept.depth]++] = kept.object;
}

std::size_t PortalCuller::bytes() const {
  return graph_.bytes() + places_.bytes() + offered_.bytes() + marks_.capacity() * sizeof(Mark) +
         reached_.capacity() * sizeof(std::uint32_t) + kept_.capacity() * sizeof(Kept) +
         sorted_.capacity() * sizeof(ObjectId) +
         place_of_depth_.capacity() * sizeof(std::uint32_t) +
         start_cells_.capacity() * sizeof(CellId);
}

Counters PortalCuller::counters() const {
  return {{"objects_tested", objects_tested_}, {"frames_outside", outside_}};
}

bool PortalCuller::append_reached_cells(std::vector<CellId>& cells) const {
  for (CellId cell = 0; cell < reached_.size(); ++cell) {
    if (cull_ != 0 && reached_[cell] == cull_) cells.push_back(cell);
  }
  return !reached_.empty();
}

}  // namespace vislab::portal_culling
