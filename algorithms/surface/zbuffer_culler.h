// The z-buffer, for the culler surface.zbuffer and the wrong variants of it.
#pragma once

#include "algorithms/surface/surface_culler.h"

namespace vislab::surface {

/// How depths are kept. standard: 0 at the near plane, 1 at the far plane, smaller is nearer;
/// reversed: 1 at the near plane, 0 at the far plane, greater is nearer.
enum class DepthConvention { standard, reversed };

struct DepthFormat {
  DepthConvention convention = DepthConvention::standard;
  int bits = 0;  // of an unsigned integer; 0: a float

  /// What is kept of a depth, from its reversed form in [0, 1].
  double stored(double reversed) const;
  double clear() const { return convention == DepthConvention::standard ? 1.0 : 0.0; }
  bool nearer(double a, double b) const {
    return convention == DepthConvention::standard ? a < b : a > b;
  }
};

class ZBuffer final : public SurfaceCuller {
 public:
  /// `comparison` and `clear` may belong to other conventions: for negative controls.
  struct Rules {
    DepthFormat format;
    DepthConvention comparison;
    DepthConvention clear;
  };
  ZBuffer(CullerInfo info, const Rules& rules) : SurfaceCuller(std::move(info)), rules_(rules) {}

  Counters counters() const override {
    return {{"depth_tests", tests_}, {"pixels_written", writes_}};
  }

 protected:
  void paint(const Frame& frame, const Candidates& candidates) override;
  std::size_t own_bytes() const override { return depths_.capacity() * sizeof(double); }

 private:
  Rules rules_;
  std::vector<double> depths_;
  std::uint64_t tests_ = 0;
  std::uint64_t writes_ = 0;
};

}  // namespace vislab::surface
