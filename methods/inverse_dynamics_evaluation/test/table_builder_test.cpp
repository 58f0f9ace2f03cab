// SPDX-License-Identifier: Apache-2.0

#include <gmock/gmock.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation::table_builder_test {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using Strings = std::vector<std::string>;
using Doubles = std::vector<double>;

// A message of its own: owns what a JointSample looks at.
struct Message {
  Strings names;
  Doubles position, velocity, effort, acceleration;
  std::int64_t header_stamp = 0, receive_stamp = 0;
  Eigen::Index number = 0;

  JointSample sample() const {
    const auto numbers = [](const Doubles& values) {
      return JointSample::Numbers{values.data(), values.size()};
    };
    JointSample sample;
    sample.names = &names;
    sample.position = numbers(position);
    sample.velocity = numbers(velocity);
    sample.effort = numbers(effort);
    sample.acceleration = numbers(acceleration);
    sample.header_stamp = header_stamp;
    sample.receive_stamp = receive_stamp;
    sample.message = number;
    return sample;
  }
};

RecordingOptions optionsOf(const Strings& joints, bool effort_required = true) {
  RecordingOptions options;
  options.joints = joints;
  options.effort_required = effort_required;
  return options;
}

// A builder of a table of its own.
struct Built {
  explicit Built(const Strings& joints, bool effort_required = true)
      : builder("bag", optionsOf(joints, effort_required), table) {}

  bool add(const JointSample& sample) { return builder.add(sample); }
  const SampleTable& finish(Clock clock = Clock::kAuto) {
    builder.finish(clock);
    return table;
  }

  SampleTable table;
  TableBuilder builder;
};

Message armMessage() {
  return {{"b", "gripper", "a"}, {2, 9, 1}, {20, 90, 10}, {200, 900, 100}, {}, 5, 7, 0};
}

std::string logErrorOf(const Message& message,
                       const RecordingOptions& options = optionsOf({"a", "b"})) {
  SampleTable table;
  TableBuilder builder("bag: /joint_states", options, table);
  return errorOf<RecordingError>([&] {
    builder.add(message.sample());
    builder.finish(Clock::kAuto);
  });
}

TEST(TableBuilder, MatchesJointsByNameAndLeavesOthersOut) {
  Built builder({"a", "b"});
  builder.add(armMessage().sample());
  Message other_order{{"a", "b"}, {3, 4}, {30, 40}, {300, 400}, {}, 6, 8, 1};
  builder.add(other_order.sample());
  const SampleTable& log = builder.finish();
  EXPECT_EQ(log.q, (Eigen::MatrixXd(2, 2) << 1, 3, 2, 4).finished());
  EXPECT_EQ(log.qd, 10 * log.q);
  EXPECT_EQ(log.effort, 100 * log.q);
  EXPECT_FALSE(log.has_accelerations);
  EXPECT_TRUE(log.notes.empty());
}

TEST(TableBuilder, KeepsEveryNumberOfManySamples) {
  Built builder({"a", "b"});
  Message message = armMessage();
  for (int k = 0; k < 1000; ++k) {
    message.position = {2.0 * k, 9, 1.0 * k};
    builder.add(message.sample());
  }
  const SampleTable& log = builder.finish();
  ASSERT_EQ(log.q.cols(), 1000);
  EXPECT_EQ(log.q.row(0), Eigen::RowVectorXd::LinSpaced(1000, 0, 999));
  EXPECT_EQ(log.q.row(1), 2 * log.q.row(0));
}

TEST(TableBuilder, LeavesMessagesOfOtherJointsOutAndSaysSo) {
  Built builder({"a", "b"});
  Message gripper{{"finger"}, {0}, {0}, {0}, {}, 1, 1, 0};
  EXPECT_FALSE(builder.add(gripper.sample()));
  Message arm = armMessage();
  arm.number = 1;
  EXPECT_TRUE(builder.add(arm.sample()));
  const SampleTable& log = builder.finish();
  EXPECT_EQ(log.q.cols(), 1);
  EXPECT_THAT(log.notes, ElementsAre("1 of 2 messages left out: they hold none of the joints, but "
                                     "finger"));
}

TEST(TableBuilder, TakesTheJointsOfTheFirstSampleIfNoneAreNamed) {
  Built builder({});
  builder.add(armMessage().sample());
  EXPECT_EQ(builder.finish().joint_names, (Strings{"b", "gripper", "a"}));
}

TEST(TableBuilder, TakesHeadersStampsAndThoseOfReceptionIfNoHeaderHasOne) {
  for (const bool stamped : {true, false}) {
    Built builder({"a", "b"});
    for (const std::int64_t k : {0, 1}) {
      Message message = armMessage();
      message.header_stamp = stamped ? 1'000'000'000 * k : 0;
      message.receive_stamp = 9 + 2'000'000'000 * k;
      builder.add(message.sample());
    }
    const SampleTable& log = builder.finish();
    EXPECT_EQ(log.clock(), stamped ? Clock::kHeader : Clock::kReceive);
    EXPECT_EQ(log.time, Eigen::Vector2d(0.0, stamped ? 1.0 : 2.0));
    EXPECT_EQ(log.notes.size(), stamped ? 0U : 1U);
  }
}

TEST(TableBuilder, TimesAreRightWhateverTheStamps) {
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kGreatest = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(nanosecondsBetween(kLeast, kGreatest), 0x1p64);
  EXPECT_EQ(nanosecondsBetween(kGreatest, kLeast), -0x1p64);
  EXPECT_EQ(nanosecondsBetween(1'700'000'000'000'000'001, 1'700'000'000'000'000'004), 3.0);
  EXPECT_EQ(nanosecondsBetween(2, -1), -3.0);
  Built builder({"a", "b"});
  for (const std::int64_t stamp : {-9'000'000'000'000'000'000, 0L, 9'000'000'000'000'000'000}) {
    Message message = armMessage();
    message.header_stamp = stamp;
    builder.add(message.sample());
  }
  EXPECT_THAT(builder.finish().time, ElementsAre(0.0, 9e9, 18e9));
}

TEST(TableBuilder, ReceptionIsTheTimeIfAskedFor) {
  Built builder({"a", "b"});
  for (const std::int64_t k : {0, 1}) {
    Message message = armMessage();
    message.receive_stamp = 9 + 2'000'000'000 * k;
    builder.add(message.sample());
  }
  EXPECT_EQ(builder.finish(Clock::kReceive).time, Eigen::Vector2d(0.0, 2.0));
}

TEST(TableBuilder, TakesTheFirstFrameThatAHeaderNames) {
  Built builder({"a", "b"});
  const Message message = armMessage();
  for (const char* const frame : {"", "base", "other"}) {
    JointSample sample = message.sample();
    sample.frame_id = frame;
    builder.add(sample);
  }
  EXPECT_EQ(builder.finish().frame_id, "base");
}

TEST(TableBuilder, SaysWhatIsWrongWithAMessage) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  RecordingOptions options = optionsOf({"a", "b"});
  options.joints_option = "--joints";
  const std::vector<std::pair<std::function<void(Message&)>, std::string>> mistakes = {
      {[](Message& message) { message.names[0] = "c"; },
       "bag: /joint_states, message 5: expected the joints a, b, got c, gripper, a; missing: b; "
       "give the recording's names with --joints, in the order of the chain"},
      {[](Message& message) {
         message.names = {"x", "y", "z"};
       },
       "bag: /joint_states: expected the joints a, b, got only x, y, z; give the recording's names "
       "with --joints, in the order of the chain"},
      {[](Message& message) { message.names[1] = "a"; },
       "expected each joint once, got b, a, a; repeated: a"},
      {[](Message& message) { message.velocity.clear(); },
       "bag: /joint_states, message 5: velocity: expected 3 numbers, one per name, got an empty "
       "array; joint velocities are needed (accelerations come from them): does the driver publish "
       "them?"},
      {[](Message& message) { message.effort.pop_back(); },
       "effort: expected 3 numbers, one per name, got 2"},
      {[=](Message& message) { message.position[0] = nan; },
       "position of joint b: expected a finite number, got nan"},
      {[](Message& message) { message.velocity[2] = -1e300; },
       "bag: /joint_states, message 5: velocity of joint a: expected a number of a motion, in SI "
       "units, of at most 1e+12, got -1e+300; is the recording damaged?"},
      {[=](Message& message) { message.position[1] = nan; }, "no error"},  // the gripper's
      {[](Message& message) { message.velocity[2] = kLargestNumber; }, "no error"}};
  for (const auto& [spoil, text] : mistakes) {
    Message message = armMessage();
    message.number = 4;
    spoil(message);
    EXPECT_THAT(logErrorOf(message, options), HasSubstr(text));
  }
  const Message one{{"a"}, {1, 2}, {1}, {1}, {}, 1, 1, 0};
  EXPECT_THAT(logErrorOf(one, optionsOf({"a"})), HasSubstr("position: expected 1 number, one per"));
  EXPECT_THAT(errorOf<RecordingError>([] { Built({"a"}).finish(); }),
              HasSubstr("expected joint states, got no message"));
}

TEST(TableBuilder, ProposesANameThatIsLikeAMissingOneButNotThatOfAnotherJoint) {
  const RecordingOptions options = optionsOf({"joint_1", "joint_2"});
  const Message like{{"joint_1", "jiont_2", "finger"}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {}};
  const Message unlike{{"joint_1", "finger"}, {1, 2}, {1, 2}, {1, 2}, {}};
  EXPECT_THAT(logErrorOf(like, options), EndsWith("of the chain; did you mean jiont_2?"));
  EXPECT_THAT(logErrorOf(unlike, options), EndsWith("in the order of the chain"));
}

TEST(TableBuilder, NamesInTextsAreShortAndHarmless) {
  Message message = armMessage();
  std::string long_name = "x";
  for (int i = 0; i < 50000; ++i) {
    long_name += "\xc3\xa9";
  }
  message.names = {long_name, "\x1b[31mred\n", "z"};
  EXPECT_THAT(logErrorOf(message), HasSubstr(" bytes left out ...] "));
  EXPECT_THAT(logErrorOf(message), HasSubstr(", \\x1b[31mred\\n, z; give"));
  EXPECT_LT(logErrorOf(message).size(), 300U);
  message.names = Strings(10000, "n");
  EXPECT_THAT(logErrorOf(message), HasSubstr("n, n and 9980 others; give"));
}

TEST(TableBuilder, MayLackEffortsWhereTheyAreNotRequired) {
  Message message = armMessage();
  message.effort.clear();
  EXPECT_THAT(logErrorOf(message), HasSubstr("effort: expected 3 numbers"));
  EXPECT_EQ(logErrorOf(message, optionsOf({"a", "b"}, false)), "no error");

  Built builder({"a", "b"}, false);
  builder.add(message.sample());
  EXPECT_THAT(errorOf<RecordingError>([&] { builder.add(armMessage().sample()); }),
              HasSubstr("effort: expected none, as in those before"));
}

TEST(TableBuilder, KeepsRecordedAccelerations) {
  Built builder({"a", "b"});
  Message message = armMessage();
  message.acceleration = {2000, 9000, 1000};
  builder.add(message.sample());
  EXPECT_EQ(builder.finish().qdd, Eigen::Vector2d(1000, 2000));
}

TEST(TableBuilder, SaysWhichSampleHasNoAccelerations) {
  Built builder({"a", "b"});
  Message message = armMessage();
  message.acceleration = {2000, 9000, 1000};
  builder.add(message.sample());
  EXPECT_THAT(
      errorOf<RecordingError>([&] { builder.add(armMessage().sample()); }),
      HasSubstr("acceleration: expected 3 numbers, one per name, got an empty array; others "
                "before it have some"));
}

TEST(TableBuilder, RefusesANameTwice) {
  EXPECT_THAT(errorOf<RecordingError>([] {
                Built({"a", "a"});
              }),
              HasSubstr("expected each name once, got a, a"));
}

}  // namespace inverse_dynamics_evaluation::table_builder_test
