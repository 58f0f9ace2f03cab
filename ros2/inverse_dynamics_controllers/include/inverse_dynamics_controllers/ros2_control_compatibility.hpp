// SPDX-License-Identifier: Apache-2.0
/// @file
/// Differences between releases of ros2_control, from humble to rolling.
///
///     const double q = valueOf(state_interfaces_[0]);     // NaN where it can't be read
///     setValue(command_interfaces_[0], tau);
#pragma once

#include <rclcpp/version.h>

#include <array>
#include <controller_interface/chainable_controller_interface.hpp>
#include <controller_interface/controller_interface.hpp>
#include <cstddef>
#include <hardware_interface/handle.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <rclcpp/node_options.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace inverse_dynamics_controllers {
namespace detail {

template <class T, class = void>
struct HasOptional : std::false_type {};
template <class T>
struct HasOptional<T, std::void_t<decltype(std::declval<const T&>().get_optional())>>
    : std::true_type {};

}  // namespace detail

/// Value of an interface, if it can be read: it has a value, which isn't being written. Real time:
/// no allocation, exception or system call.
template <class Interface>
std::optional<double> readable(const Interface& interface) noexcept {
  try {
    if constexpr (detail::HasOptional<Interface>::value) {
      return interface.get_optional();
    } else {
      return interface.get_value();
    }
  } catch (...) {  // an interface without a value
    return std::nullopt;
  }
}

/// The same; NaN where it can't be read.
template <class Interface>
double valueOf(const Interface& interface) noexcept {
  return readable(interface).value_or(std::numeric_limits<double>::quiet_NaN());
}

/// Writes a loaned command interface. Real time: no allocation, exception or system call.
///
/// @return false: it couldn't be written, and keeps its value.
template <class Interface>
bool setValue(Interface& interface, double value) noexcept {
  try {
    if constexpr (std::is_void_v<decltype(interface.set_value(value))>) {
      interface.set_value(value);
      return true;
    } else {
      return interface.set_value(value);
    }
  } catch (...) {  // an interface without a value
    return false;
  }
}

/// The robot description that the controller manager has given; empty where it gives none (humble).
template <class Controller>
std::string robotDescriptionOf([[maybe_unused]] const Controller& controller) {
#if RCLCPP_VERSION_GTE(17, 0, 0)
  return controller.get_robot_description();
#else
  return "";
#endif
}

/// A controller whose node has declared parameters alone, in all releases: no misspelt one is taken.
#if RCLCPP_VERSION_GTE(17, 0, 0)
template <class Base>
using Strict = Base;
#else
template <class Base>
class Strict : public Base {
 public:
  controller_interface::return_type init(const std::string& controller,
                                         const std::string& name_space,
                                         const rclcpp::NodeOptions& options) override {
    return Base::init(controller, name_space,
                      rclcpp::NodeOptions(options)
                          .allow_undeclared_parameters(false)
                          .automatically_declare_parameters_from_overrides(false));
  }
};
#endif

/// Base class of the chainable controllers, the same in all releases.
class ChainableController : public Strict<controller_interface::ChainableControllerInterface> {
 protected:
  /// Names of the references below the controller's; called when it is configured.
  virtual std::vector<std::string> referenceNames() const = 0;

  /// Called in each cycle that isn't in chained mode, before update_and_write_commands().
  virtual void readReferenceTopic() noexcept = 0;

  /// Copies what the controller before has written, in the order of referenceNames(). Real time: no
  /// allocation, exception or system call.
  ///
  /// @param[in,out] values  one that is being written stays as it is.
  void readReferences(std::vector<double>& values) const noexcept {
    for (std::size_t k = 0; k < values.size() && k < size(); ++k) {
      if (shared_.empty()) {
        values[k] = reference_interfaces_[k];
      } else if (const std::optional<double> value = readable(*shared_[k])) {
        values[k] = *value;
      }
    }
  }

  /// Makes all references NaN: not written.
  void forgetReferences() noexcept {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    reference_interfaces_.assign(reference_interfaces_.size(), kNan);
    for (const auto& reference : shared_) setValue(*reference, kNan);
  }

  // NOLINTBEGIN(readability-identifier-naming)
#if RCLCPP_VERSION_GTE(17, 0, 0)
  controller_interface::return_type update_reference_from_subscribers(
      const rclcpp::Time& /*time*/, const rclcpp::Duration& /*period*/) override {
    readReferenceTopic();
    return controller_interface::return_type::OK;
  }
  std::vector<std::shared_ptr<hardware_interface::CommandInterface>>
  on_export_reference_interfaces_list() override {
    shared_.clear();
    for (const std::string& name : referenceNames()) {
      shared_.push_back(
          std::make_shared<hardware_interface::CommandInterface>(get_node()->get_name(), name));
    }
    return shared_;
  }
#else
  controller_interface::return_type update_reference_from_subscribers() override {
    readReferenceTopic();
    return controller_interface::return_type::OK;
  }
  std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() override {
    const std::vector<std::string> names = referenceNames();
    reference_interfaces_.assign(names.size(), std::numeric_limits<double>::quiet_NaN());
    std::vector<hardware_interface::CommandInterface> references;
    for (std::size_t k = 0; k < names.size(); ++k) {
      references.emplace_back(get_node()->get_name(), names[k], &reference_interfaces_[k]);
    }
    return references;
  }
#endif
  // NOLINTEND(readability-identifier-naming)

 private:
  std::size_t size() const noexcept {
    return shared_.empty() ? reference_interfaces_.size() : shared_.size();
  }

  // From jazzy on; in humble references are numbers of the controller.
  std::vector<std::shared_ptr<hardware_interface::CommandInterface>> shared_;
};

/// Whether a Broadcaster has state interfaces.
constexpr bool kExportsStates = RCLCPP_VERSION_GTE(17, 0, 0);

/// Base class of controllers that measure: commands nothing, with the state interfaces of a
/// force-torque sensor that has the controller's name where the release has them.
#if RCLCPP_VERSION_GTE(17, 0, 0)
class Broadcaster : public ChainableController {
 protected:
  /// A cycle.
  virtual controller_interface::return_type measure(const rclcpp::Time& time,
                                                    const rclcpp::Duration& period) noexcept = 0;

  /// Sets the exported states: force, then torque. Real time: no allocation, exception or system call.
  void setStates(const std::array<double, 6>& values) noexcept {
    for (std::size_t k = 0; k < states_.size(); ++k) setValue(*states_[k], values[k]);
  }

  // NOLINTBEGIN(readability-identifier-naming)
  std::vector<std::shared_ptr<hardware_interface::StateInterface>> on_export_state_interfaces_list()
      override {
    states_.clear();
    for (const char* name : {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"}) {
      states_.push_back(
          std::make_shared<hardware_interface::StateInterface>(get_node()->get_name(), name));
    }
    return states_;
  }
  controller_interface::return_type update_and_write_commands(
      const rclcpp::Time& time, const rclcpp::Duration& period) override {
    return measure(time, period);
  }
  // NOLINTEND(readability-identifier-naming)

 private:
  std::vector<std::string> referenceNames() const override { return {}; }
  void readReferenceTopic() noexcept override {}

  std::vector<std::shared_ptr<hardware_interface::StateInterface>> states_;
};
#else
class Broadcaster : public Strict<controller_interface::ControllerInterface> {
 public:
  controller_interface::return_type update(const rclcpp::Time& time,
                                           const rclcpp::Duration& period) override {
    return measure(time, period);
  }

 protected:
  virtual controller_interface::return_type measure(const rclcpp::Time& time,
                                                    const rclcpp::Duration& period) noexcept = 0;
  void setStates(const std::array<double, 6>& /*values*/) noexcept {}
};
#endif

}  // namespace inverse_dynamics_controllers
