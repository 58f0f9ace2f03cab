// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/located_yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "chain_dynamics/error.hpp"
#include "reference.hpp"

namespace chain_dynamics::located_yaml_test {

using ::testing::HasSubstr;
using ::testing::StartsWith;

LocatedMap mapOf(const std::string& text) { return LocatedValue::ofText(text, "a.yaml").map(); }

TEST(LocatedYaml, ValuesHaveTheTypesThatTheyLookLike) {
  LocatedMap map = mapOf(
      "text: one\nquoted: '1'\nnumber: 1e-3\ninteger: -7\ntruth: true\nlist: [1, two]\n"
      "lines: >-\n  a\n  b\nnested: {deep: {er: 2}}\nnull: ~\n");
  EXPECT_EQ(map.required("text").text(), "one");
  EXPECT_EQ(map.required("quoted").text(), "1");
  EXPECT_EQ(map.required("number").number(), 1e-3);
  EXPECT_EQ(map.required("integer").integer(), -7);
  EXPECT_TRUE(map.required("truth").truth());
  EXPECT_EQ(map.required("list").entries()[1].text(), "two");
  EXPECT_EQ(map.required("lines").text(), "a b");
  EXPECT_EQ(map.optional("null"), std::nullopt);
  LocatedMap nested = map.required("nested").map();
  LocatedMap deep = nested.required("deep").map();
  EXPECT_EQ(deep.required("er").key(), "nested.deep.er");
  EXPECT_NO_THROW(map.rejectOthers());
  using Scalar = LocatedValue::Scalar;
  EXPECT_EQ(map.required("text").scalar(), Scalar(std::string("one")));
  EXPECT_EQ(map.required("quoted").scalar(), Scalar(std::string("1")));
  EXPECT_EQ(map.required("integer").scalar(), Scalar(std::int64_t{-7}));
  EXPECT_EQ(map.required("truth").scalar(), Scalar(true));
}

TEST(LocatedYaml, ErrorsNameFileLineKeyAndRemedy) {
  const std::string text = "schema: 1\ntip: 7\nlist: [1, a]\nempty:\nlast: 1\n";
  EXPECT_EQ(errorOf([&] { mapOf(text).required("tip").text(); }),
            "a.yaml:2: tip: expected a text, got '7'; put it in quotes");
  EXPECT_EQ(errorOf([&] { mapOf(text).required("list").entries()[1].number(); }),
            "a.yaml:3: list[1]: expected a number, got 'a'");
  EXPECT_EQ(errorOf([&] { mapOf(text).required("list").entries(3); }),
            "a.yaml:3: list: expected a list of 3, got a list of 2");
  EXPECT_EQ(errorOf([&] { mapOf(text).required("name"); }),
            "a.yaml:1: the key name is missing; keys: schema, tip, list, empty, last");
  EXPECT_EQ(errorOf([&] {
              mapOf(text).expect({"name", "tip", "plugin"});
            }),
            "a.yaml:1: the keys name, plugin are missing; keys: schema, tip, list, empty, last");
  EXPECT_EQ(errorOf([&] { mapOf(text).entries()[3].second.number(); }),
            "a.yaml:4: empty: expected a number, got nothing");
  EXPECT_EQ(errorOf([&] {
              LocatedMap map = mapOf("schema: 1\ntpi: tool0\n");
              map.required("schema");
              map.optional("tip");
              map.rejectOthers();
            }),
            "a.yaml:2: tpi: unknown key; did you mean tip?; known here: schema, tip");
  EXPECT_EQ(errorOf([] { mapOf("a: 1\nb: 2\na: 3\n"); }),
            "a.yaml:3: a: stands here for a second time");
}

TEST(LocatedYaml, NamedValuesAreCalledThatInErrors) {
  const LocatedValue joint =
      mapOf("a: 1\njoints: [{name: elbow, mass: {value: x}}]\n").required("joints").entries()[0];
  LocatedMap map = joint.named("joint elbow").map();
  EXPECT_EQ(errorOf([&] { map.required("mass").map().required("value").number(); }),
            "a.yaml:2: joint elbow: mass.value: expected a number, got 'x'");
  EXPECT_EQ(errorOf([&] { map.required("limits"); }),
            "a.yaml:2: joint elbow: the key limits is missing; keys: name, mass");
}

TEST(LocatedYaml, LeavesHaveDottedNames) {
  const auto leaves = mapOf("a: {b: {c: 1, d: [2]}}\nf.g: x\n").leaves();
  ASSERT_EQ(leaves.size(), 3U);
  EXPECT_EQ(leaves[0].first, "a.b.c");
  EXPECT_EQ(leaves[1].second.entries()[0].integer(), 2);
  EXPECT_EQ(leaves[2].first, "f.g");
  EXPECT_EQ(errorOf([] { mapOf("a: {b: 1}\na.b: 2\n").leaves(); }),
            "a.yaml:2: a.b: stands here for a second time");
}

TEST(LocatedYaml, OneDocumentOfPlainYaml) {
  EXPECT_EQ(errorOf([] { mapOf("a: 1\n---\nb: 2\n"); }),
            "a.yaml:2: isn't YAML: expected one document, got another one");
  for (const std::string table : {",a\n", ",", "\"time\",\"q\"\n1,2\n", "# heading\n'time', 1\n"}) {
    EXPECT_THAT(errorOf([&] { mapOf(table); }), HasSubstr("is it a table?")) << table;
  }
  EXPECT_EQ(errorOf([] { mapOf("a: &b 1\nc: *b\n"); }),
            "a.yaml:2: isn't YAML: the alias *b isn't supported; write out what it stands for");
  EXPECT_EQ(
      errorOf([] { mapOf("a: &b !!float 1\n"); }),
      "a.yaml:1: isn't YAML: the tag 'tag:yaml.org,2002:float' isn't supported; leave it out");
  EXPECT_EQ(errorOf([] { mapOf("a: ! 1\n"); }),
            "a.yaml:1: isn't YAML: the tag '!' isn't supported; leave it out");
  EXPECT_EQ(errorOf([] { mapOf(""); }), "a.yaml: is empty; expected keys with values");
  EXPECT_EQ(errorOf([] { mapOf("# nothing\n"); }), "a.yaml: is empty; expected keys with values");
  EXPECT_EQ(errorOf([] { mapOf("root:x:0:0:root:/root:/bin/bash\nbin:x:1:1\n"); }),
            "a.yaml:1: expected keys with values, got a text");
  EXPECT_EQ(errorOf([] { mapOf("a: 1\nb:\nc\n"); }),
            "a.yaml:3: isn't YAML: expected a colon behind the key, got none");
  EXPECT_EQ(errorOf([] { mapOf("a: 1\nb: \"c\n"); }),
            "a.yaml:2: isn't YAML: the quote \" isn't closed");
  EXPECT_EQ(errorOf([] { mapOf("a: 1\n: 2\n"); }),
            "a.yaml:2: isn't YAML: expected a key before the colon, got none");
  EXPECT_EQ(errorOf([] { mapOf("a: 'it''s\n"); }),
            "a.yaml:1: isn't YAML: the quote ' isn't closed");
  EXPECT_EQ(mapOf("? a\n: 'it''s'\n\"b\" : 1\n").required("a").text(), "it's");
  EXPECT_EQ(mapOf("a:\n  c\n").required("a").text(), "c");
  // yaml-cpp makes a byte of these that isn't UTF-8
  EXPECT_THAT(errorOf([] { mapOf("a: \"\\N\"\n"); }), HasSubstr("an escape stands for NUL, a"));
}

TEST(LocatedYaml, HostileTextsAreRefusedAtOnce) {
  for (const std::string part : {"[", "{", "- ", "? ", "a: [", "[a: ", "{a: "}) {
    std::string nested;
    for (int i = 0; i < 100000; ++i) {
      nested += part;
    }
    EXPECT_THAT(errorOf([&] { mapOf(nested); }),
                StartsWith("a.yaml:1: isn't YAML: expected at most 50 levels, got more"))
        << part;
  }
  std::string many = "a: [";
  for (int i = 0; i < 300000; ++i) {
    many += "1,";
  }
  EXPECT_THAT(errorOf([&] { mapOf(many + "]"); }), HasSubstr("at most 200000 values, got more"));
  EXPECT_THAT(errorOf([] { LocatedValue::ofFile("/dev/zero"); }),
              HasSubstr("/dev/zero: expected YAML of at most 4 MiB, got a longer file"));
}

TEST(LocatedYaml, ErrorsAreOfTheKindThatTheCallerChooses) {
  const auto raise = [](const std::string& text) { throw std::out_of_range(text); };
  EXPECT_THROW(LocatedValue::ofText("[", "a.yaml", raise), std::out_of_range);
  EXPECT_THROW(LocatedValue::ofFile("/no/such/file", raise), std::out_of_range);
  LocatedMap map = LocatedValue::ofText("a: {b: c}\n", "a.yaml", raise).map();
  EXPECT_THROW(map.required("a").map().required("b").number(), std::out_of_range);
  EXPECT_THROW(map.required("c"), std::out_of_range);
}

}  // namespace chain_dynamics::located_yaml_test
