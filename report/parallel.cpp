#include "report/parallel.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <thread>
#include <vector>

namespace vislab {

void for_each_index(std::size_t count, const std::function<void(std::size_t index)>& draw) {
  std::atomic<std::size_t> next = 0;
  const auto draw_some = [&] {
    for (std::size_t index = next++; index < count; index = next++) draw(index);
  };
  std::vector<std::future<void>> threads;
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  for (std::size_t i = 0; i < std::min(count, cores); ++i) {
    threads.push_back(std::async(std::launch::async, draw_some));
  }
  for (const std::future<void>& thread : threads) thread.wait();
  for (std::future<void>& thread : threads) thread.get();
}

}  // namespace vislab
