// Every culler of back faces that calls itself conservative, with every choice of its parameters,
// held to exact arithmetic on solids and eyes made to break it: it leaves out no triangle that is
// seen from the front or edge-on. A culler that joins the registry is judged without an edit here.
#include <gtest/gtest.h>

#include <iostream>
#include <set>

#include "common/simd/simd_target.h"
#include "tests/algorithms/facing_worlds.h"
#include "tests/geometry/exact_facing.h"

namespace vislab {
namespace {

using test::count_facings;
using test::exact_facings;
using test::Facing;
using test::facing_camera;
using test::facing_world;
using test::FacingCounts;
using test::MeshKind;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr int world_count = 6;
#else
constexpr int world_count = 60;
#endif
constexpr int cameras_per_world = 25;
constexpr int cameras_per_fine_world = 6;

Registry all_cullers() {
  Registry registry;
  register_all_cullers(registry);
  return registry;
}

/// `settings` are "name=value"; none: the culler's name alone.
std::string spec_of(const std::string& name, const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) text += (text.empty() ? "" : ",") + setting;
  return text.empty() ? name : name + "[" + text + "]";
}

/// Every other value of a choice or a switch, both ends of a number.
std::vector<std::string> other_values(const ParameterSpec& parameter) {
  using Type = ParameterSpec::Type;
  std::vector<std::string> values = parameter.choices;
  if (parameter.type == Type::boolean) values = {"false", "true"};
  if (parameter.type == Type::integer) {
    values = {std::to_string(static_cast<long long>(parameter.min)),
              std::to_string(static_cast<long long>(parameter.max))};
  }
  if (parameter.type == Type::real) {
    values = {std::to_string(parameter.min), std::to_string(parameter.max)};
  }
  std::erase(values, parameter.default_value);
  return values;
}

/// The cullers of back faces with their defaults, and with one parameter at another value; those
/// that promise to be conservative. With `open`, on meshes that are not solid: those that can be
/// told to test such meshes, and would be conservative if they were not told.
std::vector<std::string> conservative_specs(bool open) {
  const Registry registry = all_cullers();
  std::vector<std::string> specs;
  for (const auto& [name, entry] : registry.entries()) {
    const CullerInfo& info = entry.info;
    if (info.culls != Culls::back_faces) continue;
    // What needs a device leaves out nothing itself: the device does, judged by the image.
    if (info.needs_device) continue;
    const bool can_open =
        std::ranges::find(info.parameters, "open", &ParameterSpec::name) != info.parameters.end();
    if (open && !can_open) continue;
    std::vector<std::vector<std::string>> variants{{}};
    for (const ParameterSpec& parameter : info.parameters) {
      if (parameter.name == "open") continue;
      for (const std::string& value : other_values(parameter)) {
        variants.push_back({parameter.name + "=" + value});
      }
    }
    for (std::vector<std::string>& settings : variants) {
      if (registry.make(spec_of(name, settings))->info().guarantee != Guarantee::conservative) {
        continue;
      }
      if (open) settings.emplace_back("open=cull");
      specs.push_back(spec_of(name, settings));
    }
  }
  return specs;
}

/// Eyes before one world, and what is exactly true there.
struct Sitting {
  Scene scene;
  std::vector<Camera> cameras;
  std::vector<std::vector<Facing>> facings;  // by camera

  Sitting(Random& random, bool exact, bool solid, MeshKind kind = MeshKind::ordinary)
      : scene(facing_world(random, exact, solid, kind)) {
    const SceneState state(scene);
    const int count = kind == MeshKind::fine ? cameras_per_fine_world : cameras_per_world;
    for (int i = 0; i < count; ++i) {
      cameras.push_back(facing_camera(random, scene));
      facings.push_back(
          exact_facings(scene, {0, cameras.back(), Viewport{64, 64}, state.view(), 0.0}));
    }
  }

  /// What a culler leaves out before all cameras.
  struct Judgement {
    FacingCounts counts;
    std::size_t first_wrong = 0;  // a camera, if anything is wrong
  };
  Judgement judged(const std::string& spec) const {
    Judgement sum;
    CullerRun run(spec, scene);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      run.update(cameras[i], {});
      const std::vector<TriangleRange> kept = run.emitted(cameras[i]);
      const FacingCounts counts = count_facings(scene, run.frame(cameras[i]), facings[i], kept);
      if (!counts.all_right() && sum.counts.all_right()) sum.first_wrong = i;
      sum.counts += counts;
    }
    return sum;
  }
};

/// Of twelve worlds two have coordinates at either end of float; the last two of all are fine.
MeshKind kind_of(int world) {
  if (world >= world_count - 2) return MeshKind::fine;
  switch (world % 12) {
    case 2:
    case 7:
      return MeshKind::tiny;
    case 3:
    case 8:
      return MeshKind::huge;
    default:
      return MeshKind::ordinary;
  }
}

class BackfaceExactness : public testing::Test {
 protected:
  static void judge_all(bool solid) {
    const std::vector<std::string> specs = conservative_specs(!solid);
    EXPECT_GE(specs.size(), 3U);
    std::vector<FacingCounts> counts(specs.size());
    Random random(solid ? 31 : 32);
    std::uint64_t edge_on = 0;
    for (int world = 0; world < world_count; ++world) {
      const Sitting sitting(random, world % 2 == 0, solid, kind_of(world));
      for (const std::vector<Facing>& facings : sitting.facings) {
        edge_on += static_cast<std::uint64_t>(std::ranges::count(facings, Facing::edge_on));
      }
      for (std::size_t s = 0; s < specs.size(); ++s) {
        const auto& [now, first_wrong] = sitting.judged(specs[s]);
        counts[s] += now;
        EXPECT_TRUE(now.all_right())
            << specs[s] << " leaves out " << now.front_left_out << " front faces and "
            << now.edge_on_left_out << " edge-on ones, and keeps " << now.twice
            << " twice, in world " << world << ", first before camera " << first_wrong;
      }
    }
    EXPECT_GT(edge_on, static_cast<std::uint64_t>(world_count) * 10);  // the eyes do hit planes
    std::cout << world_count * cameras_per_world << " cameras, " << edge_on
              << " triangles exactly edge-on\n";
    for (std::size_t s = 0; s < specs.size(); ++s) {
      std::cout << specs[s] << ": " << counts[s].back << " back faces, " << counts[s].back_left_out
                << " left out\n";
      EXPECT_GT(counts[s].back, 1000U);
      if (specs[s].find("polygon") != std::string::npos) {
        EXPECT_GT(counts[s].recall(), 0.5) << specs[s];
      }
    }
  }
};

TEST_F(BackfaceExactness, ConservativeCullersLeaveOutOnlyBackFacesOfSolids) { judge_all(true); }

TEST_F(BackfaceExactness, ToldToTestOpenMeshesTheyStillLeaveOutOnlyBackFaces) { judge_all(false); }

TEST_F(BackfaceExactness, NothingDependsOnTheInstructionSetOrTheNumberOfThreads) {
  Random random(33);
  for (int world = 0; world < 4; ++world) {
    const Sitting sitting(random, world % 2 == 0, world < 3);
    for (const std::string& spec : conservative_specs(world == 3)) {
      const auto answers = [&](int threads) {
        BuildContext context;
        context.threads = threads;
        CullerRun run(spec, sitting.scene, context);
        std::vector<std::vector<TriangleRange>> all;
        for (const Camera& camera : sitting.cameras) {
          run.update(camera, {});
          all.push_back(run.emitted(camera));
        }
        return all;
      };
      const auto expected = answers(1);
      EXPECT_TRUE(answers(2) == expected) << spec << " with two threads";
      for (const std::string& target : simd_targets()) {
        const SimdTargetScope scope(target);
        EXPECT_TRUE(answers(1) == expected) << spec << " with " << target;
      }
    }
  }
}

TEST_F(BackfaceExactness, SolidsAroundTheEyeAreKeptWhole) {
  Random random(34);
  for (int i = 0; i < 5; ++i) {
    const Scene scene = facing_world(random, false, true);
    for (const std::string& spec : conservative_specs(false)) {
      CullerRun run(spec, scene);
      for (ObjectId object = 0; object < scene.object_count(); ++object) {
        const Mesh& mesh = scene.mesh_of(object);
        const glm::dvec3 eye =
            scene.objects[object].transform *
            glm::dvec4(glm::dvec3(mesh.bounds.center()) + test::vector_in(random, 0.5), 1.0);
        Camera camera = camera_at(eye, eye + test::vector_in(random, 1.0) * 10.0);
        camera.lens = perspective_lens(1.0, 1.0, 1e-3, 1e9);
        run.update(camera, {});
        std::uint32_t kept = 0;
        for (const TriangleRange& range : run.emitted(camera)) {
          if (range.object == object) kept += range.count;
        }
        EXPECT_EQ(kept, mesh.triangles.size()) << spec << ", object " << object;
      }
    }
  }
}

/// Mistakes that cost time or back faces, but leave out nothing that is seen.
const std::set<std::string> harmless_mistakes{"printed_cost_sign"};

TEST_F(BackfaceExactness, FindsEveryMistakeOfTheNegativeControls) {
  const Registry registry = all_cullers();
  std::size_t found = 0;
  for (const auto& [name, entry] : registry.entries()) {
    if (entry.info.culls != Culls::back_faces || entry.info.guarantee != Guarantee::erroneous) {
      continue;
    }
    for (const ParameterSpec& parameter : entry.info.parameters) {
      if (parameter.name != "error") continue;
      for (const std::string& error : parameter.choices) {
        FacingCounts counts;
        Random random(35);
        for (int world = 0; world < 6; ++world) {
          counts += Sitting(random, world % 2 == 0, true)
                        .judged(spec_of(name, {"error=" + error}))
                        .counts;
        }
        std::cout << error << ": " << counts.front_left_out << " front faces and "
                  << counts.edge_on_left_out << " edge-on left out; back faces " << counts.back
                  << ", left out " << counts.back_left_out << "\n";
        if (harmless_mistakes.contains(error)) {
          EXPECT_TRUE(counts.all_right()) << error;
        } else {
          EXPECT_GT(counts.front_left_out, 0U) << error;
        }
        ++found;
      }
    }
  }
  EXPECT_GE(found, 3U);
}

}  // namespace
}  // namespace vislab
