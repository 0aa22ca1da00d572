#include "common/scene/packages.h"

#include <algorithm>
#include <variant>

#include "common/scene/description.h"
#include "common/scene/file_bytes.h"

namespace vislab {
namespace {

/// Gathers the files that a description names; one overload for each source that has any.
struct Files {
  std::vector<FileSource> found;

  void operator()(const MeshSource& mesh) { found.push_back(mesh.source); }
  void operator()(const ModelSource& model) { (*this)(model.mesh); }
  void operator()(const QuakeSource& quake) { found.push_back(quake.source); }
  void operator()(const ShapeSource& shape) { std::visit(*this, shape); }
  void operator()(const PlacedMesh& placed) { (*this)(placed.mesh); }
  void operator()(const HaresSource& hares) { (*this)(hares.mesh); }
  void operator()(const MeshFieldSource& field) { (*this)(field.mesh); }
  template <typename Source>
  void operator()(const std::vector<Source>& sources) {
    for (const Source& source : sources) (*this)(source);
  }
  void operator()(const auto&) {}  // is made
};

}  // namespace

std::vector<std::string> missing_packages(const std::string& name_or_file,
                                          const DataFolders& folders) {
  std::filesystem::path file = folders.data / "scenes" / (name_or_file + ".toml");
  const bool is_name = name_or_file.find_first_of("/.") == std::string::npos;
  if (!is_name || !std::filesystem::exists(file)) file = name_or_file;
  if (lower_extension(file) != "toml") return {};
  Files files;
  std::visit([&](const auto& source) { files(source); }, read_scene_description(file).source);
  std::vector<std::string> missing;
  for (const FileSource& source : files.found) {
    if (source.package.empty()) continue;
    if (std::filesystem::exists(folders.cache / source.package / source.file)) continue;
    if (std::ranges::find(missing, source.package) == missing.end()) {
      missing.push_back(source.package);
    }
  }
  return missing;
}

}  // namespace vislab
