// SPDX-License-Identifier: Apache-2.0
//
// Compiled with stand-ins that have what is left of ament_index_cpp's interface in ROS rolling.

#include "../src/ament_index.hpp"

#include <gtest/gtest.h>

namespace inverse_dynamics_solver {
namespace {

TEST(AmentIndexOfRolling, IsRead) {
  EXPECT_EQ(ament_index::packageShare("arm"), "/prefix/share/arm");
  const std::map<std::string, std::string> resources = {{"plugins", "/prefix"}};
  EXPECT_EQ(ament_index::resources("plugins"), resources);
}

}  // namespace
}  // namespace inverse_dynamics_solver
