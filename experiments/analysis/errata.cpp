#include "experiments/analysis/errata.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "experiments/matrix/toml_keys.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;
using namespace toml_keys;

constexpr const char* which_mistake = "error";  // the parameter of negative controls that names it

std::string text_or(const toml::table& table, std::string_view key, const std::string& file) {
  return value_of<std::string>(table, key, "a text", file).value_or("");
}

std::string text_of(const toml::table& table, std::string_view key, const std::string& file) {
  const std::string text = text_or(table, key, file);
  if (text.empty()) throw InputError(place(file, table) + ": " + std::string(key) + " is missing");
  return text;
}

bool is_wrong(const CullerSpec& stage, const Registry& registry) {
  const std::string error =
      stage.parameters.contains(which_mistake)
          ? "[" + std::string(which_mistake) + "=" + stage.parameters.at(which_mistake) + "]"
          : "";
  return registry.make(stage.name + error)->info().guarantee == Guarantee::erroneous;
}

/// "frustum.wrong[error=degrees]": what find_wrong_variants() calls the variant of a stage.
std::string variant_of(const CullerSpec& stage) {
  const auto error = stage.parameters.find(which_mistake);
  if (error == stage.parameters.end()) return stage.name;
  return stage.name + "[" + std::string(which_mistake) + "=" + error->second + "]";
}

std::string checked_variant(const std::string& text, const Registry& registry,
                            const std::string& where) {
  try {
    const std::vector<CullerSpec> stages = parse_chain(registry.canonical(text));
    if (stages.size() == 1 && is_wrong(stages.front(), registry)) {
      return variant_of(stages.front());
    }
    return registry.short_name(text);
  } catch (const InputError& error) {
    throw InputError(where + ": " + error.what());
  }
}

Erratum read_erratum(const toml::table& table, const Registry& registry, const std::string& file) {
  refuse_unknown_keys(table,
                      {"id", "source", "place", "printed", "right", "wrong", "against", "counter",
                       "sweep", "reprint", "not_shown"},
                      "[[erratum]]", file);
  Erratum erratum;
  erratum.id = text_of(table, "id", file);
  erratum.source = text_of(table, "source", file);
  erratum.place = text_of(table, "place", file);
  erratum.printed = text_of(table, "printed", file);
  erratum.right = text_of(table, "right", file);
  erratum.not_shown = text_or(table, "not_shown", file);
  if (const toml::node* wrong = table.get("wrong")) {
    for (const std::string& text : text_list(*wrong, "wrong", file)) {
      erratum.wrong.push_back(checked_variant(text, registry, place(file, *wrong)));
    }
  }
  if (erratum.wrong.empty() == erratum.not_shown.empty()) {
    throw InputError(place(file, table) +
                     ": an erratum has either wrong, the variants that do as printed, or "
                     "not_shown, why there is none");
  }
  const std::string against = text_or(table, "against", file);
  try {
    if (!against.empty()) erratum.against = registry.short_name(against);
  } catch (const InputError& error) {
    throw InputError(place(file, table) + ": " + error.what());
  }
  erratum.counter = text_or(table, "counter", file);
  erratum.sweep = text_or(table, "sweep", file);
  erratum.reprint = value_of<bool>(table, "reprint", "true or false", file).value_or(false);
  if (erratum.reprint && (erratum.wrong.empty() || against.empty())) {
    throw InputError(place(file, table) + ": reprint needs wrong and against");
  }
  return erratum;
}

bool is_promise(Guarantee guarantee) {
  return guarantee == Guarantee::conservative || guarantee == Guarantee::image_exact;
}

std::string family_of(const std::string& name) { return name.substr(0, name.find('.')); }

/// Canonical chains as stages; what is no chain of this program has none.
class Chains {
 public:
  explicit Chains(const Registry& registry) : registry_(registry) {}

  const std::vector<CullerSpec>& of(const std::string& chain) {
    const auto found = known_.find(chain);
    if (found != known_.end()) return found->second;
    std::vector<CullerSpec> stages;
    try {
      stages = parse_chain(chain);
    } catch (const InputError&) {
      stages.clear();
    }
    return known_.emplace(chain, std::move(stages)).first->second;
  }

  /// The only stage of an erroneous chain that is wrong; null if there are several, or none that
  /// this program knows.
  const CullerSpec* wrong_stage(const std::string& chain) {
    const CullerSpec* wrong = nullptr;
    for (const CullerSpec& stage : of(chain)) {
      try {
        if (!is_wrong(stage, registry_)) continue;
      } catch (const InputError&) {
        continue;  // of an older program
      }
      if (wrong != nullptr) return nullptr;
      wrong = &stage;
    }
    return wrong;
  }

 private:
  const Registry& registry_;
  std::map<std::string, std::vector<CullerSpec>> known_;
};

/// How many of its parameters the stage has in common with another.
std::size_t shared_parameters(const CullerSpec& stage, const CullerSpec& other) {
  return static_cast<std::size_t>(std::ranges::count_if(stage.parameters, [&](const auto& entry) {
    const auto found = other.parameters.find(entry.first);
    return found != other.parameters.end() && found->second == entry.second;
  }));
}

/// Does the chain have the wanted method where the other has its wrong stage, and the same stages
/// elsewhere?
bool stands_for(const std::vector<CullerSpec>& chain, const std::vector<CullerSpec>& wrong_chain,
                const CullerSpec& wrong, const CullerSpec& wanted) {
  if (chain.size() != wrong_chain.size()) return false;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const bool replaced = &wrong_chain[i] == &wrong;
    if (chain[i].name != (replaced ? wanted.name : wrong_chain[i].name)) return false;
    if (!replaced && chain[i].parameters != wrong_chain[i].parameters) return false;
    if (replaced && shared_parameters(wanted, chain[i]) != wanted.parameters.size()) return false;
  }
  return true;
}

/// The method that the erratum names, in the place of the wrong stage; of several the one with most
/// parameters like it. Null if it was not measured.
const CellSummary* named_right(const BlockSummary& block, const CellSummary& cell,
                               const CullerSpec& wrong, const std::string& against,
                               Chains& chains) {
  const CullerSpec wanted = chains.of(against).front();
  const std::vector<CullerSpec> wrong_chain = chains.of(cell.canonical);
  const auto at = std::ranges::find_if(wrong_chain, [&](const CullerSpec& stage) {
    return stage.name == wrong.name && stage.parameters == wrong.parameters;
  });
  const CellSummary* best = nullptr;
  std::size_t most = 0;
  for (const CellSummary& other : block.cells) {
    if (!other.judged || other.guarantee == Guarantee::erroneous) continue;
    if (other.canonical == cell.canonical) continue;  // not declared erroneous, but done as printed
    const std::vector<CullerSpec>& chain = chains.of(other.canonical);
    if (at == wrong_chain.end() || !stands_for(chain, wrong_chain, *at, wanted)) continue;
    const auto stage = static_cast<std::size_t>(at - wrong_chain.begin());
    const std::size_t shared = shared_parameters(wrong, chain[stage]);
    const bool simpler = shared == most && best != nullptr &&
                         other.culler.size() < best->culler.size();  // fewer dials turned
    if (best != nullptr && shared <= most && !simpler) continue;
    best = &other;
    most = shared;
  }
  return best;
}

/// The least over of a method of the same family that promises to be right, and is so on the block.
const CellSummary* any_right(const BlockSummary& block, const CullerSpec& wrong, Chains& chains) {
  const CellSummary* best = nullptr;
  for (const CellSummary& cell : block.cells) {
    if (cell.anchor || !is_promise(cell.guarantee) || !is_free_of_errors(cell)) continue;
    const std::vector<CullerSpec>& chain = chains.of(cell.canonical);
    if (chain.size() != 1 || family_of(chain.front().name) != family_of(wrong.name)) continue;
    if (best == nullptr || cell.over < best->over) best = &cell;
  }
  return best;
}

/// A method of the same family in the place of the wrong stage of a chain, promise or not: where a
/// family promises nothing, wrong is what is worse than that. Of several the one with most
/// parameters like it.
const CellSummary* sibling_in_chain(const BlockSummary& block, const CellSummary& cell,
                                    const CullerSpec& wrong, Chains& chains) {
  const std::vector<CullerSpec> wrong_chain = chains.of(cell.canonical);
  const auto at = std::ranges::find(wrong_chain, wrong.name, &CullerSpec::name);
  const CellSummary* best = nullptr;
  std::size_t most = 0;
  for (const CellSummary& other : block.cells) {
    if (other.anchor || !other.judged || other.guarantee == Guarantee::erroneous) continue;
    const std::vector<CullerSpec>& chain = chains.of(other.canonical);
    if (chain.size() != wrong_chain.size() || at == wrong_chain.end()) continue;
    const CullerSpec& stage = chain[static_cast<std::size_t>(at - wrong_chain.begin())];
    if (family_of(stage.name) != family_of(wrong.name)) continue;
    if (!stands_for(chain, wrong_chain, *at, {stage.name, {}})) continue;
    const std::size_t shared = shared_parameters(wrong, stage);
    if (best != nullptr && shared <= most) continue;
    best = &other;
    most = shared;
  }
  return best;
}

void keep_worst(const Damage& found, double size, Damage& worst, double& worst_size) {
  if (worst.wrong != nullptr && !(size > worst_size)) return;
  worst = found;
  worst_size = size;
}

struct Sizes {
  double pixels = 0.0, over = 0.0, work = 0.0;
};

void add_damage(const Damage& found, const std::string& counter, WrongVariant& variant,
                Sizes& sizes) {
  ++variant.judged;
  const double right_share = found.right == nullptr ? 0.0 : wrong_share(*found.right);
  keep_worst(found, wrong_share(*found.wrong) - right_share, variant.pixels, sizes.pixels);
  if (found.right == nullptr) return;
  const double over = found.wrong->over - found.right->over;
  if (!std::isnan(over)) keep_worst(found, over, variant.over, sizes.over);
  const double work =
      counter_a_frame(*found.wrong, counter) / counter_a_frame(*found.right, counter);
  if (std::isfinite(work)) keep_worst(found, work, variant.work, sizes.work);
}

WrongVariant new_variant(const std::string& name, const std::vector<Erratum>& errata,
                         const Registry& registry) {
  WrongVariant variant;
  variant.name = name;
  variant.family = family_of(name);
  const CullerInfo info = registry.make(name)->info();
  variant.summary = info.summary;
  variant.limits = info.limits;
  for (const std::string& source : info.sources) {
    variant.sources += (variant.sources.empty() ? "" : "; ") + source;
  }
  for (const Erratum& erratum : errata) {
    if (std::ranges::count(erratum.wrong, name) > 0) variant.errata.push_back(&erratum);
  }
  // A method that is right otherwise does not say what is wrong with this setting of it.
  const CullerInfo& method = registry.entries().find(parse_chain(name).front().name)->second.info;
  if (method.guarantee != Guarantee::erroneous && !variant.errata.empty()) {
    variant.summary = variant.errata.front()->printed;
    variant.sources = variant.errata.front()->source + ", " + variant.errata.front()->place;
  }
  return variant;
}

/// All variants of the registry and the errata, measured or not.
std::map<std::string, WrongVariant> declared_variants(const std::vector<Erratum>& errata,
                                                      const Registry& registry) {
  std::map<std::string, WrongVariant> variants;
  for (const auto& [name, entry] : registry.entries()) {
    if (entry.info.guarantee != Guarantee::erroneous) continue;
    std::vector<std::string> names{name};
    for (const ParameterSpec& parameter : entry.info.parameters) {
      if (parameter.name != which_mistake) continue;
      names.clear();
      for (const std::string& choice : parameter.choices) {
        names.push_back(name + "[" + which_mistake + "=" + choice + "]");
      }
    }
    for (const std::string& one : names) {
      variants.emplace(one, new_variant(one, errata, registry));
    }
  }
  for (const Erratum& erratum : errata) {
    for (const std::string& name : erratum.wrong) {
      variants.emplace(name, new_variant(name, errata, registry));
    }
  }
  return variants;
}

const CellSummary* done_cell(const BlockSummary& block, const std::string& chain) {
  const auto found = std::ranges::find_if(block.cells, [&](const CellSummary& cell) {
    return cell.canonical == chain && cell.replicate == 0 &&
           cell.status == ResultCell::Status::done && cell.against_none.measured();
  });
  return found == block.cells.end() ? nullptr : &*found;
}

Reprint reprint_of(const PublishedRow& row, const std::string& wrong, const std::string& right,
                   const std::vector<const BlockSummary*>& blocks) {
  Reprint reprint;
  reprint.row = &row;
  for (const BlockSummary* block : blocks) {
    if (!block->device_models.empty() || !is_of_one_machine(*block)) continue;
    if (block->scene != row.scene || (!row.path.empty() && block->path != row.path)) continue;
    if (reprint.block != nullptr && block->frames <= reprint.block->frames) continue;
    const CellSummary* const none = done_cell(*block, "none");
    const CellSummary* const as_printed = done_cell(*block, wrong);
    const CellSummary* const as_meant = done_cell(*block, right);
    if (none == nullptr || as_printed == nullptr || as_meant == nullptr) continue;
    reprint.block = block;
    reprint.none = none;
    reprint.wrong = as_printed;
    reprint.right = as_meant;
    const Estimate& slow = as_printed->against_none;
    const Estimate& fast = as_meant->against_none;
    reprint.gain = {slow.value / fast.value, slow.low / fast.high, slow.high / fast.low};
  }
  return reprint;
}

}  // namespace

std::vector<Erratum> load_errata(const fs::path& file, const Registry& registry) {
  std::vector<Erratum> errata;
  if (!fs::exists(file)) return errata;
  const toml::table root = parse_file(file);
  refuse_unknown_keys(root, {"erratum"}, "errata", file.string());
  const toml::array* const entries = tables(root, "erratum", file.string());
  if (entries == nullptr) throw InputError(file.string() + ": there is no [[erratum]]");
  std::set<std::string> ids;
  for (const toml::node& entry : *entries) {
    errata.push_back(read_erratum(*entry.as_table(), registry, file.string()));
    if (!ids.insert(errata.back().id).second) {
      throw InputError(place(file.string(), entry) + ": there are two errata '" + errata.back().id +
                       "'");
    }
  }
  return errata;
}

double wrong_share(const CellSummary& cell) {
  return cell.pixels == 0 ? 0.0
                          : static_cast<double>(cell.wrong_px()) / static_cast<double>(cell.pixels);
}

double counter_a_frame(const CellSummary& cell, const std::string& name) {
  const auto found = cell.counters.find(name);
  return found == cell.counters.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
}

std::vector<WrongVariant> find_wrong_variants(const std::vector<const BlockSummary*>& blocks,
                                              const std::vector<Erratum>& errata,
                                              const Registry& registry) {
  std::map<std::string, WrongVariant> variants = declared_variants(errata, registry);
  std::map<std::string, Sizes> sizes;
  Chains chains(registry);
  for (const BlockSummary* block : blocks) {
    for (const CellSummary& cell : block->cells) {
      const bool is_named = variants.contains(cell.culler);  // not erroneous, but done as printed
      if (cell.guarantee != Guarantee::erroneous && !is_named) continue;
      const CullerSpec* const wrong =
          is_named ? &chains.of(cell.canonical).front() : chains.wrong_stage(cell.canonical);
      if (wrong == nullptr) continue;
      const std::string name = is_named ? cell.culler : variant_of(*wrong);
      if (!variants.contains(name)) variants.emplace(name, new_variant(name, errata, registry));
      WrongVariant& variant = variants.at(name);
      if (!cell.judged) {
        variant.reason = cell.reason.empty() ? "not judged" : cell.reason;
        continue;
      }
      const Erratum* erratum = nullptr;
      for (const Erratum* one : variant.errata) {
        if (erratum == nullptr || erratum->against.empty()) erratum = one;
      }
      const CellSummary* right = nullptr;
      if (erratum != nullptr && !erratum->against.empty()) {
        right = named_right(*block, cell, *wrong, erratum->against, chains);
      }
      if (right == nullptr) right = any_right(*block, *wrong, chains);
      if (right == nullptr && !is_named) right = sibling_in_chain(*block, cell, *wrong, chains);
      add_damage({block, &cell, right}, erratum == nullptr ? "" : erratum->counter, variant,
                 sizes[name]);
    }
  }
  std::vector<WrongVariant> all;
  for (auto& [name, variant] : variants) all.push_back(std::move(variant));
  return all;
}

std::vector<Reprint> reprints_of(const Erratum& erratum,
                                 const std::vector<PublishedFigures>& published,
                                 const std::vector<const BlockSummary*>& blocks,
                                 const Registry& registry) {
  std::vector<Reprint> reprints;
  if (!erratum.reprint) return reprints;
  const std::string wrong = registry.canonical(erratum.wrong.front());
  const std::string right = registry.canonical(erratum.against);
  for (const PublishedFigures& figures : published) {
    if (!figures.source.starts_with(erratum.source)) continue;
    for (const PublishedRow& row : figures.rows) {
      if (row.without_fps <= 0.0 || row.with_fps <= 0.0 || row.scene.empty()) continue;
      if (row.compares_places()) continue;  // its figures stand in other rows already
      reprints.push_back(reprint_of(row, wrong, right, blocks));
    }
  }
  return reprints;
}

}  // namespace vislab
