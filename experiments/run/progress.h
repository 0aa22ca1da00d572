// What a long run tells: one line that is rewritten on a terminal, plain lines elsewhere.
#pragma once

#include <chrono>
#include <string>

namespace vislab {

class Progress {
 public:
  /// Writes to standard error; says nothing if `quiet`.
  explicit Progress(bool quiet = false);

  /// Work is counted in blocks; `done_blocks` of `blocks` are finished.
  void set_blocks(int done_blocks, int blocks);
  /// Where the present block is: `fraction` of it is done.
  void step(const std::string& what, double fraction);
  /// A line that stays.
  void line(const std::string& text);
  /// Ends the line that is being rewritten.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  std::string time_left(double fraction) const;

  bool quiet_;
  bool terminal_;
  bool open_line_ = false;
  int done_blocks_ = 0, blocks_ = 1;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_line_{};
};

}  // namespace vislab
