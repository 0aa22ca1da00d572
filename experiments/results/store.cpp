#include "experiments/results/store.h"

#include <tbb/parallel_for.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <regex>

#include "common/scene/error.h"
#include "experiments/results/files.h"
#include "experiments/results/hash.h"
#include "experiments/results/json_reader.h"

namespace vislab {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// Variable-length number: seven bits a byte, the lowest first.
void append_number(std::string& bytes, std::uint32_t value) {
  while (value >= 0x80U) {
    bytes.push_back(static_cast<char>((value & 0x7FU) | 0x80U));
    value >>= 7U;
  }
  bytes.push_back(static_cast<char>(value));
}

bool take_number(const std::string& bytes, std::size_t& at, std::uint32_t& value) {
  value = 0;
  for (unsigned shift = 0; shift < 35 && at < bytes.size(); shift += 7) {
    const auto byte = static_cast<unsigned char>(bytes[at++]);
    value |= static_cast<std::uint32_t>(byte & 0x7FU) << shift;
    if ((byte & 0x80U) == 0) return true;
  }
  return false;
}

std::string compressed(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string result(4 + size, '\0');
  const auto length = static_cast<std::uint32_t>(bytes.size());
  for (unsigned i = 0; i < 4; ++i) result[i] = static_cast<char>(length >> (8 * i));
  compress2(reinterpret_cast<Bytef*>(result.data() + 4), &size,
            reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 6);
  result.resize(4 + size);
  return result;
}

/// Empty optional if the bytes are not what compressed() made.
std::optional<std::string> uncompressed(const std::string& bytes) {
  if (bytes.size() < 4) return std::nullopt;
  std::uint32_t length = 0;
  for (unsigned i = 0; i < 4; ++i) {
    length |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  if (length > 1000ULL * bytes.size()) return std::nullopt;  // zlib cannot have packed that much
  std::string result(length, '\0');
  uLongf size = length;
  const int status = uncompress(reinterpret_cast<Bytef*>(result.data()), &size,
                                reinterpret_cast<const Bytef*>(bytes.data() + 4),
                                static_cast<uLong>(bytes.size() - 4));
  if (status != Z_OK || size != length) return std::nullopt;
  return result;
}

json to_json(const Verdict& v) {
  return {{"pixels", v.pixels},
          {"false_px", v.false_px},
          {"max_false_px", v.max_false_px},
          {"disputed_lost_px", v.disputed_lost_px},
          {"false_objects", v.false_objects},
          {"false_triangles", v.false_triangles},
          {"false_jittered", v.false_jittered},
          {"jittered", v.jittered},
          {"visible_objects", v.visible_objects},
          {"visible_triangles", v.visible_triangles},
          {"kept_objects", v.kept_objects},
          {"submitted_triangles", v.submitted_triangles},
          {"over_objects_count", v.over_objects_count},
          {"over_triangles_count", v.over_triangles_count},
          {"under_objects_count", v.under_objects_count},
          {"under_triangles_count", v.under_triangles_count},
          {"scene_objects", v.scene_objects},
          {"scene_triangles", v.scene_triangles},
          {"wrong_px", v.wrong_px}};
}

json to_json(const CulledOf& count) {
  return {{"cullable", count.cullable}, {"culled", count.culled}};
}

CulledOf culled_from(const json& j) { return {j.at("cullable"), j.at("culled")}; }

Verdict verdict_from(const json& j) {
  Verdict v;
  v.pixels = j.at("pixels");
  v.false_px = j.at("false_px");
  v.max_false_px = j.at("max_false_px");
  v.disputed_lost_px = j.at("disputed_lost_px");
  v.false_objects = j.at("false_objects");
  v.false_triangles = j.at("false_triangles");
  v.false_jittered = j.at("false_jittered");
  v.jittered = j.at("jittered");
  v.visible_objects = j.at("visible_objects");
  v.visible_triangles = j.at("visible_triangles");
  v.kept_objects = j.at("kept_objects");
  v.submitted_triangles = j.at("submitted_triangles");
  v.over_objects_count = j.at("over_objects_count");
  v.over_triangles_count = j.at("over_triangles_count");
  v.under_objects_count = j.at("under_objects_count");
  v.under_triangles_count = j.at("under_triangles_count");
  v.scene_objects = j.at("scene_objects");
  v.scene_triangles = j.at("scene_triangles");
  v.wrong_px = j.at("wrong_px").get<std::vector<std::array<std::uint16_t, 2>>>();
  return v;
}

/// Removes what write_file() calls FILE.PID.COUNT.tmp, and programs before it FILE.PID.tmp.
void remove_temporary(const fs::path& folder, const std::string& file_pattern) {
  const std::regex temporary("(?:" + file_pattern + R"()(?:\.[0-9]+){1,2}\.tmp)");
  std::vector<fs::path> found;
  std::error_code code;  // what cannot be read or removed is not in the way
  for (fs::directory_iterator entry(folder, code), end; entry != end && !code;
       entry.increment(code)) {
    const fs::path name = entry->path().filename();
    if (name.extension() == ".tmp" && std::regex_match(name.string(), temporary)) {
      found.push_back(entry->path());
    }
  }
  for (const fs::path& file : found) fs::remove(file, code);
}

/// A name in the folder that nothing has: `name`, "stem.2.json", …
fs::path free_name(const fs::path& folder, const fs::path& name) {
  fs::path file = folder / name;
  for (int i = 2; fs::exists(file); ++i) {
    file = folder / (name.stem().string() + "." + std::to_string(i) + name.extension().string());
  }
  return file;
}

std::optional<ResultCell> cell_of(const std::string& text, const fs::path& file) {
  try {
    return parse_cell(text, file.string());
  } catch (const InputError& error) {
    throw DamagedCell(std::string(error.what()) +
                      "; 'vislab run' with its matrix measures it again");
  }
}

}  // namespace

std::string surface_hash(std::span<const TriangleId> owners) {
  std::string bytes;
  for (const TriangleId owner : owners) append_number(bytes, owner);
  return hash_text(bytes);
}

ResultStore ResultStore::create(fs::path folder) {
  std::error_code code;
  for (const char* part : {"cells", "sets", "images", "truth", "verdicts", "matrices"}) {
    fs::create_directories(folder / part, code);
    if (code || ::access((folder / part).c_str(), W_OK | X_OK) != 0) {
      throw InputError("results folder " + folder.string() + " cannot be written to" +
                       (code ? ": " + code.message() : std::string()) +
                       "; name another with --results");
    }
  }
  return ResultStore(std::move(folder));
}

ResultStore ResultStore::open(fs::path folder) {
  std::error_code code;
  if (!fs::is_directory(folder / "cells", code)) {
    throw InputError("no results in " + folder.string() +
                     "; measure some with 'vislab run' or name another folder with --results");
  }
  return ResultStore(std::move(folder));
}

void ResultStore::remove_unfinished() const {
  // All are named by hashes, whatever follows these.
  for (const char* part : {"cells", "sets", "images", "truth", "verdicts", "depths"}) {
    remove_temporary(folder_ / part, R"([0-9a-f]{32}(\.[a-z]+)?)");
  }
  remove_temporary(folder_ / "matrices", ".+");
  std::error_code code;  // no such folder: no sweep was run
  for (fs::directory_iterator sweep(folder_ / "stress", code), end; sweep != end && !code;
       sweep.increment(code)) {
    for (fs::directory_iterator part(sweep->path(), code), last; part != last && !code;
         part.increment(code)) {
      if (part->is_directory(code)) remove_temporary(part->path(), R"(.+\.toml)");
    }
    remove_temporary(sweep->path(), R"(cells\.json|.+\.toml)");
  }
}

bool ResultStore::holds(const std::string& id) const {
  return fs::exists(folder_ / "cells" / (id + ".json"));
}

std::optional<ResultCell> ResultStore::load_cell(const std::string& id) const {
  const fs::path file = folder_ / "cells" / (id + ".json");
  if (!fs::exists(file)) return std::nullopt;
  return cell_of(read_file(file), file);
}

void ResultStore::save_cell(const ResultCell& cell) const {
  const std::string name = cell.key.id() + ".json";
  const fs::path file = folder_ / "cells" / name;
  std::error_code code;
  if (fs::exists(file, code)) {
    const int format = cell_format(read_file(file));
    if (format != 0 && format != cell_format_version) {
      const fs::path older = folder_ / "other_formats" / std::to_string(format);
      fs::create_directories(older, code);
      if (!code) fs::rename(file, free_name(older, name), code);
      if (code) {
        throw WriteError("cannot put " + file.string() + " aside in " + older.string() + ": " +
                         code.message());
      }
    }
  }
  // A cell under way loses a round at most; the other files are made again, if need be.
  const bool whole = cell.status != ResultCell::Status::running;
  write_file(file, to_json(cell), whole ? Flush::yes : Flush::no);
}

std::vector<ResultCell> ResultStore::load_all(LeftOut* left_out) const {
  std::vector<fs::path> files;
  std::error_code code;
  for (fs::directory_iterator entry(folder_ / "cells", code), end; entry != end && !code;
       entry.increment(code)) {
    if (entry->path().extension() == ".json") files.push_back(entry->path());
  }
  if (code) {
    throw InputError("results folder " + folder_.string() + " cannot be read: " + code.message() +
                     "; name another with --results");
  }
  std::ranges::sort(files);
  struct Read {
    std::optional<ResultCell> cell;
    std::optional<DamagedCell> damage;
    int format = 0;
  };
  std::vector<Read> all(files.size());
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    const std::string text = read_file(files[i]);
    try {
      all[i].cell = cell_of(text, files[i]);
      if (!all[i].cell) all[i].format = cell_format(text);
    } catch (const DamagedCell& error) {
      all[i].damage = error;
    }
  });
  std::vector<ResultCell> cells;
  for (Read& read : all) {
    if (read.cell) {
      cells.push_back(std::move(*read.cell));
    } else if (read.damage) {
      if (left_out == nullptr) throw DamagedCell(*read.damage);
      left_out->damaged.push_back(*read.damage);
    } else if (left_out != nullptr) {
      ++left_out->other_formats[read.format];
    }
  }
  return cells;
}

void ResultStore::save_set(const std::string& hash, const VisibleSet& set) const {
  const fs::path file = folder_ / "sets" / (hash + ".set");
  if (fs::exists(file)) return;
  std::string bytes;
  TriangleId end = 0;
  for (const VisibleSet::Run& run : set.runs()) {
    append_number(bytes, run.first - end);
    append_number(bytes, run.count);
    end = run.first + run.count;
  }
  write_file(file, compressed(bytes));
}

VisibleSet ResultStore::load_set(const std::string& hash) const {
  const fs::path file = folder_ / "sets" / (hash + ".set");
  const InputError corrupt(file.string() +
                           ": not a visible set; delete it and run again with --force");
  const std::optional<std::string> bytes = uncompressed(read_file(file));
  if (!bytes) throw corrupt;
  std::vector<VisibleSet::Run> runs;
  TriangleId end = 0;
  for (std::size_t at = 0; at < bytes->size();) {
    std::uint32_t gap = 0;
    std::uint32_t count = 0;
    if (!take_number(*bytes, at, gap) || !take_number(*bytes, at, count)) throw corrupt;
    runs.push_back({end + gap, count});
    end += gap + count;
  }
  VisibleSet set(std::move(runs));
  if (set.hash() != hash) throw corrupt;
  return set;
}

void ResultStore::save_surface(const std::string& hash, std::span<const TriangleId> owners) const {
  const fs::path file = folder_ / "images" / (hash + ".ids");
  if (fs::exists(file)) return;
  std::string bytes;
  for (std::size_t at = 0; at < owners.size();) {
    std::size_t end = at + 1;
    while (end < owners.size() && owners[end] == owners[at]) ++end;
    append_number(bytes, owners[at]);
    append_number(bytes, static_cast<std::uint32_t>(end - at));
    at = end;
  }
  write_file(file, compressed(bytes));
}

std::vector<TriangleId> ResultStore::load_surface(const std::string& hash) const {
  const fs::path file = folder_ / "images" / (hash + ".ids");
  const InputError corrupt(file.string() +
                           ": not an image of owners; delete it and run again with --force");
  const std::optional<std::string> bytes = uncompressed(read_file(file));
  if (!bytes) throw corrupt;
  // Images have no more pixels than a device draws.
  constexpr std::size_t most_pixels = std::size_t{1} << 28U;
  std::vector<TriangleId> owners;
  for (std::size_t at = 0; at < bytes->size();) {
    std::uint32_t owner = 0;
    std::uint32_t count = 0;
    if (!take_number(*bytes, at, owner) || !take_number(*bytes, at, count)) throw corrupt;
    if (count > most_pixels - owners.size()) throw corrupt;
    owners.insert(owners.end(), count, owner);
  }
  if (surface_hash(owners) != hash) throw corrupt;
  return owners;
}

std::optional<CellVerdicts> ResultStore::load_verdicts(const ResultCell& cell,
                                                       const std::string& judge) const {
  const fs::path file = folder_ / "verdicts" / (cell.key.id() + ".json");
  if (!fs::exists(file)) return std::nullopt;
  try {
    const json j = json::parse(read_file(file));
    CellVerdicts verdicts;
    verdicts.judge = j.at("judge");
    verdicts.answers = j.at("answers");
    if (verdicts.judge != judge || verdicts.answers != answer_hash(cell)) return std::nullopt;
    for (const json& frame : j.at("frames")) verdicts.frames.push_back(verdict_from(frame));
    for (const json& image : j.at("images")) {
      verdicts.images.push_back({image.at("image_px"), image.at("disputed_image_px")});
    }
    for (const json& surface : j.at("surfaces")) {
      verdicts.surfaces.push_back({surface.at("surface_px"), surface.at("disputed_surface_px")});
    }
    verdicts.back_facing = culled_from(j.at("back_facing"));
    verdicts.outside = culled_from(j.at("outside"));
    verdicts.stability = {j.at("toggles"), j.at("pop_px_frames"), j.at("latency_frames")};
    verdicts.floor_disputed_px = j.at("floor_disputed_px");
    verdicts.floor_undisputed_px = j.at("floor_undisputed_px");
    return verdicts;
  } catch (const json::exception&) {
    return std::nullopt;  // derived data: it is made again
  }
}

void ResultStore::save_verdicts(const std::string& id, const CellVerdicts& verdicts) const {
  json frames = json::array();
  for (const Verdict& verdict : verdicts.frames) frames.push_back(to_json(verdict));
  json images = json::array();
  for (const ImageVerdict& image : verdicts.images) {
    images.push_back(
        {{"image_px", image.image_px}, {"disputed_image_px", image.disputed_image_px}});
  }
  json surfaces = json::array();
  for (const SurfaceVerdict& surface : verdicts.surfaces) {
    surfaces.push_back(
        {{"surface_px", surface.surface_px}, {"disputed_surface_px", surface.disputed_surface_px}});
  }
  const json j = {{"judge", verdicts.judge},
                  {"answers", verdicts.answers},
                  {"frames", frames},
                  {"images", images},
                  {"surfaces", surfaces},
                  {"back_facing", to_json(verdicts.back_facing)},
                  {"outside", to_json(verdicts.outside)},
                  {"toggles", verdicts.stability.toggles},
                  {"pop_px_frames", verdicts.stability.pop_px_frames},
                  {"latency_frames", verdicts.stability.latency_frames},
                  {"floor_disputed_px", verdicts.floor_disputed_px},
                  {"floor_undisputed_px", verdicts.floor_undisputed_px}};
  write_file(folder_ / "verdicts" / (id + ".json"), j.dump() + "\n");
}

void ResultStore::note_matrix(const std::string& name) const {
  write_file(folder_ / "matrices" / name, "run\n");
}

std::set<std::string> ResultStore::noted_matrices() const {
  std::set<std::string> names;
  std::error_code code;  // an older version noted none
  for (fs::directory_iterator entry(folder_ / "matrices", code), end; entry != end && !code;
       entry.increment(code)) {
    names.insert(entry->path().filename().string());
  }
  return names;
}

}  // namespace vislab
