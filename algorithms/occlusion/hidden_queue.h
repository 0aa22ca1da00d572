// Hidden nodes that wait to be asked about, and the questions about them that are under way: the
// I-queue of occlusion.chcpp.
//
// Idea: all that wait are asked about in one go. Nodes that have been hidden for long share queries
//   (multiquery.h); a group that shows tells nothing of its members, which then wait again, each to
//   be asked about alone.
// Guarantee: a node is told hidden only if a query that held all of its boxes found no more samples
//   than the threshold, so sharing changes what is asked, never what may be left out. Answers are
//   read in the order of asking and never polled: they do not depend on time.
// Cost: that of grouping, and a query a group. Nothing is allocated once the lists have their size.
// Sources: Mattausch, Bittner, Wimmer 2008, sections 4 and 5; Zachmann, Computer-Graphik 2, SS
//   2012, slides 54 and 64-68.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "algorithms/occlusion/multiquery.h"
#include "algorithms/occlusion/node_walk.h"
#include "common/render/device.h"

namespace vislab::occlusion_culling {

class HiddenQueue {
 public:
  struct Entry {
    NodeWalk::Visit visit;
    std::uint32_t first_box = 0, box_count = 0;  // in the list that ask() is given
    std::uint32_t hidden_frames = 0;             // in a row before this frame
    bool alone = false;                          // shares no query
  };
  struct Answer {
    Entry entry;
    bool visible = false;
  };

  /// Without a model no node shares a query.
  HiddenQueue(const std::optional<MultiqueryModel>& sharing, Persistence::Kind persistence)
      : sharing_(sharing), persistence_(persistence) {}

  /// Forgets how long things stayed hidden. Before every path.
  void reset() { persistence_.reset(); }
  /// At the start of cull(): nothing waits.
  void start();

  void add(const Entry& entry) { waiting_.push_back(entry); }
  /// It waits again.
  void add_again(Entry entry);
  std::size_t waiting() const { return waiting_.size(); }
  bool under_way() const { return !asked_.empty(); }

  /// Asks about all that wait; nothing may be under way. `boxes` holds those of all entries. The
  /// caller flushes the device.
  void ask(RenderDevice& device, const QueryHierarchy& hierarchy, std::span<const Aabb> boxes);
  /// Waits for all that is under way. `answers` is overwritten with what is known now, in the order
  /// of asking; members of groups with more samples than the threshold wait again.
  void read(RenderDevice& device, std::uint64_t threshold_px, std::vector<Answer>& answers);

  // All since construction.
  std::uint64_t queries() const { return queries_; }
  std::uint64_t shared_queries() const { return shared_queries_; }
  /// Nodes that were asked about once more in the same frame.
  std::uint64_t requeries() const { return requeries_; }

  std::size_t bytes() const;

 private:
  struct Asked {
    QueryId query;
    std::uint32_t first = 0, count = 0;  // in members_
  };

  void group(const QueryHierarchy& hierarchy);

  std::optional<MultiqueryModel> sharing_;
  Persistence persistence_;
  std::vector<Entry> waiting_;
  std::vector<Asked> asked_;
  std::vector<Entry> members_;
  // Memory of ask(): group g is candidates_[ends_[g - 1] … ends_[g] - 1].
  std::vector<MultiqueryCandidate> candidates_;
  std::vector<std::uint32_t> ends_;
  std::vector<std::uint32_t> shared_ends_;  // of those that may share
  std::vector<Aabb> group_boxes_;

  std::uint64_t queries_ = 0;
  std::uint64_t shared_queries_ = 0;
  std::uint64_t requeries_ = 0;
};

}  // namespace vislab::occlusion_culling
