// A results folder: one JSON file per cell, visible sets once per hash, truth, verdicts.
//   cells/ID.json      what was measured (the truth of the results)
//   sets/HASH.set      visible sets, compressed
//   images/HASH.ids    images of hidden-surface algorithms, compressed
//   truth/KEY.truth    what rays saw, compressed
//   verdicts/ID.json   what the judge made of a cell's sets; derived, may be deleted
//   depths/ID.json     depth complexities that a report has counted; derived, may be deleted
//   other_formats/N/   cells of format N that were measured again since
//   matrices/NAME      says that the matrix was run, whole or in part (but not by --filter)
//   stress/NAME/       what stress sweeps were asked, and which cells are theirs
// Files are written to a temporary name and renamed (write_file).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/culler/visible_set.h"
#include "common/judge/cullable.h"
#include "common/judge/metrics.h"
#include "common/judge/stability.h"
#include "common/judge/surface_judge.h"
#include "common/scene/error.h"
#include "experiments/results/cell.h"

namespace vislab {

/// Hash of the owners of all pixels, as the store names them; 32 hexadecimal digits.
std::string surface_hash(std::span<const TriangleId> owners);

/// The judge's verdicts on all frames of a cell, and the error floor of those frames.
struct CellVerdicts {
  std::string judge;    // hash of the judge's sources: verdicts of another judge are made again
  std::string answers;  // answer_hash of the cell: verdicts on other answers are made again
  std::vector<Verdict> frames;
  std::vector<ImageVerdict> images;      // empty if nothing was drawn
  std::vector<SurfaceVerdict> surfaces;  // empty unless the culler paints an image itself
  CulledOf back_facing, outside;         // sums over frames
  Stability stability;
  std::uint64_t floor_disputed_px = 0;    // truth against the unculled image, sum over frames
  std::uint64_t floor_undisputed_px = 0;  // not zero only if the judge itself is at fault
};

/// The file of a cell that holds none: cut off, or changed by hand. The text names it.
class DamagedCell : public InputError {
 public:
  using InputError::InputError;
};

/// Files of cells that give no cell.
struct LeftOut {
  std::map<int, std::size_t> other_formats;  // number of cells of each other version
  std::vector<DamagedCell> damaged;          // by file name
};

class ResultStore {
 public:
  /// Makes the folder and its parts. Throws InputError if that cannot be done or written to.
  static ResultStore create(std::filesystem::path folder);
  /// Opens an existing folder for reading. Throws InputError if there is none.
  static ResultStore open(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path truth_folder() const { return folder_ / "truth"; }

  /// Removes what killed runs left half-written: temporary files of write_file() in the store's own
  /// folders, nothing else. Only under the folder's lock.
  void remove_unfinished() const;

  /// Empty if there is none, or only one of another version of the format. Throws DamagedCell if it
  /// is corrupt, another InputError if it cannot be read.
  std::optional<ResultCell> load_cell(const std::string& id) const;
  /// Is there a file of that cell, whole or damaged?
  bool holds(const std::string& id) const;
  /// A cell of another format that has the same name is put aside, not overwritten, whatever was
  /// put aside before; a damaged one is overwritten.
  void save_cell(const ResultCell& cell) const;
  /// All cells of this version of the format, by id. The others, which are left alone, are told in
  /// `left_out`; if it is null, a damaged one throws DamagedCell. Throws InputError that names the
  /// folder or a file if it cannot be read.
  std::vector<ResultCell> load_all(LeftOut* left_out = nullptr) const;

  /// Writes the set unless it is there.
  void save_set(const std::string& hash, const VisibleSet& set) const;
  /// Throws InputError if it is missing or corrupt.
  VisibleSet load_set(const std::string& hash) const;

  /// Writes the owners of all pixels, unless they are there.
  void save_surface(const std::string& hash, std::span<const TriangleId> owners) const;
  /// Throws InputError if they are missing or corrupt.
  std::vector<TriangleId> load_surface(const std::string& hash) const;

  /// Empty if there are none, they cannot be read, another judge made them, or the cell has other
  /// answers by now.
  std::optional<CellVerdicts> load_verdicts(const ResultCell& cell, const std::string& judge) const;
  void save_verdicts(const std::string& id, const CellVerdicts& verdicts) const;

  /// That a matrix of that name was run in this folder; what it plans and is not there is a gap.
  void note_matrix(const std::string& name) const;
  std::set<std::string> noted_matrices() const;

 private:
  explicit ResultStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;
};

}  // namespace vislab
