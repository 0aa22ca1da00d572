// What the sources got wrong, and what it costs to do as they say: a TOML file of facts, beside
// which stand the wrong variants that do so.
//
//   [[erratum]]
//   id = "X1"
//   source = "Kowalka 2016"
//   place = "figure 3.4"           page, section or slide
//   printed = "…"                  what stands there
//   right = "…"                    what should stand there, and why
//   wrong = ["frustum.wrong[error=degrees]"]   the variants that do as printed
//   against = "frustum.flat"       the right method beside them; left out: whichever right method
//   of
//                                  the family keeps least
//   counter = "plane_tests"        a counter that shows what is lost, if pixels and triangles do
//   not sweep = "half_width"           a stress sweep on it; its first `wrong` is looked for there
//   reprint = true                 the source's frames a second with culling were measured with the
//                                  first of `wrong`: they are set right by `against`
//   not_shown = "…"                instead of wrong and what follows: why no method shows it
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/analysis/published.h"
#include "experiments/analysis/summary.h"

namespace vislab {

struct Erratum {
  std::string id, source, place, printed, right;
  std::vector<std::string> wrong;  // as find_mistakes() names variants
  std::string against;             // short name; "" if any will do
  std::string counter, sweep;
  bool reprint = false;
  std::string not_shown;
};

/// Throws InputError that names file, line or key, and what would be right. Nothing if there is no
/// such file.
std::vector<Erratum> load_errata(const std::filesystem::path& file, const Registry& registry);

/// A wrong variant on one block, and what is right beside it there.
struct Damage {
  const BlockSummary* block = nullptr;  // null: not found anywhere
  const CellSummary* wrong = nullptr;
  const CellSummary* right = nullptr;  // may be null in `pixels`
};

/// A wrong variant and the worst that was measured of it. Sizes of the same mistake (by other
/// parameters) are one variant, and so are chains with it.
struct WrongVariant {
  std::string name;  // "frustum.wrong[error=degrees]", other parameters at their defaults
  std::string family, summary, limits, sources;
  std::vector<const Erratum*> errata;  // that name it
  std::size_t judged = 0;              // cells
  std::string reason;                  // why none was judged; "" if it was not run
  Damage pixels;  // the largest share of wrong pixels beyond the right method's
  Damage over;    // the most over beyond the right method's
  Damage work;    // the largest ratio of the erratum's counter; if it names one
};

/// Share of the pixels that are wrong.
double wrong_share(const CellSummary& cell);

/// A counter's value a frame; NaN if the cell does not have it.
double counter_a_frame(const CellSummary& cell, const std::string& name);

/// Every variant that the registry declares erroneous, measured or not, by name: cullers that are
/// always so, once for each choice of their parameter `error` if they have it; what errata name
/// besides; and what else was measured and is erroneous. Pointers lead into the blocks and errata.
std::vector<WrongVariant> find_wrong_variants(const std::vector<const BlockSummary*>& blocks,
                                              const std::vector<Erratum>& errata,
                                              const Registry& registry);

/// A published row that was measured with a mistake, and what it would have been without.
struct Reprint {
  const PublishedRow* row = nullptr;
  const BlockSummary* block = nullptr;  // null if both were measured nowhere
  const CellSummary *none = nullptr, *wrong = nullptr, *right = nullptr;
  /// frame_ms with the mistake / without it: what the published frames a second are to be
  /// multiplied by. From the ratios to none, with the widest interval that these allow.
  Estimate gain = Estimate::none();
};

/// One for each row with frames a second of the erratum's source; none unless `reprint`. Pointers
/// lead into `published` and `blocks`.
std::vector<Reprint> reprints_of(const Erratum& erratum,
                                 const std::vector<PublishedFigures>& published,
                                 const std::vector<const BlockSummary*>& blocks,
                                 const Registry& registry);

}  // namespace vislab
