// What all methods share that ask a device about boxes: which boxes may be asked about, in which
// form, in which order, and of which device.
//
// Idea: a box in the view is asked about in its enlarged form (common/render/query_bounds.h), so
// that an answer of no samples proves that nothing of it would change a pixel. Boxes that come as
// near as the near plane's corners are cut by it, or hold the eye: their faces tell nothing, and
// what is in them counts as visible. So does what has no valid box. A box that is surely outside of
// the view needs no question.
// Guarantee: leaving out what is `outside`, and what a question of this frame about `asked` found
// without samples, changes no pixel of the image.
// Cost: of a box six plane distances and about 50 operations.
// Source: Zachmann, Computer-Graphik 2, SS 2012, slides 51-52 (proxies), 59 (front to back); MinSG,
// handleCameraInBox (eye in a box); own derivation of how much a box is enlarged.
#pragma once

#include <string_view>

#include "common/culler/culler.h"
#include "common/geometry/frustum.h"

namespace vislab::occlusion_culling {

/// What may be concluded about a box before anything is asked.
enum class BoxPlace {
  outside,    // surely not in the view: may be left out
  unaskable,  // cut by the near plane, around the eye, or broken: counts as visible
  askable     // in the view, and a question about it has a meaning
};

/// The view of one frame, as boxes need it.
class BoxView {
 public:
  /// Before anything else, in every frame.
  void start(const Frame& frame);

  /// `asked` becomes the form in which to ask about the box if it is askable, else it is undefined.
  BoxPlace place(const Aabb& box, Aabb& asked) const;
  /// The same for what is known to be in the view: never outside.
  BoxPlace place_inside(const Aabb& box, Aabb& asked) const;

 private:
  Camera camera_;
  Viewport viewport_;
  Frustum frustum_;
};

/// The key of front-to-back orders, smaller is nearer: squared distance of the box from the eye,
/// metres squared; for an orthographic camera its least depth, metres. Never NaN: broken boxes come
/// at 0. No box in this box is nearer.
double nearness(const Camera& camera, const Aabb& box);

/// The parameter that says from how many samples on something counts as visible.
ParameterSpec threshold_parameter();

/// The context's device. Throws InputError that names the culler if there is none.
RenderDevice& required_device(std::string_view culler, const BuildContext& context);

}  // namespace vislab::occlusion_culling
