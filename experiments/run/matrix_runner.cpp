#include "experiments/run/matrix_runner.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "common/scene/error.h"
#include "experiments/devices/device_spec.h"
#include "experiments/results/files.h"
#include "experiments/results/hash.h"
#include "experiments/results/store.h"

namespace vislab {
namespace {

/// How often this process was asked to stop.
volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int) { stop_requested = stop_requested + 1; }

/// Ctrl-C and SIGTERM count up stop_requested while an object of this class lives.
class StopOnSignal {
 public:
  StopOnSignal() {
    stop_requested = 0;
    struct sigaction action {};
    action.sa_handler = request_stop;
    ::sigaction(SIGINT, &action, &interrupt_before_);
    ::sigaction(SIGTERM, &action, &terminate_before_);
  }
  ~StopOnSignal() {
    ::sigaction(SIGINT, &interrupt_before_, nullptr);
    ::sigaction(SIGTERM, &terminate_before_, nullptr);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  struct sigaction interrupt_before_ {};
  struct sigaction terminate_before_ {};
};

/// A name that no other run has.
std::string new_run() {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return hash_text(std::to_string(now) + "/" + std::to_string(::getpid())).substr(0, 12);
}

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

std::string to_text(const CostTable& costs) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (const CostQuantity& quantity : cost_quantities()) {
    const Cost& cost = costs.*quantity.cost;
    text << " " << cost.ns << " " << cost.low_ns << " " << cost.high_ns;
  }
  return text.str();
}

CostTable costs_from_text(std::istream& in) {
  CostTable costs;
  for (const CostQuantity& quantity : cost_quantities()) {
    Cost& cost = costs.*quantity.cost;
    in >> cost.ns >> cost.low_ns >> cost.high_ns;
  }
  return costs;
}

std::string to_line(const GpuModel& model) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (const GpuDial& dial : gpu_dials()) text << " " << dial.value(model);
  return text.str();
}

GpuModel model_from_line(std::istream& in) {
  GpuModel model;
  for (const GpuDial& dial : gpu_dials()) {
    double value = 0.0;
    in >> value;
    dial.set(model, value);
  }
  return model;
}

/// The child: runs the block and tells the parent what it does. Messages:
///   cell ID SECONDS | idle | costs NS LOW HIGH for each quantity | fit VALUE for each dial |
///   member ID | kept TEXT | outcome MEASURED PRESENT FAILED STOPPED | error TEXT |
///   unwritten TEXT | failure TEXT
int run_child(int pipe, const Block& block, const RunSettings& settings, const Registry& registry,
              Progress& progress) {
  const CellWatch watch{[&](const std::string& id, double seconds) {
                          tell(pipe, "cell " + id + " " + std::to_string(seconds));
                        },
                        [&] { tell(pipe, "idle"); },
                        [&](const CostTable& costs) { tell(pipe, "costs" + to_text(costs)); },
                        [&](const GpuModel& model) { tell(pipe, "fit" + to_line(model)); }};
  try {
    const BlockOutcome outcome =
        run_block(block, settings, registry, progress, watch, stop_requested);
    progress.finish();
    for (const std::string& id : outcome.cells) tell(pipe, "member " + id);
    for (std::string text : outcome.failed_but_kept) {
      std::ranges::replace(text, '\n', ' ');
      tell(pipe, "kept " + text);
    }
    tell(pipe, "outcome " + std::to_string(outcome.measured) + " " +
                   std::to_string(outcome.present) + " " + std::to_string(outcome.failed) + " " +
                   std::to_string(outcome.stopped ? 1 : 0));
    return 0;
  } catch (const std::exception& error) {
    progress.finish();
    const bool wrong_input = dynamic_cast<const InputError*>(&error) != nullptr;
    std::string text = error.what();
    std::ranges::replace(text, '\n', ' ');
    const bool unwritten = dynamic_cast<const WriteError*>(&error) != nullptr;
    tell(pipe, (unwritten ? "unwritten " : wrong_input ? "error " : "failure ") + text);
    return wrong_input ? 2 : 1;
  }
}

/// What the parent knows of a child.
struct Child {
  std::optional<CostTable> costs;  // that it measured
  std::optional<GpuModel> fit;     // likewise
  std::string cell;                // that runs now; "" between cells
  std::chrono::steady_clock::time_point deadline;
  std::optional<BlockOutcome> outcome;
  std::vector<std::string> members;
  std::vector<std::string> kept;
  std::string error;      // wrong input
  std::string unwritten;  // a result that could not be written
  std::string failure;    // anything else that ended the block
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
  } else if (word == "costs") {
    child.costs = costs_from_text(in);
  } else if (word == "fit") {
    child.fit = model_from_line(in);
  } else if (word == "member") {
    in >> child.members.emplace_back();
  } else if (word == "kept") {
    child.kept.push_back(line.substr(5));
  } else if (word == "outcome") {
    BlockOutcome outcome;
    in >> outcome.measured >> outcome.present >> outcome.failed >> outcome.stopped;
    child.outcome = outcome;
  } else if (word == "error") {
    child.error = line.substr(6);
  } else if (word == "unwritten") {
    child.unwritten = line.substr(10);
  } else if (word == "failure") {
    child.failure = line.substr(8);
  }
}

/// Listens until the child closes its end; kills it if a cell takes longer than it may.
Child watch_child(pid_t pid, int pipe) {
  Child child;
  std::string buffer;
  int passed_on = 0;
  for (;;) {
    // The first wish to stop lets the present work end, the second does not wait for it.
    if (stop_requested > passed_on) {
      passed_on = stop_requested;
      ::kill(pid, passed_on == 1 ? SIGINT : SIGKILL);
    }
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
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody is left to record a failure then
    const int code = run_child(ends[1], block, settings, registry, progress);
    std::fflush(nullptr);
    ::_exit(code);
  }
  ::close(ends[1]);
  const Child child = watch_child(pid, ends[0]);
  ::close(ends[0]);
  return child;
}

std::string reason_of_death(const Child& child) {
  if (child.timed_out) {
    std::ostringstream text;
    text << "timed out after " << child.timeout_s << " s";
    return text.str();
  }
  if (WIFSIGNALED(child.status)) {
    return std::string("crashed: ") + ::strsignal(WTERMSIG(child.status));
  }
  return "ended without an answer";
}

/// Writes a failure into the cell that a dead child was at. A cell that has a result already keeps
/// it: its name is given back.
std::optional<std::string> record_failure(const std::string& id, const std::string& reason,
                                          const std::filesystem::path& results) {
  const ResultStore store = ResultStore::open(results);
  std::optional<ResultCell> cell = store.load_cell(id);
  if (!cell) return std::nullopt;
  if (cell->status == ResultCell::Status::done) return cell->culler;
  cell->status = ResultCell::Status::failed;
  cell->reason = reason;
  store.save_cell(*cell);
  return std::nullopt;
}

}  // namespace

RunOutcome run_blocks(const std::vector<Block>& blocks, const RunOptions& options,
                      const Registry& registry) {
  RunOutcome total;
  Progress progress(options.quiet);
  const StopOnSignal signals;
  ResultStore::open(options.settings.results).remove_unfinished();
  RunSettings settings = options.settings;
  settings.run = new_run();
  std::vector<std::size_t> mine;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (static_cast<int>(i) % options.shards == options.shard - 1) mine.push_back(i);
  }
  total.cells_of_block.resize(blocks.size());
  for (std::size_t i = 0; i < mine.size() && stop_requested == 0; ++i) {
    progress.set_blocks(static_cast<int>(i), static_cast<int>(mine.size()));
    const Block& block = blocks[mine[i]];
    settings.given_up.clear();
    // A cell that brings the process down is marked as failed and left out of the next attempt.
    for (std::size_t attempt = 0; attempt <= block.cullers.size(); ++attempt) {
      const Child child = run_in_child(block, settings, registry, progress);
      const int threads = parse_device(block.device).drawing_threads(block.threads);
      if (child.costs) settings.costs[threads] = *child.costs;
      if (child.fit) settings.device_fits[threads] = *child.fit;
      total.cells.insert(child.members.begin(), child.members.end());
      std::vector<std::string>& members = total.cells_of_block[mine[i]];
      members.insert(members.end(), child.members.begin(), child.members.end());
      for (const std::string& text : child.kept) {
        total.failures.push_back(block.title() + ": " + text);
      }
      if (child.outcome) {
        const BlockOutcome& outcome = *child.outcome;
        total.measured += outcome.measured;
        total.present += outcome.present;
        total.failed += outcome.failed;
        total.stopped |= outcome.stopped;
        progress.line(
            "[" + std::to_string(i + 1) + "/" + std::to_string(mine.size()) + "] " + block.title() +
            ": " + std::to_string(outcome.measured) + " cells measured, " +
            std::to_string(outcome.present) + " were there" +
            (outcome.failed > 0 ? ", " + std::to_string(outcome.failed) + " failed" : ""));
        break;
      }
      if (!child.error.empty()) {
        total.errors.push_back(child.error);
        break;
      }
      if (!child.unwritten.empty()) {
        // No other block could be written either.
        total.errors.push_back(child.unwritten +
                               "; what is whole is kept: make room, and the same call goes on");
        progress.finish();
        return total;
      }
      if (stop_requested != 0) break;
      const std::string reason = child.failure.empty() ? reason_of_death(child) : child.failure;
      if (child.cell.empty() || settings.given_up.contains(child.cell)) {
        total.failures.push_back(block.title() + ": " + reason);
        break;
      }
      if (const auto culler = record_failure(child.cell, reason, settings.results)) {
        total.failures.push_back(block.title() + ": " + *culler + ": " + reason +
                                 "; the result from before is kept");
      }
      settings.given_up.insert(child.cell);
      progress.line(block.title() + ": a cell failed: " + reason);
    }
  }
  progress.finish();
  total.stopped |= stop_requested != 0;
  return total;
}

}  // namespace vislab
