#include <algorithm>
#include <iostream>

#include "experiments/contract/contract.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {

int check(const Lab& lab, const std::string& culler, bool json) {
  const std::vector<ContractResult> results = check_contract(lab.cullers, culler);
  Table table({"check", "passed", "message"});
  for (const ContractResult& result : results) {
    table.add({result.check, result.passed, result.message});
  }
  table.print(std::cout, json);
  return std::ranges::all_of(results, &ContractResult::passed) ? 0 : 1;
}

}  // namespace vislab
