#include "experiments/bench/portal/worlds.h"

#include <map>
#include <memory>

#include "algorithms/all_cullers.h"
#include "common/scene/library.h"

namespace vislab {

const PortalWorld& portal_world(const std::string& name) {
  // Cullers and states refer to scenes, so these stay where they are.
  static std::map<std::string, std::unique_ptr<PortalWorld>> loaded;
  std::unique_ptr<PortalWorld>& world = loaded[name];
  if (world == nullptr) {
    const std::filesystem::path data = std::filesystem::path(VISLAB_SOURCE_DIR) / "data";
    const DataFolders folders{data, data / "cache"};
    auto fresh = std::make_unique<PortalWorld>();
    fresh->scene = load_scene(name, folders).scene;
    fresh->walk = load_path(name + "_walk", fresh->scene, portal_viewport, 0, folders);
    world = std::move(fresh);
  }
  return *world;
}

std::unique_ptr<ICuller> built_culler(const std::string& spec, const Scene& scene, int threads) {
  static const Registry registry = [] {
    Registry all;
    register_all_cullers(all);
    return all;
  }();
  std::unique_ptr<ICuller> culler = registry.make(spec);
  BuildContext context;
  context.cullers = &registry;
  context.threads = threads;
  culler->build(scene, context);
  return culler;
}

}  // namespace vislab
