// What the cullers by potentially visible sets share: places (cells or clusters) that the viewer
// may be in, what is seen from each of them, and the objects of each.
#pragma once

#include <vector>

#include "algorithms/portal/pvs_rows.h"
#include "common/culler/culler.h"

namespace vislab::portal_culling {

/// Which objects reach into which places.
struct ObjectsByPlace {
  std::vector<std::uint32_t> first;  // by place, and their end: of `objects`
  std::vector<ObjectId> objects;

  /// From pairs (place, object) in any order.
  void assign(std::size_t places, std::vector<std::pair<std::uint32_t, ObjectId>> pairs);
  std::span<const ObjectId> of(std::size_t place) const {
    return std::span(objects).subspan(first[place], first[place + 1] - first[place]);
  }
};

/// Keeps the objects of all places that are seen from the viewer's, if the frustum's planes do not
/// exclude them; where the viewer is in no place, or has among them one that a wall has left or
/// that it is hidden in (closing_objects.h), all in the frustum. Objects that lie in no place,
/// and those that are elsewhere than the scene puts them, are tested against the frustum only: no
/// set tells of them. The scene outlives the culler.
class PvsCuller : public ICuller {
 public:
  explicit PvsCuller(CullerInfo info) : info_(std::move(info)) {}

  const CullerInfo& info() const final { return info_; }
  void build(const Scene& scene, const BuildContext& context) final;
  void reset(std::uint64_t seed) final;
  void update(const Frame& frame, const Changes& changes) final;
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) final;
  bool region(CellId cell, DrawSink& out) final;
  std::size_t bytes() const final;
  Counters counters() const final;

 protected:
  /// Makes the sets. Gives the objects of each place, none for a scene that has no places.
  virtual ObjectsByPlace build_sets(const Scene& scene, const BuildContext& context) = 0;
  /// Adds the places seen from where the camera is; false if that is in no place.
  virtual bool add_seen(const Camera& camera, std::span<std::uint64_t> places) = 0;
  /// Adds the places seen from anywhere in the cell; false if nothing is known of it.
  virtual bool add_seen_from(CellId cell, std::span<std::uint64_t> places) const = 0;
  virtual std::size_t bytes_of_sets() const = 0;
  /// Which place sees which, without all that is held beside it: as it is stored, and with a bit
  /// for each pair of places, so that sets of different makers can be compared.
  struct SetSizes {
    std::size_t stored = 0, raw = 0;  // bytes
  };
  virtual SetSizes set_sizes() const = 0;
  /// Of a row of whole bytes for each place.
  static std::size_t raw_bytes(std::size_t places) { return places * ((places + 7) / 8); }

 private:
  void mark();
  bool is_away(const Frame& frame, ObjectId object) const;
  void set_gap(ObjectId object, bool is_hidden, bool is_away);

  CullerInfo info_;
  const Scene* scene_ = nullptr;
  ObjectsByPlace objects_;
  std::vector<std::uint8_t> lies_in_a_place_;  // by object, as built
  std::vector<std::uint8_t> is_free_;          // by object: of no place, or away
  bool any_moved_ = false;
  std::vector<std::uint8_t> is_closing_;  // by object
  std::vector<std::uint8_t> is_hidden_;   // by object
  std::vector<ObjectId> gaps_;            // closing objects that are hidden or away
  BitWords seen_;                         // places, of this call
  BitWords marked_places_;                // those whose objects are marked
  std::vector<std::uint8_t> marked_;      // by object
  std::vector<ObjectId> kept_;
  std::uint64_t objects_tested_ = 0;
  std::uint64_t sets_changed_ = 0;
  std::uint64_t frames_outside_ = 0;
  // Counters are told by how much they grow in a frame, so the sizes are added in each update().
  std::uint64_t set_bytes_ = 0;
  std::uint64_t set_raw_bytes_ = 0;
};

}  // namespace vislab::portal_culling
