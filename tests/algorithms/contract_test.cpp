// The contract over every registered culler and over chains; and the contract check itself, held
// against cullers that break it.
#include "experiments/contract/contract.h"

#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/all_cullers.h"
#include "common/geometry/random.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/misbehaving_cullers.h"
#include "tests/algorithms/run_culler.h"
#include "tests/algorithms/wrong_variants.h"

namespace vislab {
namespace {

Registry all_cullers() {
  Registry registry;
  register_all_cullers(registry);
  return registry;
}

/// What a parameter may be switched to: its choices, or a switch's other position.
std::vector<std::string> others_of(const ParameterSpec& parameter) {
  std::vector<std::string> others = parameter.choices;
  if (parameter.type == ParameterSpec::Type::boolean) others = {"false", "true"};
  std::erase(others, parameter.default_value);
  return others;
}

/// `culler` with every pair of choices of two parameters of its build. What only several parameters
/// together break (a volume that does not fit a structure, a builder in a rebuild) shows in pairs.
std::vector<std::string> pairs_of_build_choices(const CullerInfo& culler) {
  std::vector<std::string> specs;
  const auto for_each_choice = [](const ParameterSpec& parameter, auto&& act) {
    if (parameter.stage != ParameterSpec::Stage::build) return;
    for (const std::string& choice : parameter.choices) {
      if (choice != parameter.default_value) act(parameter.name + "=" + choice);
    }
  };
  const std::vector<ParameterSpec>& parameters = culler.parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    for (std::size_t j = i + 1; j < parameters.size(); ++j) {
      for_each_choice(parameters[i], [&](const std::string& first) {
        for_each_choice(parameters[j], [&](const std::string& second) {
          // Other tests do not read which sphere.
          const bool with_sphere = first == "test=sphere" || first == "test=dual";
          if (parameters[j].name == "sphere" && !with_sphere) return;
          specs.push_back(culler.name + "[" + first + "," + second + "]");
        });
      });
    }
  }
  return specs;
}

/// Every culler with its defaults, with each choice or switch of each parameter, and with pairs of
/// those that it is built by; and the chains.
std::vector<std::string> specs_under_contract() {
  std::vector<std::string> specs;
  const Registry registry = all_cullers();
  for (const auto& [name, entry] : registry.entries()) {
    specs.push_back(name);
    for (const ParameterSpec& parameter : entry.info.parameters) {
      for (const std::string& other : others_of(parameter)) {
        specs.push_back(name + "[" + parameter.name + "=" + other + "]");
      }
    }
    for (std::string& pair : pairs_of_build_choices(entry.info)) specs.push_back(std::move(pair));
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

/// All specifications of cullers that test objects by volumes of choice.
std::vector<std::string> specs_with_volumes() {
  const Registry registry = all_cullers();
  std::vector<std::string> specs = specs_under_contract();
  std::erase_if(specs, [&](const std::string& spec) {
    const auto entry = registry.entries().find(spec.substr(0, spec.find('[')));
    return spec.find('>') != std::string::npos || entry == registry.entries().end() ||
           std::ranges::find(entry->second.info.parameters, "test", &ParameterSpec::name) ==
               entry->second.info.parameters.end();
  });
  return specs;
}

/// Long thin things at all angles, whose boxes, spheres and oriented boxes differ much.
Scene scattered_sticks(Random& random) {
  Scene scene;
  scene.meshes = {cube_mesh(), sphere_mesh(5)};
  for (std::uint32_t i = 0; i < 400; ++i) {
    const double angle = random.uniform(0.0, 3.0);
    const double length = random.uniform(0.5, 6.0);
    const glm::dvec3 along(std::cos(angle), 0.0, std::sin(angle));
    glm::dmat4x3 transform = placed(
        {random.uniform(-60.0, 60.0), random.uniform(-60.0, 60.0), random.uniform(-60.0, 60.0)});
    transform[0] = along * length;
    transform[1] *= 0.1;
    transform[2] = glm::dvec3(-along.z, 0.0, along.x) * 0.3;
    scene.objects.push_back({i % 2, transform, none_id});
  }
  scene.finish();
  return scene;
}

// The contract's scenes have too few objects for nodes that hide what their objects' volumes show.
TEST(ContractOverHistories, StatelessCullersKeepTheSameWhereverObjectsHaveBeen) {
  Random random(5);
  const Scene scene = scattered_sticks(random);
  Changes away;
  Changes back;
  for (ObjectId object = 0; object < scene.object_count(); ++object) {
    glm::dmat4x3 transform = scene.objects[object].transform;
    back.moved.push_back(object);
    back.transforms.push_back(transform);
    transform[3] = {random.uniform(-60.0, 60.0), random.uniform(-60.0, 60.0),
                    random.uniform(-60.0, 60.0)};
    away.moved.push_back(object);
    away.transforms.push_back(transform);
  }
  std::vector<Camera> cameras;
  for (int i = 0; i < 30; ++i) {
    const auto point = [&] {
      const double x = random.uniform(-50.0, 50.0);
      const double y = random.uniform(-50.0, 50.0);
      return glm::dvec3(x, y, random.uniform(-50.0, 50.0));
    };
    const glm::dvec3 eye = point();
    cameras.push_back(camera_at(eye, point()));
  }
  std::size_t stateless = 0;
  for (const std::string& spec : specs_with_volumes()) {
    CullerRun settled(spec, scene);
    if (settled.culler().info().repeatability != Repeatability::stateless) continue;
    ++stateless;
    CullerRun travelled(spec, scene);
    travelled.update(cameras.front(), away);
    travelled.update(cameras.front(), back);
    for (const Camera& camera : cameras) {
      std::vector<ObjectId> expected = settled.objects(camera);
      std::vector<ObjectId> kept = travelled.objects(camera);
      std::ranges::sort(expected);
      std::ranges::sort(kept);
      ASSERT_EQ(kept, expected) << spec;
    }
  }
  EXPECT_GT(stateless, 50U);
}

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

TEST_P(EveryWrongVariant, IsShownAtItsFirstWrongPixel) {
  Registry registry;
  add_wrong_variants(registry);
  std::optional<Witness> witness;
  check_contract(registry, GetParam(), &witness);
  ASSERT_TRUE(witness.has_value());
  EXPECT_NE(witness->triangle, witness->instead);
  EXPECT_FALSE(witness->scene.empty());
  EXPECT_GE(witness->window_px.x, 0.0);
  EXPECT_GE(witness->window_px.y, 0.0);
  // Wrong pixels are vermillion in the picture, and nothing else is.
  const Image& picture = witness->picture;
  std::size_t marked = 0;
  for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3) {
    marked += picture.rgb[i] == 213 && picture.rgb[i + 1] == 94 && picture.rgb[i + 2] == 0;
  }
  EXPECT_GT(marked, 0U);
}

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
                    Breach{Misdeed::has_poor_sets, "guarantee", "hit what their sets lack"},
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

TEST(ContractCheck, ShowsWhatMethodsLeaveOutThatPromiseNothing) {
  std::optional<Witness> witness;
  check_contract(all_cullers(), "frustum.wrong", &witness);
  ASSERT_TRUE(witness.has_value());
  EXPECT_GT(witness->wrong_px, 0U);
  witness.reset();
  check_contract(all_cullers(), "frustum.flat", &witness);
  EXPECT_FALSE(witness.has_value()) << "nothing is wrong";
}

TEST(ContractCheck, RefusesAnUnknownCuller) {
  EXPECT_THROW(check_contract(all_cullers(), "no.such"), InputError);
}

}  // namespace
}  // namespace vislab
