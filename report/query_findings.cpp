#include "report/query_findings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <span>
#include <string_view>
#include <utility>

#include "common/scene/error.h"
#include "experiments/analysis/statistics.h"
#include "report/device_fits.h"

namespace vislab {
namespace {

constexpr std::size_t least_batches = 3;
constexpr std::size_t most_retest_charts = 4;

std::string title_of(const BlockSummary& block) {
  return block.scene + (block.path.empty() ? "" : ", " + block.path) + ", " + block.device +
         (block.seed == 1 ? "" : ", seed " + std::to_string(block.seed));
}

/// A canonical chain cut where the value of a parameter of one of its stages stands.
struct Cut {
  std::string before, value, after;
  std::size_t stage = 0;
};

constexpr std::string_view between_stages = " > ";

/// The cuts of all stages that have the parameter.
std::vector<Cut> cuts_at(const std::string& canonical, const std::string& parameter) {
  std::vector<Cut> cuts;
  std::size_t stage = 0;
  for (std::size_t from = 0; from < canonical.size(); ++stage) {
    const std::size_t to = std::min(canonical.find(between_stages, from), canonical.size());
    for (const char* opening : {"[", ",", ", "}) {
      const std::string wanted = opening + parameter + "=";
      const std::size_t at = canonical.find(wanted, from);
      if (at >= to) continue;
      const std::size_t first = at + wanted.size();
      const std::size_t end = canonical.find_first_of(",]", first);
      cuts.push_back({canonical.substr(0, first), canonical.substr(first, end - first),
                      canonical.substr(end), stage});
    }
    from = to + between_stages.size();
  }
  return cuts;
}

/// A chain as people write it, without one parameter of one of its stages.
std::string without(const std::string& chain, std::size_t stage, const std::string& parameter) {
  std::size_t from = 0;
  for (; stage > 0; --stage) from = chain.find(between_stages, from) + between_stages.size();
  const std::size_t to = std::min(chain.find(between_stages, from), chain.size());
  std::size_t at = chain.find('[', from);
  for (; at < to; at = chain.find(',', at + 1)) {
    const std::size_t name = chain.find_first_not_of(' ', at + 1);
    if (chain.compare(name, parameter.size() + 1, parameter + "=") != 0) continue;
    const std::size_t end = chain.find_first_of(",]", name);
    if (chain[at] == ',') return chain.substr(0, at) + chain.substr(end);
    if (chain[end] == ']') return chain.substr(0, at) + chain.substr(end + 1);
    return chain.substr(0, at + 1) + chain.substr(chain.find_first_not_of(' ', end + 1));
  }
  return chain;  // it has the usual value
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
    if (!random.frame_ms.measured()) continue;
    for (const Cut& cut : cuts_at(random.canonical, "retest")) {
      if (cut.value != "random") continue;
      const auto aligned = std::ranges::find(block.cells, cut.before + "aligned" + cut.after,
                                             &CellSummary::canonical);
      if (aligned == block.cells.end() || !aligned->frame_ms.measured()) continue;
      if (aligned->device_model != random.device_model) continue;  // fits that differ
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

/// Of one block and a chain of which only the size of bunches differs.
struct Bunches {
  std::string name;
  std::map<double, double> rate;  // by the size
};

/// One line for each chain of a block that was measured with several sizes of bunches.
std::vector<LineSeries> bunches_of(const BlockSummary& block, const DeviceFits& fits) {
  // By the fit of the device and the canonical chain without that size.
  std::map<std::pair<std::string, std::string>, Bunches> found;
  for (const CellSummary& cell : block.cells) {
    const auto queries = cell.counters.find("queries");
    if (!cell.asks_device || !cell.frame_ms.measured() || queries == cell.counters.end()) continue;
    const double rate = 1e3 * queries->second / cell.frame_ms.median.value;
    if (rate <= 0.0) continue;
    for (const Cut& cut : cuts_at(cell.canonical, "batch")) {
      const std::string fit = fits.name_of(block, cell);
      Bunches& bunches = found[{fit, cut.before + cut.after}];
      bunches.name = without(cell.culler, cut.stage, "batch");
      bunches.rate[std::stod(cut.value)] = rate;
    }
  }
  std::vector<LineSeries> lines;
  for (const auto& [key, bunches] : found) {
    if (bunches.rate.size() < least_batches) continue;
    const std::string& fit = key.first;
    lines.push_back(
        {bunches.name + ", " + block.scene + ", " + block.path + (fit.empty() ? "" : ", " + fit),
         {bunches.rate.begin(), bunches.rate.end()}});
  }
  return lines;
}

/// Rates on different devices have no axis in common: some run on a clock of their own.
std::vector<BunchChart> bunch_charts(const std::vector<BlockSummary>& blocks) {
  const DeviceFits fits(blocks);
  std::vector<BunchChart> charts;
  for (const BlockSummary& block : blocks) {
    std::vector<LineSeries> lines = bunches_of(block, fits);
    if (lines.empty()) continue;
    auto chart = std::ranges::find(charts, block.device, &BunchChart::device);
    if (chart == charts.end()) {
      charts.push_back(
          {block.device, {"queries in a bunch", "queries ÷ time of the frame (1/s)", {}, false}});
      chart = charts.end() - 1;
    }
    std::ranges::move(lines, std::back_inserter(chart->chart.series));
  }
  return charts;
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
  findings.bunches = bunch_charts(input.blocks);
  if (input.frame_times) {
    for (const auto* blocks : {&input.blocks, &input.sweep_blocks}) {
      for (const BlockSummary& block : *blocks) add_retests(input, block, findings.retests);
    }
  }
  findings.pictures = choose_query_pictures(input.blocks, findings.diagram_blocks());
  findings.charted_retests = most_different(findings.retests);
  return findings;
}

std::vector<const BlockSummary*> QueryFindings::diagram_blocks() const {
  std::vector<const BlockSummary*> blocks;
  for (const PhaseDiagram& diagram : phases) {
    blocks.insert(blocks.end(), diagram.blocks.begin(), diagram.blocks.end());
  }
  return blocks;
}

std::string phase_file_name(std::size_t phase) {
  return "phases-" + std::to_string(phase + 1) + ".svg";
}

std::string retest_file_name(std::size_t retest) {
  return "retests-" + std::to_string(retest + 1) + ".svg";
}

std::string bunch_file_name(std::size_t chart) {
  return "bunches-" + std::to_string(chart + 1) + ".svg";
}

std::string query_chart_script(const QueryFindings& findings) {
  std::string script;
  for (std::size_t i = 0; i < findings.phases.size(); ++i) {
    script += phase_script(findings.phases[i], phase_file_name(i));
  }
  for (const std::size_t i : findings.charted_retests) {
    script += line_chart_script(retest_chart(findings.retests[i]), retest_file_name(i));
  }
  for (std::size_t i = 0; i < findings.bunches.size(); ++i) {
    script += line_chart_script(findings.bunches[i].chart, bunch_file_name(i));
  }
  return script;
}

}  // namespace vislab
