// Memory for arrays that are read here and there: in huge pages where the system gives them,
// because each visit of a page costs a look-up of its address, which for small pages of a large
// array is a cache miss by itself.
#pragma once

#include <cstddef>
#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace vislab {

/// For std::vector. Arrays of less than a huge page, and other systems, get plain memory.
template <typename T>
class HugePageAllocator {
 public:
  using value_type = T;

  HugePageAllocator() = default;
  template <typename Other>
  explicit HugePageAllocator(const HugePageAllocator<Other>&) {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes < huge_page) return static_cast<T*>(::operator new(bytes, alignment()));
    void* memory = ::operator new (bytes, std::align_val_t{huge_page});
#ifdef __linux__
    // Only advice: what it returns does not matter. Whole pages, so that nothing else is touched.
    madvise(memory, bytes / huge_page * huge_page, MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }

  void deallocate(T* memory, std::size_t count) {
    const bool huge = count * sizeof(T) >= huge_page;
    ::operator delete(memory, huge ? std::align_val_t{huge_page} : alignment());
  }

  friend bool operator==(const HugePageAllocator&, const HugePageAllocator&) { return true; }

 private:
  static constexpr std::size_t huge_page = std::size_t{2} << 20U;
  static constexpr std::align_val_t alignment() { return std::align_val_t{alignof(T)}; }
};

}  // namespace vislab
