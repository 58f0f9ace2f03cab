// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/run_configuration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <inverse_dynamics_solver/parameters.hpp>
#include <optional>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/package_share.hpp"

namespace inverse_dynamics_evaluation::run_configuration_test {

namespace fs = std::filesystem;
using inverse_dynamics_solver::ParameterValue;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kLeast =
    "schema: 1\nname: mine\ndescription: |\n  My robot\nplugin: package/Class\n";

/// A directory with a workspace that has the project's robots; both are gone after the test.
class RunConfigurations : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "run_configuration_test_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
    const fs::path index = folder_ / "share/ament_index/resource_index/packages";
    fs::create_directories(index);
    std::ofstream(index / "inverse_dynamics_robots").flush();
    fs::create_directory_symlink(INVERSE_DYNAMICS_ROBOTS_DIR,
                                 folder_ / "share/inverse_dynamics_robots");
    ::setenv("AMENT_PREFIX_PATH", folder_.c_str(), 1);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& text) const {
    const fs::path file = folder_ / "mine.yaml";
    std::ofstream(file) << text;
    return file;
  }

  std::string errorOf(const std::string& name_or_file) const {
    try {
      readRunConfiguration(name_or_file);
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_;
};

TEST_F(RunConfigurations, AreFoundByNameInTheSourcedWorkspaces) {
  EXPECT_THAT(robotNames(), ::testing::IsSupersetOf({"panda_real", "ur10_real", "ur10_simulated"}));
  for (const std::string& name : robotNames()) {
    const RunConfiguration robot = readRunConfiguration(name);
    EXPECT_EQ(robot.name, name);
    const std::string& file = robot.urdf.empty() ? robot.model : robot.urdf;
    EXPECT_TRUE(fs::is_regular_file(file)) << name << ": " << file;
  }
  EXPECT_THAT(errorOf("ur10_rael"),
              AllOf(StartsWith("robot 'ur10_rael': expected one of "),
                    EndsWith("or a file ending in .yaml or .urdf; did you mean ur10_real?")));
  EXPECT_THAT(errorOf("mine.yaml"),
              HasSubstr("no such file; expected a run configuration, or one"));
  EXPECT_THAT(errorOf(std::string("a\0.yaml", 7)), HasSubstr("no such file"));
  ::unsetenv("AMENT_PREFIX_PATH");
  EXPECT_THROW(robotNames(), PackageNotFoundError);
  EXPECT_THAT(errorOf("ur10_real"), AllOf(HasSubstr("package inverse_dynamics_robots: not found"),
                                          HasSubstr("source the workspace that has it")));
}

TEST_F(RunConfigurations, HoldWhatTheFileSays) {
  std::ofstream(folder_ / "arm.urdf") << "<robot/>";
  const RunConfiguration robot = readRunConfiguration(
      write(std::string(kLeast) +
            "urdf: arm.urdf\nroot: base\ntip: tool\ngravity: [0, -9.81, 0]\ntopic: /states\n"
            "joints: [a, b]\nfriction: false\neffort: current\ndrive_gains: [13.5, 9]\n"
            "accelerations: {method: low-pass, cutoff: 5}\nsource: measured\n"
            "simulation: {rate: 500}\n"
            "parameters: {allow_massless: true, locked_joints: {finger: 0.02}, weights: [1, 2.5],\n"
            "  names: [x], counts: [1, 2], none: []}\n"));
  EXPECT_EQ(robot.description, "My robot");
  EXPECT_EQ(robot.urdf, folder_ / "arm.urdf");
  EXPECT_EQ(robot.topic, "/states");
  EXPECT_EQ(robot.cutoff, 5);
  EXPECT_EQ(robot.effort, "current");
  EXPECT_THAT(robot.drive_gains, ElementsAre(13.5, 9));
  using Value = ParameterValue;
  const SolverParameters expected = {
      {"allow_massless", true},
      {"locked_joints.finger", 0.02},
      {"weights", Value(std::vector<double>{1, 2.5})},
      {"names", Value(std::vector<std::string>{"x"})},
      {"counts", Value(std::vector<std::int64_t>{1, 2})},
      {"none", Value(std::vector<std::int64_t>())},
      {"friction", false},
      {"root", Value(std::string("base"))},
      {"tip", Value(std::string("tool"))},
      {"gravity", Value(std::vector<double>{0, -9.81, 0})},
  };
  EXPECT_EQ(solverParameters(robot), expected);
  const RunConfiguration least = readRunConfiguration(write(kLeast));
  EXPECT_EQ(least.topic, "/joint_states");
  EXPECT_EQ(least.effort, "torque");
  EXPECT_EQ(least.accelerations, "auto");
  EXPECT_EQ(solverParameters(least), (SolverParameters{{"friction", true}}));
}

TEST_F(RunConfigurations, NameAModelOfTheProjectOrAFile) {
  const auto with_model = [this](const std::string& model) {
    return write(std::string(kLeast) + "model: " + model + "\n");
  };
  const fs::path named = readRunConfiguration(with_model("ur10_identified")).model;
  EXPECT_EQ(named.filename(), "ur10_identified.yaml");
  EXPECT_TRUE(fs::is_regular_file(named)) << named;
  EXPECT_THAT(errorOf(with_model("ur10_identifeid")),
              AllOf(HasSubstr("model: expected a file, or the name of a model"),
                    HasSubstr("models/ur10_identifeid.yaml isn't there")));
  EXPECT_THAT(errorOf(with_model("ur10_identified.yaml")), HasSubstr("isn't there"));
}

TEST_F(RunConfigurations, ChangesReplaceWhatBelongsToAField) {
  RunConfiguration robot;
  robot.model = "model.yaml";
  robot.accelerations = "low-pass";
  robot.cutoff = 5;
  replaceAccelerations(robot, {}, {});
  EXPECT_EQ(robot.cutoff, 5);
  replaceDescription(robot, "arm.urdf");
  EXPECT_EQ(robot.urdf, "arm.urdf");
  EXPECT_EQ(robot.model, "") << "the description stands instead of it";
  replaceAccelerations(robot, "given", {});
  EXPECT_EQ(robot.accelerations, "given");
  EXPECT_EQ(robot.cutoff, std::nullopt) << "it belonged to the other method";
  replaceAccelerations(robot, {}, 7);
  EXPECT_EQ(robot.accelerations, "given");
  EXPECT_EQ(robot.cutoff, 7);
}

TEST_F(RunConfigurations, NameTheJointsOfRecordingsInTheOrderOfTheChain) {
  RunConfiguration robot;
  robot.file = "arm.yaml";
  EXPECT_THAT(recordedNames(robot, {"a", "b"}), ElementsAre("a", "b"));
  robot.joints = {"x", "y"};
  EXPECT_THAT(recordedNames(robot, {"a", "b"}), ElementsAre("x", "y"));
  const auto error = [&robot](const std::vector<std::string>& chain) {
    try {
      recordedNames(robot, chain);
    } catch (const ConfigurationError& refused) {
      return std::string(refused.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(error({"a"}),
            "arm.yaml: joints: expected 1 names, one per joint of the chain (a), got 2 (x, y)");
  EXPECT_THAT(error({"y", "x"}), StartsWith("arm.yaml: joints: expected the order of the chain"));
  robot.parameters_of_node = {"joints"};
  EXPECT_THAT(error({"a"}), StartsWith("parameter 'joints': expected 1 names"));
  robot.parameters_of_node.clear();
  robot.file.clear();
  EXPECT_THAT(error({"a"}), StartsWith("parameter 'joints': expected 1 names"));
}

}  // namespace inverse_dynamics_evaluation::run_configuration_test
