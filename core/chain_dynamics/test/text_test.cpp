// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"

namespace chain_dynamics::text_test {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Text, ErrorsHaveOneFormatWithoutTheEmptyParts) {
  EXPECT_EQ(errorText("a.yaml:3", "mass", "a number", "'x'", "write it in kg"),
            "a.yaml:3: mass: expected a number, got 'x'; write it in kg");
  EXPECT_EQ(errorText("a.yaml", "mass", "", "'x'"), "a.yaml: mass: got 'x'");
  EXPECT_EQ(errorText("", "mass", "a number"), "mass: expected a number");
}

TEST(Text, ControlCharactersAreEscaped) {
  EXPECT_EQ(printable("a\x1b[31mred\n\t\r\x7f"), "a\\x1b[31mred\\n\\t\\r\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xC2\x9B 2J"), "\\u009b 2J");  // what ESC [ is in eight bits
  EXPECT_EQ(printable("a\xE2\x80\xAE"
                      "b"),
            "a\\u202eb");  // writes b before a
}

TEST(Text, WhatIsUtf8StaysAndOtherBytesAreEscaped) {
  const std::string arms = "Ärmel, 腕, \xF0\x9F\xA6\xBE \\x1b";
  EXPECT_EQ(printable(arms), arms);
  EXPECT_TRUE(isPrintable(arms));
  EXPECT_EQ(printable("\xC4rmel"), "\\xc4rmel");
  EXPECT_EQ(printable("\xC0\x80 \xED\xA0\x80 \xF5\x80\x80\x80 \xE8\x85"),
            "\\xc0\\x80 \\xed\\xa0\\x80 \\xf5\\x80\\x80\\x80 \\xe8\\x85");
  EXPECT_FALSE(isPrintable("\xC4rmel"));
  EXPECT_FALSE(isPrintable("\xE0\x80\x80"));      // a zero in three bytes
  EXPECT_FALSE(isPrintable("\xF4\x90\x80\x80"));  // beyond the last character
  EXPECT_FALSE(isPrintable("a\nb"));
}

TEST(Text, PrintableTextsStayWhenTheyAreQuotedAgain) {
  const std::string once = printable("a\x1b[0m\xC4");
  EXPECT_EQ(printable(once), once);
}

TEST(Text, LongTextsKeepBeginningAndEnd) {
  const std::string text = printable("begin" + std::string(100000, 'x') + "end");
  EXPECT_LT(text.size(), 600U);
  EXPECT_THAT(text, StartsWith("beginx"));
  EXPECT_THAT(text, HasSubstr("bytes left out"));
  EXPECT_THAT(text, EndsWith("xend"));

  // cut between characters, however many bytes they have
  for (std::size_t shift = 0; shift < 4; ++shift) {
    std::string arms(shift, ' ');
    for (int i = 0; i < 1000; ++i) arms += "\xF0\x9F\xA6\xBE";
    EXPECT_EQ(printable(arms).find("\\x"), std::string::npos);
  }
}

TEST(Text, EveryErrorOfThisPackageIsPrintable) {
  const std::string name = "arm\x1b[2J" + std::string(100000, 'x');
  const ModelError parts("file", "joint " + name, "a joint", "'" + name + "'", "correct " + name);
  EXPECT_TRUE(isPrintable(parts.what()));
  EXPECT_LT(std::string(parts.what()).size(), 4000U);

  const ModelError whole("joint " + name);
  EXPECT_TRUE(isPrintable(whole.what()));
  EXPECT_LT(std::string(whole.what()).size(), 10000U);
}

TEST(Text, WordsAreJoined) {
  EXPECT_EQ(joined({}), "");
  EXPECT_EQ(joined({"", "b"}), ", b");
  EXPECT_EQ(joined({"a", "b", "c"}, " "), "a b c");
}

TEST(Text, EditDistanceCountsInsertedDeletedReplacedAndExchangedLetters) {
  EXPECT_EQ(editDistance("", "axis"), 4U);
  EXPECT_EQ(editDistance("axis", "axis"), 0U);
  EXPECT_EQ(editDistance("axes", "axis"), 1U);
  EXPECT_EQ(editDistance("orgin", "origin"), 1U);
  EXPECT_EQ(editDistance("xzy", "xyz"), 1U);
  EXPECT_EQ(editDistance("Origin", "origin"), 0U);
  EXPECT_EQ(editDistance("kitten", "sitting"), 3U);
  EXPECT_EQ(editDistance("ca", "abc"), 3U);  // optimal string alignment: no letter moves twice
}

TEST(Text, NearestNameIsOneThatIsNear) {
  const std::vector<std::string> known{"origin", "mass", "inertia"};
  EXPECT_EQ(nearestName("orgin", known), "origin");
  EXPECT_EQ(nearestName("Mas", known), "mass");
  EXPECT_EQ(nearestName("iyx", {"ixx", "ixy", "iyy"}), "ixy");  // all near; one has its letters
  EXPECT_EQ(nearestName("com", known), "");
  EXPECT_EQ(nearestName("", known), "");
  EXPECT_EQ(nearestName("a", {"b"}), "");
}

}  // namespace chain_dynamics::text_test
