// Fits a modelled graphics processor to OSMesa on this machine.
//
// Idea: small frames of many kinds (few and many objects, triangles and samples, seen and unseen;
//   queries in batches and alone) are drawn with OSMesa and timed. What a dial adds to the time of
//   such a frame is asked of the model itself: its clock with that dial at 1 and all others at 0.
//   So times are sums of dials with known weights, and the dials are the weights' least squares,
//   none below 0, of relative errors.
// Limits: the works do not overlap on the two clocks, or nothing would be linear; what the model
//   makes of overlapping is not fitted. OSMesa hands over no draws on its own unless their memory
//   is full, so pipeline_depth is taken as endless.
// Cost: some seconds.
// Source: own; non-negative least squares by coordinate descent.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/render/gpu_model.h"

namespace vislab {

/// A frame of the fit: what OSMesa took and what the fitted model says.
struct FittedWork {
  std::string name;
  double measured_ms = 0.0;
  double modelled_ms = 0.0;
};

struct DeviceFit {
  GpuModel model;
  std::vector<FittedWork> works;
};

/// Draws with a device of its own. `drawing_threads` is what Mesa was told when the process's first
/// context was made (LP_NUM_THREADS): with none, the calling thread draws, and the model is serial.
DeviceFit fit_device(int drawing_threads);

/// x >= 0 that makes the sum over rows of (weights[row] · x - 1)² least, with a slight pull towards
/// small values where that leaves a choice. Each row of `weights` has the same length.
std::vector<double> nonnegative_least_squares(std::span<const std::vector<double>> weights);

}  // namespace vislab
