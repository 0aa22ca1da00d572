// The box culler of Google's Filament behind a small interface, so that its headers stay in one
// file.
#pragma once

#include <memory>
#include <span>

#include "common/scene/frame.h"

namespace vislab::peers {

/// Boxes by object id as Filament keeps them: centres and half sizes in float.
class FilamentBoxes {
 public:
  FilamentBoxes();
  ~FilamentBoxes();
  FilamentBoxes(const FilamentBoxes&) = delete;
  FilamentBoxes& operator=(const FilamentBoxes&) = delete;

  void build(std::span<const Aabb> boxes);
  void move(ObjectId object, const Aabb& box);

  /// By object: 1 if Filament keeps it, else 0. Valid until the next call. A camera without a far
  /// plane gets one behind all boxes, since Filament always has six.
  std::span<const std::uint8_t> cull(const Camera& camera);

  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vislab::peers
