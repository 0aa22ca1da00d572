// How much of a matrix is in the results.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace vislab {

struct MatrixShare {
  std::string name;
  std::size_t planned = 0;  // cells
  std::size_t present = 0;
  std::map<std::string, std::size_t>
      missing;  // by the chain's short name: cells that are not there
};

}  // namespace vislab
