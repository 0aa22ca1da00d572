// Counts calls of operator new in a thread. Linking this library replaces the program's operator
// new and delete by ones that count and then call malloc and free.
#pragma once

#include <cstdint>

namespace vislab {

/// While it lives, calls of operator new in its thread are counted. One at a time in a thread.
class AllocationCounter {
 public:
  AllocationCounter();
  ~AllocationCounter();
  AllocationCounter(const AllocationCounter&) = delete;
  AllocationCounter& operator=(const AllocationCounter&) = delete;

  std::uint64_t count() const;

  /// While it lives, nothing is counted in its thread: for what the harness does inside of a
  /// culler's call.
  class Pause {
   public:
    Pause();
    ~Pause();
    Pause(const Pause&) = delete;
    Pause& operator=(const Pause&) = delete;

   private:
    bool was_counting_;
  };
};

}  // namespace vislab
