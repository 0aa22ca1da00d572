// The small scenes, with paths through them, on which the contract of cullers is checked: ordinary
// ones, degenerate ones, and cameras in awkward places.
#pragma once

#include <string>
#include <vector>

#include "common/scene/generators/generators.h"
#include "common/scene/path.h"

namespace vislab {

struct SmallScene {
  std::string name;
  Scene scene;
  Path path;
  Viewport viewport;
};

/// Deterministic; needs no file.
std::vector<SmallScene> small_scenes();

/// A closed sphere of radius 1 around 0, in `rings` bands of 2 * rings sectors each; rings >= 2.
Mesh sphere_mesh(int rings);
/// Moves by `offset` after scaling by `scale`.
glm::dmat4x3 placed(const glm::dvec3& offset, const glm::dvec3& scale = glm::dvec3(1.0));

}  // namespace vislab
