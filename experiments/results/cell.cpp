#include "experiments/results/cell.h"

#include <array>
#include <cstdlib>

#include "experiments/results/hash.h"
#include "experiments/results/json_reader.h"

namespace vislab {
namespace {

using nlohmann::json;

/// The value of an enumeration from its name.
template <typename Enum, std::size_t n>
Enum from_name(const std::string& name, const std::array<Enum, n>& values,
               const std::string& where) {
  for (const Enum value : values) {
    if (to_string(value) == name) return value;
  }
  throw InputError(where + ": '" + name + "' is not a known word");
}

constexpr std::array statuses{ResultCell::Status::running, ResultCell::Status::done,
                              ResultCell::Status::failed};
constexpr std::array guarantees{Guarantee::conservative, Guarantee::image_exact,
                                Guarantee::approximate, Guarantee::erroneous};
constexpr std::array repeatabilities{Repeatability::stateless, Repeatability::path,
                                     Repeatability::timing};
constexpr std::array kinds{Culls::back_faces, Culls::outside_frustum, Culls::hidden};
constexpr std::array granularities{Granularity::object, Granularity::triangle};

json key_to_json(const CellKey& key) {
  return {
      {"chain", key.chain},          {"scene_hash", key.scene_hash},  {"path_hash", key.path_hash},
      {"width", key.viewport.width}, {"height", key.viewport.height}, {"seed", key.seed},
      {"device", key.device},        {"threads", key.threads},        {"simd", key.simd},
      {"sources", key.sources},      {"replicate", key.replicate}};
}

CellKey key_from_json(const json& j) {
  CellKey key;
  key.chain = j.at("chain");
  key.scene_hash = j.at("scene_hash");
  key.path_hash = j.at("path_hash");
  key.viewport = {j.at("width"), j.at("height")};
  key.seed = j.at("seed");
  key.device = j.at("device");
  key.threads = j.at("threads");
  key.simd = j.at("simd");
  key.sources = j.at("sources");
  key.replicate = j.at("replicate");
  return key;
}

/// [{"quantity": "triangle", "value": 160, "unit": "ns", "low": 155, "high": 170}, …]: low and high
/// are quartiles.
json costs_to_json(const CostTable& costs) {
  json list = json::array();
  for (const CostQuantity& quantity : cost_quantities()) {
    const Cost& cost = costs.*quantity.cost;
    list.push_back({{"quantity", quantity.name},
                    {"value", cost.ns},
                    {"unit", "ns"},
                    {"low", cost.low_ns},
                    {"high", cost.high_ns}});
  }
  return list;
}

/// A quantity that the program did not know then stays at its typical cost.
CostTable costs_from_json(const json& list) {
  CostTable costs = CostTable::typical();
  for (const json& entry : list) {
    const std::string name = entry.at("quantity");
    for (const CostQuantity& quantity : cost_quantities()) {
      if (quantity.name == name) {
        costs.*quantity.cost = {entry.at("value"), entry.at("low"), entry.at("high")};
      }
    }
  }
  return costs;
}

json model_to_json(const GpuModel& model) {
  json dials = json::object();
  for (const GpuDial& dial : gpu_dials()) dials[std::string(dial.name)] = dial.value(model);
  return dials;
}

/// A dial that the program did not know then stays at its default.
GpuModel model_from_json(const json& dials) {
  GpuModel model;
  for (const GpuDial& dial : gpu_dials()) {
    const auto found = dials.find(std::string(dial.name));
    if (found != dials.end()) dial.set(model, found->get<double>());
  }
  return model;
}

struct RegionCount {
  const char* name;
  std::uint64_t RegionVerdict::*count;
};

constexpr RegionCount region_counts[] = {{"cells", &RegionVerdict::cells},
                                         {"viewpoints", &RegionVerdict::viewpoints},
                                         {"rays", &RegionVerdict::rays},
                                         {"hits", &RegionVerdict::hits},
                                         {"misses", &RegionVerdict::misses},
                                         {"strays", &RegionVerdict::strays},
                                         {"kept", &RegionVerdict::kept},
                                         {"unseen", &RegionVerdict::unseen},
                                         {"seen", &RegionVerdict::seen},
                                         {"kept_by_points", &RegionVerdict::kept_by_points},
                                         {"seen_by_points", &RegionVerdict::seen_by_points}};

json regions_to_json(const RegionVerdict& regions) {
  json j = json::object();
  for (const RegionCount& entry : region_counts) j[entry.name] = regions.*entry.count;
  return j;
}

RegionVerdict regions_from_json(const json& j) {
  RegionVerdict regions;
  for (const RegionCount& entry : region_counts) regions.*entry.count = j.at(entry.name);
  return regions;
}

}  // namespace

std::string CellKey::id() const { return hash_text(key_to_json(*this).dump()); }

std::string to_string(ResultCell::Status status) {
  switch (status) {
    case ResultCell::Status::running:
      return "running";
    case ResultCell::Status::done:
      return "done";
    case ResultCell::Status::failed:
      return "failed";
  }
  return "";
}

std::string answer_hash(const ResultCell& cell) {
  std::string text;
  for (const CellFrame& frame : cell.frames) {
    text += frame.set + " " + frame.truth;
    if (!frame.one_sided.empty()) text += " " + frame.one_sided;
    if (!frame.surface.empty()) text += " surface " + frame.surface;
    text += "\n";
  }
  return hash_text(text);
}

std::string to_json(const ResultCell& cell) {
  json frames = json::array();
  for (const CellFrame& frame : cell.frames) {
    frames.push_back({{"set", frame.set},
                      {"truth", frame.truth},
                      {"submitted_triangles", frame.submitted_triangles},
                      {"draws", frame.draws},
                      {"pieces", frame.pieces},
                      {"one_sided", frame.one_sided},
                      {"surface", frame.surface},
                      {"counters", frame.counters}});
  }
  json rounds = json::array();
  for (const Round& round : cell.rounds) {
    rounds.push_back({{"session", round.session},
                      {"number", round.number},
                      {"update_us", round.update_us},
                      {"cull_us", round.cull_us},
                      {"draw_ms", round.draw_ms},
                      {"frame_ms", round.frame_ms}});
  }
  json anchors = json::object();
  for (const auto& [chain, anchor_rounds] : cell.anchors) {
    json& list = anchors[chain] = json::array();
    for (const AnchorRound& round : anchor_rounds) {
      list.push_back(
          {{"session", round.session}, {"number", round.number}, {"frame_ms", round.frame_ms}});
    }
  }
  json j = {{"format", cell_format_version},
            {"id", cell.key.id()},
            {"key", key_to_json(cell.key)},
            {"culler", cell.culler},
            {"scene", cell.scene},
            {"path", cell.path},
            {"scene_description", cell.scene_description},
            {"scene_source", cell.scene_source},
            {"path_source", cell.path_source},
            {"scene_objects", cell.scene_objects},
            {"scene_triangles", cell.scene_triangles},
            {"moving_objects", cell.moving_objects},
            {"status", to_string(cell.status)},
            {"reason", cell.reason},
            {"guarantee", to_string(cell.guarantee)},
            {"repeatability", to_string(cell.repeatability)},
            {"granularity", to_string(cell.granularity)},
            {"culls", to_string(cell.culls)},
            {"asks_device", cell.asks_device},
            {"build_ms", cell.build_ms},
            {"bytes", cell.bytes},
            {"frames", frames},
            {"rounds", rounds},
            {"anchors", anchors},
            {"context", cell.context}};
  if (cell.costs) j["costs"] = costs_to_json(*cell.costs);
  if (cell.device_model) j["device_model"] = model_to_json(*cell.device_model);
  if (cell.regions) j["regions"] = regions_to_json(*cell.regions);
  // Names of files need not be UTF-8: what is not is replaced.
  return j.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

int cell_format(const std::string& text) {
  // Not parsed as a whole: cells are large, and inside of a string the quotes would be escaped.
  const std::string name = "\"format\":";
  const std::size_t at = text.find(name);
  return at == std::string::npos ? 0 : std::atoi(text.c_str() + at + name.size());
}

std::optional<ResultCell> parse_cell(const std::string& text, const std::string& where) {
  const json j = parse_json(text, where);
  return read_json(where, [&]() -> std::optional<ResultCell> {
    if (j.at("format") != cell_format_version) return std::nullopt;
    ResultCell cell;
    cell.key = key_from_json(j.at("key"));
    if (j.at("id") != cell.key.id()) {
      throw InputError(where + ": the id does not fit the key");
    }
    cell.culler = j.at("culler");
    cell.scene = j.at("scene");
    cell.path = j.at("path");
    cell.scene_description = j.at("scene_description");
    cell.scene_source = j.at("scene_source");
    cell.path_source = j.at("path_source");
    cell.scene_objects = j.at("scene_objects");
    cell.scene_triangles = j.at("scene_triangles");
    cell.moving_objects = j.value("moving_objects", 0.0);  // since paths can move objects
    cell.status = from_name(j.at("status").get<std::string>(), statuses, where);
    cell.reason = j.at("reason");
    cell.guarantee = from_name(j.at("guarantee").get<std::string>(), guarantees, where);
    cell.repeatability =
        from_name(j.at("repeatability").get<std::string>(), repeatabilities, where);
    cell.granularity = from_name(j.at("granularity").get<std::string>(), granularities, where);
    cell.culls = from_name(j.at("culls").get<std::string>(), kinds, where);
    cell.asks_device = j.at("asks_device");
    cell.build_ms = j.at("build_ms");
    cell.bytes = j.at("bytes");
    for (const json& frame : j.at("frames")) {
      cell.frames.push_back(
          {frame.at("set"), frame.at("truth"), frame.at("submitted_triangles"),
           frame.at("counters"),
           // Since there are costs of them, and methods that use the device's
           // culling.
           frame.value("draws", std::uint64_t{0}), frame.value("pieces", std::uint64_t{0}),
           frame.value("one_sided", std::string()), frame.value("surface", std::string())});
    }
    for (const json& r : j.at("rounds")) {
      cell.rounds.push_back({r.at("session"), r.at("number"), r.at("update_us"), r.at("cull_us"),
                             r.at("draw_ms"), r.at("frame_ms")});
      const Round& round = cell.rounds.back();
      for (const auto* samples :
           {&round.update_us, &round.cull_us, &round.draw_ms, &round.frame_ms}) {
        if (samples->size() != cell.frames.size()) {
          throw InputError(where + ": a round does not have one sample a frame");
        }
      }
    }
    for (const auto& [chain, list] : j.at("anchors").items()) {
      for (const json& r : list) {
        cell.anchors[chain].push_back({r.at("session"), r.at("number"), r.at("frame_ms")});
      }
    }
    cell.context = j.at("context").get<std::map<std::string, std::string>>();
    if (j.contains("costs")) cell.costs = costs_from_json(j.at("costs"));
    if (j.contains("device_model")) cell.device_model = model_from_json(j.at("device_model"));
    if (j.contains("regions")) cell.regions = regions_from_json(j.at("regions"));
    return cell;
  });
}

}  // namespace vislab
