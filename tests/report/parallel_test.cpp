#include "report/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace vislab {
namespace {

TEST(ForEachIndex, CallsOnceWithEachIndex) {
  std::vector<std::atomic<int>> calls(1000);
  for_each_index(calls.size(), [&](std::size_t i) { ++calls[i]; });
  for (const std::atomic<int>& count : calls) EXPECT_EQ(count, 1);
  for_each_index(0, [](std::size_t) { FAIL(); });
}

TEST(ForEachIndex, ThrowsWhatACallThrewAfterTheOthersHaveReturned) {
  std::atomic<int> under_way = 0;
  const auto call = [&](std::size_t i) {
    if (i == 3) throw std::runtime_error("the fourth");
    ++under_way;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    --under_way;
  };
  EXPECT_THROW(for_each_index(100, call), std::runtime_error);
  EXPECT_EQ(under_way, 0);
}

}  // namespace
}  // namespace vislab
