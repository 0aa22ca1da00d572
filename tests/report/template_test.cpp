#include "report/template.h"

#include <gtest/gtest.h>

#include "tests/input_error.h"

namespace vislab {
namespace {

Fields some_fields() {
  Fields fields;
  fields.values["name"] = "outer";
  for (const char* name : {"a", "b"}) {
    Fields entry;
    entry.values["entry"] = name;
    fields.lists["list"].push_back(entry);
  }
  fields.flag("yes", true);
  fields.flag("no", false);
  return fields;
}

std::string fill(const std::string& text) { return fill_template(text, some_fields(), "t.md"); }

TEST(Template, ValuesFillTheirGaps) { EXPECT_EQ(fill("<{{name}}>"), "<outer>"); }

TEST(Template, SectionsRepeatForEachEntryAndSeeOuterNames) {
  EXPECT_EQ(fill("{{#list}}{{name}}.{{entry}} {{/list}}"), "outer.a outer.b ");
}

TEST(Template, SectionsOfEmptyListsAreLeftOutAndTheirOppositesStand) {
  EXPECT_EQ(fill("{{#yes}}1{{/yes}}{{#no}}2{{/no}}{{^no}}3{{/no}}{{^yes}}4{{/yes}}"), "13");
}

TEST(Template, TagsAloneOnALineLeaveNoLine) {
  EXPECT_EQ(fill("x\n{{#list}}\n- {{entry}}\n{{/list}}\ny\n"), "x\n- a\n- b\ny\n");
}

TEST(Template, SectionsNest) {
  EXPECT_EQ(fill("{{#list}}{{#yes}}{{entry}}{{/yes}}{{#no}}-{{/no}}{{/list}}"), "ab");
}

TEST(Template, ValuesAreNotFilledAgain) {
  Fields fields;
  fields.values["a"] = "{{b}}";
  EXPECT_EQ(fill_template("{{a}}", fields, "t.md"), "{{b}}");
}

void expect_message(const std::string& text, const std::string& part) {
  EXPECT_TRUE(says(input_error([&] { fill(text); }), part)) << text;
}

TEST(Template, FaultsAreNamedWithTheirLine) {
  expect_message("\n\n{{unknown}}", "t.md:3: there is no value 'unknown'");
  expect_message("{{#unknown}}{{/unknown}}", "there is no list 'unknown'");
  expect_message("{{#list}}", "section 'list' has no end");
  expect_message("{{#list}}{{/name}}", "does not end the section 'list'");
  expect_message("{{name", "without '}}'");
}

}  // namespace
}  // namespace vislab
