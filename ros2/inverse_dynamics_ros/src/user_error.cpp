// SPDX-License-Identifier: Apache-2.0

#include "user_error.hpp"

#include <exception>
#include <inverse_dynamics_evaluation/error.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <rclcpp/exceptions.hpp>
#include <rclcpp/parameter_value.hpp>
#include <string>

namespace inverse_dynamics_ros {
namespace {

template <class... Errors>
bool isOneOf(const std::exception& error) {
  return ((dynamic_cast<const Errors*>(&error) != nullptr) || ...);
}

}  // namespace

Failure failureOf(const std::exception& error) {
  if (isOneOf<rclcpp::exceptions::InvalidParameterTypeException, rclcpp::ParameterTypeException>(
          error)) {
    return {kExitUserError,
            std::string(error.what()) +
                " A list has brackets: [a]. A number with a decimal point (5.0) is a "
                "double, without one (5) an integer."};
  }
  const bool repairable = isOneOf<
      UserError, inverse_dynamics_solver::Exception, inverse_dynamics_evaluation::EvaluationError,
      inverse_dynamics_evaluation::ConfigurationError, inverse_dynamics_evaluation::RecordingError,
      rclcpp::exceptions::InvalidParametersException, rclcpp::exceptions::RCLInvalidROSArgsError,
      rclcpp::exceptions::InvalidParameterValueException,
      rclcpp::exceptions::ParameterUninitializedException>(error);
  return {repairable ? kExitUserError : kExitUnexpected, error.what()};
}

}  // namespace inverse_dynamics_ros
