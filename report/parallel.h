// What sections draw, on all cores.
#pragma once

#include <cstddef>
#include <functional>

namespace vislab {

/// Calls `draw` with each index below `count` once, on a thread for each core, in no fixed order;
/// returns when all calls have. Throws what a call threw, after the others have returned. The
/// threads are no workers of TBB: one that waits inside a picture could otherwise begin a second
/// one that waits for the first.
void for_each_index(std::size_t count, const std::function<void(std::size_t index)>& draw);

}  // namespace vislab
