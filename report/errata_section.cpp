#include "report/errata_section.h"

#include <algorithm>
#include <map>

#include "common/scene/error.h"
#include "report/format.h"
#include "report/sweep_section.h"

namespace vislab {
namespace {

constexpr const char* not_run = "not run";

std::string place_of(const BlockSummary& block) {
  return markdown_text(block.scene + (block.path.empty() ? "" : ", " + block.path));
}

/// "1,234 of 15,728,640 (0.0078 %)"
std::string pixel_text(const CellSummary& cell) {
  const std::string count = format_of(cell.wrong_px(), cell.pixels);
  return cell.wrong_px() == 0 ? count : count + " (" + format_percent(wrong_share(cell)) + ")";
}

std::string why_missing(const WrongVariant& variant) {
  return variant.reason.empty() ? not_run : markdown_text(variant.reason);
}

/// "6.50 against 1.00, on hares_56, hares_walk"; only where it is more.
std::string over_text(const WrongVariant& variant) {
  const Damage& over = variant.over;
  if (over.wrong == nullptr || !(over.wrong->over > over.right->over)) return "–";
  return format_number(over.wrong->over) + " against " + format_number(over.right->over) + ", on " +
         place_of(*over.block);
}

bool shows_nothing(const WrongVariant& variant) {
  const Damage& pixels = variant.pixels;
  const Damage& over = variant.over;
  return pixels.wrong != nullptr && pixels.wrong->wrong_px() == 0 &&
         (over.wrong == nullptr || !(over.wrong->over > over.right->over));
}

/// "not shown by what was measured here: leaves out what is behind": what would have to be there.
std::string why_nothing_shows(const WrongVariant& variant) {
  constexpr std::string_view declared = "Wrong on purpose: ";
  std::string_view limits = variant.limits;
  if (limits.starts_with(declared)) limits.remove_prefix(declared.size());
  if (limits.ends_with('.')) limits.remove_suffix(1);
  return "nothing measured here shows it: " + markdown_text(std::string(limits));
}

/// "cluster_tests 40 against 20"; only where there is a difference.
std::string work_text(const WrongVariant& variant, const std::string& counter) {
  const Damage& work = variant.work;
  if (work.wrong == nullptr || counter.empty()) return {};
  return markdown_code(counter) + " " + format_number(counter_a_frame(*work.wrong, counter)) +
         " a frame against " + format_number(counter_a_frame(*work.right, counter)) + " of " +
         markdown_code(work.right->culler) + ", on " + place_of(*work.block);
}

Fields variant_fields(const WrongVariant& variant) {
  Fields row;
  std::string ids;
  for (const Erratum* erratum : variant.errata) ids += (ids.empty() ? "" : ", ") + erratum->id;
  row.values["ids"] = ids.empty() ? "–" : markdown_text(ids);
  row.values["summary"] = markdown_text(variant.summary);
  row.values["sources"] = markdown_text(variant.sources);
  row.values["over"] = over_text(variant);
  for (const char* name : {"false_px", "objects", "frame", "place", "right"}) {
    row.values[name] = "–";
  }
  row.values["method"] = markdown_code(variant.name);
  const Damage& damage = variant.pixels;
  if (damage.wrong == nullptr) {
    row.values["false_px"] = why_missing(variant);
    return row;
  }
  const CellSummary& worst = *damage.wrong;
  row.values["method"] = markdown_code(worst.culler);
  row.values["place"] = place_of(*damage.block);
  row.values["false_px"] = worst.wrong_px() == 0 ? "0 everywhere" : pixel_text(worst);
  if (worst.wrong_px() > 0) {
    row.values["objects"] = worst.paints ? "–" : format_count(worst.false_objects);
    row.values["frame"] =
        std::to_string(worst.worst_frame) + ": " + format_count(worst.worst_frame_px) + " pixels";
  } else {
    row.values["place"] = shows_nothing(variant) ? why_nothing_shows(variant) : "–";
  }
  if (damage.right != nullptr) {
    row.values["right"] =
        markdown_code(damage.right->culler) + ": " + format_count(damage.right->wrong_px());
  }
  return row;
}

/// What a sweep says of the variant: "breaks at 5.5785 m".
std::string sweep_text(const ReportInput& input, const Erratum& erratum) {
  if (erratum.sweep.empty()) return {};
  std::string text = "sweep " + markdown_code(erratum.sweep) + ": ";
  const auto sweep = std::ranges::find(input.sweeps, erratum.sweep,
                                       [](const SweepResult& result) { return result.sweep.name; });
  if (sweep == input.sweeps.end() || !sweep->was_measured()) return text + not_run;
  // Parameters besides the mistake may follow the dial.
  const std::string begin = erratum.wrong.front().substr(0, erratum.wrong.front().find(']'));
  for (const SweepVerdict& verdict : sweep->verdicts) {
    if (!verdict.culler.starts_with(begin)) continue;
    const SweepDial& dial = sweep->sweep.dial;
    if (verdict.break_point) {
      return text + "breaks at " + dial_text(dial, *verdict.break_point) + " (" +
             markdown_text(dial.name) + ")";
    }
    return text + (verdict.is_complete ? "does not break" : "not all values were measured");
  }
  return text + not_run;
}

/// All that was measured of an erratum, in a sentence a piece.
std::string measured_text(const ReportInput& input, const Erratum& erratum,
                          const std::vector<WrongVariant>& variants) {
  std::string text;
  const auto add = [&](const std::string& piece) {
    if (!piece.empty()) text += (text.empty() ? "" : "; ") + piece;
  };
  for (const std::string& name : erratum.wrong) {
    const auto variant = std::ranges::find(variants, name, &WrongVariant::name);
    if (variant == variants.end()) continue;
    const Damage& damage = variant->pixels;
    if (damage.wrong == nullptr) {
      add(markdown_code(name) + ": " + why_missing(*variant));
      continue;
    }
    std::string pixels = "no false pixel";
    if (shows_nothing(*variant)) pixels += ", and " + why_nothing_shows(*variant);
    if (damage.wrong->wrong_px() > 0) {
      pixels = pixel_text(*damage.wrong) + " pixels wrong on " + place_of(*damage.block);
      if (damage.right != nullptr) {
        pixels += " (" + format_count(damage.right->wrong_px()) + " of " +
                  markdown_code(damage.right->culler) + ")";
      }
    }
    const std::string over = over_text(*variant);
    add(markdown_code(name) + ": " + pixels + (over == "–" ? "" : "; over " + over));
    add(work_text(*variant, erratum.counter));
  }
  add(sweep_text(input, erratum));
  return text;
}

Fields erratum_fields(const Erratum& erratum) {
  Fields row;
  row.values["id"] = markdown_text(erratum.id);
  row.values["source"] = markdown_text(erratum.source);
  row.values["erratum_place"] = markdown_text(erratum.place);
  row.values["printed"] = markdown_text(erratum.printed);
  row.values["right_is"] = markdown_text(erratum.right);
  row.values["not_shown"] = markdown_text(erratum.not_shown);
  return row;
}

/// Frames a second as the source prints them: two decimals.
std::string reprint_fps(const Reprint& reprint) {
  const double fps = reprint.row->with_fps;
  const Estimate& gain = reprint.gain;
  return format_estimate({fps * gain.value, fps * gain.low, fps * gain.high});
}

Fields reprint_fields(const Reprint& reprint) {
  Fields row;
  row.values["what"] = markdown_text(reprint.row->what);
  row.values["table"] = markdown_text(reprint.row->table);
  row.values["without"] = format_number(reprint.row->without_fps);
  row.values["with"] = format_number(reprint.row->with_fps);
  for (const char* name : {"all", "wrong", "right", "wrong_ratio", "right_ratio"}) {
    row.values[name] = "–";
  }
  row.values["would_be"] = not_run;
  if (reprint.block == nullptr) return row;
  const auto ratio = [](const CellSummary& cell) {
    const Estimate& time = cell.against_none;
    return format_estimate({1.0 / time.value, 1.0 / time.high, 1.0 / time.low});
  };
  row.values["all"] = format_rounded(reprint.none->submitted_triangles);
  row.values["wrong"] = format_rounded(reprint.wrong->submitted_triangles);
  row.values["right"] = format_rounded(reprint.right->submitted_triangles);
  row.values["wrong_ratio"] = ratio(*reprint.wrong);
  row.values["right_ratio"] = ratio(*reprint.right);
  row.values["would_be"] = reprint_fps(reprint);
  return row;
}

/// The tables of one source as they would have been.
Fields reprint_entry(const ReportInput& input, const Erratum& erratum,
                     const std::vector<Reprint>& reprints) {
  Fields entry = erratum_fields(erratum);
  entry.values["wrong_method"] = markdown_code(erratum.wrong.front());
  entry.values["right_method"] = markdown_code(erratum.against);
  entry.values["sweep"] = sweep_text(input, erratum);
  entry.flag("has_break", entry.values["sweep"].find("breaks at") != std::string::npos);
  for (const Reprint& reprint : reprints) entry.lists["rows"].push_back(reprint_fields(reprint));
  return entry;
}

/// The variant of each family that got the largest share of the pixels wrong, as a picture.
void add_pictures(const ReportInput& input, const std::vector<WrongVariant>& variants,
                  const std::filesystem::path& folder, Fields& fields) {
  auto& pictures = fields.lists["errata_pictures"];
  auto& missing = fields.lists["errata_pictures_missing"];
  if (!input.picture) return;
  std::map<std::string, const WrongVariant*> worst;  // by family
  for (const WrongVariant& variant : variants) {
    const CellSummary* const cell = variant.pixels.wrong;
    if (cell == nullptr || cell->wrong_px() == 0 || cell->paints) continue;
    const WrongVariant*& known = worst[variant.family];
    if (known == nullptr || wrong_share(*cell) > wrong_share(*known->pixels.wrong)) {
      known = &variant;
    }
  }
  for (const auto& [family, variant] : worst) {
    const std::string file = "erratum-" + family + ".png";
    Fields entry;
    entry.values["method"] = markdown_code(variant->pixels.wrong->culler);
    try {
      entry.values["caption"] = markdown_text(
          input.picture(*variant->pixels.block, *variant->pixels.wrong, folder / file));
      entry.values["file"] = file;
      pictures.push_back(std::move(entry));
    } catch (const InputError& error) {
      // Results outlive the scenes they were measured on; the report is whole without pictures.
      entry.values["reason"] = markdown_text(error.what());
      missing.push_back(std::move(entry));
    }
  }
}

void add_museum(const std::vector<WrongVariant>& variants, Fields& fields) {
  auto& families = fields.lists["wrong_families"];
  std::string family;
  for (const WrongVariant& variant : variants) {
    if (families.empty() || variant.family != family) {
      family = variant.family;
      families.emplace_back();
      families.back().values["family"] = markdown_code(family);
    }
    families.back().lists["rows"].push_back(variant_fields(variant));
  }
}

}  // namespace

void add_errata_fields(const ReportInput& input, const std::filesystem::path& folder,
                       Fields& fields) {
  for (const char* name : {"errata", "figure_errata", "reprints", "wrong_families",
                           "errata_pictures", "errata_pictures_missing"}) {
    fields.lists[name];
  }
  std::vector<const BlockSummary*> blocks;
  for (const BlockSummary& block : input.blocks) blocks.push_back(&block);
  for (const BlockSummary& block : input.sweep_blocks) blocks.push_back(&block);
  std::vector<WrongVariant> variants;
  if (input.cullers != nullptr) {
    variants = find_wrong_variants(blocks, input.errata, *input.cullers);
  }
  const auto is_measured = [](const WrongVariant& variant) { return variant.judged > 0; };
  const auto measured = std::ranges::count_if(variants, is_measured);
  fields.flag("has_errata", !input.errata.empty() || !variants.empty());
  fields.flag("has_unmeasured", measured < std::ssize(variants));
  fields.flag("has_wrong_variants", !variants.empty());
  fields.values["wrong_count"] = std::to_string(variants.size());
  fields.values["wrong_measured"] = std::to_string(measured);
  fields.values["errata_count"] = std::to_string(input.errata.size());
  for (const Erratum& erratum : input.errata) {
    Fields row = erratum_fields(erratum);
    if (!erratum.not_shown.empty()) {
      fields.lists["figure_errata"].push_back(std::move(row));
      continue;
    }
    row.values["measured"] = measured_text(input, erratum, variants);
    fields.lists["errata"].push_back(std::move(row));
    if (input.cullers == nullptr) continue;
    const std::vector<Reprint> reprints =
        reprints_of(erratum, input.published, blocks, *input.cullers);
    if (!reprints.empty()) {
      fields.lists["reprints"].push_back(reprint_entry(input, erratum, reprints));
    }
  }
  fields.flag("has_shown_errata", !fields.lists["errata"].empty());
  fields.flag("has_figure_errata", !fields.lists["figure_errata"].empty());
  add_museum(variants, fields);
  add_pictures(input, variants, folder, fields);
  fields.flag("has_errata_pictures", !fields.lists["errata_pictures"].empty());
}

}  // namespace vislab
