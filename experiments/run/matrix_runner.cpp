#include "experiments/run/matrix_runner.h"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "experiments/results/store.h"

namespace vislab {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int) { stop_requested = 1; }

/// Ctrl-C sets a flag while an object of this class lives.
class StopOnInterrupt {
 public:
  StopOnInterrupt() {
    stop_requested = 0;
    struct sigaction action {};
    action.sa_handler = request_stop;
    // The second Ctrl-C ends the process at once, as always.
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigaction(SIGINT, &action, &before_);
  }
  ~StopOnInterrupt() { ::sigaction(SIGINT, &before_, nullptr); }
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

 private:
  struct sigaction before_ {};
};

/// Writes one message line of the child to its parent.
void tell(int pipe, const std::string& message) {
  const std::string line = message + "\n";
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t n = ::write(pipe, line.data() + written, line.size() - written);
    if (n < 0 && errno != EINTR) return;  // the parent is gone: nobody listens
    if (n > 0) written += static_cast<std::size_t>(n);
  }
}

/// The child: runs the block and tells the parent what it does. Messages:
///   cell ID SECONDS | idle | outcome MEASURED PRESENT FAILED STOPPED | error TEXT
int run_child(int pipe, const Block& block, const RunSettings& settings, const Registry& registry,
              Progress& progress) {
  const CellWatch watch{[&](const std::string& id, double seconds) {
                          tell(pipe, "cell " + id + " " + std::to_string(seconds));
                        },
                        [&] { tell(pipe, "idle"); }};
  try {
    const BlockOutcome outcome =
        run_block(block, settings, registry, progress, watch, stop_requested);
    progress.finish();
    tell(pipe, "outcome " + std::to_string(outcome.measured) + " " +
                   std::to_string(outcome.present) + " " + std::to_string(outcome.failed) + " " +
                   std::to_string(outcome.stopped ? 1 : 0));
    return 0;
  } catch (const std::exception& error) {
    progress.finish();
    std::string text = error.what();
    std::ranges::replace(text, '\n', ' ');
    tell(pipe, "error " + text);
    return 2;
  }
}

/// What the parent knows of a child.
struct Child {
  std::string cell;  // that runs now; "" between cells
  std::chrono::steady_clock::time_point deadline;
  std::optional<BlockOutcome> outcome;
  std::string error;
  bool timed_out = false;
  double timeout_s = 0.0;
  int status = 0;  // of waitpid
};

void take_message(const std::string& line, Child& child) {
  std::istringstream in(line);
  std::string word;
  in >> word;
  if (word == "cell") {
    in >> child.cell >> child.timeout_s;
    child.deadline = std::chrono::steady_clock::now() +
                     std::chrono::milliseconds(static_cast<long long>(child.timeout_s * 1e3));
  } else if (word == "idle") {
    child.cell.clear();
  } else if (word == "outcome") {
    BlockOutcome outcome;
    in >> outcome.measured >> outcome.present >> outcome.failed >> outcome.stopped;
    child.outcome = outcome;
  } else if (word == "error") {
    child.error = line.substr(6);
  }
}

/// Listens until the child closes its end; kills it if a cell takes longer than it may.
Child watch_child(pid_t pid, int pipe) {
  Child child;
  std::string buffer;
  for (;;) {
    pollfd waiting{pipe, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, 100);
    if (ready < 0 && errno != EINTR) break;
    if (ready > 0) {
      char bytes[512];
      const ssize_t n = ::read(pipe, bytes, sizeof bytes);
      if (n == 0 || (n < 0 && errno != EINTR)) break;
      if (n > 0) buffer.append(bytes, static_cast<std::size_t>(n));
      for (std::size_t end = buffer.find('\n'); end != std::string::npos; end = buffer.find('\n')) {
        take_message(buffer.substr(0, end), child);
        buffer.erase(0, end + 1);
      }
    }
    if (!child.cell.empty() && std::chrono::steady_clock::now() > child.deadline) {
      child.timed_out = true;
      ::kill(pid, SIGKILL);
      break;
    }
  }
  while (::waitpid(pid, &child.status, 0) < 0 && errno == EINTR) {
  }
  return child;
}

Child run_in_child(const Block& block, const RunSettings& settings, const Registry& registry,
                   Progress& progress) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  std::fflush(nullptr);
  const pid_t pid = ::fork();
  if (pid < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (pid == 0) {
    ::close(ends[0]);
    const int code = run_child(ends[1], block, settings, registry, progress);
    std::fflush(nullptr);
    ::_exit(code);
  }
  ::close(ends[1]);
  const Child child = watch_child(pid, ends[0]);
  ::close(ends[0]);
  return child;
}

/// Writes the reason of a dead child into the cell that it was at. False if there is no such cell.
bool record_failure(const Child& child, const RunSettings& settings, std::string& reason) {
  if (child.timed_out) {
    std::ostringstream text;
    text << "timed out after " << child.timeout_s << " s";
    reason = text.str();
  } else if (WIFSIGNALED(child.status)) {
    reason = std::string("crashed: ") + ::strsignal(WTERMSIG(child.status));
  } else {
    reason = "ended without an answer";
  }
  if (child.cell.empty()) return false;
  const ResultStore store = ResultStore::open(settings.results);
  std::optional<ResultCell> cell = store.load_cell(child.cell);
  if (!cell) return false;
  cell->status = ResultCell::Status::failed;
  cell->reason = reason;
  store.save_cell(*cell);
  return true;
}

}  // namespace

RunOutcome run_blocks(const std::vector<Block>& blocks, const RunOptions& options,
                      const Registry& registry) {
  RunOutcome total;
  Progress progress(options.quiet);
  const StopOnInterrupt interrupt;
  ResultStore::create(options.settings.results);  // wrong folders are told before any work
  std::vector<Block> mine;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (static_cast<int>(i) % options.shards == options.shard - 1) mine.push_back(blocks[i]);
  }
  for (std::size_t i = 0; i < mine.size() && stop_requested == 0; ++i) {
    progress.set_blocks(static_cast<int>(i), static_cast<int>(mine.size()));
    const Block& block = mine[i];
    RunSettings settings = options.settings;
    // A cell that brings the process down is marked as failed and left out of the next attempt.
    for (std::size_t attempt = 0; attempt <= block.cullers.size(); ++attempt) {
      const Child child = run_in_child(block, settings, registry, progress);
      if (child.outcome) {
        total.measured += child.outcome->measured;
        total.present += child.outcome->present;
        total.failed += child.outcome->failed;
        total.stopped |= child.outcome->stopped;
        progress.line("[" + std::to_string(i + 1) + "/" + std::to_string(mine.size()) + "] " +
                      block.title() + ": " + std::to_string(child.outcome->measured) +
                      " cells measured, " + std::to_string(child.outcome->present) + " were there" +
                      (child.outcome->failed > 0
                           ? ", " + std::to_string(child.outcome->failed) + " failed"
                           : ""));
        break;
      }
      if (!child.error.empty()) {
        total.errors.push_back(child.error);
        break;
      }
      if (stop_requested != 0) {
        total.stopped = true;
        break;
      }
      std::string reason;
      if (!record_failure(child, settings, reason)) {
        total.errors.push_back(block.title() + ": the process of this block " + reason);
        break;
      }
      progress.line(block.title() + ": a cell failed: " + reason);
      // What was just written must not be thrown away by the next attempt.
      settings.force = false;
      settings.retry_failed = false;
    }
  }
  progress.finish();
  total.stopped |= stop_requested != 0;
  return total;
}

}  // namespace vislab
