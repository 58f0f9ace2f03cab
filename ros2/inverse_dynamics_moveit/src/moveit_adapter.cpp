// SPDX-License-Identifier: Apache-2.0

/// @file
/// MoveIt 2's response adapter: planned paths get the shortest time within the torque limits.
///
/// In a pipeline's `response_adapters` it stands in place of AddTimeOptimalParameterization. Parameters of
/// the node `retime`, below `PIPELINE.retime.`. Scaling factors of a request slow the whole motion.
/// MoveIt's states hold accelerations or efforts, not both: the trajectory has accelerations.

#include <algorithm>
#include <class_loader/class_loader.hpp>
#include <cmath>
#include <exception>
#include <inverse_dynamics_ros/retiming.hpp>
#include <memory>
#include <moveit/planning_interface/planning_response_adapter.hpp>
#include <moveit/robot_trajectory/robot_trajectory.hpp>
#include <rclcpp/logging.hpp>
#include <rclcpp/node.hpp>
#include <string>

namespace inverse_dynamics_moveit {

using inverse_dynamics_ros::Retiming;

class AddTorqueLimitedTiming : public planning_interface::PlanningResponseAdapter {
 public:
  void initialize(const rclcpp::Node::SharedPtr& node, const std::string& pipeline) override {
    logger_ = node->get_logger().get_child("retime");
    retiming_.reset(new Retiming(Retiming::ofNode(*node, pipeline + ".retime.")));
  }

  std::string getDescription() const override { return "AddTorqueLimitedTiming"; }

  void adapt(const planning_scene::PlanningSceneConstPtr&,
             const planning_interface::MotionPlanRequest& request,
             planning_interface::MotionPlanResponse& response) const override {
    using moveit_msgs::msg::MoveItErrorCodes;
    if (!response.trajectory) {
      RCLCPP_ERROR(logger_, "no path to time: expected a planner before this adapter");
      response.error_code.val = MoveItErrorCodes::INVALID_MOTION_PLAN;
      return;
    }
    moveit_msgs::msg::RobotTrajectory planned;
    response.trajectory->getRobotTrajectoryMsg(planned);
    try {
      auto timed = retiming_->timed(retiming_->path(planned.joint_trajectory), retiming_->limits(),
                                    slower(request));
      timed.header = planned.joint_trajectory.header;
      for (auto& point : timed.points) point.effort.clear();
      const moveit::core::RobotState start = response.trajectory->getFirstWayPoint();
      response.trajectory->setRobotTrajectoryMsg(start, timed);
      response.error_code.val = MoveItErrorCodes::SUCCESS;
    } catch (const std::exception& error) {
      RCLCPP_ERROR(logger_, "%s", error.what());
      response.error_code.val = MoveItErrorCodes::FAILURE;
    }
  }

 private:
  // How many times as long the motion takes: velocities fall with it, accelerations with its square. Outside 0
  // to 1 a factor is 1, as in MoveIt.
  static double slower(const planning_interface::MotionPlanRequest& request) {
    const auto share = [](double factor) { return factor > 0 && factor <= 1 ? factor : 1.0; };
    return std::max(1 / share(request.max_velocity_scaling_factor),
                    1 / std::sqrt(share(request.max_acceleration_scaling_factor)));
  }

  rclcpp::Logger logger_ = rclcpp::get_logger("retime");
  std::unique_ptr<Retiming> retiming_;
};

}  // namespace inverse_dynamics_moveit

CLASS_LOADER_REGISTER_CLASS(inverse_dynamics_moveit::AddTorqueLimitedTiming,
                            planning_interface::PlanningResponseAdapter)
