#include "common/culler/registry.h"

#include <gtest/gtest.h>

#include "algorithms/all_cullers.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

Registry all_cullers() {
  Registry registry;
  register_all_cullers(registry);
  return registry;
}

std::string refusal(const std::string& spec) {
  return input_error([&] { all_cullers().make(spec); });
}

TEST(Registry, KnowsTheCullersOfTheLab) {
  const Registry registry = all_cullers();
  for (const char* name : {"none", "oracle", "frustum.flat", "backface.polygon",
                           "occlusion.stop_and_wait", "skeleton.example"}) {
    EXPECT_EQ(registry.entry(name).info.name, name);
    EXPECT_EQ(registry.make(name)->info().name, name);
  }
}

TEST(Registry, DoesNotTakeANameTwice) {
  Registry registry = all_cullers();
  EXPECT_THROW(registry.add(registry.entry("none")), std::logic_error);
}

TEST(Registry, GivesEqualChainsEqualKeys) {
  const Registry registry = all_cullers();
  const std::string key =
      "backface.polygon[form=hesse,open=two_sided] > occlusion.stop_and_wait[threshold_px=7]";
  for (const char* spec :
       {"backface.polygon>occlusion.stop_and_wait[threshold_px=7]",
        " backface.polygon[open=two_sided]  >  occlusion.stop_and_wait[threshold_px=007] ",
        "backface.polygon[ open = two_sided ] > occlusion.stop_and_wait[threshold_px= 7]"}) {
    EXPECT_EQ(registry.canonical(spec), key);
    EXPECT_EQ(registry.short_name(spec),
              "backface.polygon > occlusion.stop_and_wait[threshold_px=7]");
  }
  EXPECT_EQ(registry.canonical(key), key);
}

TEST(Registry, RefusesAnUnknownCullerWithTheKnownNames) {
  for (const char* spec : {"frustum.round", "none > frustum.round", "frustum", "None"}) {
    const std::string message = refusal(spec);
    EXPECT_NE(message.find("frustum.flat"), std::string::npos) << spec << ": " << message;
    EXPECT_NE(message.find("backface.polygon"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(Registry, RefusesMalformedText) {
  for (const char* spec :
       {"", " ", ">", "none >", "> none", "none > > none", "frustum.flat[",
        "frustum.flat[test=vertex", "frustum.flat]", "frustum.flat[test]",
        "frustum.flat[test=vertex]x", "frustum.flat[test=vertex,test=vertex]",
        "frustum.flat[[test=vertex]]", "frustum.flat[,]", "a b", "frustum.flat[=box]",
        "frustum.flat[test=]", "[test=vertex]", "frustum.flat[]"}) {
    EXPECT_NE(refusal(spec), "") << "'" << spec << "' was taken";
  }
}

}  // namespace
}  // namespace vislab
