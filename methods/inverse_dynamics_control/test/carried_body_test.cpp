// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/carried_body.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp>
#include <utility>
#include <variant>
#include <vector>

namespace inverse_dynamics_control::carried_body_test {
namespace {

using Numbers = std::vector<double>;

// The part of rclcpp that is used, without threads: the test calls what an executor calls.
struct Value {
  std::variant<double, Numbers> of;
  template <class T>
  const T& get() const {
    return std::get<T>(of);
  }
  bool operator==(const Value& other) const { return of == other.of; }
};

struct Parameter {
  std::string name;
  Value value;
  const std::string& get_name() const { return name; }
  const Value& get_parameter_value() const { return value; }
  double as_double() const { return value.get<double>(); }
};

struct Result {
  bool successful = false;
  std::string reason;
};

struct Interface {
  std::map<std::string, Value> values{{"payload.mass", {0.0}},
                                      {"payload.center_of_mass", {Numbers(3, 0.0)}},
                                      {"payload.inertia", {Numbers(6, 0.0)}},
                                      {"payload.ramp_time", {1.0}}};
  std::function<Result(const std::vector<Parameter>&)> check;

  Parameter get_parameter(const std::string& name) const { return {name, values.at(name)}; }
  Result set_parameters_atomically(const std::vector<Parameter>& wanted) {
    const Result result = check(wanted);
    for (const Parameter& parameter : wanted) {
      if (result.successful) values[parameter.name] = parameter.value;
    }
    return result;
  }
};

struct Time {
  std::int64_t stamp;
  std::int64_t nanoseconds() const { return stamp; }
};
struct Clock {
  std::int64_t stamp = 0;
  Time now() const { return {stamp}; }
};

struct Message {
  struct {
    std::string frame_id;
  } header;
  struct {
    double m = 0, ixx = 0, ixy = 0, ixz = 0, iyy = 0, iyz = 0, izz = 0;
    struct {
      double x = 0, y = 0, z = 0;
    } com;
  } inertia;
};

struct Node {
  std::shared_ptr<Interface> parameters = std::make_shared<Interface>();
  std::shared_ptr<Clock> clock = std::make_shared<Clock>();
  std::vector<std::function<void()>> timers;
  std::function<void(const Message&)> send;

  std::shared_ptr<Interface> get_node_parameters_interface() { return parameters; }
  std::shared_ptr<Clock> get_clock() { return clock; }
  Parameter get_parameter(const std::string& name) { return parameters->get_parameter(name); }
  std::shared_ptr<void> add_on_set_parameters_callback(
      std::function<Result(const std::vector<Parameter>&)> check) {
    parameters->check = std::move(check);
    return nullptr;
  }
  std::shared_ptr<void> create_wall_timer(std::chrono::milliseconds, std::function<void()> call) {
    timers.push_back(std::move(call));
    return nullptr;
  }
  template <class T>
  std::shared_ptr<void> create_subscription(const std::string&, int,
                                            std::function<void(const T&)> receive, int) {
    send = std::move(receive);
    return nullptr;
  }

  Result set(const std::string& name, const Value& value) {
    return parameters->set_parameters_atomically({{name, value}});
  }
  void spin(double seconds) {
    clock->stamp += std::llround(1e9 * seconds);
    for (const auto& timer : timers) timer();
  }
};

// From iron on.
struct NewerNode : Node {
  std::function<void(const std::vector<Parameter>&)> changed;
  std::shared_ptr<void> add_post_set_parameters_callback(
      std::function<void(const std::vector<Parameter>&)> call) {
    changed = std::move(call);
    return nullptr;
  }
};

class CarriedBodyTest : public testing::Test {
 protected:
  void SetUp() override { arm->initialize(); }
  void use() { carried.use(carried.rampOf(arm), "tool0"); }
  double shoulder() const { return arm->getGravityVector(q)[1]; }

  Node node;
  std::string log;
  const std::shared_ptr<InverseDynamicsSolver> arm =
      std::make_shared<ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10>();
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(6);
  CarriedBody<Node, Message> carried{node, 1, 1, [this](const std::string& line) { log += line; }};
};

TEST_F(CarriedBodyTest, ChangesTakeTheTimeOfTheRampOnTheNodesClock) {
  use();
  const double empty = shoulder();
  ASSERT_TRUE(node.set("payload.mass", {2.0}).successful);
  node.spin(0.0);
  EXPECT_EQ(shoulder(), empty);
  for (int k = 0; k < 5; ++k) node.spin(0.1);
  const double half = shoulder();
  EXPECT_NE(half, empty);
  for (int k = 0; k < 6; ++k) node.spin(0.1);
  EXPECT_NEAR(shoulder() - empty, 2.0 * (half - empty), 1e-9);
}

TEST_F(CarriedBodyTest, ChangesAreTakenWithoutATimerWhereTheNodeTellsOfThem) {
  NewerNode newer;
  const CarriedBody<NewerNode, Message> body(newer, 1, 1, [](const std::string&) {});
  EXPECT_EQ(newer.timers.size(), 1u);  // the ramp's
  ASSERT_TRUE(newer.set("payload.mass", {2.0}).successful);
  EXPECT_EQ(body.body().mass, 0.0);  // another check may refuse it
  newer.changed({});
  EXPECT_EQ(body.body().mass, 2.0);
}

TEST_F(CarriedBodyTest, AJumpOfTheClockIsNoJumpOfTorques) {
  use();
  const double empty = shoulder();
  node.set("payload.mass", {2.0});
  node.spin(0.0);
  node.spin(1e6);
  const double jumped = shoulder() - empty;
  node.spin(-2e6);
  EXPECT_EQ(shoulder() - empty, jumped);
  for (int k = 0; k < 10; ++k) node.spin(0.1);
  EXPECT_NEAR(shoulder() - empty, 10.0 * jumped, 1e-9);
}

TEST_F(CarriedBodyTest, WhatIsNoBodyIsRefusedAndChangesNothing) {
  use();
  ASSERT_TRUE(node.set("payload.mass", {2.0}).successful);
  const Result refused = node.set("payload.inertia", {Numbers{1.0, 0.0, 0.0, 1.0, 0.0, 3.0}});
  EXPECT_FALSE(refused.successful);
  EXPECT_EQ(refused.reason.find("parameter payload.inertia: no possible body: "), 0u);
  node.spin(0.0);
  EXPECT_EQ(carried.body().mass, 2.0);
  Message message;
  message.inertia.m = 1.0;
  message.header.frame_id = "flange";
  node.send(message);
  EXPECT_EQ(log.find("~/payload: ignored: header.frame_id: another frame: expected the tip tool0"),
            0u)
      << log;
  EXPECT_EQ(carried.body().mass, 2.0);
}

TEST_F(CarriedBodyTest, ABodyThatCameBeforeTheSolverIsCarriedFromItsFirstTorqueOn) {
  const double empty = shoulder();
  Message message;
  message.inertia.m = 2.0;
  node.send(message);
  EXPECT_EQ(log, "");
  use();
  EXPECT_NE(shoulder(), empty);
}

}  // namespace
}  // namespace inverse_dynamics_control::carried_body_test
