// SPDX-License-Identifier: Apache-2.0
/// @file
/// A controller manager whose clock is that of the simulation: each cycle takes exactly one period,
/// however long it takes to compute. Publishes /clock; everybody else sets use_sim_time.
///
///     simulated_controller_manager --ros-args --params-file ur10.yaml -p use_sim_time:=true
///
/// With ros2_control_node a simulation that is late would be given long periods, and controllers
/// long delays: no fault of theirs. It never runs faster than real time.
#include <algorithm>
#include <chrono>
#include <controller_manager/controller_manager.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosgraph_msgs/msg/clock.hpp>
#include <thread>

namespace {

using controller_manager::ControllerManager;
using rosgraph_msgs::msg::Clock;

// Cycles until the end of the program.
void run(ControllerManager& manager, rclcpp::Publisher<Clock>& publisher) {
  const auto period = std::chrono::nanoseconds(1'000'000'000 / manager.get_update_rate());
  auto next = std::chrono::steady_clock::now();
  rclcpp::Time now(0, 0, RCL_ROS_TIME);
  while (rclcpp::ok()) {
    now += rclcpp::Duration(period);
    Clock clock;
    clock.clock = now;
    publisher.publish(clock);

    manager.read(now, rclcpp::Duration(period));
    manager.update(now, rclcpp::Duration(period));
    manager.write(now, rclcpp::Duration(period));

    next = std::max(next + period, std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
}

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  const auto executor = std::make_shared<rclcpp::executors::MultiThreadedExecutor>();
  const auto manager = std::make_shared<ControllerManager>(executor, "controller_manager");
  const auto publisher = manager->create_publisher<Clock>("/clock", rclcpp::ClockQoS());
  executor->add_node(manager);
  std::thread loop([&] { run(*manager, *publisher); });
  executor->spin();
  loop.join();
  rclcpp::shutdown();
  return 0;
}
