// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/parameters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "node_parameters_stand_in.hpp"

namespace inverse_dynamics_solver::parameters_test {

using conformance::errorOf;
using stand_in::NodeParameters;
using stand_in::NodeParametersInterface;

/// The implicit conversion that initialize() relies on.
Parameters implicitly(const Parameters& parameters) { return parameters; }

TEST(Parameters, AreEmptyFromNothing) {
  EXPECT_FALSE(implicitly({}).find("root"));
  EXPECT_FALSE(implicitly(nullptr).find("root"));
  EXPECT_FALSE(implicitly(NodeParametersInterface::SharedPtr()).find("root"));
  EXPECT_FALSE(implicitly(NodeParametersInterface::ConstSharedPtr()).find("root"));
}

TEST(Parameters, WatchedTellWhatIsAskedFor) {
  std::vector<std::string> asked;
  const Parameters watched = Parameters({{"tip", "tool0"}}).watched([&](const std::string& name) {
    asked.push_back(name);
  });
  EXPECT_EQ(watched.get<std::string>("tip"), "tool0");
  EXPECT_FALSE(watched.find("root"));
  EXPECT_EQ(asked, (std::vector<std::string>{"tip", "root"}));
}

TEST(Parameters, AreReadFromASharedPointerToNodeParameters) {
  const auto node = std::make_shared<NodeParameters>();
  node->values = {{"b", true},
                  {"i", std::int64_t{-3}},
                  {"d", 2.5},
                  {"s", std::string("tool0")},
                  {"bs", std::vector<bool>{true, false}},
                  {"is", std::vector<std::int64_t>{1, 2}},
                  {"ds", std::vector<double>{0.0, -9.81}},
                  {"ss", std::vector<std::string>{"x", "y"}}};

  // As rclcpp::Node::get_node_parameters_interface() returns it, as a const one, as the class
  // itself.
  for (const Parameters& p :
       {implicitly(NodeParametersInterface::SharedPtr(node)),
        implicitly(NodeParametersInterface::ConstSharedPtr(node)), implicitly(node)}) {
    EXPECT_EQ(p.get<bool>("b"), true);
    EXPECT_EQ(p.get<std::int64_t>("i"), -3);
    EXPECT_EQ(p.get<double>("d"), 2.5);
    EXPECT_EQ(p.get<std::string>("s"), "tool0");
    EXPECT_EQ(p.get<std::vector<bool>>("bs"), (std::vector<bool>{true, false}));
    EXPECT_EQ(p.get<std::vector<std::int64_t>>("is"), (std::vector<std::int64_t>{1, 2}));
    EXPECT_EQ(p.get<std::vector<double>>("ds"), (std::vector<double>{0.0, -9.81}));
    EXPECT_EQ(p.get<std::vector<std::string>>("ss"), (std::vector<std::string>{"x", "y"}));
    EXPECT_FALSE(p.find("absent"));
  }
}

TEST(Parameters, DeclaredButNotSetIsAbsent) {
  const auto node = std::make_shared<NodeParameters>();
  node->values = {{"tip", std::monostate()}};
  EXPECT_FALSE(Parameters(node).find("tip"));
}

TEST(Parameters, AreReadAtTheMomentOfAskingAndKeepTheNodeAlive) {
  auto node = std::make_shared<NodeParameters>();
  NodeParameters& values = *node;
  const Parameters parameters = node;
  node.reset();
  EXPECT_FALSE(parameters.find("tip"));
  values.values["tip"] = std::string("tool0");
  EXPECT_EQ(parameters.get<std::string>("tip"), "tool0");
}

TEST(Parameters, AreFoundWhereTheyAreSetFromOutsideDeclaredOrNot) {
  const auto node = std::make_shared<NodeParameters>();
  node->overrides = {{"ids.tip", {std::string("tool0")}}, {"ids.root", {std::string("world")}}};
  node->values = {{"ids.root", std::string("base_link")}, {"ids.gravity", std::monostate()}};
  const NodeParametersInterface::ConstSharedPtr interface = node;
  const Parameters parameters = interface;
  EXPECT_EQ(parameters.get<std::string>("ids.tip"), "tool0");
  EXPECT_EQ(parameters.get<std::string>("ids.root"), "base_link");
  EXPECT_EQ(parameters.names(), (std::vector<std::string>{"ids.root", "ids.tip"}));
  EXPECT_TRUE(parameters.isShared());
}

TEST(Parameters, NameWhatTheyHold) {
  const Parameters parameters = {{"tip", "tool0"}, {"ids.root", "base_link"}};
  EXPECT_EQ(parameters.names(), (std::vector<std::string>{"ids.root", "tip"}));
  EXPECT_FALSE(parameters.isShared());
  EXPECT_EQ(Parameters::fromYaml("ids: {tip: a, unset: }").names(),
            std::vector<std::string>{"ids.tip"});
  EXPECT_TRUE(Parameters().names().empty());
  EXPECT_TRUE(implicitly(NodeParametersInterface::SharedPtr()).strict().names().empty());
}

TEST(Parameters, StrictOnesStaySoAndAreListed) {
  EXPECT_FALSE(Parameters({{"tip", "tool0"}}).isStrict());
  const Parameters strict = Parameters({{"tip", "tool0"}}).strict().watched([](const auto&) {});
  EXPECT_TRUE(strict.isStrict());
  EXPECT_EQ(strict.names(), std::vector<std::string>{"tip"});
}

TEST(Parameters, ListOfBytesIsRefused) {
  const auto node = std::make_shared<NodeParameters>();
  node->values = {{"ids.tip", std::vector<std::uint8_t>{1}}};
  const std::string error =
      errorOf<InvalidParameterValueException>([&] { Parameters(node).find("ids.tip"); });
  EXPECT_EQ(error,
            "parameter 'ids.tip': wrong type: expected bool, integer, double, string, or a list of "
            "these, got list of bytes; correct it where it is set");
}

TEST(Parameters, AreMadeFromAMapAsItIsWritten) {
  const Parameters parameters = {
      {"root", "base_link"}, {"friction", false}, {"max_threads", 4}, {"mass", 2.0}};
  EXPECT_EQ(parameters.get<std::string>("root"), "base_link");
  EXPECT_EQ(parameters.get<bool>("friction"), false);
  EXPECT_EQ(parameters.get<std::int64_t>("max_threads"), 4);
  EXPECT_EQ(parameters.get<double>("mass"), 2.0);
  EXPECT_EQ(implicitly({{"tip", "tool0"}}).get<std::string>("tip"), "tool0");
}

TEST(Parameters, IntegersPassForDoublesAndNothingElseIsConverted) {
  const Parameters parameters = {{"i", 3},
                                 {"is", std::vector<std::int64_t>{0, 0, -9}},
                                 {"none", std::vector<std::string>{}},
                                 {"s", "3.0"}};
  EXPECT_EQ(parameters.get<double>("i"), 3.0);
  EXPECT_EQ(parameters.get<std::vector<double>>("is"), (std::vector<double>{0, 0, -9}));
  EXPECT_EQ(parameters.get<std::vector<double>>("none"), std::vector<double>{});
  const std::string error =
      errorOf<InvalidParameterValueException>([&] { parameters.get<double>("s"); });
  EXPECT_EQ(error,
            "parameter 's': wrong type: expected double, got string; correct it where it is set");
  EXPECT_THROW(parameters.get<bool>("i"), InvalidParameterValueException);
  EXPECT_THROW(parameters.get<std::string>("i"), InvalidParameterValueException);
  EXPECT_THROW(parameters.get<std::vector<double>>("i"), InvalidParameterValueException);
}

TEST(Parameters, RequireThrowsForWhatIsAbsent) {
  const Parameters parameters = {{"mass", 2.0}};
  EXPECT_EQ(parameters.require<double>("mass"), 2.0);
  const std::string error =
      errorOf<ParameterUninitializedException>([&] { parameters.require<double>("ids.length"); });
  EXPECT_EQ(error,
            "parameter 'ids.length': not set: expected double, got nothing; set it; it has no "
            "default");
}

TEST(ParametersFromYaml, NestedMapsBecomeDottedNames) {
  const Parameters parameters = Parameters::fromYaml(R"(
ids:
  root: base_link
  tip: "1"
  gravity: [0, 0, -9.81]
  counts: [1, 2]
  names: [a, b]
  flags: [true, false]
  friction: false
  max_threads: 4
  mass: 1.5e1
  empty: []
  unset:
  locked_joints: {finger: 0.02}
ids.dotted: 1
)");
  EXPECT_EQ(parameters.get<std::string>("ids.root"), "base_link");
  EXPECT_EQ(parameters.get<std::string>("ids.tip"), "1");  // in quotes: a string
  EXPECT_EQ(parameters.get<std::vector<double>>("ids.gravity"), (std::vector<double>{0, 0, -9.81}));
  EXPECT_EQ(parameters.get<std::vector<std::int64_t>>("ids.counts"),
            (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(parameters.get<std::vector<std::string>>("ids.names"),
            (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(parameters.get<std::vector<bool>>("ids.flags"), (std::vector<bool>{true, false}));
  EXPECT_EQ(parameters.get<bool>("ids.friction"), false);
  EXPECT_EQ(parameters.get<std::int64_t>("ids.max_threads"), 4);
  EXPECT_EQ(parameters.get<double>("ids.mass"), 15.0);
  EXPECT_EQ(parameters.get<std::vector<double>>("ids.empty"), std::vector<double>{});
  EXPECT_FALSE(parameters.find("ids.unset"));
  EXPECT_EQ(parameters.get<double>("ids.locked_joints.finger"), 0.02);
  EXPECT_EQ(parameters.get<double>("ids.dotted"), 1.0);
  EXPECT_FALSE(Parameters::fromYaml("").find("anything"));
}

TEST(ParametersFromYaml, RosParameterFilesAreUnderstood) {
  const Parameters parameters = Parameters::fromYaml(R"(
/**:
  ros__parameters:
    robot_description: <robot/>
    ids: {tip: tool0}
)");
  EXPECT_EQ(parameters.get<std::string>("robot_description"), "<robot/>");
  EXPECT_EQ(parameters.get<std::string>("ids.tip"), "tool0");
}

TEST(ParametersFromYaml, MistakesNameTheirLine) {
  const auto error = [](const std::string& text) {
    return errorOf<InvalidParameterValueException>(
        [&] { Parameters::fromYaml(text, "ur10.yaml"); });
  };
  EXPECT_EQ(error("a: 1\nb: [1, x]"),
            "ur10.yaml:2: b[1]: expected a number, as the entries before it, got 'x'");
  EXPECT_EQ(error("a: [[1]]"),
            "ur10.yaml:1: a[0]: expected a text, a number, true or false, got a list of 1");
  EXPECT_EQ(error("ids: {tip: a}\nids.tip: b"),
            "ur10.yaml:2: ids.tip: stands here for a second time");
  EXPECT_EQ(error("- 1"), "ur10.yaml:1: expected keys with values, got a list of 1");
  EXPECT_EQ(error("a: [1,").rfind("ur10.yaml:1: isn't YAML: ", 0), 0U) << error("a: [1,");
  EXPECT_EQ(error("/a:\n  ros__parameters: {b: 1}\n/c:\n  ros__parameters: {b: 1}\n"),
            "ur10.yaml:4: /c.ros__parameters.b: parameter 'b' stands here for a second time");
}

TEST(ParametersFromYaml, FilesAreReadOrTheErrorNamesThem) {
  const std::string path = ::testing::TempDir() + "parameters_test.yaml";
  std::ofstream(path) << "tip: tool0\n";
  EXPECT_EQ(Parameters::fromYamlFile(path).get<std::string>("tip"), "tool0");
  std::ofstream(path) << "tip: [\n";
  EXPECT_NE(errorOf<InvalidParameterValueException>([&] {
              Parameters::fromYamlFile(path);
            }).find(path + ":"),
            std::string::npos);
  std::remove(path.c_str());
  const std::string error = errorOf<Exception>([&] { Parameters::fromYamlFile(path); });
  EXPECT_EQ(error, path + ": can't be read (No such file or directory)");
}

}  // namespace inverse_dynamics_solver::parameters_test
