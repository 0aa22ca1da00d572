#include "report/query_findings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>

#include "common/scene/error.h"
#include "experiments/analysis/statistics.h"

namespace vislab {
namespace {

constexpr std::size_t least_batches = 3;
constexpr std::size_t most_retest_charts = 4;

std::string title_of(const BlockSummary& block) {
  return block.scene + (block.path.empty() ? "" : ", " + block.path) + ", " + block.device;
}

/// A canonical chain cut where the value of a parameter stands.
struct Cut {
  std::string before, value, after;
};

std::optional<Cut> cut_at(const std::string& canonical, const std::string& parameter) {
  for (const char* opening : {"[", ",", ", "}) {
    const std::string wanted = opening + parameter + "=";
    const std::size_t at = canonical.find(wanted);
    if (at == std::string::npos) continue;
    const std::size_t first = at + wanted.size();
    const std::size_t end = canonical.find_first_of(",]", first);
    return Cut{canonical.substr(0, first), canonical.substr(first, end - first),
               canonical.substr(end)};
  }
  return std::nullopt;
}

double deviation(std::span<const double> samples) {
  const auto count = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / count;
  double sum = 0.0;
  for (const double sample : samples) sum += (sample - mean) * (sample - mean);
  return std::sqrt(sum / count);
}

/// The whole path's times without those of its first quarter.
std::span<const double> settled(const std::vector<double>& times) {
  return std::span<const double>(times).subspan(times.size() / 4);
}

void add_retests(const ReportInput& input, const BlockSummary& block,
                 std::vector<RetestPair>& pairs) {
  for (const CellSummary& random : block.cells) {
    const std::optional<Cut> cut = cut_at(random.canonical, "retest");
    if (!cut || cut->value != "random" || !random.frame_ms.measured()) continue;
    const auto aligned = std::ranges::find(block.cells, cut->before + "aligned" + cut->after,
                                           &CellSummary::canonical);
    if (aligned == block.cells.end() || !aligned->frame_ms.measured()) continue;
    RetestPair pair{title_of(block), random.culler, {}, {}};
    try {
      pair.aligned_ms = input.frame_times(*aligned);
      pair.random_ms = input.frame_times(random);
    } catch (const InputError&) {
      continue;  // measured, but no longer there
    }
    if (pair.aligned_ms.size() < 2 || pair.random_ms.size() < 2) continue;
    pair.aligned_deviation_ms = deviation(settled(pair.aligned_ms));
    pair.random_deviation_ms = deviation(settled(pair.random_ms));
    pair.aligned_worst_ms = std::ranges::max(settled(pair.aligned_ms));
    pair.random_worst_ms = std::ranges::max(settled(pair.random_ms));
    pairs.push_back(std::move(pair));
  }
}

/// By how much the two kinds of re-tests differ, whichever is steadier.
double difference(const RetestPair& pair) {
  return std::abs(pair.aligned_deviation_ms - pair.random_deviation_ms);
}

std::vector<std::size_t> most_different(const std::vector<RetestPair>& pairs) {
  std::map<std::string, std::size_t> best;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [at, is_new] = best.emplace(pairs[i].title, i);
    if (!is_new && difference(pairs[i]) > difference(pairs[at->second])) at->second = i;
  }
  std::vector<std::size_t> chosen;
  for (const auto& [title, index] : best) chosen.push_back(index);
  std::ranges::stable_sort(chosen, std::ranges::greater(),
                           [&](std::size_t i) { return difference(pairs[i]); });
  chosen.resize(std::min(chosen.size(), most_retest_charts));
  return chosen;
}

/// One line for each method of a block that was measured with several sizes of bunches.
void add_bunches(const BlockSummary& block, std::vector<LineSeries>& lines) {
  std::map<std::string, std::map<double, double>> found;  // by the chain without its batch
  for (const CellSummary& cell : block.cells) {
    const std::optional<Cut> cut = cut_at(cell.canonical, "batch");
    const auto queries = cell.counters.find("queries");
    if (!cut || !cell.frame_ms.measured() || queries == cell.counters.end()) continue;
    const double rate = 1e3 * queries->second / cell.frame_ms.median.value;
    if (rate > 0.0) found[cut->before + cut->after][std::stod(cut->value)] = rate;
  }
  for (const auto& [chain, points] : found) {
    if (points.size() < least_batches) continue;
    const std::string method = chain.substr(0, chain.find('['));
    lines.push_back({method + ", " + title_of(block), {points.begin(), points.end()}});
  }
}

LineChart retest_chart(const RetestPair& pair) {
  LineChart chart{"frame", "frame_ms (ms)", {{"aligned", {}}, {"randomised", {}}}, true};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<double>& times = k == 0 ? pair.aligned_ms : pair.random_ms;
    for (std::size_t i = 0; i < times.size(); ++i) {
      chart.series[k].points.emplace_back(static_cast<double>(i), times[i]);
    }
  }
  return chart;
}

}  // namespace

QueryFindings find_queries(const ReportInput& input) {
  QueryFindings findings;
  findings.phases = phase_diagrams(input.blocks, input.hidden_share);
  findings.bunches = {"queries in a bunch", "queries a second", {}, false};
  for (const BlockSummary& block : input.blocks) add_bunches(block, findings.bunches.series);
  if (input.frame_times) {
    for (const auto* blocks : {&input.blocks, &input.sweep_blocks}) {
      for (const BlockSummary& block : *blocks) add_retests(input, block, findings.retests);
    }
  }
  findings.charted_retests = most_different(findings.retests);
  return findings;
}

std::string phase_file_name(std::size_t phase) {
  return "phases-" + std::to_string(phase + 1) + ".svg";
}

std::string retest_file_name(std::size_t retest) {
  return "retests-" + std::to_string(retest + 1) + ".svg";
}

std::string query_chart_script(const QueryFindings& findings) {
  std::string script;
  for (std::size_t i = 0; i < findings.phases.size(); ++i) {
    script += phase_script(findings.phases[i], phase_file_name(i));
  }
  for (const std::size_t i : findings.charted_retests) {
    script += line_chart_script(retest_chart(findings.retests[i]), retest_file_name(i));
  }
  if (!findings.bunches.series.empty()) {
    script += line_chart_script(findings.bunches, bunch_file_name);
  }
  return script;
}

}  // namespace vislab
