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

// Tells everybody the time, and waits until the manager knows it: from ros2_control 4.22 on it gives
// controllers its own clock's time, which follows /clock in another thread.
void publish(const rclcpp::Time& now, rclcpp::Publisher<Clock>& publisher,
             rclcpp::Clock& managers) {
  using namespace std::chrono_literals;
  Clock clock;
  clock.clock = now;
  auto again = std::chrono::steady_clock::now();
  while (rclcpp::ok()) {
    if (std::chrono::steady_clock::now() >= again) {  // messages of /clock may get lost
      publisher.publish(clock);
      again += 20ms;
    }
    if (managers.now().nanoseconds() >= now.nanoseconds()) return;
    std::this_thread::sleep_for(20us);
  }
}

// Cycles until the end of the program.
void run(ControllerManager& manager, rclcpp::Publisher<Clock>& publisher) {
  const auto period = std::chrono::nanoseconds(1'000'000'000 / manager.get_update_rate());
  auto next = std::chrono::steady_clock::now();
  rclcpp::Time now(0, 0, RCL_ROS_TIME);
  while (rclcpp::ok()) {
    now += rclcpp::Duration(period);
    publish(now, publisher, *manager.get_clock());
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
