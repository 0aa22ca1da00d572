#include "report/dial_curves.h"

#include <algorithm>
#include <cstdlib>
#include <map>

#include "common/culler/registry.h"

namespace vislab {
namespace {

/// True if all of the text is a number.
bool read_number(const std::string& text, double& number) {
  char* end = nullptr;
  number = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

/// As the chain is written, without one parameter of one stage.
std::string text_without(const std::vector<CullerSpec>& chain, std::size_t stage,
                         const std::string& parameter) {
  std::string text;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    text += (i == 0 ? "" : " > ") + chain[i].name;
    std::string list;
    for (const auto& [name, value] : chain[i].parameters) {
      if (i == stage && name == parameter) continue;
      list += (list.empty() ? "" : ",") + name + "=" + value;
    }
    if (!list.empty()) text += "[" + list + "]";
  }
  return text;
}

struct Member {
  double number = 0.0;
  std::string value;
  std::size_t cell = 0;
};

struct Dial {
  std::string rest;  // the canonical chain without the dial
  std::size_t stage = 0;
  std::string parameter;

  friend auto operator<=>(const Dial&, const Dial&) = default;
};

}  // namespace

std::vector<DialCurve> dial_curves(const std::vector<const CellSummary*>& cells) {
  std::map<Dial, std::vector<Member>> groups;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i]->anchor || cells[i]->replicate > 0) continue;
    const std::vector<CullerSpec> chain = parse_chain(cells[i]->canonical);
    for (std::size_t stage = 0; stage < chain.size(); ++stage) {
      for (const auto& [parameter, value] : chain[stage].parameters) {
        Member member{0.0, value, i};
        if (!read_number(value, member.number)) continue;
        groups[{text_without(chain, stage, parameter), stage, parameter}].push_back(member);
      }
    }
  }
  std::vector<DialCurve> curves;
  for (auto& [dial, members] : groups) {
    if (members.size() < 2) continue;
    std::ranges::stable_sort(members, {}, &Member::number);
    DialCurve curve;
    curve.parameter = dial.parameter;
    curve.name =
        text_without(parse_chain(cells[members.front().cell]->culler), dial.stage, dial.parameter);
    for (const Member& member : members) {
      curve.cells.push_back(member.cell);
      curve.values.push_back(member.value);
    }
    curves.push_back(std::move(curve));
  }
  std::ranges::stable_sort(curves, [](const DialCurve& a, const DialCurve& b) {
    if (a.cells.size() != b.cells.size()) return a.cells.size() > b.cells.size();
    return std::pair(a.name, a.parameter) < std::pair(b.name, b.parameter);
  });
  return curves;
}

}  // namespace vislab
