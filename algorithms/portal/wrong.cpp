// portal.wrong: negative controls: portal.polygon with one of the mistakes that engines made.
//
// Each leaves out what is seen, or walks too far, under the conditions that its description names.

#include <algorithm>

#include "algorithms/portal/polygon_rule.h"
#include "algorithms/portal/portal_culler.h"
#include "common/culler/mistakes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace portal_culling;

struct PortalMistake : Mistake {
  WalkLimits limits;
  bool from_eye = false;      // the view begins in the eye's cell
  bool forgets_view = false;  // what is left of the view is all of it
};

const std::array mistakes = {
    PortalMistake{{"enters_once",
                   "A cell is visited once in a frame, through the portal that leads to it first",
                   "another portal may show another part of it",
                   "leaves out what is seen through all portals between two rooms but the first",
                   "Godot, portal_pvs_builder: a room was entered once only"},
                  {1, true}},
    PortalMistake{{"eye_cell", "The view begins in the cell that the eye lies in",
                   "it begins at the near plane, which may lie behind a portal already, and the "
                   "part of the portal before it is not looked through",
                   "leaves out the room beyond, while the eye is nearer to a portal than the near "
                   "plane",
                   "noclip issue 643; Godot pull request 87713"},
                  {},
                  true},
    PortalMistake{
        {"forgets_view",
         "Every portal in the image is gone through, whether or not the portals before it "
         "leave it to be seen",
         "nothing but the view that is left ends a way early, and the number of ways is a "
         "power of their length",
         "leaves out nothing that is seen, but keeps all that doors in the image lead to, "
         "and comes to the bound of its visits where rooms have several doors",
         "Godot pull request 46130: a limit for the depth of the walk was needed"},
        {},
        false,
        true},
};

CullerInfo describe() {
  CullerInfo info = portal_culler_info("portal.wrong");
  info.summary = "A negative control: exact portals with one of the mistakes found in engines.";
  info.guarantee = Guarantee::erroneous;
  info.parameters = {error_parameter(mistakes)};
  info.cost = "as portal.polygon";
  info.limits = "Wrong on purpose: leaves out what is seen.";
  return info;
}

/// Narrows the view by no portal.
class ForgetfulRule : public PolygonRule {
 public:
  bool narrow(std::uint32_t opening, const View&, View& left) {
    View all;
    whole(all);
    if (!PolygonRule::narrow(opening, all, left)) return false;
    left = all;
    return true;
  }
};

class WrongPortals : public WalkingCuller<PolygonRule> {
 public:
  explicit WrongPortals(const PortalMistake& mistake)
      : WalkingCuller(info_of(describe(), mistake), mistake.limits), from_eye_(mistake.from_eye) {}

 protected:
  bool find_start(const Camera& camera, std::vector<CellId>& cells) const override {
    if (!from_eye_) return WalkingCuller::find_start(camera, cells);
    Aabb eye;
    eye.extend(glm::vec3(camera.pose.eye));
    graph().cells_of(eye, cells);
    if (cells.size() > 1) cells.erase(cells.begin() + 1, cells.end());
    return !cells.empty();
  }

 private:
  bool from_eye_;
};

}  // namespace

namespace cullers {

CullerEntry portal_wrong() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            const PortalMistake& mistake = chosen_mistake(mistakes, values);
            if (!mistake.forgets_view) return std::make_unique<WrongPortals>(mistake);
            return std::make_unique<WalkingCuller<ForgetfulRule>>(info_of(describe(), mistake));
          }};
}

}  // namespace cullers
}  // namespace vislab
