// SPDX-License-Identifier: Apache-2.0

#include "number.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <locale>
#include <string>

namespace chain_dynamics::number_test {

TEST(Number, DecimalNumbersAreRead) {
  EXPECT_EQ(finiteNumber("0.1273"), 0.1273);
  EXPECT_EQ(finiteNumber("+2"), 2.0);
  EXPECT_EQ(finiteNumber("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(finiteNumber("1E+2"), 100.0);
  EXPECT_EQ(finiteNumber(".5"), 0.5);
  EXPECT_EQ(finiteNumber("5."), 5.0);
  EXPECT_EQ(finiteNumber("007"), 7.0);
  EXPECT_EQ(finiteNumber(" \t\r\n1.5\n "), 1.5);
  EXPECT_EQ(finiteNumber("1.7976931348623157e308"), std::numeric_limits<double>::max());
  EXPECT_EQ(finiteNumber("4.9406564584124654e-324"), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(finiteNumber(std::string(400, '1') + "e-399"), 1.1111111111111112);
}

TEST(Number, NumbersTooSmallForADoubleAreZero) {
  EXPECT_EQ(finiteNumber("1e-400"), 0.0);
  EXPECT_EQ(finiteNumber("-0." + std::string(400, '0') + "1"), 0.0);
}

TEST(Number, AnythingElseIsNoNumber) {
  for (const char* const text : {"",
                                 " ",
                                 "+",
                                 "-",
                                 ".",
                                 "e5",
                                 "1e",
                                 "1e+",
                                 "1e400",
                                 "-1e400",
                                 "1..5",
                                 "1.5.2",
                                 "+-1",
                                 "--1",
                                 "+ 1",
                                 "1 2",
                                 "1,5",
                                 "1_0",
                                 "-9_81",
                                 "1:30",
                                 "0x10",
                                 "0o17",
                                 "0b1",
                                 "1e1.5",
                                 "1f",
                                 "1.5kg",
                                 "nan",
                                 "NaN",
                                 "inf",
                                 "-inf",
                                 "infinity",
                                 ".inf",
                                 ".nan",
                                 "1\v",
                                 "\f1",
                                 "1\xC2\xA0",  // no-break space
                                 "\xEF\xBC\x91",
                                 "\xD9\xA1",  // a one of full width, of Arabic
                                 "\xE2\x88\x92"
                                 "1"}) {  // a minus sign that isn't ASCII's
    EXPECT_FALSE(finiteNumber(text)) << text;
  }
  EXPECT_FALSE(finiteNumber(std::string("1\0", 2)));
}

/// A language that writes 1.234,5.
struct German : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Number, TheLocaleHasNoInfluence) {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new German));
  const auto number = finiteNumber("1.5");
  const auto small = finiteNumber("1e-400");
  const auto comma = finiteNumber("1,5");
  std::locale::global(before);
  EXPECT_EQ(number, 1.5);
  EXPECT_EQ(small, 0.0);
  EXPECT_FALSE(comma);
}

}  // namespace chain_dynamics::number_test
