// The contract over every registered culler and over chains; and the contract check itself, held
// against cullers that break it.
#include "experiments/contract/contract.h"

#include <gtest/gtest.h>

#include "algorithms/all_cullers.h"
#include "tests/algorithms/misbehaving_cullers.h"
#include "tests/algorithms/wrong_variants.h"

namespace vislab {
namespace {

Registry all_cullers() {
  Registry registry;
  register_all_cullers(registry);
  return registry;
}

/// Every culler with its defaults and with each choice of each parameter, and the chains.
std::vector<std::string> specs_under_contract() {
  std::vector<std::string> specs;
  const Registry registry = all_cullers();
  for (const auto& [name, entry] : registry.entries()) {
    specs.push_back(name);
    for (const ParameterSpec& parameter : entry.info.parameters) {
      for (const std::string& choice : parameter.choices) {
        if (choice != parameter.default_value) {
          specs.push_back(name + "[" + parameter.name + "=" + choice + "]");
        }
      }
    }
  }
  specs.insert(
      specs.end(),
      {"skeleton.example[margin_m=5]", "occlusion.stop_and_wait[threshold_px=20]",
       "none > none > none", "frustum.flat > backface.polygon", "backface.polygon > frustum.flat",
       "frustum.flat > occlusion.stop_and_wait > backface.polygon",
       "backface.polygon > occlusion.stop_and_wait", "oracle > backface.polygon",
       "frustum.flat[test=sphere] > frustum.flat > oracle[level=triangle]"});
  // The switches of the frustum test that are no choices, together and on everything that has them.
  for (const auto& [name, entry] : registry.entries()) {
    if (std::ranges::find(entry.info.parameters, "octant", &ParameterSpec::name) !=
        entry.info.parameters.end()) {
      specs.push_back(name + "[octant=true,plane_coherence=true]");
      specs.push_back(name + "[motion_coherence=true,meta=sphere]");
    }
  }
  return specs;
}

/// The one result that a failing check is expected in.
ContractResult result_of(const std::vector<ContractResult>& results, const std::string& word) {
  for (const ContractResult& result : results) {
    if (result.check.find(word) != std::string::npos) return result;
  }
  ADD_FAILURE() << "no check is called '" << word << "'";
  return {};
}

class EveryCuller : public testing::TestWithParam<std::string> {};

TEST_P(EveryCuller, KeepsItsContract) {
  const Registry registry = all_cullers();
  const std::vector<ContractResult> results = check_contract(registry, GetParam());
  EXPECT_GE(results.size(), 7U);
  for (const ContractResult& result : results) {
    EXPECT_TRUE(result.passed) << GetParam() << ": not true that " << result.check << ": "
                               << result.message;
  }
}

INSTANTIATE_TEST_SUITE_P(Contract, EveryCuller, testing::ValuesIn(specs_under_contract()),
                         [](const testing::TestParamInfo<std::string>& param) {
                           std::string name;
                           for (const char c : param.param) {
                             name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           }
                           return name;
                         });

class EveryWrongVariant : public testing::TestWithParam<std::string> {};

TEST_P(EveryWrongVariant, IsFoundOutByItsGuaranteeAlone) {
  Registry registry;
  add_wrong_variants(registry);
  for (const ContractResult& result : check_contract(registry, GetParam())) {
    const bool guarantee = result.check.find("guarantee") != std::string::npos;
    if (guarantee) {
      EXPECT_FALSE(result.passed) << GetParam() << " was believed";
      const bool by_image = GetParam() == "wrong.image";
      const std::string finding = by_image ? "pixels of the image" : "visible things are left out";
      EXPECT_NE(result.message.find(finding), std::string::npos) << result.message;
    } else {
      EXPECT_TRUE(result.passed) << result.check << ": " << result.message;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Contract, EveryWrongVariant,
                         testing::Values("wrong.left_plane_flipped", "wrong.all_corners_inside",
                                         "wrong.any_corner_inside", "wrong.normals_flipped",
                                         "wrong.image"),
                         [](const testing::TestParamInfo<std::string>& param) {
                           return param.param.substr(param.param.find('.') + 1);
                         });

struct Breach {
  Misdeed misdeed;
  std::string check;    // a word of the check that must fail
  std::string message;  // a word of its message
};

class EveryMisdeed : public testing::TestWithParam<Breach> {};

TEST_P(EveryMisdeed, IsFoundOut) {
  Registry registry;
  registry.add({MisbehavingCuller::describe(), [](const ParameterValues&) {
                  return std::make_unique<MisbehavingCuller>(GetParam().misdeed);
                }});
  const ContractResult result =
      result_of(check_contract(registry, "misbehaving"), GetParam().check);
  EXPECT_FALSE(result.passed);
  EXPECT_NE(result.message.find(GetParam().message), std::string::npos) << result.message;
}

INSTANTIATE_TEST_SUITE_P(
    Contract, EveryMisdeed,
    testing::Values(Breach{Misdeed::emits_twice, "emits only", "twice"},
                    Breach{Misdeed::emits_unoffered, "emits only", "not offered"},
                    Breach{Misdeed::emits_everything, "emits only", "offered a part"},
                    Breach{Misdeed::forgets_declared, "come again", "kept"},
                    Breach{Misdeed::depends_on_threads, "come again", "two threads"},
                    Breach{Misdeed::allocates, "allocates", "allocations"},
                    Breach{Misdeed::overwrites_emission, "emits only", "twice"},
                    Breach{Misdeed::needs_device_silently, "needs", "more than it declares"}),
    [](const testing::TestParamInfo<Breach>& param) { return std::to_string(param.index); });

TEST(ContractCheck, FindsAnIncompleteDeclaration) {
  Registry registry;
  CullerInfo info = MisbehavingCuller::describe();
  info.limits.clear();
  registry.add({info, [](const ParameterValues&) {
                  return std::make_unique<MisbehavingCuller>(Misdeed::emits_twice);
                }});
  const ContractResult result = result_of(check_contract(registry, "misbehaving"), "info");
  EXPECT_FALSE(result.passed);
  EXPECT_NE(result.message.find("limits"), std::string::npos) << result.message;
}

TEST(ContractCheck, RefusesAnUnknownCuller) {
  EXPECT_THROW(check_contract(all_cullers(), "no.such"), InputError);
}

}  // namespace
}  // namespace vislab
