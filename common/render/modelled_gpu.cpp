#include "common/render/modelled_gpu.h"

#include <stdexcept>
#include <vector>

#include "common/raster/box_samples.h"
#include "common/raster/depth_raster.h"
#include "common/render/handedness.h"

namespace vislab {

class ModelledGpu::Implementation {
 public:
  explicit Implementation(const GpuModel& model) : clock(model) {}

  void load(const Scene& scene);
  void begin_frame(const Frame& frame);
  void draw(std::span<const ObjectId> objects);
  void draw(std::span<const TriangleRange> ranges);
  void cull_back_faces(std::span<const ObjectId> objects);
  std::span<const ObjectId> one_sided() const { return one_sided_; }
  QueryId query(std::span<const Aabb> boxes);
  std::uint32_t index_of(QueryId query) const;
  std::uint64_t answer(std::uint32_t query) const { return answers_[query]; }
  std::span<const Aabb> boxes(std::uint32_t query) const;
  void require_frame() const;

  GpuClock clock;

 private:
  void add_draw(ObjectId object, std::uint32_t first, std::uint32_t count);

  const Scene* scene_ = nullptr;
  std::vector<RasterMesh> meshes_;
  std::optional<DepthRaster> raster_;
  std::uint32_t frame_ = 0;  // counts begin_frame
  bool in_frame_ = false;
  std::vector<glm::dmat4x3> transforms_;
  std::vector<std::uint8_t> front_only_;  // by object
  std::vector<ObjectId> one_sided_;

  std::vector<RasterDraw> draws_;
  std::vector<std::uint64_t> samples_, outlines_px_;
  std::vector<GpuClock::Work> work_;
  std::vector<std::uint64_t> answers_;    // of this frame's queries
  std::vector<Aabb> boxes_;               // of this frame's queries, one after the other
  std::vector<std::size_t> first_boxes_;  // by query
};

void ModelledGpu::Implementation::load(const Scene& scene) {
  in_frame_ = false;
  scene_ = &scene;
  meshes_.clear();
  for (const Mesh& mesh : scene.meshes) meshes_.emplace_back(mesh);
  front_only_.assign(scene.object_count(), 0);
  one_sided_.clear();
}

void ModelledGpu::Implementation::begin_frame(const Frame& frame) {
  if (scene_ == nullptr) throw std::logic_error("ModelledGpu: begin_frame before load");
  if (frame.objects.transforms.size() != scene_->object_count()) {
    throw std::logic_error("ModelledGpu: the frame shows another scene than the one loaded");
  }
  in_frame_ = false;
  if (!raster_ || raster_->viewport() != frame.viewport) {
    raster_.emplace(frame.viewport, RasterOptions{});
  }
  raster_->begin(frame.camera);
  transforms_.assign(frame.objects.transforms.begin(), frame.objects.transforms.end());
  for (const ObjectId object : one_sided_) front_only_[object] = 0;
  one_sided_.clear();
  answers_.clear();
  boxes_.clear();
  first_boxes_.clear();
  clock.begin_frame();
  ++frame_;
  in_frame_ = true;
}

void ModelledGpu::Implementation::require_frame() const {
  if (!in_frame_) throw std::logic_error("ModelledGpu: used before begin_frame");
}

void ModelledGpu::Implementation::add_draw(ObjectId object, std::uint32_t first,
                                           std::uint32_t count) {
  RasterDraw draw;
  draw.mesh = &meshes_[scene_->objects[object].mesh];
  draw.transform = &transforms_[object];
  draw.first = first;
  draw.count = count;
  draw.front_only = front_only_[object] != 0;
  draws_.push_back(draw);
}

void ModelledGpu::Implementation::draw(std::span<const ObjectId> objects) {
  require_frame();
  draws_.clear();
  for (const ObjectId object : objects) add_draw(object, 0, scene_->triangle_count(object));
  samples_.resize(draws_.size());
  outlines_px_.resize(draws_.size());
  raster_->draw_counted(draws_, samples_, outlines_px_);
  work_.clear();
  for (std::size_t i = 0; i < draws_.size(); ++i) {
    work_.push_back({draws_[i].count, samples_[i], outlines_px_[i]});
  }
  clock.draw(work_);
}

void ModelledGpu::Implementation::draw(std::span<const TriangleRange> ranges) {
  require_frame();
  draws_.clear();
  for (const TriangleRange& range : ranges) add_draw(range.object, range.first, range.count);
  samples_.resize(draws_.size());
  outlines_px_.resize(draws_.size());
  raster_->draw_counted(draws_, samples_, outlines_px_);
  work_.clear();
  // Ranges of one object that follow each other are one draw; without triangles there is none.
  for (std::size_t i = 0; i < ranges.size();) {
    GpuClock::Work work;
    const ObjectId object = ranges[i].object;
    for (; i < ranges.size() && ranges[i].object == object; ++i) {
      work.triangles += ranges[i].count;
      work.samples += samples_[i];
      work.outline_px += outlines_px_[i];
    }
    if (work.triangles > 0) work_.push_back(work);
  }
  clock.draw(work_);
}

void ModelledGpu::Implementation::cull_back_faces(std::span<const ObjectId> objects) {
  require_frame();
  for (const ObjectId object : objects) {
    if (front_only_[object] != 0 || handedness(transforms_[object]) == 0.0) continue;
    front_only_[object] = 1;
    one_sided_.push_back(object);
  }
}

QueryId ModelledGpu::Implementation::query(std::span<const Aabb> boxes) {
  require_frame();
  BoxSamples sum;
  for (const Aabb& box : boxes) {
    const BoxSamples one = count_box_samples(raster_->window(), raster_->tiles(), box);
    sum.covered += one.covered;
    sum.passed += one.passed;
    sum.outline_px += one.outline_px;
  }
  first_boxes_.push_back(boxes_.size());
  boxes_.insert(boxes_.end(), boxes.begin(), boxes.end());
  answers_.push_back(sum.passed);
  return {frame_,
          clock.query(static_cast<std::uint32_t>(boxes.size()), sum.covered, sum.outline_px)};
}

std::uint32_t ModelledGpu::Implementation::index_of(QueryId query) const {
  require_frame();
  if (query.frame != frame_ || query.index >= answers_.size()) {
    throw std::logic_error("ModelledGpu: no such query in this frame");
  }
  return query.index;
}

std::span<const Aabb> ModelledGpu::Implementation::boxes(std::uint32_t query) const {
  if (query >= first_boxes_.size()) {
    throw std::logic_error("ModelledGpu: no such query in this frame");
  }
  const std::size_t first = first_boxes_[query];
  const std::size_t end = query + 1 < first_boxes_.size() ? first_boxes_[query + 1] : boxes_.size();
  return {boxes_.data() + first, end - first};
}

ModelledGpu::ModelledGpu(const GpuModel& model)
    : implementation_(std::make_unique<Implementation>(model)) {}
ModelledGpu::~ModelledGpu() = default;
void ModelledGpu::load(const Scene& scene) { implementation_->load(scene); }
void ModelledGpu::begin_frame(const Frame& frame) { implementation_->begin_frame(frame); }
void ModelledGpu::draw(std::span<const ObjectId> objects) { implementation_->draw(objects); }
void ModelledGpu::draw(std::span<const TriangleRange> ranges) { implementation_->draw(ranges); }
void ModelledGpu::cull_back_faces(std::span<const ObjectId> objects) {
  implementation_->cull_back_faces(objects);
}
std::span<const ObjectId> ModelledGpu::one_sided() const { return implementation_->one_sided(); }
QueryId ModelledGpu::query(std::span<const Aabb> boxes) { return implementation_->query(boxes); }
void ModelledGpu::flush() {
  implementation_->require_frame();
  implementation_->clock.flush();
}
bool ModelledGpu::ready(QueryId query) {
  return implementation_->clock.poll(implementation_->index_of(query));
}
std::uint64_t ModelledGpu::samples(QueryId query) {
  const std::uint32_t index = implementation_->index_of(query);
  implementation_->clock.wait(index);
  return implementation_->answer(index);
}
void ModelledGpu::finish() {
  implementation_->require_frame();
  implementation_->clock.finish();
}
std::optional<double> ModelledGpu::clock_ms() const {
  return implementation_->clock.host_us() * 1e-3;
}
std::string ModelledGpu::description() const {
  return "modelled GPU: " + to_text(implementation_->clock.model());
}
const GpuModel& ModelledGpu::model() const { return implementation_->clock.model(); }
const std::vector<GpuCommand>& ModelledGpu::log() const { return implementation_->clock.log(); }
std::span<const Aabb> ModelledGpu::boxes(std::uint32_t query) const {
  return implementation_->boxes(query);
}

}  // namespace vislab
