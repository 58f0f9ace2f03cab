// SPDX-License-Identifier: Apache-2.0

#include "rosbag2_compatibility.hpp"

#include <gtest/gtest.h>

namespace inverse_dynamics_ros {
namespace {

struct MessageUpToIron {
  std::int64_t time_stamp = 3;
};

struct MessageFromJazzyOn {
  std::int64_t recv_timestamp = 5;
  std::int64_t send_timestamp = 7;
};

TEST(Rosbag2Compatibility, FindsTheTimeOfReceptionWhateverItIsCalled) {
  EXPECT_EQ(receiveStamp(MessageUpToIron()), 3);
  EXPECT_EQ(receiveStamp(MessageFromJazzyOn()), 5);
  rosbag2_storage::SerializedBagMessage message{};
  EXPECT_EQ(receiveStamp(message), 0);
}

}  // namespace
}  // namespace inverse_dynamics_ros
