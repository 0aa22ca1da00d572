#include "experiments/run/progress.h"

#include <unistd.h>

#include <cstdio>

namespace vislab {

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) != 0) {}

void Progress::set_blocks(int done_blocks, int blocks) {
  done_blocks_ = done_blocks;
  blocks_ = blocks;
}

std::string Progress::time_left(double fraction) const {
  const double done = (done_blocks_ + fraction) / blocks_;
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  if (done < 0.02 || seconds < 2.0) return "";
  const int left = static_cast<int>(seconds * (1.0 - done) / done);
  return left >= 90 ? ", about " + std::to_string((left + 30) / 60) + " min left"
                    : ", about " + std::to_string(left) + " s left";
}

void Progress::step(const std::string& what, double fraction) {
  if (quiet_) return;
  const auto now = Clock::now();
  // A log wants a line now and then, a terminal a picture of the moment.
  const double pause_s = terminal_ ? 0.1 : 15.0;
  if (std::chrono::duration<double>(now - last_line_).count() < pause_s) return;
  last_line_ = now;
  const std::string text = "[" + std::to_string(done_blocks_ + 1) + "/" + std::to_string(blocks_) +
                           "] " + what + time_left(fraction);
  if (terminal_) {
    std::fprintf(stderr, "\r\033[K%s", text.c_str());
    open_line_ = true;
  } else {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
  std::fflush(stderr);
}

void Progress::line(const std::string& text) {
  if (quiet_) return;
  finish();
  std::fprintf(stderr, "%s\n", text.c_str());
  std::fflush(stderr);
}

void Progress::finish() {
  if (open_line_) std::fprintf(stderr, "\r\033[K");
  open_line_ = false;
}

}  // namespace vislab
