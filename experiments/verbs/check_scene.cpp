#include <iostream>
#include <sstream>
#include <string>

#include "common/judge/cell_leaks.h"
#include "common/scene/cell_check.h"
#include "common/scene/error.h"
#include "common/scene/library.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

constexpr std::size_t rays_per_cell = 1000;
constexpr std::uint64_t leak_seed = 1;

std::string first_of(const CellFault& fault) {
  if (fault.count == 0) return "";
  std::ostringstream text;
  text << "cell " << fault.cell;
  if (fault.other != none_id) text << " and " << fault.other;
  text << " at " << fault.place.x << ' ' << fault.place.y << ' ' << fault.place.z;
  return text.str();
}

}  // namespace

int check_scene(const Lab& lab, const std::string& scene_name, bool json) {
  const Scene scene = load_scene(scene_name, lab.data).scene;
  if (scene.cells.empty()) throw InputError("scene " + scene_name + " has no cells to be checked");
  const CellCheck check = check_cells(scene);
  const CellLeaks leaks = find_cell_leaks(scene, rays_per_cell, leak_seed);
  Table table({"check", "of", "found", "first"});
  table.add({"cells overlap", scene.cells.size(), check.overlaps.count, first_of(check.overlaps)});
  table.add({"portals have no cell behind", scene.portals.size(), check.gaps.count,
             first_of(check.gaps)});
  table.add({"portals are off their cells' boundary", scene.portals.size(), check.off.count,
             first_of(check.off)});
  table.add({"cells leak", scene.cells.size(), leaks.leaking_cells, first_of(leaks.leaks)});
  table.add({"rays leave their cell through no portal", leaks.rays, leaks.leaks.count,
             first_of(leaks.leaks)});
  // No faults of the scene's; but what is not looked at is not found.
  table.add({"rays begin inside of closed objects, not followed",
             leaks.rays + leaks.rays_inside_objects, leaks.rays_inside_objects, ""});
  table.add({"cells are in closed objects or too thin: leaks unknown", scene.cells.size(),
             leaks.unchecked_cells,
             leaks.unchecked_cells == 0 ? "" : "cell " + std::to_string(leaks.first_unchecked)});
  table.print(std::cout, json);
  const std::size_t faults =
      check.overlaps.count + check.gaps.count + check.off.count + leaks.leaks.count;
  return faults == 0 ? 0 : 1;
}

}  // namespace vislab
