// What methods that go from cell to cell tell of their way; for pictures.
#pragma once

#include <vector>

#include "common/scene/scene.h"

namespace vislab {

/// To be implemented beside ICuller.
class CellWalker {
 public:
  virtual ~CellWalker() = default;
  /// Appends the cells that the last cull() came to, each once; none if the viewer was outside of
  /// all. False if that is not known (a chain of which no stage goes from cell to cell). O(cells).
  virtual bool append_reached_cells(std::vector<CellId>& cells) const = 0;
};

}  // namespace vislab
